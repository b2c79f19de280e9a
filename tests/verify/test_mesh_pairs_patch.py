"""Constant stress is transferred between faces of different meshes: ties, joints and the paper's
chain.

Two blocks at an angle in space, loaded on all outer faces by the tractions of a uniform stress and
held at the far face by its displacements. Six states, each with the full size of one stress in the
axes of the interface. Exact: that stress at every point, and a jump of t / k between the blocks.
"""

from __future__ import annotations

import numpy as np
import pytest
from exact_fields import uniform
from loaded_pairs import Loaded, bare_forces
from mesh_pairs import Pair, Side, graded, scattered, skewed, swirled

SIZE = 1e6  # of a stress [Pa]
STRESSES = {(0, 0): "11", (1, 1): "22", (2, 2): "33", (0, 1): "12", (0, 2): "13", (1, 2): "23"}
NORMAL, SHEAR, SPRING = 1e12, 4e11, 3e11  # of the joint, of couplings [Pa/m]
LAW = f"*JOINT LAW, NAME=L, KN={NORMAL!r}, KT={SHEAR!r}"
BONDED = LAW + ", TENSILE STRENGTH=1e12\n"
PRESSED = LAW + ", FRICTION=0.8\n"
SOFT = np.array([1.0 / SHEAR, 1.0 / SHEAR, 1.0 / NORMAL])  # [m/Pa]

# Divisions and places of nodes on both sides; the lower block first.
MESHES = {
    "nested 1:2": (Side((2, 3, 1)), Side((4, 6, 2))),
    "3:7": (Side((3, 3, 1)), Side((7, 7, 2))),
    "1:10": (Side((1, 2, 1)), Side((10, 13, 1))),
    "graded 1:10 crosswise": (Side((4, 5, 1), graded(10.0)), Side((5, 4, 1), graded(0.1))),
    "turned": (Side((4, 4, 1)), Side((5, 5, 1), swirled(0.6))),
    "skewed": (Side((3, 4, 1), skewed(0.12)), Side((5, 3, 1), skewed(-0.1))),
    "by lot": (Side((4, 4, 1), scattered(0.3, 1)), Side((5, 6, 1), scattered(0.3, 2))),
    "wedges": (Side((3, 3, 1), scattered(0.2, 3), wedges=True), Side((4, 5, 1))),
    "wedges on both sides": (
        Side((3, 3, 1), wedges=True),
        Side((4, 5, 1), scattered(0.2, 4), wedges=True),
    ),
}


def six_states(pressed: float = 0.0) -> dict[str, np.ndarray]:
    """Each stress alone, and pressure on the interface besides."""
    states = {}
    for (i, j), name in STRESSES.items():
        stress = np.zeros((3, 3))
        stress[i, j] = stress[j, i] = SIZE
        stress[2, 2] -= pressed
        states[name] = stress
    return states


def faces(slave: str) -> str:
    """Data line: slave, master."""
    return f"{slave}, {'UPPER' if slave == 'LOWER' else 'LOWER'}\n"


# What joins the blocks: cards for a slave face, and how it gives way.
JOINED = {
    "tie": (lambda slave: "*TIE, NAME=J\n" + faces(slave), np.zeros(3)),
    "springs": (
        lambda slave: f"*TIE, NAME=J, STIFFNESS={SPRING!r}\n" + faces(slave),
        np.full(3, 1.0 / SPRING),
    ),
    "joint": (lambda slave: BONDED + "*JOINT, NAME=J, LAW=L\n" + faces(slave), SOFT),
    "joint at segments": (
        lambda slave: BONDED + "*JOINT, NAME=J, LAW=L, INTEGRATION=GAUSS\n" + faces(slave),
        SOFT,
    ),
}


