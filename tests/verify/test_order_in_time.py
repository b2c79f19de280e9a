"""HHT is of second order in time, from a consistent start: a damped column after removal of its
load.

One brick held sideways is an oscillator: stiffness E A / l (nu = 0), mass rho A l / 3. It stands
deformed under its weight in a static step; then the weight is gone. Exact: u = u0 exp(-z w t) (cos
wd t + z w / wd sin wd t), and a0 = -w^2 u0 at the start, which the step must compute.
"""

import math

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, order_of
from keyway_tools.box_mesh import box_mesh, stretched

OMEGA = 2.0 * math.pi  # a period of 1 s
RATIO = 0.05
DENSITY = 3.0
MODULUS = OMEGA**2  # k = E, m = rho / 3 = 1
NAMES = {"U": "displacement", "V": "velocity", "A": "acceleration"}
DURATION = 1.25  # s, neither a crest nor a zero


def deck(dt: float, alpha: float) -> str:
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:1, :1, 1].ravel()
    law = elastic(MODULUS, 0.0, DENSITY)
    law = law.replace("*ELASTIC", f"*DAMPING, ALPHA={2.0 * RATIO * OMEGA!r}\n*ELASTIC")
    cards = law + "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n"
    cards += "*STEP\n*STATIC\n*DLOAD\nBODY, GRAV, 1., 0., 0., -1.\n"
    cards += "*NODE PRINT, NSET=TOP\nU, V, A\n*END STEP\n"
    cards += f"*STEP, INC=100000\n*DYNAMIC, DIRECT, ALPHA={alpha}\n{dt!r}, {DURATION}\n"
    cards += "*DLOAD, OP=NEW\nBODY, GRAV, 0., 0., 0., -1.\n*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


def exact(t: float) -> np.ndarray:
    """Displacement, velocity, acceleration."""
    start = -0.5 * DENSITY / MODULUS  # half of the weight over k
    decay, damped = RATIO * OMEGA, OMEGA * math.sqrt(1.0 - RATIO**2)
    root = complex(-decay, damped)
    amplitude = start * complex(1.0, -decay / damped)
    return np.array([(amplitude * root**n * np.exp(root * t)).real for n in range(3)])


def errors(keyway, alpha: float, steps: list[int]) -> np.ndarray:
    """Of u, v, a at the end, each over its size at rest or in motion."""
    scale = 0.5 * DENSITY / MODULUS * OMEGA ** np.arange(3)
    found = []
    for count in steps:
        table = keyway(deck(DURATION / count, alpha)).csv("node_TOP")
        end = np.array([table[f"{field}3"][-1] for field in "UVA"])
        found.append(np.abs(end - exact(DURATION)) / scale)
    return np.array(found)


@pytest.mark.parametrize(("alpha", "fields"), [(0.0, "UVA"), (-0.05, "UV"), (-0.3, "UV")])
def test_second_order(keyway, documented, alpha, fields):
    """0.1: at 100 and 200 increments a period the next term is some percent of the first.

    The acceleration is of first order when alpha < 0: HHT's balance gives that of the time
    t + (1 + alpha) dt. Nothing else depends on it in that way.
    """
    counts = np.array([125, 250])
    found = errors(keyway, alpha, counts.tolist())
    for field in fields:
        order = order_of(1.0 / counts, found[:, "UVA".index(field)])
        assert order == pytest.approx(2.0, abs=0.1)
        documented(
            "orders", (f"{NAMES[field]} in time, HHT", f"alpha {alpha:g}"), "measured", order
        )


def test_order_of_the_acceleration(keyway, documented):
    """Between the second order of coarse increments and the first of fine ones; see above."""
    counts = np.array([125, 250])
    order = order_of(1.0 / counts, errors(keyway, -0.05, counts.tolist())[:, 2])
    assert 1.0 < order < 2.0
    documented("orders", ("acceleration in time, HHT", "alpha -0.05"), "measured", order)


def test_start_is_consistent(keyway):
    """The first acceleration is that of the weight taken away; 0.1 %: HHT's is 5e-5 s late."""
    table = keyway(deck(1.0e-3, -0.05)).csv("node_TOP")
    first = table["A3"][table["step"] == 2][0]
    assert first == pytest.approx(exact(1.0e-3)[2], rel=1e-3)


def test_scheme_of_a_dynamic_step(keyway):
    """HHT is the default: named or not, the motion is the same to the last digit."""
    named = deck(0.05, -0.05).replace("*DYNAMIC, ", "*DYNAMIC, SCHEME=HHT, ")
    tables = [
        keyway(text, name=name).csv("node_TOP")
        for name, text in (("named", named), ("unnamed", deck(0.05, -0.05)))
    ]
    assert "SCHEME=HHT" in named
    for field in "UVA":
        assert np.array_equal(tables[0][f"{field}3"], tables[1][f"{field}3"])
