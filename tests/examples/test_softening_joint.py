"""The worked example of a joint law: a cohesive joint with softening, against its closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
DECK = HERE / "softening_joint" / "deck.inp"
STIFFNESS, STRENGTH, ENERGY = 1e12, 1e6, 100.0  # k_n [Pa/m], f [Pa], G_f [J/m2] of the deck
FIRST = STRENGTH / STIFFNESS  # v_0 [m]
LAST = 2.0 * ENERGY / STRENGTH  # v_f [m]
BLOCKS = 1e10  # stiffness of both cubes in a row [N/m]
AREA = 1.0  # of the joint [m2]
# The increments end where the residual is below 1e-6 of the joint force.
TOLERANCE = 1e-6


def envelope(w: np.ndarray) -> np.ndarray:
    """Traction at the largest opening so far [Pa]."""
    softening = STRENGTH * np.clip((LAST - w) / (LAST - FIRST), 0.0, 1.0)
    return np.minimum(STIFFNESS * w, softening)


def test_path_of_a_softening_joint(example):
    """Softening, unloading to the origin, opening for good, contact; all the work is G_f A."""
    run = example("softening_joint")(DECK)
    joint = run.csv("joint_J")
    here = joint["point"] == 1
    opening, traction = joint["opening"][here], joint["tn"][here]
    largest = np.maximum.accumulate(opening)
    tension = envelope(largest) * opening / np.maximum(largest, 1e-30)
    by_law = np.where(opening < 0.0, STIFFNESS * opening, tension)
    assert traction == pytest.approx(by_law, abs=1e-9 * STRENGTH)
    top = run.csv("node_UPZ1")
    moved = top["U3"][top["node"] == top["node"][0]]
    assert traction == pytest.approx(BLOCKS * (moved - opening), abs=TOLERANCE * STRENGTH)
    # The path meets every part of the law.
    assert np.any((largest > FIRST) & (largest < LAST) & (opening < 0.9 * largest) & (opening > 0))
    assert np.any((opening > LAST) & (traction == 0.0))
    assert traction.min() < -0.5 * STRENGTH
    work = run.csv("energy")["fracture"]
    assert work[-1] == pytest.approx(ENERGY * AREA, rel=1e-9)
    # End of the first leg: area below the curve less the energy recovered by unloading.
    w = largest[19]
    below = 0.5 * STRENGTH * FIRST + 0.5 * (STRENGTH + envelope(w)) * (w - FIRST)
    assert work[19] == pytest.approx((below - 0.5 * envelope(w) * w) * AREA, rel=1e-9)
    assert work[39] == pytest.approx(work[19], rel=1e-12)
    assert run.csv("energy")["error"].max() < TOLERANCE


def test_state_of_a_softening_joint(example):
    """The law reports bonded while it can carry tension, open, and pressed when it is broken."""
    table = example("softening_joint")(DECK).csv("joint_J")
    here = table["point"] == 1
    opening, state = table["opening"][here], table["state"][here]
    broken = np.maximum.accumulate(opening) >= LAST
    assert broken.any()
    assert np.array_equal(state, np.where(broken, np.where(opening > 0.0, 0, 1), 3))


def test_help_and_messages_name_the_new_law(example):
    """The reader, the help and the messages are made from the catalogue."""
    program = example("softening_joint")
    text = program.call("--keywords", "JOINT LAW").stdout
    assert "one of CONTRACTION, SOFTENING; default CONTRACTION" in text
    assert "With TYPE=SOFTENING" in text
    assert "work of fracture per area; a number > 0 [J/m2]; required" in text
    deck = DECK.read_text(encoding="utf-8")
    run = program(deck.replace("TYPE=SOFTENING", "TYPE=SOFT"), code=2)
    assert "expected one of CONTRACTION, SOFTENING" in run.stderr
    run = program(deck.replace("FRACTURE ENERGY=100.", "FRICTION=0.5"), code=2)
    assert "unknown parameter 'FRICTION'; expected one of NAME, TYPE, KN, KT," in run.stderr
    assert "parameter FRACTURE ENERGY is missing" in run.stderr
    run = program(deck.replace("ENERGY=100.", "ENERGY=0.4"), code=2)
    assert "more than TENSILE STRENGTH**2/(2 KN)" in run.stderr
