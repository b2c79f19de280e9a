"""Dams with the full and with the reduced model (*DYNAMIC, REDUCED), and their comparison."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from dam_trials import Trial, deck_of
from harness import Program, Run

ACCURACY = 0.02  # default of the keyword
HONEST = 3.0  # factor between the error and its estimate
# An error far below the accuracy need not be known to a factor.
NEGLIGIBLE = 0.2 * ACCURACY


@dataclass(frozen=True)
class Comparison:
    """Both runs and what the reduced one leaves out."""

    full: Run
    reduced: Run
    error: float  # largest of the history of any opening, over the largest opening
    most: float  # error of the largest opening of any joint, over the largest of all

    @property
    def estimate(self) -> float:
        """The program's own; the last step's where there are two."""
        return list(self.reduced.json["accuracy"]["reduced"].values())[-1]["estimated_error"]

    def check(self) -> None:
        """Openings within the accuracy, an honest estimate, the same energies."""
        assert self.most <= ACCURACY
        assert self.error <= HONEST * ACCURACY
        self.check_estimate()
        self.check_energies()

    def check_estimate(self) -> None:
        assert self.error <= HONEST * max(self.estimate, NEGLIGIBLE)
        assert self.estimate <= HONEST * max(self.error, NEGLIGIBLE)

    def check_energies(self) -> None:
        """The balance closes, and its items are those of the full model."""
        expected = self.full.json["steps"][-1]["energy"]
        found = self.reduced.json["steps"][-1]["energy"]
        assert found["error"] <= 1e-6
        for name in ("external", "kinetic", "strain", "damping", "friction"):
            assert found[name] == pytest.approx(expected[name], abs=0.03 * expected["external"])


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


def decks(trial: Trial, reduced: str = "") -> tuple[str, str, dict[str, str]]:
    """Decks with the full and with the reduced model, and the files beside them."""
    text, files = deck_of(trial)
    text = with_openings(text)
    prints = "".join(f"*JOINT PRINT, JOINT=JOINT{j + 1}\n" for j in range(trial.num_joints))
    head, tail = text.rsplit("*END STEP", 1)
    full = head + prints + "*END STEP" + tail
    assert "*DYNAMIC," in full
    return full, full.replace("*DYNAMIC,", f"*DYNAMIC, REDUCED{reduced},"), files


def openings(run: Run, num_joints: int) -> np.ndarray:
    """Openings of all points in the increments that print them [m]."""
    tables = [run.csv(f"joint_JOINT{j + 1}") for j in range(num_joints)]
    return np.concatenate([np.maximum(table["opening"], 0.0) for table in tables])


def compare(
    keyway: Program, trial: Trial, reduced: str = "", change: Callable[[str], str] = str
) -> Comparison:
    """Runs both models, with a change of both decks."""
    full_deck, reduced_deck, files = decks(trial, reduced)
    full = keyway(change(full_deck), name="full", files=files)
    run = keyway(change(reduced_deck), name="reduced", files=files)
    expected, found = openings(full, trial.num_joints), openings(run, trial.num_joints)
    largest = expected.max()
    assert largest > 1e-3
    error = np.abs(found - expected).max() / largest
    both = zip(full.json["joints"].values(), run.json["joints"].values(), strict=True)
    most = max(
        abs(a["opening"]["anywhere"]["value"] - b["opening"]["anywhere"]["value"]) for a, b in both
    )
    return Comparison(full, run, error, most / largest)
