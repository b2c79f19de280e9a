"""*JOINT PRINT with NSET: of Gauss points equally far from a node the lowest, in all units."""

from __future__ import annotations

import csv
import math
import subprocess
from pathlib import Path

import pytest
from restart_case import bricks

UNITS = {"m": 1.0, "mm": 1000.0, "ft": 1 / 0.3048, "in": 1 / 0.0254}
NODES = ((1, 0), (0, 1), (1, 1), (2, 1), (1, 2))  # MIDDLES, in edges of two units
EQUAL = 1 + 1e-6  # of distances: round-off is smaller, other distances differ by a tenth and more

STEPS = """*MATERIAL, NAME=M
*DENSITY
{density}
*ELASTIC
{young}, 0.2
*SOLID SECTION, ELSET=E, MATERIAL=M
*JOINT LAW, NAME=L, KN={young}, FRICTION=0.7
*SURFACE, NAME=LOW
1, S2
2, S2
3, S2
4, S2
*SURFACE, NAME=HIGH
101, S1
102, S1
103, S1
104, S1
*JOINT, NAME=J, LAW=L, INTEGRATION=GAUSS
HIGH, LOW
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
5, 1, 3
6, 1, 3
7, 1, 3
8, 1, 3
9, 1, 3
*NSET, NSET=MIDDLES
11, 13, 14, 15, 17
*STEP
*STATIC
*CLOAD
114, 3, -1.
*JOINT PRINT, JOINT=J, NSET=MIDDLES
*END STEP
"""


def scaled(node: str, unit: float) -> str:
    number, *x = node.split(", ")
    return ", ".join([number, *(f"{float(value) * unit:.15g}" for value in x)])


def deck(unit: float) -> str:
    low, high = bricks(1, 2, 0.0, 2.0), bricks(101, 2, 1.0, 2.0)
    nodes = [scaled(node, unit) for node in (*low[0], *high[0])]
    lines = ["*NODE", *nodes, "*ELEMENT, TYPE=C3D8I, ELSET=E", *low[1], *high[1]]
    return "\n".join(lines) + "\n" + STEPS.format(density=2400, young=2e10)


def points(program: Path, folder: Path, text: str) -> dict[int, tuple[float, float]]:
    """The points that a deck prints, with their place."""
    folder.mkdir()
    (folder / "job.inp").write_text(text)
    subprocess.run([program, "-q", "-o", folder, folder / "job.inp"], check=True)
    with (folder / "job_joint_J.csv").open() as file:
        return {int(r["point"]): (float(r["x"]), float(r["y"])) for r in csv.DictReader(file)}


@pytest.mark.parametrize("unit", UNITS)
def test_the_lowest_of_equally_near_points(program_path: Path, tmp_path: Path, unit: str):
    """Two or four Gauss points are equally near to a node in the middle of an edge or face."""
    edge = UNITS[unit]
    every = points(program_path, tmp_path / "all", deck(edge).replace(", NSET=MIDDLES\n*E", "\n*E"))
    expected = set()
    for x, y in NODES:
        away = {p: math.dist(place, (x * edge, y * edge)) for p, place in every.items()}
        near = [p for p in away if away[p] <= EQUAL * min(away.values())]
        assert len(near) >= 2
        expected.add(min(near))
    assert set(points(program_path, tmp_path / "some", deck(edge))) == expected
