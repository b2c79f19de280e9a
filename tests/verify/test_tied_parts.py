"""Parts that ties and equations hold: what is an error and what is not when the deck is read."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from joint_decks import static
from tied_blocks import Blocks, node_set, ties

LAW = {"": "*DENSITY\n2400.\n*ELASTIC\n20e9, 0.2\n"}
WEIGHT = static("*DLOAD\nBODY, GRAV, 9.81, 0., 0., -1.\n")


def tower(num: int, num_pinned: int = 0) -> str:
    """Lifts of 5 m x 1 m x 3 m on each other, tied over their faces; the highest `num_pinned` are
    tied along one edge of them."""
    blocks = Blocks()
    names = [f"L{k}" for k in range(num)]
    for k, name in enumerate(names):
        blocks.add(name, (1, 0.0, 5.0), (1, 0.0, 1.0), (1, 3.0 * k, 3.0 * k + 3.0))
    cards = node_set("FEET", blocks.side("L0", "Z0")) + "*BOUNDARY\nFEET, 1, 3\n"
    pairs = list(itertools.pairwise(names))
    for low, high in pairs[num - 1 - num_pinned :]:
        below, above = blocks.side(low, "Z1"), blocks.side(high, "Z0")
        edge = blocks.x[below][:, 1] < 0.5
        for a, b in zip(above[edge], below[edge], strict=True):
            cards += f"*MPC\nPIN, {a + 1}, {b + 1}\n"
    held = pairs[: num - 1 - num_pinned]
    cards += ties(*((f"{high}_Z0", f"{low}_Z1") for low, high in held))
    return blocks.deck(LAW, cards + WEIGHT)


def test_a_tall_tower_is_held(keyway):
    """The lowest of 60 lifts hardly resists the tilt of the highest: a chain resists less with the
    fourth power of its length, and is no mechanism."""
    run = keyway(tower(60), "--check")
    assert "free to move" not in run.stderr


def test_many_lifts(keyway):
    """Lifts that are tied over their faces are one body: 150 of them are checked at once, and one
    more on an edge is free."""
    run = keyway(tower(150), "--check", name="held")
    assert "free to move" not in run.stderr
    run = keyway(tower(151, 1), "--check", code=2, name="pinned")
    assert "the block with element 151 of set L150 is free to move" in run.stderr


@pytest.mark.parametrize("num_pinned", [0, 1])
def test_a_tie_of_many_parts(keyway, num_pinned):
    """One tie of 25 columns and a slab. Columns more are pinned to the slab along an edge."""
    blocks = Blocks()
    blocks.add("SLAB", (60, 0.0, 60.0), (2, 0.0, 2.0), (1, -1.0, 0.0))
    names = [f"C{k}" for k in range(25 + num_pinned)]
    for k, name in enumerate(names):
        blocks.add(name, (1, 2.0 * k, 2.0 * k + 1.0), (1, 0.0, 1.0), (1, 0.0, 2.0))
    cards = node_set("FEET", blocks.side("SLAB", "Z0")) + "*BOUNDARY\nFEET, 1, 3\n"
    cards += "*SURFACE, NAME=COLUMNS\n" + "".join(f"{name}, S1\n" for name in names[:25])
    cards += ties(("COLUMNS", "SLAB_Z1"))
    slab = blocks.side("SLAB", "Z1")
    for foot in (node for name in names[25:] for node in blocks.side(name, "Z0")):
        if blocks.x[foot][1] < 0.5:
            below = slab[np.abs(blocks.x[slab] - blocks.x[foot]).sum(axis=1) < 1e-9]
            cards += f"*MPC\nPIN, {foot + 1}, {below[0] + 1}\n"
    run = keyway(blocks.deck(LAW, cards + WEIGHT), "--check", code=2 if num_pinned else 0)
    assert ("of set C25 is free to move" in run.stderr) == (num_pinned == 1)


@pytest.mark.parametrize("num", [2, 3])
def test_lifts_on_an_edge_are_free(keyway, num):
    run = keyway(tower(num, num - 1), "--check", code=2)
    assert "is free to move" in run.stderr


@pytest.mark.parametrize("first", [1.0, 1e-3, 1e-6])
def test_the_size_of_coefficients_does_not_count(keyway, first):
    """Supports in an inclined direction, with a small coefficient of the displacement that follows:
    n1 u1 + n2 u2 = 0."""
    blocks = Blocks()
    blocks.add("A", (1, 0.0, 1.0), (1, 0.0, 1.0), (1, 0.0, 1.0))
    blocks.add("B", (1, 0.0, 1.0), (1, 0.0, 1.0), (1, 1.0, 2.0))
    cards = node_set("FEET", blocks.side("A", "Z0")) + "*BOUNDARY\nFEET, 1, 3\n"
    cards += ties(("B_Z0", "A_Z1"))
    for node in blocks.side("B", "Z1")[:3]:
        cards += f"*EQUATION\n2\n{node + 1}, 1, {first!r}, {node + 1}, 2, 1.\n"
    run = keyway(blocks.deck(LAW, cards + WEIGHT))
    assert run.json["status"] == "finished"


def test_parts_that_are_not_there_need_no_support(keyway):
    """A block on pins is taken out in the only step."""
    deck = tower(2, 1)
    deck = deck.replace("*DLOAD", "*MODEL CHANGE, REMOVE\nL1\n*DLOAD", 1)
    run = keyway(deck)
    assert run.json["status"] == "finished"
    assert np.isfinite(run.json["steps"][0]["energy"]["strain"])


@pytest.mark.parametrize("chained", ["FOOT", "TOP"])
def test_a_node_without_elements_excuses_only_its_own_parts(keyway, chained):
    """A lift on an edge is free, whatever node without elements an equation adds elsewhere; beside
    the lift itself that node may hold it."""
    deck = tower(2, 1)
    node = {"FOOT": 1, "TOP": 16}[chained]  # the first node of L0, the last of L1
    deck = deck.replace("NSET=ALL\n", "NSET=ALL\n9999, 50., 0., 0.\n", 1)
    deck = deck.replace("*STEP", f"*EQUATION\n2\n9999, 1, 1., {node}, 1, -1.\n*STEP", 1)
    run = keyway(deck, "--check", code=2 if chained == "FOOT" else 0)
    assert ("is free to move" in run.stderr) == (chained == "FOOT")


def test_too_many_hinges_are_reported(keyway):
    """Beyond 100 parts on hinges the check is left out, and the log says so."""
    run = keyway(tower(102, 101), "--check")
    assert "warning: ties and equations leave 102 separate parts" in run.stderr
    assert "is left out above 100 parts" in run.stderr
