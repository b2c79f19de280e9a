"""Joints under elements that are absent although their nodes have other elements (theory.md, 15.1).

Blocks A, B, C, D stand in a row and share their nodes; a joint is below them. Without B and D all
four nodes of the face of B belong to A and C. Without Poisson's ratio and held across, each block
presses its own face.
"""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import pyvista
from stage_decks import YOUNG, add, remove, step
from test_stage_areas import at_end, press
from tied_blocks import Blocks, node_set, ties

KN, FIRST, SECOND = 1e10, 4e5, 1e6  # [Pa/m]; pressures [Pa]
NAMES = "ABCD"
OUTPUT = "*NODE PRINT, NSET=FREE\nU\n*JOINT PRINT, JOINT=J\nOPENING, TRACTION, STATE\n"
JOINTS = pytest.mark.parametrize("joint", ["elements", "matching", "different"])
INTEGRATIONS = pytest.mark.parametrize("integration", ["NODES", "GAUSS"])


def pairs(blocks: Blocks, name: str) -> str:
    """The JOINT8 element below a block."""
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    low = [blocks.nodes["SLAB"][NAMES.index(name) + a, b, 1] + 1 for a, b in ring]
    top = [blocks.nodes[name][a, b, 0] + 1 for a, b in ring]
    return ", ".join(map(str, [900 + NAMES.index(name), *low, *top])) + "\n"


def row(joint: str, integration: str, law: str = "FRICTION=0.6", **joints: str) -> str:
    """The model: a slab, held as a whole, and the blocks on it; joints and the blocks on them."""
    joints = joints or {"J": NAMES}
    blocks = Blocks()
    n = 3 if joint == "different" else 1
    blocks.add("SLAB", (4 * n, 0, 4), (n, 0, 1), (1, -1, 0))
    for i, name in enumerate(NAMES):
        blocks.add(name, (1, i, i + 1), (1, 0, 1), (1, 0, 1))
        if i > 0:
            blocks.share(NAMES[i - 1], name)
    held = blocks.nodes["SLAB"].ravel()
    free = np.unique([blocks.nodes[name].ravel() for name in NAMES])
    cards = node_set("HELD", held) + node_set("FREE", free)
    cards += f"*JOINT LAW, NAME=LAW, KN={KN!r}, KT={KN!r}, {law}\n"
    for name, above in joints.items():
        if joint == "elements":
            named = f", ELSET={name}\n"
            cards += f"*ELEMENT, TYPE=JOINT8, ELSET={name}\n"
            cards += "".join(pairs(blocks, i) for i in above)
        else:
            named = f"\nBASE_{name}, SLAB_Z1\n"
            cards += f"*SURFACE, NAME=BASE_{name}, TYPE=ELEMENT\n"
            cards += "".join(f"{block}, S1\n" for block in above)
        cards += f"*JOINT, NAME={name}, LAW=LAW, INTEGRATION={integration}{named}"
    cards += "*BOUNDARY\nHELD, 1, 3\nFREE, 1, 2\n"
    return blocks.deck({"": f"*ELASTIC\n{YOUNG!r}, 0.\n"}, cards)


def pressures(run, number: int, table: str = "joint_J") -> dict[str, np.ndarray]:
    """Normal tractions at the end of a step, of the points inside the face of each block."""
    traction, x = (at_end(run, number, table, name) for name in ("tn", "x"))
    return {b: traction[(x > i) & (x < i + 1)] for i, b in enumerate(NAMES)}


@JOINTS
def test_gauss_points_below_an_absent_block(keyway, joint):
    """Its face carries nothing although its nodes move: -p below the others, whose p comes first.

    The blocks come without stress; then a pressure on all adds itself everywhere. When the blocks
    leave, their load goes with them, and the others keep theirs.
    """
    loads = press(A=FIRST, C=FIRST)
    every = press(A=FIRST + SECOND, B=SECOND, C=FIRST + SECOND, D=SECOND)
    run = keyway(
        row(joint, "GAUSS")
        + step(remove("B", "D") + loads.replace("P4", "P2") + OUTPUT)
        + step(add("B", "D"))
        + step(every.replace("P4", "P2"))
        + step(remove("B", "D"))
    )
    for number, (old, new) in enumerate(
        [(FIRST, 0.0), (FIRST, 0.0), (FIRST + SECOND, SECOND), (FIRST + SECOND, 0.0)], start=1
    ):
        found = pressures(run, number)
        for name, p in zip(NAMES, (old, new, old, new), strict=True):
            assert found[name] == pytest.approx(-p, rel=1e-9, abs=1e-9 * FIRST), (number, name)
    assert run.json["joints"]["J"]["area"] == pytest.approx(4.0, rel=1e-12)  # of the whole joint
    assert at_end(run, 1, "node_FREE", "U3").max() <= 0.0
    low = at_end(run, 1, "node_FREE", "U3")
    assert low.min() == pytest.approx(-FIRST / KN - FIRST / YOUNG, rel=1e-9)
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-9


@JOINTS
@INTEGRATIONS
def test_a_joint_of_its_own_below_an_absent_block(keyway, joint, integration):
    """The joint K below B is absent with B, also where all its nodes have other elements."""
    load = press(A=FIRST, C=FIRST, D=FIRST).replace("P4", "P2")
    output = OUTPUT + "*JOINT PRINT, JOINT=K\nTRACTION\n"
    run = keyway(
        row(joint, integration, J="ACD", K="B") + step(remove("B") + load + output) + step(add("B"))
    )
    for number in (1, 2):
        assert at_end(run, number, "joint_J", "tn") == pytest.approx(-FIRST, rel=1e-9)
        assert np.abs(at_end(run, number, "joint_K", "tn")).max() < 1e-9 * FIRST
    assert (at_end(run, 1, "joint_K", "tn") == 0.0).all()


