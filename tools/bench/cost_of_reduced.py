"""The reduced model against the full one: a dam with joints in a strong motion."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from cost_of_joints import write_dam
from measured_run import Program, Run

MESH = ["--arc", "54"]  # 50 565 unknowns with two joints, for which the ratio is wanted
DATA = {"*NODE PRINT": 1, "*NODE FILE": 1, "*EL FILE": 1, "*ENVELOPE": 1, "*JOINT PRINT": 0}


def openings_only(text: str) -> str:
    """The deck of a dam with the openings of all points in its last step, and no other output."""
    kept, skipped = [], 0
    for line in text.splitlines():
        data = [count for card, count in DATA.items() if line.startswith(card)]
        if data:
            skipped = data[0]
        elif skipped:
            skipped -= 1
        else:
            kept.append(line)
    names = re.findall(r"^\*JOINT, NAME=(\w+)", text, re.MULTILINE)
    head, tail = "\n".join(kept).rsplit("*END STEP", 1)
    return head + "".join(f"*JOINT PRINT, JOINT={n}\n" for n in names) + "*END STEP" + tail + "\n"


def cost_of_increment(run: Run) -> float:
    """Wall seconds of an increment, without output."""
    count = run.results.find("steps")[-1]["increments"]
    repeated = [p for p in run.parts if p["calls"] >= count and p["kind"] != "output"]
    return sum(p["wall_s"] for p in repeated) / count


def openings(run: Run) -> np.ndarray:
    """Openings of all points in all increments [m]."""
    names = list(run.results.find("joints"))
    return np.concatenate([run.results.table(f"joint_{n}")["opening"] for n in names]).clip(0.0)


def measure_reduced(program: Program, folder: Path, joints: int, duration: float) -> str:
    """A table in Markdown."""
    deck = write_dam(folder, joints, duration, MESH)
    text = openings_only(deck.read_text())
    full_deck, reduced_deck = folder / "full.inp", folder / "reduced.inp"
    full_deck.write_text(text)
    reduced_deck.write_text(text.replace("*DYNAMIC,", "*DYNAMIC, REDUCED,"))
    full, reduced = program.run(full_deck), program.run(reduced_deck)
    expected, found = openings(full), openings(reduced)
    largest = expected.max()
    (model,) = reduced.results.find("accuracy.reduced").values()
    whole, part = cost_of_increment(full), cost_of_increment(reduced)
    increments = full.results.find("steps")[-1]["increments"]
    set_up = reduced.wall - part * increments
    points = sum(joint["points"] for joint in full.results.find("joints").values())
    return "\n".join(
        [
            "| unknowns | joints | points | increment, full [ms] | increment, reduced [ms] | ratio "
            "| modes | set-up and output [s] | largest opening [mm] | error of openings "
            "| of the largest opening | estimate |",
            "|" + "---|" * 12,
            f"| {full.unknowns} | {joints} | {points} | {1e3 * whole:.1f} | {1e3 * part:.2f} "
            f"| {whole / part:.0f} | {model['modes']} | {set_up:.0f} | {1e3 * largest:.1f} "
            f"| {100 * np.abs(found - expected).max() / largest:.2f} % "
            f"| {100 * abs(found.max() - largest) / largest:.2f} % "
            f"| {100 * model['estimated_error']:.2f} % |",
        ]
    )
