"""The start of *DYNAMIC of a block bonded to one layer of rock without mass.

All that moves then has mass of the block in M, which is singular all the same. Where the loads left
the rock in balance the rock got any acceleration, up to twice the right one; a constant load at
the same time, whose round-off is not in balance, gave the right one."""

from __future__ import annotations

import numpy as np
import pytest
from tied_blocks import Blocks, node_set

ROCK = "*ELASTIC\n1e10, 0.2\n"
CONCRETE = "*DENSITY\n2400.\n*ELASTIC\n2.5e10, 0.25\n"
CARDS = """*JOINT LAW, NAME=LAW, KN=1e10, KT=4e9, FRICTION=1., TENSILE STRENGTH=1e15
*JOINT, NAME=BED, LAW=LAW
BLOCK_Z0, ROCK_Z1
*BOUNDARY
BASE, 1, 3
*STEP
*STATIC
*DSLOAD
BLOCK_X0, P, 1e4
{constant}*END STEP
*STEP
*DYNAMIC, ALPHA=0
0.005, 0.02
*DSLOAD
BLOCK_X0, P, 9e3
*NODE PRINT, NSET=TOP
A
*END STEP
"""
CONSTANT = "BLOCK_Y0, P, 1e5\n"


@pytest.mark.parametrize("along", [1, 2])
def test_a_constant_load_changes_no_acceleration(keyway, along):
    blocks = Blocks()
    blocks.add("ROCK", (along, 0.0, 3.0), (1, 0.0, 2.0), (1, -3.0, 0.0))
    blocks.add("BLOCK", (along, 0.0, 3.0), (1, 0.0, 2.0), (1, 0.0, 4.0))
    sets = node_set("BASE", blocks.side("ROCK", "Z0")) + node_set("TOP", blocks.side("ROCK", "Z1"))
    without, beside = (
        keyway(
            blocks.deck({"ROCK": ROCK, "BLOCK": CONCRETE}, sets + CARDS.format(constant=line)),
            name=name,
        ).csv("node_TOP")
        for name, line in (("without", ""), ("beside", CONSTANT))
    )
    size = np.abs(without["A1"]).max()
    assert size > 0.1
    for name in ("A1", "A2", "A3"):
        # round-off of the displacements of the constant load, 1e-16 times 4/dt^2: 2e-9 is seen
        assert np.abs(without[name] - beside[name]).max() <= 1e-7 * size
