"""One element of concrete in a structure: the points agree with the point driver."""

from __future__ import annotations

import numpy as np
import pytest
from concretes import CRUSHING, JINPING, TABLE_1, Material
from point_decks import PointDeck, material_cards
from reference import closed_forms as exact
from reference.path import Leg

CUBE = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*NSET, NSET=WEST
1, 4, 5, 8
*NSET, NSET=EAST
2, 3, 6, 7
*NSET, NSET=SOUTH
1, 2, 5, 6
*NSET, NSET=FLOOR
1, 2, 3, 4
*ELEMENT, TYPE={element}, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
{material}*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE
*AMPLITUDE, NAME=PATH
{amplitude}*BOUNDARY
WEST, 1, 1
SOUTH, 2, 2
FLOOR, 3, 3
*STEP, INC=100000
*STATIC, DIRECT
{increment!r}, {duration!r}
*CONTROLS, RESIDUAL=1e-9, TANGENT={tangent}
*BOUNDARY, AMPLITUDE=PATH
EAST, 1, 1, 1.
*EL PRINT, ELSET=BODY
S, DAMAGET, DAMAGEC
*END STEP
"""


def cube_deck(material: Material, strains, increments: int, element="C3D8", tangent="AUTO") -> str:
    """A cube of 1 m pulled through strains, its sides free; a second for each leg."""
    times = np.arange(len(strains) + 1)
    values = [0.0, *(float(strain) for strain in strains)]
    return CUBE.format(
        element=element,
        material=material_cards("CONCRETE", material),
        amplitude="".join(f"{t}., {v!r}\n" for t, v in zip(times, values, strict=True)),
        increment=1.0 / increments,
        duration=float(len(strains)),
        tangent=tangent,
    )


def stresses(run, increments: int) -> np.ndarray:
    """S11 of all points at the ends of the legs (legs, points) [Pa]."""
    table = run.csv("el_BODY")
    points = int(table["point"].max())
    return table["S11"].reshape(-1, points)[increments - 1 :: increments]


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_table_1(keyway, element):
    """Each row of Table 1, in all points; 0.2 % is allowed, the iteration gives 1e-6."""
    strain, stress = exact.uniaxial_rows(JINPING.law(), JINPING.tension_curve)
    run = keyway(cube_deck(JINPING, strain, 4, element))
    found = stresses(run, 4)
    assert stress == pytest.approx(TABLE_1[:, 0], rel=1e-12)
    assert found == pytest.approx(np.outer(stress, np.ones(found.shape[1])), rel=1e-5)


@pytest.mark.parametrize("tangent", ["CONSISTENT", "SECANT", "ELASTIC"])
def test_cycles(keyway, tangent):
    """Cracked, closed, crushed and pulled again: as the point driver in the same increments."""
    material = Material(**CRUSHING, tension_recovery=0.5)
    strains = (3e-4, -2e-3, 2e-4, -3e-3)
    found = stresses(keyway(cube_deck(material, strains, 20, tangent=tangent)), 20)
    deck = PointDeck()
    deck.add("T", material, [Leg.of("ESSEEE", [e, 0, 0, 0, 0, 0]) for e in strains], 20)
    curve = deck.run(keyway, "point")["T"]
    expected = curve.at_legs(curve.stress[:, 0], 20)
    scale = np.abs(expected).max()
    # The iteration's residual, 1e-9, on a point with a damage of 0.9.
    assert found == pytest.approx(np.outer(expected, np.ones(8)), abs=1e-6 * scale)


@pytest.mark.parametrize("tangent", ["AUTO", "CONSISTENT"])
@pytest.mark.parametrize("recovery", ["SIGN", "LEE-FENVES"])
def test_energy_up_to_cracking(keyway, recovery, tangent):
    """ENER = S:E/2 in points that are about to crack, and have not (round-off of S:E)."""
    material = Material(recovery=recovery)
    pulled = cube_deck(material, [1.2 * TABLE_1[0, 0] / material.young], 60, tangent=tangent)
    sheared = pulled.replace(
        "*NSET, NSET=FLOOR", "*NSET, NSET=NORTH\n3, 4, 7, 8\n*NSET, NSET=FLOOR"
    )
    sheared = sheared.replace("EAST, 1, 1, 1.\n", "EAST, 1, 1, 1.\nNORTH, 2, 2, -1.\n")
    table = keyway(sheared.replace("S, DAMAGET, DAMAGEC", "S, E, ENER, PE")).csv("el_BODY")
    elastic = table["PE11"] == 0.0
    assert 0.5 < np.mean(elastic) < 0.95
    energy = 0.5 * sum(table["S" + part] * table["E" + part] for part in ("11", "22", "33", "12"))
    assert table["ENER"][elastic] == pytest.approx(energy[elastic], rel=1e-9)
