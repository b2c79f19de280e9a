"""A brick of a dam on a brick of rock, with or without mass, joined by a JOINT8 or tied."""

from __future__ import annotations

import itertools

SIDES = (0.0, 2.0)
HISTORIES = """*AMPLITUDE, NAME=ALONG, TIME=TOTAL TIME
1., 0., 1.05, 2., 1.1, -3., 1.15, 2., 1.2, 1., 1.4, 0.
*AMPLITUDE, NAME=UPWARDS, TIME=TOTAL TIME
1., 0., 1.07, 4., 1.14, -3., 1.2, 0.
"""
WEIGHT = "*STEP\n*STATIC\n0.5, 1.\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n"
WEIGHT += "*NODE PRINT, NSET=CREST\nU\n*END STEP\n"
SHAKEN = "*BASE MOTION, DOF=1, AMPLITUDE=ALONG\n*BASE MOTION, DOF=3, AMPLITUDE=UPWARDS\n"


def deck(
    steps: str, rock_density: float = 0.0, tied: bool = False, rows: tuple[float, ...] = SIDES
) -> str:
    """The rock from z = 0 to 1, the dam from 1 to 4; the dam is the slave of the joint. The set TOP
    has the inner nodes of the crest, where there are more than two rows along y."""
    heights = (0.0, 1.0, 1.0, 4.0)
    level = 2 * len(rows)
    corners = list(itertools.product(rows, SIDES))
    places = [(x, y, z) for z in heights for y, x in corners]
    lines = "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(places, 1))
    text = f"*NODE, NSET=ALL\n{lines}*NSET, NSET=BASE, GENERATE\n1, {level}\n"
    text += f"*NSET, NSET=CREST\n{3 * level + 1}\n"
    if len(rows) > 2:
        text += f"*NSET, NSET=TOP, GENERATE\n{3 * level + 3}, {4 * level - 2}\n"
    number = len(rows) - 1
    text += f"*ELEMENT, TYPE=C3D8, ELSET=ROCK\n{bricks(1, number, 0, level)}"
    text += f"*ELEMENT, TYPE=C3D8, ELSET=DAM\n{bricks(1 + number, number, 2 * level, level)}"
    density = f"*DENSITY\n{rock_density!r}\n" if rock_density else ""
    text += f"*MATERIAL, NAME=STONE\n{density}*ELASTIC\n3e10, 0.2\n"
    text += "*MATERIAL, NAME=CONCRETE\n*DENSITY\n2400.\n*ELASTIC\n2e10, 0.2\n"
    text += "*DAMPING, ALPHA=1., BETA=0.001\n"
    text += "*SOLID SECTION, ELSET=ROCK, MATERIAL=STONE\n"
    text += "*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE\n"
    if tied:
        text += "*SURFACE, NAME=LOW\nROCK, S2\n*SURFACE, NAME=HIGH\nDAM, S1\n"
        text += "*TIE, NAME=FOOT\nHIGH, LOW\n"
    else:
        text += f"*ELEMENT, TYPE=JOINT8, ELSET=BED\n{bricks(1 + 2 * number, number, level, level)}"
        text += "*JOINT LAW, NAME=LAW, KN=1e11, KT=4e10, FRICTION=0.7\n"
        text += "*JOINT, NAME=BED, LAW=LAW, ELSET=BED\n"
    return text + f"*BOUNDARY\nBASE, 1, 3\n{HISTORIES}{WEIGHT}{steps}"


def bricks(first: int, number: int, offset: int, level: int) -> str:
    """Elements side by side along y, between two levels of nodes."""
    lines = []
    for k in range(number):
        low = [offset + 2 * k + i for i in (1, 2, 4, 3)]
        nodes = low + [node + level for node in low]
        lines.append(f"{first + k}, {', '.join(map(str, nodes))}\n")
    return "".join(lines)


def shaken(duration: float, options: str = "", motion: str = SHAKEN) -> str:
    """A dynamic step."""
    return f"*STEP\n*DYNAMIC{options}\n0.01, {duration!r}\n{motion}*END STEP\n"
