"""The straight cantilever of MacNeal & Harder, one element over height and width.

R.H. MacNeal & R.L. Harder, A proposed standard set of problems to test finite element accuracy,
Finite Elements in Analysis and Design 1 (1985) 3-20: length 6, height 0.2, width 0.1, six
elements, E = 1e7, nu = 0.3, unit loads at the tip; meshes with cross lines at right angles,
leaning one way (parallelogram) and alternately (trapezoid) by 45 degrees.
"""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, last_state, nodal_forces
from keyway_tools.box_mesh import box_mesh

LENGTH, HEIGHT, WIDTH = 6.0, 0.2, 0.1
COUNT = 6
# Tip displacements of beam theory, as the paper has them.
TARGETS = {"extension": 3.0e-5, "in plane": 0.1081, "out of plane": 0.4321, "twist": 0.03208}
AXIS = {"extension": 0, "in plane": 2, "out of plane": 1}

# Published for an 8-node brick with incompatible modes: Altair OptiStruct 2022, verification
# problem OS-V 0720, HEX8, displacement over target, printed with three digits.
PUBLISHED = {
    "regular": {"extension": 0.988, "in plane": 0.978, "out of plane": 0.973, "twist": 0.892},
    "parallelogram": {"extension": 1.012, "in plane": 0.624, "out of plane": 0.529, "twist": 0.820},
    "trapezoid": {"extension": 1.010, "in plane": 0.047, "out of plane": 0.030, "twist": 0.563},
}


def lean(shape: str, share: np.ndarray) -> np.ndarray:
    """Shift of the top of a cross line against its bottom, over the height; none at the ends."""
    line = np.rint(share * COUNT)
    inner = (line > 0) & (line < COUNT)
    sign = {"regular": 0.0, "parallelogram": 1.0, "trapezoid": (-1.0) ** line}[shape]
    return np.where(inner, sign, 0.0)


def beam(shape: str):
    """Mesh and node numbers [along, across, up]."""

    def place(a, b, c):
        x = a * LENGTH + lean(shape, a) * (c - 0.5) * HEIGHT
        return np.stack([x, b * WIDTH, c * HEIGHT], axis=-1)

    mesh, number = box_mesh((COUNT, 1, 1), place)
    mesh.node_sets["ROOT"] = number[0].ravel()
    mesh.node_sets["TIP"] = number[-1].ravel()
    return mesh, number


def tip_forces(load: str, number: np.ndarray) -> dict[int, tuple[float, ...]]:
    """A unit force on the four nodes of the tip, or a unit moment: forces along y, up and down."""
    tip = number[-1]
    if load != "twist":
        force = tuple(0.25 if i == AXIS[load] else 0.0 for i in range(3))
        return dict.fromkeys(tip.ravel().tolist(), force)
    return {int(tip[j, k]): (0.0, (0.5 - k) / HEIGHT, 0.0) for j in (0, 1) for k in (0, 1)}


def share_of_target(keyway, shape: str, element: str, load: str) -> float:
    mesh, number = beam(shape)
    forces = nodal_forces(tip_forces(load, number))
    cards = elastic(1.0e7, 0.3) + "*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n*CLOAD\n" + forces
    deck = brick_deck(mesh, element, cards + "*NODE PRINT, NSET=TIP\nU\n*END STEP\n")
    u = last_state(keyway(deck), "TIP")  # nodes (0,0), (0,1), (1,0), (1,1) in y, z
    if load == "extension":  # of the node that goes furthest, as published: a skew end turns
        return float(u[:, 0].max() / TARGETS[load])
    if load != "twist":
        return float(u[:, AXIS[load]].mean() / TARGETS[load])
    return float((u[::2, 1].mean() - u[1::2, 1].mean()) / HEIGHT / TARGETS[load])


@pytest.mark.parametrize("load", TARGETS)
@pytest.mark.parametrize("shape", PUBLISHED)
def test_incompatible_modes_give_the_published_values(keyway, documented, shape, load):
    """0.001: the published ratios have three digits."""
    found = share_of_target(keyway, shape, "C3D8I", load)
    assert found == pytest.approx(PUBLISHED[shape][load], abs=0.001)
    documented("cantilever", (shape, load), "C3D8I", found)
    documented("cantilever", (shape, load), "published", PUBLISHED[shape][load])


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8R"])
@pytest.mark.parametrize("load", TARGETS)
@pytest.mark.parametrize("shape", PUBLISHED)
def test_other_bricks_are_as_documented(keyway, documented, shape, load, element):
    """No source has these ratios: the page shows how stiff or soft these elements are."""
    found = share_of_target(keyway, shape, element, load)
    documented("cantilever", (shape, load), element, found)


@pytest.mark.parametrize("element", ["C3D8", "C3D8B"])
def test_plain_and_b_bar_bricks_lock_in_shear(keyway, element):
    """One brick with aspect ratio 5: the parasitic shear makes it about ten times too stiff."""
    assert share_of_target(keyway, "regular", element, "in plane") < 0.15
