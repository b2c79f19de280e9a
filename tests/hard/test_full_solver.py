"""Crossings and monoliths hold with JOINT SOLVER=FULL too: both solvers have one policy."""

import pytest
from crossing_cases import CROSSINGS

NAMES = (
    "X crossing, friction 0.6, meshes 2:3",
    "X crossing, shaken, friction 0.8",
    "T crossing",
    "arch of 12 blocks",
    "monoliths, base 3 facets, friction 0.7, 0.3 g",
    "lift joint across contraction joints",
)


@pytest.mark.parametrize("name", NAMES)
def test_case_holds_with_full_newton(keyway, name):
    case = next(case for case in CROSSINGS.cases if case.name == name)

    def with_full_newton(deck, *options, **more):
        assert "*STATIC" in deck
        deck = deck.replace("*STATIC", "*CONTROLS, JOINT SOLVER=FULL\n*STATIC")
        return keyway(deck, *options, **more)

    assert case.run(with_full_newton).holds
