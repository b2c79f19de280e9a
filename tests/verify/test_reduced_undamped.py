"""*DYNAMIC, REDUCED of an undamped block whose joint has another mesh than the rock without mass.

All shapes move the four nodes of the rock alike once the rock follows the block. What was left of
their differences, round-off, stayed among the modes: displacements were 123 times those of the
full model (block of 3 x 3 elements) or 1.7 times (2 x 2), with estimates below 0.03 %."""

from __future__ import annotations

import numpy as np
import pytest
from tied_blocks import Blocks, node_set, state_of

ROCK = "*ELASTIC\n1e10, 0.2\n"
CONCRETE = "*DENSITY\n2400.\n*ELASTIC\n2.5e10, 0.2\n"
CARDS = """*JOINT LAW, NAME=LAW, KN=5e10, KT=2e10, FRICTION=1.
*JOINT, NAME=BED, LAW=LAW
BLOCK_Z0, ROCK_Z1
*AMPLITUDE, NAME=PULSE
0., 0., 0.1, 1., 0.2, 0.
*BOUNDARY
BASE, 1, 3
*STEP
*STATIC
*DLOAD
BLOCK, GRAV, 9.81, 0., 0., -1.
*END STEP
"""
SHAKEN = """*STEP
*DYNAMIC, ALPHA=0{reduced}
0.01, 0.1
*CONTROLS, RESIDUAL=1e-10
*BASE MOTION, DOF=1, AMPLITUDE=PULSE, SCALE=-6.
*BASE MOTION, DOF=2, AMPLITUDE=PULSE, SCALE=3.
*BASE MOTION, DOF=3, AMPLITUDE=PULSE, SCALE=-2.
*NODE PRINT, NSET=ALL
U
*JOINT PRINT, JOINT=BED
*END STEP
"""
# Of the largest value; measured are 2e-5 of the displacements and of the opening, from increments
# that do not resolve the fastest modes of the block.
ALLOWED = 2e-4


@pytest.mark.parametrize("along", [2, 3])
def test_displacements_are_those_of_the_full_model(keyway, along):
    blocks = Blocks()
    blocks.add("ROCK", (1, 0.0, 2.0), (1, 0.0, 2.0), (1, -3.0, 0.0))
    blocks.add("BLOCK", (along, 0.0, 2.0), (along, 0.0, 2.0), (1, 0.0, 3.0))
    cards = node_set("BASE", blocks.side("ROCK", "Z0")) + CARDS
    full, reduced = (
        keyway(
            blocks.deck({"ROCK": ROCK, "BLOCK": CONCRETE}, cards + SHAKEN.format(reduced=word)),
            name=name,
        )
        for name, word in (("full", ""), ("reduced", ", REDUCED"))
    )
    expected, found = (state_of(run, "ALL") for run in (full, reduced))
    assert np.abs(expected).max() > 1e-4
    assert np.abs(found - expected).max() <= ALLOWED * np.abs(expected).max()
    expected, found = (run.csv("joint_BED")["opening"] for run in (full, reduced))
    assert expected.max() > 5e-5
    assert np.abs(found - expected).max() <= ALLOWED * expected.max()
