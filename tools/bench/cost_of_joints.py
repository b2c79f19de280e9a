"""Ratios of the joint iteration to the equation solver: dams with joints in a strong motion."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from bare_cholmod import measure_beside
from measured_run import Program, Run

TOOLS = Path(__file__).resolve().parent.parent
SHAPE = ["--height", "200", "--crest-arc", "500", "--refine", "2"]
MESH = ["--arc", "44", "--levels", "16", "--bottom", "12", "--thick", "4"]
FINE = ["--arc", "104", "--levels", "40", "--bottom", "24", "--thick", "10", "--refine", "1"]
DAMS = {1: MESH, 2: MESH, 6: MESH, 12: MESH, 25: FINE, 50: FINE}  # joints: options of the mesh
HEAD = (
    "| joints | points | unknowns | solve and joints [ms] | own solve [ms] "
    "| CHOLMOD, same order [ms] | CHOLMOD, METIS [ms] | in own solves | in solves of CHOLMOD "
    "| with METIS | set-up of joints, in factorisations |"
)
PEAK = "0.35"  # of the motion [g]


def write_dam(folder: Path, joints: int, duration: float, more: Sequence[str] = ()) -> Path:
    """The deck of a dam and its motion of three components; `more` options of the mesh."""
    deck, motion = folder / f"joints_{joints}.inp", folder / "motion"
    make = [sys.executable, str(TOOLS / "make_motion.py"), "-o", str(motion), "--pga", PEAK]
    run_quietly([*make, "--duration", "4", "--no-pictures"])
    records = [f"{motion}_{axis}.txt" for axis in "xyz"]
    mesh = [*SHAPE, *DAMS[joints], *more]
    make = [sys.executable, str(TOOLS / "make_dam.py"), "-o", str(deck), *mesh]
    run_quietly([*make, "--joints", str(joints), "--duration", str(duration), "--motion", *records])
    return deck


def run_quietly(command: list[str]) -> None:
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def seconds(run: Run, pattern: str) -> float:
    return run.cost(pattern)[0]


def measure_joints(program: Program, folder: Path, joints: list[int], duration: float) -> str:
    """A table in Markdown, with one row for each dam."""
    lines = [HEAD, "|" + "---|" * 11]
    for number in joints:
        deck = write_dam(folder, number, duration)
        run, bare = measure_beside(program, deck, partial(program.run, deck))
        points = sum(joint["points"] for joint in run.results.find("joints").values())
        solve = seconds(run, "solve (forward|backward) structure")
        iteration = seconds(run, r"(iterate|correct) JOINT\d+")
        increments = sum(step["increments"] for step in run.results.find("steps"))
        each = (solve + iteration) / increments
        times = [solve / increments, bare.same_order, bare.own_order]
        set_up = seconds(run, r"condense JOINT\d+") / seconds(run, "factor structure")
        lines.append(
            f"| {number} | {points} | {run.unknowns} | {1e3 * each:.1f} | "
            + " | ".join(f"{1e3 * time:.1f}" for time in times)
            + " | "
            + " | ".join(f"{each / time:.2f}" for time in times)
            + f" | {set_up:.2f} |"
        )
    return "\n".join(lines)
