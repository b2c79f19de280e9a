"""*EQUATION and *MPC: levers and periodic bars by hand, chains, the same as *TIE, joints."""

from __future__ import annotations

import numpy as np
import pytest
from tied_blocks import Blocks, node_set, state_of, ties

YOUNG = 1e9
ELASTIC = f"*DENSITY\n2000.\n*ELASTIC\n{YOUNG}, 0.\n"
PRINT = "*NODE PRINT, NSET=ALL\nU, RF\n"
# Round-off of a direct solver with some hundred unknowns.
SAME = 1e-11


def equations(*terms: str) -> str:
    """An equation for each argument, as 'A, 1, 1., B, 1, -1.'."""
    lines = [f"{len(text.split(',')) // 3}\n{text}\n" for text in terms]
    return "*EQUATION\n" + "".join(lines)


def static(load: str) -> str:
    return f"*STEP\n*STATIC\n{load}{PRINT}*END STEP\n"


def hold(blocks: Blocks, *sides: str) -> str:
    nodes = np.concatenate([blocks.side(*side.split("_")) for side in sides])
    return node_set("BASE", np.unique(nodes)) + "*BOUNDARY\nBASE, 1, 3\n"


def two_bars(cards: str) -> str:
    """Two bars of 1 x 1 x 1 m side by side, their ends X0 held, ends X1 are sets A and B."""
    blocks = Blocks()
    blocks.add("LEFT", (2, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("RIGHT", (3, 0, 1), (1, 2, 3), (1, 0, 1))
    sets = node_set("A", blocks.side("LEFT", "X1")) + node_set("B", blocks.side("RIGHT", "X1"))
    return blocks.deck({"": ELASTIC}, sets + hold(blocks, "LEFT_X0", "RIGHT_X0") + cards)


@pytest.mark.parametrize("first", ["A", "B"])
def test_a_lever(keyway, first):
    """2 u_A = 3 u_B: with k = E A/L of each bar, F = k u_A + 2/3 k u_B at A, u_B = 2/3 u_A."""
    terms = {"A": "A, 1, 2., B, 1, -3.", "B": "B, 1, -3., A, 1, 2."}
    run = keyway(two_bars(equations(terms[first]) + static("*CLOAD\nA, 1, 1e3\n")))
    u, force = state_of(run, "ALL"), state_of(run, "ALL", "RF")
    u_a = 4e3 / YOUNG / (1.0 + 4.0 / 9.0)
    assert np.abs(u[:, 0]).max() == pytest.approx(u_a, rel=SAME)
    held = np.abs(force).max(axis=1) > 0.0
    left = np.arange(len(u)) < 12
    assert force[held & left, 0].sum() == pytest.approx(-YOUNG * u_a, rel=SAME)
    assert force[held & ~left, 0].sum() == pytest.approx(-YOUNG * 2.0 / 3.0 * u_a, rel=SAME)
    assert run.csv("energy")["error"].max() < 1e-9


@pytest.mark.parametrize("num_more", [0, 20])
def test_sets_in_the_order_of_the_deck(keyway, num_more):
    """Nodes of UNSORTED sets are pairs as the deck lists them, also where many sets follow; others
    by their ids."""
    blocks = Blocks()
    blocks.add("LEFT", (2, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("RIGHT", (3, 0, 1), (1, 2, 3), (1, 0, 1))
    a, b = blocks.side("LEFT", "X1") + 1, blocks.side("RIGHT", "X1") + 1
    lines = [f"*NSET, NSET=A, UNSORTED\n{a[0]}\n*NSET, NSET=A\n{a[1]}, {a[2]}, {a[3]}\n"]
    lines.append(f"*NSET, NSET=B, UNSORTED\n{b[3]}, {b[0]}, {b[1]}, {b[3]}, {b[2]}\n")
    lines += [f"*NSET, NSET=MORE{k}\n{a[0]}\n" for k in range(num_more)]
    lines.append(hold(blocks, "LEFT_X0", "RIGHT_X0") + equations("A, 1, 1., B, 1, -1."))
    deck = blocks.deck({"": ELASTIC}, "".join(lines))
    load = f"*CLOAD\n{a[0]}, 1, 1e3\n{a[1]}, 1, 2e3\n{a[2]}, 1, -1e3\n"
    u = state_of(keyway(deck + static(load)), "ALL")[:, 0]
    assert np.ptp(u[a - 1]) > 1e-7
    assert u[a - 1] == pytest.approx(u[[b[3] - 1, b[0] - 1, b[1] - 1, b[2] - 1]], rel=SAME)


def test_terms_of_other_directions(keyway):
    """u_A along x equals minus u_B along y: the bar B, free along y only, is
    sheared, k_s = G A/L with nu = 0."""
    nodes = "".join(f"{n}\n" for n in range(13, 29))
    more = f"*NSET, NSET=SHEARED\n{nodes}*BOUNDARY\nSHEARED, 1, 1\nSHEARED, 3, 3\n"
    run = keyway(two_bars(equations("A, 1, 1., B, 2, 1.") + more + static("*CLOAD\nA, 1, 1e3\n")))
    u = state_of(run, "ALL")
    u_a = 4e3 / (YOUNG + 0.5 * YOUNG)
    assert u[:, 0].max() == pytest.approx(u_a, rel=SAME)
    assert u[:, 1].min() == pytest.approx(-u_a, rel=SAME)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_a_chain(keyway, order):
    """Equations that refer to each other, in any order: C = 2 B, B = 2 A, D = C - A for one of the
    nodes each; D has no element and shows 3 u_A."""
    blocks = Blocks()
    for k, name in enumerate("ABC"):
        blocks.add(name, (1, 0, 1), (1, 2 * k, 2 * k + 1), (1, 0, 1))
    sets = "".join(node_set(f"E{name}", blocks.side(name, "X1")) for name in "ABC")
    last, first = blocks.side("C", "X1")[0] + 1, blocks.side("A", "X1")[0] + 1
    text = ["EC, 1, 1., EB, 1, -2.", "EB, 1, 1., EA, 1, -2."]
    text.append(f"25, 1, 1., {last}, 1, -1., {first}, 1, 1.")
    cards = "*NODE, NSET=ALL\n25, 9., 9., 9.\n" + sets + hold(blocks, "A_X0", "B_X0", "C_X0")
    cards += equations(*(text[k] for k in order)) + static("*CLOAD\nEA, 1, 1e3\n")
    u = state_of(keyway(blocks.deck({"": ELASTIC}, cards)), "ALL")[:, 0]
    u_a = 4e3 / YOUNG / (1.0 + 4.0 + 16.0)
    ends = [blocks.side(name, "X1") for name in "ABC"]
    for factor, nodes in zip((1.0, 2.0, 4.0), ends, strict=True):
        assert u[nodes] == pytest.approx(factor * u_a, rel=SAME)
    assert u[24] == pytest.approx(3.0 * u_a, rel=SAME)


def test_a_periodic_bar(keyway):
    """u(X1) - u(X0) = strain L, held by a node without elements: uniform stress without shear, its
    reaction is E strain A. Poisson's ratio 0.3 makes the sides move freely."""
    blocks = Blocks()
    blocks.add("A", (3, 0, 3), (2, 0, 1), (2, 0, 1))
    number = blocks.nodes["A"].size + 1
    sets = node_set("RIGHT", blocks.side("A", "X1")) + node_set("LEFT", blocks.side("A", "X0"))
    sets += f"*NODE, NSET=ALL\n{number}, 9., 0., 0.\n*NSET, NSET=STRAIN\n{number}\n"
    terms = [f"RIGHT, {i}, 1., LEFT, {i}, -1., STRAIN, {i}, -1." for i in (1, 2, 3)]
    corner = blocks.nodes["A"][:, 0, 0] + 1
    held = f"*BOUNDARY\n{corner[0]}, 1, 3\n{blocks.nodes['A'][0, -1, 0] + 1}, 3, 3\n"
    load = "*BOUNDARY\nSTRAIN, 1, 1, 3e-3\nSTRAIN, 2, 3, 0.\n"
    law = f"*DENSITY\n2000.\n*ELASTIC\n{YOUNG}, 0.3\n"
    deck = blocks.deck({"": law}, sets + held + equations(*terms) + static(load))
    deck = deck.replace(PRINT, PRINT + "*EL PRINT, ELSET=BODY\nS\n")
    run = keyway(deck)
    force = state_of(run, "ALL", "RF")
    assert force[number - 1, 0] == pytest.approx(1e-3 * YOUNG, rel=1e-9)
    assert np.abs(force[: number - 1]).max() < 1e-9 * YOUNG * 1e-3
    table = run.csv("el_BODY")
    assert table["S11"] == pytest.approx(1e-3 * YOUNG, rel=1e-9)
    for name in ("S22", "S33", "S12", "S13", "S23"):
        assert np.abs(table[name]).max() < 1e-9 * 1e-3 * YOUNG


def beam() -> Blocks:
    blocks = Blocks()
    blocks.add("A", (4, 0, 4), (2, 0, 1), (2, 0, 1))
    blocks.add("B", (4, 4, 8), (2, 0, 1), (2, 0, 1))
    return blocks


STEPS = f"""\
*STEP
*STATIC
*DLOAD
BODY, GRAV, 9.81, 0., 0., -1.
{PRINT}*END STEP
*STEP
*FREQUENCY
6
*END STEP
*STEP
*DYNAMIC, DIRECT
0.005, 0.1
*DAMPING, RATIO=0.02, F1=5., F2=50.
*BASE MOTION, DOF=2, AMPLITUDE=PUSH
*DSLOAD, AMPLITUDE=PUSH
B_Z1, P, 1e5
{PRINT}*END STEP
"""
PUSH = "*AMPLITUDE, NAME=PUSH\n0., 0.\n0.03, 1.\n0.1, -0.5\n"


@pytest.mark.parametrize("kind", ["equation", "mpc"])
def test_equals_a_tie_of_equal_meshes(keyway, kind):
    """Statics, modes, motion of the base, reactions: 1e-10 as in the tests of ties and threads."""
    blocks = beam()
    held = PUSH + hold(blocks, "A_X0")
    sets = node_set("MINE", blocks.side("B", "X0")) + node_set("OTHER", blocks.side("A", "X1"))
    if kind == "mpc":
        link = sets + "*MPC\nTIE, MINE, OTHER\n"
    else:
        link = sets + equations(*(f"MINE, {i}, 1., OTHER, {i}, -1." for i in (1, 2, 3)))
    runs = [
        keyway(blocks.deck({"": ELASTIC}, cards + held + STEPS), name=name)
        for name, cards in (("ours", link), ("tied", ties(("B_X0", "A_X1"))))
    ]
    hz = [[mode["hz"] for mode in run.json["steps"][1]["frequencies"]] for run in runs]
    assert hz[0] == pytest.approx(hz[1], rel=1e-10)
    for step in (1, 3):
        for field in ("U", "RF"):
            ours, tied = (state_of(run, "ALL", field, step) for run in runs)
            assert np.abs(ours - tied).max() <= 1e-10 * np.abs(tied).max()
    assert max(abs(run.csv("energy")["error"]).max() for run in runs) < 1e-6


def test_hanging_nodes(keyway):
    """One brick beside 2 x 2: corners by TIE, nodes between by LINEAR and by *EQUATION for the
    middle. A uniform stress passes."""
    blocks = Blocks()
    blocks.add("A", (1, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("B", (1, 1, 2), (2, 0, 1), (2, 0, 1))
    own, other = blocks.nodes["B"][0] + 1, blocks.nodes["A"][-1] + 1
    corner = [(2 * j, 2 * k, j, k) for j in (0, 1) for k in (0, 1)]
    mpc = "*MPC\n" + "".join(f"TIE, {own[a, b]}, {other[j, k]}\n" for a, b, j, k in corner)
    for j in (0, 1):
        mpc += f"LINEAR, {own[2 * j, 1]}, {other[j, 0]}, {other[j, 1]}\n"
        mpc += f"LINEAR, {own[1, 2 * j]}, {other[0, j]}, {other[1, j]}\n"
    means = ", ".join(f"{n}, {{i}}, -0.25" for n in other.ravel())
    mean = equations(*(f"{own[1, 1]}, {i}, 1.0, {means.format(i=i)}" for i in (1, 2, 3)))
    face = blocks.side("A", "X0")
    held = node_set("FACE", face) + "*BOUNDARY\nFACE, 1, 1\n"
    held += f"{face[0] + 1}, 1, 3\n{face[1] + 1}, 2, 2\n"
    law = f"*DENSITY\n2000.\n*ELASTIC\n{YOUNG}, 0.3\n"
    load = "*DSLOAD\nB_X1, P, -1e6\n*EL PRINT, ELSET=BODY\nS\n"
    run = keyway(blocks.deck({"": law}, mpc + mean + held + static(load)))
    table = run.csv("el_BODY")
    assert table["S11"] == pytest.approx(1e6, rel=1e-9)
    for name in ("S22", "S33", "S12", "S13", "S23"):
        assert np.abs(table[name]).max() < 1e-3


@pytest.mark.parametrize("side", ["slave", "master"])
def test_a_plane_section_on_a_joint(keyway, side):
    """A column that stands on a joint, pushed at its top; the nodes at one face of the joint follow
    one of them upwards. The face stays level, the joint carries the weight, energy is balanced."""
    blocks = Blocks()
    blocks.add("A", (2, 0, 2), (2, 0, 2), (1, 0, 1))
    blocks.add("B", (2, 0, 2), (2, 0, 2), (2, 1, 3))
    face = blocks.side("B", "Z0") if side == "slave" else blocks.side("A", "Z1")
    sets = node_set("REST", face[1:]) + hold(blocks, "A_Z0")
    joint = (
        "*JOINT LAW, NAME=L, KN=1e11, KT=1e11, FRICTION=0.8\n*JOINT, NAME=J, LAW=L\nB_Z0, A_Z1\n"
    )
    cards = sets + joint + equations(f"REST, 3, 1., {face[0] + 1}, 3, -1.")
    load = "*DLOAD\nB, GRAV, 9.81, 0., 0., -1.\n*DSLOAD\nB_X0, P, 1e4\n"
    load += "*JOINT PRINT, JOINT=J\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards + static(load)))
    u, force = state_of(run, "ALL"), state_of(run, "ALL", "RF")
    assert np.ptp(u[face, 2]) <= 1e-15
    total = np.array([-4e4, 0.0, 2000.0 * 8.0 * 9.81])
    assert force.sum(axis=0) == pytest.approx(total, rel=1e-6, abs=1e-6 * total.max())
    assert run.csv("energy")["error"].max() < 1e-6


def test_threads(keyway):
    blocks = beam()
    sets = node_set("MINE", blocks.side("B", "X0")) + node_set("OTHER", blocks.side("A", "X1"))
    link = sets + equations(*(f"MINE, {i}, 1., OTHER, {i}, -1." for i in (1, 2, 3)))
    deck = blocks.deck({"": ELASTIC}, link + PUSH + hold(blocks, "A_X0") + STEPS)
    runs = [keyway(deck, "-j", str(n), name=f"threads{n}") for n in (1, 2)]
    one, two = (state_of(run, "ALL") for run in runs)
    assert np.abs(one - two).max() <= 1e-10 * np.abs(two).max()
