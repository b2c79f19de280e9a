"""What --check says of a motion within its step: the peak, and values between the increments."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

BASE = Path(__file__).parent / "errors" / "base" / "block.inp"
STATIC = "*STEP\n*STATIC\n1., 1.\n*END STEP\n"
MODES = "*STEP\n*FREQUENCY\n1\n*END STEP\n"
GROWTH = "they leave out values"


def check(program: Path, folder: Path, history: str, step: str, before: str = ""):
    """Output of --check of a dynamic step with this base motion after other steps."""
    deck = BASE.read_text(encoding="utf-8")
    old = "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n"
    assert old in deck
    motion = f"*STEP\n*DYNAMIC\n{step}\n*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n"
    deck = deck.replace(old, f"*AMPLITUDE, NAME=QUAKE{history}\n{before}{motion}")
    (folder / "deck.inp").write_text(deck, encoding="utf-8")
    command = [str(program.resolve()), "--check", "deck.inp"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)


@pytest.mark.parametrize(
    ("history", "before", "expected"),
    [
        ("0., 0., 0.5, 10., 1., 1., 2., 2., 3., 0.", STATIC, "peak 2 m/s2 = 0.2039 g at t = 2 s"),
        ("0., 0., 0.5, 10., 1.5, 0., 3., 1.", STATIC, "peak 5 m/s2 = 0.5097 g at t = 1 s"),
        ("0., 0., 2., 1., 4., 3.", STATIC, "peak 2 m/s2 = 0.2039 g at t = 3 s"),
        ("0., 0., 2., 1., 4., 3.", STATIC + MODES, "peak 2 m/s2 = 0.2039 g at t = 3 s"),
        ("0., 0., 0.5, 3., 0.9, 1.", STATIC, "peak 1 m/s2 = 0.1019 g at t = 1 s"),
    ],
    ids=["a peak before the step", "at the start", "at the end", "modes take no time", "over"],
)
def test_the_peak_lies_within_the_step(program_path, tmp_path, history, before, expected) -> None:
    """The dynamic step lasts from 1 to 3 s of the total time."""
    done = check(program_path, tmp_path, f", TIME=TOTAL TIME\n{history}", "0.01, 2.", before)
    assert f", {expected}\n" in done.stdout


def sampled(spacing: float, number: int, start: float = 0.0) -> str:
    """A motion with values at equal times."""
    return "".join(f"\n{start + i * spacing:.6g}, {(-1) ** i}." for i in range(number)) + "\n"


@pytest.mark.parametrize(
    ("history", "is_coarse"),
    [
        ("\n0., 0.\n0.001, 1.\n0.002, 0.\n5., 0.\n", False),  # they grow where nothing happens
        (sampled(0.001, 11), False),
        (sampled(0.001, 13), True),
        # Ten increments each of 0.001, 0.002, .. s: 0.008 s long from 0.07 to 0.15 s
        (sampled(0.01, 15), False),
        (sampled(0.01, 40), True),
        (sampled(0.0011, 11, start=0.1) + "5., 0.\n", True),  # a train of pulses later on
        (sampled(0.001, 200, start=3.5), False),  # after the step
        (sampled(0.1, 50), False),
        ("\n0., 0.\n1., 0.\n1.000001, 1.\n2., 0.\n", False),  # a jump is no sampling
    ],
)
def test_increments_that_grow_beyond_a_motion(program_path, tmp_path, history, is_coarse) -> None:
    """The warning looks at the values within each increment alone."""
    done = check(program_path, tmp_path, history, "0.001, 3., 1e-5, 0.1")
    assert (GROWTH in done.stderr) == is_coarse, done.stderr
