"""The largest tension of concrete that has cracked completely, beside equal compression in the two
other directions (docs/theory.md, 11.2), by keyway --material.

The references are solutions of the yield surface (Eqs. 19 and 23) with the recovery of stiffness
(Eqs. 14 to 18) by bisection here, without the program.
"""

from __future__ import annotations

import pytest
from harness import ROOT

DECK = ROOT / "input" / "material" / "table1_tension.inp"
STRENGTH, DAMAGE = 0.169e6, 0.964  # of the last row of Table 1
ALPHA, CRUSHING = 0.1, 30e6
EFFECTIVE = STRENGTH / (1.0 - DAMAGE)
BESIDE = 5.472e6  # [Pa] where the tension of LEE-FENVES is largest


def effective_tension(compression: float) -> float:
    """Effective tension t with F(t, -c, -c) = 0, linear in t: q = t + c, 3 p = 2 c - t."""
    beta = CRUSHING / EFFECTIVE * (1.0 - ALPHA) - (1.0 + ALPHA)
    return ((1.0 - ALPHA) * CRUSHING - compression * (1.0 - 2.0 * ALPHA)) / (1.0 + ALPHA + beta)


def tension_of_switch() -> float:
    """RECOVERY=SIGN: the sum of the stresses is negative, so that nothing is left of the damage."""
    tension = effective_tension(BESIDE)
    assert tension < 2.0 * BESIDE
    return tension


def tension_of_weight() -> float:
    """RECOVERY=LEE-FENVES: the damage counts with r, the share of tension."""
    low, high = BESIDE, 3.0 * BESIDE
    for _ in range(60):
        middle = 0.5 * (low + high)
        tension = effective_tension(middle)
        left = 1.0 - DAMAGE * tension / (tension + 2.0 * middle)
        low, high = (middle, high) if left * middle < BESIDE else (low, middle)
    return left * tension


CASES = (("SIGN", tension_of_switch()), ("LEE-FENVES", tension_of_weight()))


def largest_tension(keyway, recovery: str) -> float:
    """Cracks a point completely, compresses it sideways and pulls it again, beyond the surface."""
    law = DECK.read_text().split("*MATERIAL TEST")[0]
    law = law.replace("RECOVERY=LEE-FENVES", f"RECOVERY={recovery}")
    test = f"""*MATERIAL TEST, NAME=T, TYPE=GENERAL
ESSSSS, 1.67076e-3, 0., 0., 0., 0., 0., 200
SSSSSS, 0., -{BESIDE}, -{BESIDE}, 0., 0., 0., 20
ESSSSS, 1.9e-3, -{BESIDE}, -{BESIDE}, 0., 0., 0., 400
"""
    legs = keyway(law + test, "--material").csv("material_T")
    return max(legs["S11"][legs["leg"] == 3])


@pytest.mark.parametrize(("recovery", "expected"), CASES)
def test_closed_cracks_return_a_tension_beyond_the_strength(keyway, recovery, expected):
    """The path meets the surface between two of its 400 states: 5 kPa a state, less than 0.2 %."""
    assert expected > 1.19 * 2.48e6
    assert largest_tension(keyway, recovery) == pytest.approx(expected, rel=2e-3)


def test_energy_split_keeps_the_tension_below_the_strength_of_the_crack(keyway):
    assert 0.0 < largest_tension(keyway, "ENERGY") < STRENGTH
