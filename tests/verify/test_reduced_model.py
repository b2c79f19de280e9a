"""*DYNAMIC, REDUCED against the full model: openings, energies, the estimate of the error."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from dam_trials import DeckOptions, Trial, deck_of

DAMPED = DeckOptions(damping=(0.05, 2.0, 10.0))
SHAKEN = Trial(size=1.0, duration=2.0, is_coarse=True, options=DAMPED)
ACCURACY = 0.02
HONEST = 3.0  # factor between the error and its estimate
# An error far below the accuracy need not be known to a factor.
NEGLIGIBLE = 0.2 * ACCURACY


def with_openings(text: str) -> str:
    """The deck with all points of the joints printed, and without fields and envelopes."""
    lines = [line for line in text.splitlines() if not line.startswith("**")]
    kept, skips = [], 0
    for line in lines:
        if line.startswith(("*NODE PRINT", "*NODE FILE", "*EL FILE", "*ENVELOPE", "*JOINT PRINT")):
            skips = 0 if line.startswith("*JOINT PRINT") else 1
            continue
        if skips:
            skips -= 1
            continue
        kept.append(line)
    return "\n".join(kept) + "\n"


def decks(trial: Trial, reduced: str) -> tuple[str, str, dict[str, str]]:
    """Decks with the full and with the reduced model, and the files beside them."""
    text, files = deck_of(trial)
    text = with_openings(text)
    prints = "".join(f"*JOINT PRINT, JOINT=JOINT{j + 1}\n" for j in range(trial.num_joints))
    head, tail = text.rsplit("*END STEP", 1)
    full = head + prints + "*END STEP" + tail
    assert full.count("*DYNAMIC,") == 1
    return full, full.replace("*DYNAMIC,", f"*DYNAMIC, REDUCED{reduced},"), files


def openings(run, num_joints: int) -> np.ndarray:
    """Openings of all points in the increments of the last step [m]."""
    tables = [run.csv(f"joint_JOINT{j + 1}") for j in range(num_joints)]
    return np.concatenate([np.maximum(table["opening"], 0.0) for table in tables])


def compare(keyway, trial: Trial, reduced: str = ""):
    """The reduced run, its largest error of the openings, and that of the largest openings."""
    full_deck, reduced_deck, files = decks(trial, reduced)
    full = keyway(full_deck, name="full", files=files)
    run = keyway(reduced_deck, name="reduced", files=files)
    expected, found = openings(full, trial.num_joints), openings(run, trial.num_joints)
    largest = expected.max()
    assert largest > 1e-3
    error = np.abs(found - expected).max() / largest
    joints = full.json["joints"]
    most = max(
        abs(run.json["joints"][name]["opening"]["anywhere"]["value"] - value) / value
        for name in joints
        if (value := joints[name]["opening"]["anywhere"]["value"]) > 0.1 * largest
    )
    return full, run, error, most


def estimate_of(run) -> float:
    (reduced,) = run.json["accuracy"]["reduced"].values()
    return reduced["estimated_error"]


def check_estimate(run, error: float) -> None:
    estimate = estimate_of(run)
    assert error <= HONEST * max(estimate, NEGLIGIBLE)
    assert estimate <= HONEST * max(error, NEGLIGIBLE)


def check_energies(full, run) -> None:
    """The balance closes, and its items are those of the full model."""
    expected, found = full.json["steps"][-1]["energy"], run.json["steps"][-1]["energy"]
    assert found["error"] <= 1e-6
    for name in ("external", "kinetic", "strain", "damping", "friction"):
        assert found[name] == pytest.approx(expected[name], abs=0.03 * expected["external"])


def test_openings_of_a_dam(keyway):
    full, run, error, most = compare(keyway, SHAKEN)
    assert most <= ACCURACY
    assert error <= HONEST * ACCURACY
    check_estimate(run, error)
    check_energies(full, run)


def test_estimate_with_too_few_modes(keyway):
    _, run, error, _ = compare(keyway, SHAKEN, ", MODES=40")
    assert error > ACCURACY
    assert estimate_of(run) > ACCURACY
    check_estimate(run, error)
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
    check_energies(full, run)
    assert estimate_of(run) <= ACCURACY


def test_threads(keyway):
    """The last shapes amplify round-off: a small part of the accuracy."""
    _, deck, files = decks(SHAKEN, ", MODES=60")
    one = keyway(deck, "-j", "1", name="one", files=files)
    two = keyway(deck, "-j", "2", name="two", files=files)
    expected = openings(one, SHAKEN.num_joints)
    found = openings(two, SHAKEN.num_joints)
    assert found == pytest.approx(expected, abs=0.05 * ACCURACY * expected.max())
