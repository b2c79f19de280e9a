"""Ties and equations that begin to hold when elements come (docs/theory.md, 15.1)."""

from __future__ import annotations

import numpy as np
import pytest
from stage_decks import YOUNG, add, remove, step
from test_stages import CRACKING, balances
from tied_blocks import Blocks, node_set, state_of, ties

# Stress that a relation without force leaves, over the largest: round-off of displacements of
# 1e-4 m in elements of 0.5 m, whose strains are 1e-4 too.
ROUND_OFF = 1e-9
DIGITS = 1e-15  # [m] of displacements of 1e-3 in the CSV files
ELASTIC = f"*ELASTIC\n{YOUNG!r}, 0.2\n"
OUTPUT = "*NODE PRINT, NSET=ALL\nU\n*EL PRINT, ELSET=BODY\nS\n"


class Column:
    """A block LOW that forces at its top bend and press, and a block TOP that is cast on it."""

    def __init__(self, low: int, top: int, below: int = 0):
        self.blocks = Blocks()
        self.blocks.add("LOW", (low, 0, 1), (low, 0, 1), (2, 0, 1))
        self.blocks.add("TOP", (top, 0, 1), (top, 0, 1), (2, 1, 2))
        self.num_low = 2 * low**2
        if below:
            self.blocks.add("GROUND", (below, 0, 1), (below, 0, 1), (1, -1, 0))

    @property
    def seam(self) -> tuple[np.ndarray, np.ndarray]:
        return self.blocks.side("LOW", "Z1"), self.blocks.side("TOP", "Z0")

    def deck(self, cards: str, law: str = ELASTIC, held: str = "") -> str:
        """The model; the top of TOP and the foot of the lowest block are held."""
        low = "GROUND" if "GROUND" in self.blocks.nodes else "LOW"
        base = np.concatenate([self.blocks.side(low, "Z0"), self.blocks.side("TOP", "Z1")])
        text = node_set("BASE", base) + cards + "*BOUNDARY\nBASE, 1, 3\n" + held
        return self.blocks.deck({"": law}, text)

    def press(self, part: float = 1.0) -> str:
        """Forces at the corners of LOW's top, of different size."""
        upper = self.blocks.nodes["LOW"][:, :, -1]
        corners = upper[[0, -1, 0, -1], [0, 0, -1, -1]] + 1
        forces = ((1e5, 0.0, -1e6), (0.0, 2e5, -2e6), (0.0, 0.0, -5e5), (3e5, 1e5, -1e6))
        return "*CLOAD\n" + "".join(
            f"{node}, {i + 1}, {part * value!r}\n"
            for node, force in zip(corners, forces, strict=True)
            for i, value in enumerate(force)
        )

    def stress(self, run, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Stresses of both blocks at the end of a step."""
        table = run.csv("el_BODY")
        rows = table["step"] == number
        rows &= table["increment"] == table["increment"][rows][-1]
        values = np.stack([table[f"S{ij}"][rows] for ij in (11, 22, 33, 12, 13, 23)], axis=1)
        element = table["element"][rows]
        is_top = (element > self.num_low) & (element <= self.num_low + self.num_top)
        return values[element <= self.num_low], values[is_top]

    @property
    def num_top(self) -> int:
        return 2 * (self.blocks.nodes["TOP"].shape[0] - 1) ** 2


def cast(column: Column, part: float = 1.0) -> str:
    """LOW is loaded alone, and TOP comes."""
    return step(remove("TOP") + column.press(part) + OUTPUT) + step(add("TOP"))


def built(column: Column) -> str:
    """The same, and a third step presses again."""
    again = f"{column.blocks.nodes['LOW'][0, 0, -2] + 1}, 3, -4e5\n"
    return cast(column) + step("*CLOAD, OP=MOD\n" + again)


def assert_stress_stays(column: Column, run, rel: float = ROUND_OFF) -> float:
    """TOP has no stress when it comes, and LOW keeps its own, whose size is returned."""
    alone, _ = column.stress(run, 1)
    size = np.abs(alone).max()
    low, top = column.stress(run, 2)
    assert low == pytest.approx(alone, abs=rel * size)
    assert np.abs(top).max() < rel * size
    return size


def assert_nothing_moves(column: Column, run) -> None:
    """The same; then both carry."""
    size = assert_stress_stays(column, run)
    assert np.abs(column.stress(run, 3)[1]).max() > 0.01 * size
    balances(run)


@pytest.mark.parametrize("slave", ["LOW_Z1", "TOP_Z0"])
@pytest.mark.parametrize(("low", "top"), [(2, 2), (3, 2), (2, 3), (1, 3)])
def test_a_block_tied_to_one_that_has_settled(keyway, low, top, slave):
    """Whichever side follows, and whichever mesh is finer."""
    column = Column(low, top)
    master = "TOP_Z0" if slave == "LOW_Z1" else "LOW_Z1"
    run = keyway(column.deck(ties((slave, master))) + built(column))
    assert_nothing_moves(column, run)
    # Equal meshes: the displacements of LOW stay, and TOP starts from them.
    if low == top:
        below, above = (state_of(run, "ALL", step=2)[nodes] for nodes in column.seam)
        assert below == pytest.approx(state_of(run, "ALL", step=1)[column.seam[0]], abs=DIGITS)
        assert above == pytest.approx(below, abs=DIGITS)


@pytest.mark.parametrize(("low", "top"), [(1, 2), (1, 4), (2, 4), (3, 4), (2, 3)])
def test_a_block_that_has_settled_as_a_whole(keyway, low, top):
    """All new nodes of the seam start where the old block is, also where their mesh is finer."""
    column = Column(low, top)
    settles = node_set("LOW", column.blocks.nodes["LOW"].ravel())
    text = settles + ties(("LOW_Z1", "TOP_Z0"))
    model = column.deck(text).replace("BASE, 1, 3", "FOOT, 1, 2\nBASE, 1, 3")
    foot = node_set("FOOT", column.blocks.side("LOW", "Z0"))
    moved = step(f"{remove('TOP')}*BOUNDARY\nFOOT, 3, 3, -0.01\n{OUTPUT}")
    run = keyway(model.replace("*BOUNDARY", f"{foot}*BOUNDARY", 1) + moved + step(add("TOP")))
    u = state_of(run, "ALL", step=2)[np.concatenate(column.seam)]
    assert u == pytest.approx(np.tile([0.0, 0.0, -0.01], (len(u), 1)), abs=1e-14)


@pytest.mark.parametrize("card", ["EQUATION", "MPC"])
@pytest.mark.parametrize("old_depends", [True, False])
def test_relations_of_nodes(keyway, card, old_depends):
    column = Column(2, 2)
    pairs = np.array(column.seam) + 1
    pairs = pairs if old_depends else pairs[::-1]
    if card == "MPC":
        cards = "*MPC\n" + "".join(f"TIE, {a}, {b}\n" for a, b in pairs.T)
    else:
        cards = "*EQUATION\n" + "".join(
            f"2\n{a}, {i}, 2., {b}, {i}, -2.\n" for a, b in pairs.T for i in (1, 2, 3)
        )
    assert_nothing_moves(column, keyway(column.deck(cards) + built(column)))


def test_new_nodes_that_are_held(keyway):
    """They stay where they are cast: the old nodes that follow them then show no displacement, but
    keep their stress."""
    column = Column(2, 2)
    held = node_set("SEAM", column.seam[1])
    model = column.deck(held + ties(("LOW_Z1", "TOP_Z0")), held="SEAM, 1, 2\n")
    run = keyway(model + built(column))
    assert_nothing_moves(column, run)
    u = state_of(run, "ALL", step=2)[column.seam[0]]
    assert np.abs(u[:, :2]).max() == 0.0
    assert np.abs(u[:, 2]).max() > 1e-5


def test_the_mean_of_settled_nodes(keyway):
    """An equation of two old nodes and one that comes, in the middle between them."""
    column = Column(2, 2)
    below, above = column.blocks.nodes["LOW"][:, :, -1], column.blocks.nodes["TOP"][:, :, 0]
    cards = "*EQUATION\n" + "".join(
        f"3\n{below[0, j] + 1}, {i}, 1., {below[2, j] + 1}, {i}, 1., {above[1, j] + 1}, {i}, -2.\n"
        for j in range(3)
        for i in (1, 2, 3)
    )
    run = keyway(column.deck(cards) + built(column))
    assert_nothing_moves(column, run)
    u = state_of(run, "ALL", step=3)
    middle = 0.5 * (u[below[0]] + u[below[2]])
    assert u[above[1]] == pytest.approx(middle, abs=DIGITS)


def test_a_settled_block_on_a_joint(keyway):
    """The joint below LOW, between different meshes, keeps its tractions; so do cracks in LOW."""
    column = Column(3, 2, below=2)
    joint = "*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, FRICTION=1.\n"
    joint += "*JOINT, NAME=SEAM, LAW=LAW\nLOW_Z0, GROUND_Z1\n"
    table = "*JOINT PRINT, JOINT=SEAM\nTRACTION, OPENING\n"
    law = CRACKING.replace("20e3, 2.", "2e6, 100.")
    steps = cast(column, 0.1).replace(OUTPUT, OUTPUT + table)
    run = keyway(column.deck(ties(("LOW_Z1", "TOP_Z0")) + joint, law=law) + steps)
    # Iterations end at 1e-6 of the largest force.
    assert_stress_stays(column, run, 1e-5)
    rows = run.csv("joint_SEAM")
    ends = [
        rows["increment"][rows["step"] == number].max() == rows["increment"] for number in (1, 2)
    ]
    first, second = (
        rows["tn"][(rows["step"] == number) & end] for number, end in zip((1, 2), ends, strict=True)
    )
    assert second == pytest.approx(first, abs=1e-5 * np.abs(first).max())
