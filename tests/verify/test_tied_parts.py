"""Parts that ties and equations hold: what is an error and what is not when the deck is read."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from joint_decks import static
from tied_blocks import Blocks, node_set, ties

LAW = {"": "*DENSITY\n2400.\n*ELASTIC\n20e9, 0.2\n"}
WEIGHT = static("*DLOAD\nBODY, GRAV, 9.81, 0., 0., -1.\n")


def tower(num: int, pinned: bool = False) -> str:
    """Lifts of 5 m x 1 m x 3 m on each other, tied over their faces or along one edge of them."""
    blocks = Blocks()
    names = [f"L{k}" for k in range(num)]
    for k, name in enumerate(names):
        blocks.add(name, (1, 0.0, 5.0), (1, 0.0, 1.0), (1, 3.0 * k, 3.0 * k + 3.0))
    cards = node_set("FEET", blocks.side("L0", "Z0")) + "*BOUNDARY\nFEET, 1, 3\n"
    if pinned:
        for low, high in itertools.pairwise(names):
            below, above = blocks.side(low, "Z1"), blocks.side(high, "Z0")
            edge = blocks.x[below][:, 1] < 0.5
            for a, b in zip(above[edge], below[edge], strict=True):
                cards += f"*MPC\nPIN, {a + 1}, {b + 1}\n"
    else:
        cards += ties(*((f"{high}_Z0", f"{low}_Z1") for low, high in itertools.pairwise(names)))
    return blocks.deck(LAW, cards + WEIGHT)


def test_a_tall_tower_is_held(keyway):
    """The lowest of 60 lifts hardly resists the tilt of the highest: a chain resists less with the
    fourth power of its length, and is no mechanism."""
    run = keyway(tower(60), "--check")
    assert "free to move" not in run.stderr


@pytest.mark.parametrize("num", [2, 3])
def test_lifts_on_an_edge_are_free(keyway, num):
    run = keyway(tower(num, pinned=True), "--check", code=2)
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
    deck = tower(2, pinned=True)
    deck = deck.replace("*DLOAD", "*MODEL CHANGE, REMOVE\nL1\n*DLOAD", 1)
    run = keyway(deck)
    assert run.json["status"] == "finished"
    assert np.isfinite(run.json["steps"][0]["energy"]["strain"])


@pytest.mark.parametrize("pins", [2, 4])
def test_nodes_without_elements_pass_on_motions(keyway, pins):
    """The corners of two faces follow nodes without elements, one for each pair of corners. Two
    pairs leave a hinge; four hold the block."""
    blocks = Blocks()
    blocks.add("A", (1, 0.0, 1.0), (1, 0.0, 1.0), (1, 0.0, 1.0))
    blocks.add("B", (1, 0.0, 1.0), (1, 0.0, 1.0), (1, 1.0, 2.0))
    cards = node_set("FEET", blocks.side("A", "Z0")) + "*BOUNDARY\nFEET, 1, 3\n"
    pairs = list(zip(blocks.side("B", "Z0"), blocks.side("A", "Z1"), strict=True))[:pins]
    for extra, (a, b) in enumerate(pairs, 1001):
        cards += f"*NODE\n{extra}, 0.5, 0.5, 5.\n*MPC\n"
        cards += f"PIN, {a + 1}, {extra}\nPIN, {b + 1}, {extra}\n"
    run = keyway(blocks.deck(LAW, cards + WEIGHT), code=0 if pins == 4 else 2)
    assert ("free to move" in run.stderr) == (pins == 2)