def worst_errors(keyway, pair: Pair, cards: str, give: np.ndarray, pressed: float = 0.0):
    """Of stresses and displacements, over all states."""
    states = six_states(pressed)
    loaded = Loaded(pair, {name: uniform(s, pair, give) for name, s in states.items()})
    if any(pair.shift):
        loaded.more_forces = {name: bare_forces(pair, s) for name, s in states.items()}
    return loaded.errors_of_uniform_stress(keyway(loaded.deck(cards)))


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("way", ["tie", "joint"])
def test_stress_is_transferred_between_any_two_meshes(keyway, way, mesh, slave):
    """1e-10: round-off and the digits of the tables (measured: 8e-14 and 3e-13 at most)."""
    cards, give = JOINED[way]
    assert max(worst_errors(keyway, Pair(*MESHES[mesh]), cards(slave), give)) < 1e-10


@pytest.mark.parametrize("mesh", ["nested 1:2", "by lot", "wedges"])
@pytest.mark.parametrize("way", ["springs", "joint at segments"])
def test_stress_is_transferred_at_points_of_segments(keyway, way, mesh):
    """Springs and joint laws at the points of the segments: the jump is t / k to 1e-10."""
    cards, give = JOINED[way]
    assert max(worst_errors(keyway, Pair(*MESHES[mesh]), cards("UPPER"), give)) < 1e-10


@pytest.mark.parametrize("coarse", ["LOWER", "UPPER"])
@pytest.mark.parametrize("mesh", ["3:7", "by lot"])
def test_jump_of_the_chain_of_the_paper_is_t_over_k(keyway, mesh, coarse):
    """Eq. 8 and JOINT8 in a row: the jump is t / k of the coupling and t / k of the joint."""
    pair = Pair(*MESHES[mesh])
    fine = "UPPER" if coarse == "LOWER" else "LOWER"
    quads = pair.add_chain(coarse)
    pair.mesh.node_sets["ALL"] = np.concatenate((pair.low.ravel(), pair.high.ravel()))
    cards = (
        f"{quads}{BONDED}*JOINT, NAME=J, LAW=L, ELSET=JOINTS\n"
        f"*INTERFACE, NAME=I, ELSET=QUADS, SURFACE={fine}, STIFFNESS={SPRING!r}\n"
    )
    assert max(worst_errors(keyway, pair, cards, SOFT + 1.0 / SPRING)) < 1e-10


@pytest.mark.parametrize("element", ["C3D8I", "C3D8B", "C3D8R"])
@pytest.mark.parametrize("way", ["tie", "joint"])
def test_stress_is_transferred_between_all_elements(keyway, way, element):
    """As C3D8: the traces of all four on a facet are the same."""
    cards, give = JOINED[way]
    pair = Pair(*MESHES["by lot"], element=element)
    assert max(worst_errors(keyway, pair, cards("LOWER"), give)) < 1e-10


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
@pytest.mark.parametrize("way", ["joint", "joint at segments"])
def test_faces_without_tension(keyway, way, slave):
    """No tensile strength; pressed by three times the stress, which friction of 0.8 holds."""
    cards, give = JOINED[way]
    text = cards(slave).replace(BONDED, PRESSED)
    pair = Pair(*MESHES["nested 1:2" if way == "joint at segments" else "skewed"])
    assert max(worst_errors(keyway, pair, text, give, pressed=3.0 * SIZE)) < 1e-10


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
@pytest.mark.parametrize("way", ["tie", "joint"])
def test_faces_with_partial_overlap(keyway, way, slave):
    """The upper block is shifted by 0.37 and 0.21 m; tractions act on the bare parts of facets."""
    cards, give = JOINED[way]
    pair = Pair(Side((3, 4, 1)), Side((5, 3, 1), graded(2.0)), shift=(0.37, -0.21))
    assert max(worst_errors(keyway, pair, cards(slave), give)) < 1e-10


@pytest.mark.parametrize("way", JOINED)
def test_threads_agree(keyway, way):
    """One and two threads, which add in other orders: displacements within 1e-12 of the largest."""
    cards, give = JOINED[way]
    pair = Pair(*MESHES["by lot"])
    loaded = Loaded(pair, {"33": uniform(six_states()["33"], pair, give)})
    deck = loaded.deck(cards("UPPER"))
    runs = [keyway(deck, "-j", str(j), name=f"threads_{j}") for j in (1, 2)]
    one, two = (loaded.wrong_displacement(run, "33") for run in runs)
    assert np.abs(one - two).max() < 1e-12 * np.abs(loaded.displacement("33")).max()