@pytest.mark.parametrize("joint", ["elements", "different"])
def test_openings_of_shared_nodes(keyway, joint):
    """A and C are lifted by 1 mm: at all nodes of their faces, shared or not, the joint is open by
    as much. The faces of B and D take no part in the means at nodes and corners."""
    lift = "*BOUNDARY\nFREE, 3, 3, 1e-3\n*EL FILE\nOPENING, STATE\n"
    run = keyway(row(joint, "GAUSS") + step(remove("B", "D") + lift + OUTPUT))
    lifted = run.csv("node_FREE")["U3"] > 0.5e-3
    nodes = run.csv("node_FREE")["node"][lifted].astype(int) - 1
    with h5py.File(run.folder / "job.h5") as file:
        group = file["steps/0001/increments"]
        opening = group[sorted(group)[-1]]["OPENING"][:][nodes]
        low = file["mesh/x"][:, 2][nodes] == 0.0
    assert opening[low] == pytest.approx(1e-3, rel=1e-9)
    faces = pyvista.read(sorted((run.folder / "job_vtk").glob("job_joints_*.vtu"))[-1])
    left = faces.points[:, 0] < 3.5
    assert faces.point_data["OPENING"][left] == pytest.approx(1e-3, rel=1e-6)
    assert (faces.point_data["STATE"][left] == faces.point_data["STATE"][left][0]).all()


@JOINTS
def test_held_nodes_of_an_absent_block_wait(keyway, joint):
    """All nodes of the block D are moved by 1 mm. While it is absent they stay; then the block
    moves as a whole: no strain (the nodes that JOINT8 elements have are no base without solids)."""
    lift = "*BOUNDARY\nFREE, 3, 3, 1e-3\n*EL PRINT, ELSET=BODY\nS\n"
    run = keyway(row(joint, "NODES") + step(remove("D") + lift + OUTPUT) + step(add("D")))
    moved = {number: at_end(run, number, "node_FREE", "U3") for number in (1, 2)}
    assert moved[1].max() == pytest.approx(1e-3, rel=1e-12)
    assert np.sum(moved[1] == 0.0) == 4  # the nodes that D alone has
    assert moved[2] == pytest.approx(1e-3, rel=1e-12)
    assert np.abs(at_end(run, 2, "el_BODY", "S33")).max() < 1e-9 * YOUNG * 1e-3


@INTEGRATIONS
@pytest.mark.parametrize("gone", ["A", "NEW"])
def test_a_block_in_the_place_of_another(keyway, integration, gone):
    """NEW has the nodes of A, and one of both is absent: the JOINT8 element below them acts."""
    deck = row("elements", integration)
    block = deck.split("*ELEMENT, TYPE=C3D8, ELSET=A\n")[1].split("\n")[0]
    twin = f"*ELEMENT, TYPE=C3D8, ELSET=NEW\n500, {block.split(', ', 1)[1]}\n"
    deck = deck.replace("*MATERIAL", f"{twin}*MATERIAL", 1)
    deck = deck.replace(
        "*ELSET, ELSET=BODY", "*SOLID SECTION, ELSET=NEW, MATERIAL=M\n*ELSET, ELSET=X"
    )
    stays = "A" if gone == "NEW" else "NEW"
    load = press(**{stays: FIRST, "B": FIRST, "C": FIRST, "D": FIRST}).replace("P4", "P2")
    run = keyway(deck + step(remove(gone) + load + OUTPUT))
    assert at_end(run, 1, "joint_J", "tn") == pytest.approx(-FIRST, rel=1e-9)


@pytest.mark.parametrize("slave", ["top", "low"])
@pytest.mark.parametrize("bricks", [3, 6], ids=["equal", "different"])
def test_a_tie_over_an_absent_block(keyway, bricks, slave):
    """T is tied to A and C, and to B, whose nodes A and C have. Without B equal meshes leave the
    load 3 p of T to A and C, by equilibrium and symmetry; a tie of a finer T would hold it over the
    gap, and is refused."""
    blocks = Blocks()
    for i, name in enumerate("ABC"):
        blocks.add(name, (1, i, i + 1), (1, 0, 1), (1, 0, 1))
        if i > 0:
            blocks.share("ABC"[i - 1], name)
    blocks.add("T", (bricks, 0, 3), (1, 0, 1), (1, 1, 2))
    base = np.unique([blocks.side(name, "Z0") for name in "AC"])
    cards = node_set("BASE", base) + "*SURFACE, NAME=LOW, TYPE=ELEMENT\nA, S2\nB, S2\nC, S2\n"
    cards += ties(("T_Z0", "LOW") if slave == "top" else ("LOW", "T_Z0"))
    cards += "*BOUNDARY\nBASE, 1, 3\n"
    deck = blocks.deck({"": f"*ELASTIC\n{YOUNG!r}, 0.2\n"}, cards)
    deck += step(remove("B") + f"*DSLOAD\nT_Z1, P, {FIRST!r}\n*EL PRINT, ELSET=BODY\nS\n")
    if bricks == 3:
        run = keyway(deck)
        block = at_end(run, 1, "el_BODY", "element")
        for number in (1, 3):
            mean = at_end(run, 1, "el_BODY", "S33")[block == number].mean()
            assert mean == pytest.approx(-1.5 * FIRST, rel=1e-9)
    else:
        run = keyway(deck, code=2)
        assert "in step 1 element 2 is absent, and the tie would hold its face" in run.stderr
