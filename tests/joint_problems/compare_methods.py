#!/usr/bin/env python3
"""Prints the table of docs/studies/joint_problems.md: the methods on the saved problems."""

from __future__ import annotations

import argparse
import sys
import tempfile
from itertools import groupby
from pathlib import Path

from solved import METHODS, SAVED, Solved, solve, unpack

ROOT = Path(__file__).resolve().parents[2]
HEAD = (
    "| problems | points | method | solved | no equilibrium | unsolved | iterations | sweeps | s |"
)


def row_of(group: str, method: str, found: list[Solved]) -> str:
    """Counts of one method on some problems."""
    solved = sum(one.converged for one in found)
    loose = sum(one.is_loose and not one.converged for one in found)
    points = sorted(one.points for one in found)
    cells = [f"{group} ({len(found)})", f"{points[0]}-{points[-1]}", method, solved, loose]
    cells += [len(found) - solved - loose, sum(one.iterations for one in found)]
    cells += [sum(one.sweeps for one in found), f"{sum(one.seconds for one in found):.2f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    place = ROOT / "build/release/tests/joint_problems/solve_joint_problems"
    parser.add_argument("--solver", type=Path, default=place)
    options = parser.parse_args()
    files = sorted(SAVED.glob("*.h5.xz"))
    lines = [HEAD, "|---|---|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        for group, members in groupby(files, key=lambda path: path.name.split("_")[0]):
            plain = unpack(Path(folder), list(members))
            lines += [
                row_of(group.split(".")[0], m, solve(options.solver, m, plain)) for m in METHODS
            ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
