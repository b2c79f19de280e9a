"""*DYNAMIC, REDUCED against the full model: openings, energies, the estimate of the error."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from dam_trials import DeckOptions, Trial, deck_of
from keyway_tools.arch_shape import ArchShape
from reduced_trials import ACCURACY, compare, decks, openings, with_openings

DAMPED = DeckOptions(damping=(0.05, 2.0, 10.0))
SHAKEN = Trial(size=1.0, duration=2.0, is_coarse=True, options=DAMPED)
# The dams of theory.md, 7.4, but the largest.
DAMS = {
    "strong": dataclasses.replace(SHAKEN, size=2.0),
    "finer": Trial(size=1.5, duration=2.0, options=DAMPED),
    "200 m, five joints": dataclasses.replace(
        SHAKEN,
        num_joints=5,
        shape=ArchShape(height=200.0, crest_arc=500.0),
        options=dataclasses.replace(DAMPED, water_depth=155.0),
    ),
    "no rock": Trial(size=1.5, duration=2.0, options=DAMPED, num_joints=3, has_rock=False),
    "four joints": Trial(size=1.0, duration=2.0, options=DAMPED, num_joints=4),
    "90 m": dataclasses.replace(
        SHAKEN,
        size=0.7,
        shape=ArchShape(height=90.0, crest_arc=300.0, base_thickness=25.0),
        options=dataclasses.replace(DAMPED, water_depth=70.0),
    ),
}
LONG = ("finer", "no rock", "four joints")


def test_openings_of_a_dam(keyway):
    compare(keyway, SHAKEN).check()


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.full] if n in LONG else []) for n in DAMS]
)
def test_openings_of_other_dams(keyway, name):
    """Openings within 2 % of the full model, the estimate within a factor of 3 of the error."""
    compare(keyway, DAMS[name]).check()


def test_estimate_with_too_few_modes(keyway):
    found = compare(keyway, SHAKEN, ", MODES=40")
    assert found.error > ACCURACY
    assert found.estimate > ACCURACY
    found.check_estimate()
    run = found.reduced
    assert "does not reach the ACCURACY" in (run.folder / f"{run.job}.log").read_text()


def test_dam_without_joints(keyway):
    """A linear dam: displacements of the crest against those of the full model."""
    trial = dataclasses.replace(SHAKEN, num_joints=0)
    text, files = deck_of(trial)
    plain = with_openings(text)
    head, tail = plain.rsplit("*END STEP", 1)
    full_deck = head + "*NODE PRINT, NSET=CROWN_CREST\nU, V, A, RF\n*END STEP" + tail
    full = keyway(full_deck, name="full", files=files)
    run = keyway(full_deck.replace("*DYNAMIC,", "*DYNAMIC, REDUCED,"), name="reduced", files=files)
    expected, found = full.csv("node_CROWN_CREST"), run.csv("node_CROWN_CREST")
    start = expected["U2"][0]
    size = np.abs(expected["U2"] - start).max()
    assert found["U2"] == pytest.approx(expected["U2"], abs=ACCURACY * size)
    for column in ("V2", "A2"):
        size = np.abs(expected[column]).max()
        assert found[column] == pytest.approx(expected[column], abs=0.05 * size)
    (reduced,) = run.json["accuracy"]["reduced"].values()
    assert reduced["estimated_error"] <= ACCURACY


def test_threads(keyway):
    """Sums over threads differ in the last digits; the shapes amplify that little."""
    _, deck, files = decks(SHAKEN, ", MODES=60")
    one = keyway(deck, "-j", "1", name="one", files=files)
    two = keyway(deck, "-j", "2", name="two", files=files)
    expected = openings(one, SHAKEN.num_joints)
    found = openings(two, SHAKEN.num_joints)
    assert found == pytest.approx(expected, abs=1e-6 * expected.max())


def test_model_without_an_estimate(keyway):
    """With MODES and ERROR ESTIMATE=OFF the step is not run for an estimate: the same openings."""
    _, deck, files = decks(SHAKEN, ", MODES=60")
    tried = keyway(deck, name="tried", files=files)
    off = deck.replace("*DYNAMIC,", "*CONTROLS, ERROR ESTIMATE=OFF\n*DYNAMIC,")
    run = keyway(off, name="off", files=files)
    expected = openings(tried, SHAKEN.num_joints)
    # The same increments from the same model.
    assert openings(run, SHAKEN.num_joints) == pytest.approx(expected, abs=1e-9 * expected.max())
    parts = [part["name"] for part in run.json["ledger"]["parts"]]
    assert "estimate reduced model" not in parts
    (reduced,) = run.json["accuracy"]["reduced"].values()
    assert set(reduced) == {"modes", "highest_hz"}


def test_accuracy_needs_the_estimate(keyway):
    """Without MODES the estimate finds their number, also with ERROR ESTIMATE=OFF."""
    _, deck, files = decks(SHAKEN)
    run = keyway(deck.replace("*DYNAMIC,", "*CONTROLS, ERROR ESTIMATE=OFF\n*DYNAMIC,"), files=files)
    (reduced,) = run.json["accuracy"]["reduced"].values()
    assert reduced["estimated_error"] <= ACCURACY
