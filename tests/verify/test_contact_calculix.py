"""Contact of unequal meshes: one deck in Keyway and in CalculiX (face to face, penalty)."""

from __future__ import annotations

import numpy as np
import pytest
from brick_decks import last_state
from calculix import displacements, needs_calculix, run_calculix
from contact_decks import Contact, law
from joint_decks import static

pytestmark = [pytest.mark.full, needs_calculix]

PAIR = "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\nSOLE, ROOF\n"
LOAD = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\nBLOCK, P2, 1e6\n"


@pytest.mark.parametrize("fine", [1, 2])
@pytest.mark.parametrize(
    ("push", "stiffness", "allowed"),
    [(0.0, 1e12, 1e-6), (2e4, 1e12, 3e-3), (2e4, 1e13, 3e-4), (2e4, 1e14, 3e-5)],
    ids=["pressed", "pushed", "pushed-10", "pushed-100"],
)
def test_the_same_deck(keyway, tmp_path, fine, push, stiffness, allowed):
    """A block on its bed, LINEAR and friction with a stick slope.

    Both have C3D8 with 2 x 2 x 2 points; they differ in the points of the springs: nodes of the
    slave here, points within its faces there, which a uniform pressure does not see. The difference
    falls as 1/stiffness, and is the same where the meshes match. Measured, of the largest
    displacement: pressed 2.9e-7 and 1.7e-7, where CalculiX prints seven digits; pushed 1.1e-3 and
    1.4e-3, with 10 times the stiffness 1.4e-4, with 100 times 1.4e-5.
    """
    counts = {"counts": (4 * fine, 2 * fine, 2 * fine), "base_counts": (6 * fine, 3 * fine, fine)}
    cards = [law("LINEAR", f"0.5, {stiffness / 10}", f"{stiffness}"), PAIR]
    load = LOAD + f"*CLOAD\nTOP, 1, {push!r}\n*NODE PRINT, NSET=BODY\nU\n"
    deck = Contact(young=1e10, contact=cards, **counts).deck(static(load, "0.5, 1."))
    other = displacements(run_calculix(deck, tmp_path))[1.0]
    ours = last_state(keyway(deck), "BODY")
    apart = np.abs(ours - other).max() / np.abs(other).max()
    assert apart < allowed, apart
