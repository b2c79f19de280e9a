"""What increments cost while concrete cracks: a dam with two joints in a strong motion."""

from __future__ import annotations

import re
import sys
from functools import partial
from pathlib import Path

from bare_cholmod import BareSolve, measure_beside
from cost_of_joints import TOOLS, run_quietly
from measured_run import Program, Run

PLASTICITY = "*CONCRETE DAMAGED PLASTICITY\n32.5, 0.01, 1.125, 0.6667, 0.\n"
COMPRESSION = "*CONCRETE COMPRESSION HARDENING\n30e6, 0.\n"
# Table 1 of the paper: strength [Pa] and damage over cracking strain.
TABLE_1 = """*CONCRETE TENSION STIFFENING, TYPE=STRAIN
2.480e6, 0.
0.858e6, 0.175e-3
0.545e6, 0.324e-3
0.415e6, 0.469e-3
0.294e6, 0.757e-3
0.234e6, 1.044e-3
0.198e6, 1.330e-3
0.169e6, 1.664e-3
*CONCRETE TENSION DAMAGE, TYPE=STRAIN, COMPRESSION RECOVERY=1.
0., 0.
0.359, 0.175e-3
0.620, 0.324e-3
0.756, 0.469e-3
0.876, 0.757e-3
0.924, 1.044e-3
0.949, 1.330e-3
0.964, 1.664e-3
"""
# A table of openings; elements of this mesh are longer than it allows.
OPENINGS = """*CONCRETE TENSION STIFFENING, TYPE=GFI, LONG ELEMENTS=LOWER STRENGTH
2.5e6, 250.
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT, COMPRESSION RECOVERY=1.
0., 0.
0.9, 2.e-4
"""
LAWS = {"Table 1": TABLE_1, "G_f": OPENINGS}
CASES = [("Table 1", 0.269), ("Table 1", 0.5), ("G_f", 0.5)]  # law, peak of the motion [g]
ELASTIC = r"(\*MATERIAL, NAME=CONCRETE\n\*DENSITY\n\S+\n\*ELASTIC\n.*\n)"
HEAD = (
    "| concrete | peak [g] | unknowns | increments | cut-backs | iterations an increment "
    "| evaluations of laws an increment | laws, share of the increment | increment [ms] "
    "| own solve [ms] | CHOLMOD, same order [ms] | CHOLMOD, METIS [ms] | in own solves "
    "| in solves of CHOLMOD | with METIS |"
)


def write_dam(folder: Path, peak: float, refine: int, duration: float) -> str:
    """The deck of the dam with elastic concrete; increments may be cut."""
    motion, deck = folder / "motion", folder / "cracks.inp"
    make = [sys.executable, str(TOOLS / "make_motion.py"), "-o", str(motion), "--pga", str(peak)]
    run_quietly([*make, "--duration", "4", "--no-pictures"])
    records = [f"{motion}_{axis}.txt" for axis in "xyz"]
    make = [sys.executable, str(TOOLS / "make_dam.py"), "-o", str(deck), "--refine", str(refine)]
    run_quietly([*make, "--duration", str(duration), "--motion", *records])
    return deck.read_text().replace("*DYNAMIC, DIRECT,", "*DYNAMIC,")


def solve_time(run: Run, increments: int) -> float:
    """Seconds of a forward and a backward substitution: elastic increments have one of each."""
    return run.cost("solve (forward|backward) structure")[0] / increments


def measure_cracks(program: Program, folder: Path, refine: int, duration: float) -> str:
    """A table in Markdown, with one row for each concrete and motion."""
    lines = [HEAD, "|" + "---|" * 15]
    for law, peak in CASES:
        text = write_dam(folder, peak, refine, duration)
        elastic = folder / "elastic.inp"
        elastic.write_text(text)
        cards = PLASTICITY + COMPRESSION + LAWS[law]
        deck = folder / "cracks.inp"
        place = re.search(ELASTIC, text).end()
        deck.write_text(text[:place] + cards + text[place:])
        run, bare = measure_beside(program, elastic, partial(program.run, deck))
        lines.append(row(run, program.run(elastic), bare, law, peak))
    return "\n".join(lines)


def row(run: Run, elastic: Run, bare: BareSolve, law: str, peak: float) -> str:
    """One row: the time of all parts that are called in each increment, over that of a solve."""
    step = run.results.find("steps")[-1]
    increments, counts = step["increments"], elastic.results.find("steps")[-1]["increments"]
    parts = [p for p in run.parts if p["calls"] >= increments and p["kind"] != "output"]
    whole = sum(p["wall_s"] for p in parts)
    laws, calls = run.cost("update CONCRETE")
    solves = [solve_time(elastic, counts), bare.same_order, bare.own_order]
    return (
        f"| {law} | {peak} | {run.unknowns} | {increments} | {step['cutbacks']} "
        f"| {step['iterations'] / increments:.1f} | {calls / increments:.1f} "
        f"| {laws / whole:.2f} | {1e3 * whole / increments:.1f} | "
        + " | ".join(f"{1e3 * solve:.2f}" for solve in solves)
        + " | "
        + " | ".join(f"{whole / increments / solve:.1f}" for solve in solves)
        + " |"
    )
