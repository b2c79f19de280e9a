"""Loads and reactions that mean another thing in CalculiX (docs/compatibility.md).

A cube of one C3D8 of 2400 kg, held at its four lower nodes. CalculiX prints seven digits.
"""

import numpy as np
import pytest
from brick_decks import last_state
from calculix import displacements, needs_calculix, run_calculix, table_below

pytestmark = [pytest.mark.full, needs_calculix]

CUBE = """\
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*NSET, NSET=BASE
1, 2, 3, 4
*ELEMENT, TYPE=C3D8, ELSET=DAM
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=CONCRETE
*ELASTIC
25.e9, 0.2
*DENSITY
2400.
*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 3
"""
WEIGHT, QUAKE = "DAM, GRAV, 9.81, 0., 0., -1.\n", "DAM, GRAV, 2., 1., 0., 0.\n"


def step(loads: str, output: str = "*NODE PRINT, NSET=ALL\nU\n") -> str:
    return f"*STEP\n*STATIC\n*DLOAD\n{loads}{output}*END STEP\n"


@pytest.mark.parametrize(
    ("ours", "theirs"), [(QUAKE, WEIGHT + QUAKE), (WEIGHT + QUAKE, WEIGHT + QUAKE)]
)
def test_gravity_of_another_direction_in_a_later_step(keyway, tmp_path, ours, theirs):
    """CalculiX adds it to that of the earlier step; here the later step has all that acts in it, so
    that a step with both lines is the same in both. Half of the seventh digit is up to 5e-7."""
    lines = run_calculix(CUBE + step(WEIGHT) + step(ours), tmp_path)
    found = last_state(keyway(CUBE + step(WEIGHT) + step(ours)), "ALL")
    both = displacements(lines)[2.0]
    largest = np.abs(both).max()
    assert np.abs(both - last_state(keyway(CUBE + step(theirs)), "ALL")).max() < 1e-6 * largest
    alone = last_state(keyway(CUBE + step(ours)), "ALL")
    assert np.abs(found - alone).max() < 1e-12 * largest  # round-off of two solutions


def test_reactions_hold_the_loads_of_held_nodes_in_calculix(keyway, tmp_path):
    """Half of the weight of one element lies on its lower nodes."""
    deck = CUBE + step(WEIGHT, "*NODE PRINT, NSET=BASE\nRF\n")
    theirs = table_below(run_calculix(deck, tmp_path), "forces")[:, 3].sum()
    ours = keyway(deck).csv("node_BASE")["RF3"].sum()
    assert ours == pytest.approx(2400.0 * 9.81, rel=1e-10)  # equilibrium, to round-off
    assert theirs == pytest.approx(0.5 * 2400.0 * 9.81, rel=1e-6)  # seven digits of four nodes
