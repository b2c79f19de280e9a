"""A scene pays only for the effects that it has: effects are added to a scene one by one.

An effect that a deck lacks has no line in the ledger, so it takes no time that the ledger could
book and no memory of its own. What else the run does is the same: the parts of the smaller scene
are all there in the larger one, and what one effect adds bears its own name. The files that every
run leaves (job.h5, job.pvd, tables) are no effects.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from keyway_tools.study.deck_cards import Card, Deck, read_deck

MESH = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 0., 0., 1.
12, 1., 0., 1.
13, 1., 1., 1.
14, 0., 1., 1.
15, 0., 0., 2.
16, 1., 0., 2.
17, 1., 1., 2.
18, 0., 1., 2.
*ELEMENT, TYPE=C3D8, ELSET=LOWER
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UPPER
2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=BASE
1, 2, 3, 4
*NSET, NSET=TOP
15, 16, 17, 18
*SURFACE, NAME=LOWER_TOP, TYPE=ELEMENT
1, S2
*SURFACE, NAME=UPPER_BASE, TYPE=ELEMENT
2, S1
*SURFACE, NAME=FACE, TYPE=ELEMENT
1, S6
2, S6
*MATERIAL, NAME=ROCK
*DENSITY
2400.
*ELASTIC
2.e10, 0.2
*SOLID SECTION, ELSET=LOWER, MATERIAL=ROCK
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
2.e10, 0.2
*SOLID SECTION, ELSET=UPPER, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 3
*TIE, NAME=SEAM
UPPER_BASE, LOWER_TOP
*STEP, NAME=MOTION, INC=100
*DYNAMIC, DIRECT
0.01, 0.05
*END STEP
"""
CURVES = """*CONCRETE DAMAGED PLASTICITY
36., 0.1, 1.16, 0.6667
*CONCRETE COMPRESSION HARDENING
20.e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
2.5e6, 200.
"""


@dataclass
class Effect:
    """An effect: its cards, the card after which they stand, and its name in the ledger."""

    name: str
    text: str
    after: str  # keyword, and a word of its parameters
    word: str = ""
    replaces: str = ""  # keyword of a card that goes away


EFFECTS = [
    Effect("gravity LOWER", "*DLOAD\nLOWER, GRAV, 9.81, 0., 0., -1.\n", "DYNAMIC"),
    Effect("reservoir LAKE", "*RESERVOIR, NAME=LAKE, SURFACE=FACE, LEVEL=2., BED=0.\n", "DYNAMIC"),
    Effect("damping", "*DAMPING, RATIO=0.05, F1=2., F2=10.\n", "DYNAMIC"),
    Effect("base motion 1", "*BASE MOTION, DOF=1, AMPLITUDE=RAMP\n", "DYNAMIC"),
    Effect("envelopes", "*ENVELOPE\nS1, U\n", "DYNAMIC"),
    Effect("CONCRETE", CURVES, "ELASTIC", "CONCRETE"),
    Effect(
        "JOINT",
        "*JOINT LAW, NAME=DRY, KN=1.e10, KT=1.e10, FRICTION=0.6\n"
        "*JOINT, NAME=JOINT, LAW=DRY\nUPPER_BASE, LOWER_TOP\n",
        "BOUNDARY",
        replaces="TIE",
    ),
]


def with_effect(deck: Deck, effect: Effect, folder) -> Deck:
    """The deck with the cards of an effect."""
    path = folder / "effect.inp"
    path.write_text(effect.text, encoding="utf-8")
    new = deck.copy()
    new.without(new.of(effect.replaces))
    places = [i for i, card in enumerate(new.cards) if card.keyword == effect.after]
    place = places[-1]
    new.cards[place + 1 : place + 1] = read_deck(path).cards
    return new


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Deck:
    """Two blocks, tied, that stand still: mass and stiffness alone."""
    folder = tmp_path_factory.mktemp("plain")
    (folder / "plain.inp").write_text(MESH, encoding="utf-8")
    deck = read_deck(folder / "plain.inp")
    ramp = Card("AMPLITUDE", {"NAME": "RAMP"}, ["0., 0., 1., 1."])
    deck.cards.insert(0, ramp)
    return deck


def parts_of(run) -> dict[str, dict]:
    return {part["name"]: part for part in run.json["ledger"]["parts"]}


def named(parts: dict[str, dict], effect: str) -> list[str]:
    """Parts with the name of an effect, or of its kind."""
    return [name for name, part in parts.items() if effect in (part["kind"], part["effect"])]


def test_effects_have_no_part_before_they_are_added(keyway, plain, tmp_path):
    deck = plain
    before = parts_of(keyway(deck.text(), name="scene_0"))
    for number, effect in enumerate(EFFECTS, start=1):
        assert not named(before, effect.name), f"{effect.name} has a part without being there"
        deck = with_effect(deck, effect, tmp_path)
        after = parts_of(keyway(deck.text(), name=f"scene_{number}"))
        assert named(after, effect.name), f"{effect.name} has no part"
        before = after


def test_the_plain_scene_has_the_structure_alone(keyway, plain):
    """Without effects: files, one matrix, one factor, one solve an increment; the tie."""
    parts = parts_of(keyway(plain.text(), name="plain"))
    assert {part["kind"] for part in parts.values()} <= {"deck", "output", "run", "solver"}
    calls = {name: part["calls"] for name, part in parts.items()}
    assert calls["factor structure"] == 1
    assert calls["solve structure"] <= 6  # five increments and the start
