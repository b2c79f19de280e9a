"""One and two threads give the same results: modes, statics and motion of an arch dam.

Sums over threads may be taken in another order, so the last digits may differ: 1e-10 of the
largest value is some thousand roundings of a well-conditioned system.
"""

import numpy as np
import pytest
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.deck_text import mesh_deck

STEPS = """\
*MATERIAL, NAME=CONCRETE
*ELASTIC
22.e9, 0.167
*DENSITY
2400.
*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*BOUNDARY
FIXED, 1, 3
*AMPLITUDE, NAME=QUAKE
0., 0., 0.1, 3., 0.3, -3., 0.5, 1.
*STEP
*STATIC
*DLOAD
DAM, GRAV, 9.81, 0., 0., -1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=105., BED=0., ADDED MASS=WESTERGAARD
*NODE PRINT, NSET=ALL
U
*END STEP
*STEP
*FREQUENCY
4
*END STEP
*STEP
*DYNAMIC, DIRECT
0.01, 0.5
*DAMPING, RATIO=0.05, F1=2., F2=10.
*BASE MOTION, DOF=2, AMPLITUDE=QUAKE
*END STEP
"""


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_threads_do_not_change_results(keyway, element):
    options = DamOptions(num_joints=0, rock=None)
    mesh = build_arch_dam(ArchShape(), options)
    mesh.node_sets["ALL"] = np.arange(len(mesh.x))
    deck = mesh_deck(mesh, {"DAM": element}, "") + STEPS
    runs = [keyway(deck, "-j", str(count), name=f"threads{count}") for count in (1, 2)]
    tables = [run.csv("node_ALL") for run in runs]
    size = max(np.abs(tables[0][f"U{i}"]).max() for i in (1, 2, 3))
    apart = max(np.abs(tables[0][f"U{i}"] - tables[1][f"U{i}"]).max() for i in (1, 2, 3))
    modes = [[m["hz"] for m in run.json["steps"][1]["frequencies"]] for run in runs]
    assert apart <= 1e-10 * size
    assert modes[0] == pytest.approx(modes[1], rel=1e-10)
