"""Continuity from step to step: motion, forces and damping of a brick that oscillates at 1 Hz.

The brick of test_order_in_time.py: held sideways, nu = 0, so one oscillator of stiffness E A / l
and mass rho A l / 3. It stands deformed under its weight; then the weight is gone.
"""

import math

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from keyway_tools.box_mesh import box_mesh, stretched

OMEGA = 2.0 * math.pi
WEIGHT = "*DLOAD{}\nBODY, GRAV, {}, 0., 0., -1.\n"
REST = "*STEP\n*STATIC\n" + WEIGHT.format("", 1.0) + "*NODE PRINT, NSET=TOP\nU, V, A\n*END STEP\n"


def swinging(keyway, steps: str, damping: str = "", name: str = "job"):
    """Table of the top after a static step under the weight and these steps."""
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:1, :1, 1].ravel()
    cards = elastic(OMEGA**2, 0.0, 3.0).replace("*ELASTIC", damping + "*ELASTIC")
    cards += "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n" + REST + steps
    return keyway(brick_deck(mesh, "C3D8", cards), name=name).csv("node_TOP")


def dynamic(duration: float, content: str = "", alpha: float = 0.0) -> str:
    return f"*STEP\n*DYNAMIC, DIRECT, ALPHA={alpha}\n0.01, {duration}\n{content}*END STEP\n"


def test_ratio_at_two_frequencies_is_that_ratio(keyway):
    """5 % at 1 Hz and 8 Hz is, at 1 Hz, 2 zeta w times the mass: to round-off."""
    gone = WEIGHT.format(", OP=NEW", 0.0)
    by_ratio = swinging(
        keyway, dynamic(1.0, gone + "*DAMPING, RATIO=0.05, F1=1., F2=8.\n"), name="ratio"
    )
    by_mass = swinging(
        keyway,
        dynamic(1.0, gone),
        damping=f"*DAMPING, ALPHA={2.0 * 0.05 * OMEGA!r}\n",
        name="mass",
    )
    size = np.abs(by_mass["U3"]).max()
    assert by_ratio["U3"] == pytest.approx(by_mass["U3"], abs=1e-10 * size)
    assert np.abs(by_mass["U3"][-1]) < 0.75 * size  # exp(-0.05 2 pi) = 0.73


def test_a_motion_goes_on_in_a_second_step(keyway):
    """With alpha = 0 the acceleration that starts the second step is the last one of the first.

    1e-9: twenty increments carry the tolerance of that start, 1e-13, and thirteen printed digits.
    """
    damping = "*DAMPING, RATIO=0.05, F1=1., F2=8.\n"
    gone = WEIGHT.format(", OP=NEW", 0.0) + damping
    once = swinging(keyway, dynamic(0.4, gone), name="once")
    twice = swinging(keyway, dynamic(0.2, gone) + dynamic(0.2), name="twice")
    for column in ("time", "U3", "V3", "A3"):
        size = np.abs(once[column]).max()
        assert twice[column] == pytest.approx(once[column], abs=1e-9 * size)


def test_a_static_step_ends_the_motion(keyway):
    """Back under its weight the brick is at rest in its first position, to round-off."""
    back = "*STEP\n*STATIC\n" + WEIGHT.format("", 1.0) + "*END STEP\n"
    table = swinging(keyway, dynamic(0.2, WEIGHT.format(", OP=NEW", 0.0)) + back)
    start, end = table["U3"][0], table["U3"][-1]
    assert end == pytest.approx(start, rel=1e-12)
    assert table["V3"][-1] == 0.0 and table["A3"][-1] == 0.0
