"""The dam of input/built_in_lifts through its construction and its seasons, without the motion."""

from __future__ import annotations

import numpy as np
import pytest
from harness import ROOT

FOLDER = ROOT / "input" / "built_in_lifts"
FEBRUARY, AUGUST = 5.0, 11.0  # months after 1 October: 1 March, 1 September


@pytest.fixture
def built(tmp_path, keyway):
    """The run of the static steps."""
    text = (FOLDER / "built_in_lifts.inp").read_text()
    text = text[: text.index("** Earthquake")]
    text = "\n".join(line for line in text.splitlines() if not line.startswith("*AMPLITUDE")) + "\n"
    files = ("built_in_lifts_mesh.inp", "seasons.csv")
    return keyway(text, files={name: (FOLDER / name).read_text() for name in files})


def test_joints_open_in_winter_and_close_in_summer(built):
    """Signs of the physics; the numbers are in the README of the deck, the program's own."""
    rows = built.csv("joint_JOINT1")
    seasons = rows["step"] == 14
    month = rows["time"] - rows["time"][rows["step"] == 13].max()
    winter = seasons & (np.abs(month - FEBRUARY) < 0.01)
    summer = seasons & (np.abs(month - AUGUST) < 0.01)
    assert 2.0e-3 < rows["opening"][winter].max() < 3.5e-3
    assert rows["opening"][summer].max() < 1e-6
    crest = built.csv("node_CROWN_CREST")
    month = crest["time"] - crest["time"][crest["step"] == 13].max()
    cold, warm = (crest["U2"][np.abs(month - m) < 0.01][-1] for m in (FEBRUARY, AUGUST))
    assert cold - warm > 0.02  # [m] downstream: a cold arch is shorter
    assert max(step["energy"]["error"] for step in built.json["steps"]) < 1e-6
