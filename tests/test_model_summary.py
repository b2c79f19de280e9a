"""What --check says of the steps of a deck: stages, temperatures, forces, clocks of histories."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

INPUT = Path(__file__).resolve().parent.parent / "input"
BASE = Path(__file__).parent / "errors" / "base" / "block.inp"
STEP = "*STEP\n*STATIC\n*DLOAD, AMPLITUDE=RISE\n"


def summary(program: Path, deck: Path) -> str:
    command = [str(program.resolve()), "--check", str(deck)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def step(text: str, name: str) -> list[str]:
    """The rows of a step."""
    first = text.index(f" {name}\n", text.index("\nStep 1 "))
    return text[first : text.index("\nStep ", first)].splitlines()[1:]


def test_stages(program_path) -> None:
    """Counts of the deck: 1472 elements, 294 of which come after the first lift."""
    text = summary(program_path, INPUT / "built_in_lifts/built_in_lifts.inp")
    assert "  model change            0 elements added, 294 removed, 1178 in the step" in step(
        text, "LIFT1"
    )
    assert "  model change            60 elements added, 0 removed, 1472 in the step" in step(
        text, "LIFT8"
    )
    grouted = [line.split()[1] for line in step(text, "GROUT2") if line.startswith("  grout ")]
    assert grouted == ["JOINT1", "JOINT2", "JOINT3", "JOINT4"]
    assert not [line for line in step(text, "WATER") if "change" in line or "grout" in line]


def test_temperatures(program_path) -> None:
    text = summary(program_path, INPUT / "built_in_lifts/built_in_lifts.inp")
    assert "  temperature             548 nodes: 10 at the end of the step" in step(text, "COOL2")
    [seasons] = [line for line in step(text, "SEASONS") if line.startswith("  temperature ")]
    assert seasons.endswith(", table from 0 to 17 s of the step time")


def test_grout_under_pressure(program_path, tmp_path) -> None:
    deck = tmp_path / "lifts.inp"
    text = (INPUT / "built_in_lifts/built_in_lifts.inp").read_text(encoding="utf-8")
    text = text.replace("INPUT=", f"INPUT={INPUT / 'built_in_lifts'}/")
    deck.write_text(
        text.replace("*GROUT, JOINT=JOINT2", "*GROUT, JOINT=JOINT2, PRESSURE=2e5"), encoding="utf-8"
    )
    rows = step(summary(program_path, deck), "GROUT2")
    assert "  grout                   JOINT2, pressure 200000 Pa" in rows


def test_point_forces(program_path) -> None:
    """The deck has nine forces in the tip, 1 MN together."""
    text = summary(program_path, INPUT / "cantilever.inp")
    assert "point forces: factor 0 to 1, sum of the forces 0 0 -1e6 N, loaded nodes: 9\n" in text


@pytest.mark.parametrize("clock", ["STEP TIME", "TOTAL TIME"])
def test_clock_of_an_amplitude(program_path, tmp_path, clock) -> None:
    text = BASE.read_text(encoding="utf-8")
    history = f"*AMPLITUDE, NAME=RISE, TIME={clock}\n0., 0., 2., 3.\n"
    deck = tmp_path / "deck.inp"
    deck.write_text(text.replace("*STEP\n*STATIC\n*DLOAD\n", history + STEP), encoding="utf-8")
    row = f"  RISE                    2 points, 0 to 2 s of the {clock.lower()}, values 0 to 3\n"
    assert row in summary(program_path, deck)


@pytest.mark.parametrize(
    ("option", "expected"), [("ACCURACY=0.02", "ACCURACY 0.02"), ("MODES=12", "MODES 12")]
)
def test_modes_of_a_reduced_model(program_path, tmp_path, option, expected) -> None:
    text = (INPUT / "fragility/fragility.inp").read_text(encoding="utf-8")
    text = text.replace("INPUT=", f"INPUT={INPUT / 'fragility'}/")
    deck = tmp_path / "deck.inp"
    deck.write_text(text.replace("REDUCED, ACCURACY=0.02", f"REDUCED, {option}"), encoding="utf-8")
    assert f"\n  reduced model           {expected}\n" in summary(program_path, deck)


def forecast(program: Path, folder: Path, old: str, new: str) -> float:
    """Forecast time of the matching dam with a change [s]."""
    text = (INPUT / "xingbiling_matching/xingbiling_matching.inp").read_text(encoding="utf-8")
    assert old in text
    text = text.replace("INPUT=", f"INPUT={INPUT / 'xingbiling_matching'}/").replace(old, new)
    (folder / "deck.inp").write_text(text, encoding="utf-8")
    return float(re.search(r"\n  time +about (\S+) s", summary(program, folder / "deck.inp"))[1])


def test_forecast_counts_factored_tangents(program_path, tmp_path) -> None:
    """Each increment of JOINT SOLVER=FULL has some four factors of unsymmetric matrices."""
    usual = forecast(program_path, tmp_path, "*DYNAMIC", "*DYNAMIC")
    full = forecast(program_path, tmp_path, "*DYNAMIC", "*CONTROLS, JOINT SOLVER=FULL\n*DYNAMIC")
    assert full > 3.0 * usual
