"""Elements and points of joints that are absent take no part in the extremes of a run."""

from __future__ import annotations

import pytest
from keyway_tools.results import Results
from keyway_tools.study.measured import exceeded_stress
from stage_decks import YOUNG, add, lifts, remove, step
from test_stages import CRACKING

PRESSURE, POISSON = 1e4, 0.2  # [Pa], below the strength in tension
ACROSS = POISSON / (1.0 - POISSON)  # of the pressure, in a body that is held across
HELD = CRACKING.replace(f"{YOUNG!r}, 0.", f"{YOUNG!r}, {POISSON!r}")
SIDES = "*BOUNDARY\nEVERY, 1, 2\n"
REQUEST = "*ENVELOPE\nS1, S3, S1_POINT, S3_POINT\n"


def column(pressure: float) -> str:
    """Two lifts that are held across, with a pressure on the top of the first one and no second."""
    return lifts(2, HELD) + SIDES + step(remove("L2") + f"*DLOAD\nL1, P2, {pressure!r}\n" + REQUEST)


def largest(run, name: str) -> float:
    """The extreme of an envelope anywhere."""
    return run.json["envelopes"][name]["anywhere"]["value"]


def test_extremes_of_the_elements_that_are_there(keyway):
    """S1 of a body that is pressed is below zero, S3 of one that is pulled above; the second lift,
    which is not there, has no zero in between. Closed forms of a body that is held across."""
    for pressure, name, share in ((PRESSURE, "S1", ACROSS), (-PRESSURE, "S3", ACROSS)):
        run = keyway(column(pressure), name=name)
        for field in (name, f"{name}_POINT"):
            assert largest(run, field) == pytest.approx(-share * pressure, rel=1e-9)


def test_extremes_of_an_element_that_comes_and_goes(keyway):
    """Without stress when it comes, it has the largest S1, 0; when it is gone, it has none."""
    comes = keyway(column(PRESSURE) + step(add("L2") + REQUEST), name="comes")
    assert largest(comes, "S1_POINT") == pytest.approx(0.0, abs=1e-9 * PRESSURE)
    low, high = (f"*DLOAD\n{name}, P2, {PRESSURE!r}\n" for name in ("L1", "L2"))
    deck = lifts(2, HELD) + SIDES + step(high + REQUEST) + step(remove("L2") + low + REQUEST)
    goes = keyway(deck, name="goes")
    for field in ("S1", "S1_POINT"):
        assert largest(goes, field) == pytest.approx(-ACROSS * PRESSURE, rel=1e-9)


def test_the_stress_of_a_study(keyway):
    """The S1 that is exceeded in a share of the volume counts a node while it has an element."""
    cards = column(PRESSURE) + step(
        add("L2") + f"*DLOAD\nL1, P2, 0.\nL2, P2, {PRESSURE!r}\n" + REQUEST
    )
    run = keyway(cards)
    assert exceeded_stress(Results(run.folder)) == pytest.approx(-ACROSS * PRESSURE, rel=1e-9)
