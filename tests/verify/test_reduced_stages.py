"""*DYNAMIC, REDUCED after stages and temperatures that the step does not change."""

from __future__ import annotations

import numpy as np
import pytest
from reduced_trials import ACCURACY
from stage_decks import add, remove, step
from stopped_runs import stops_that_go_on
from test_grouting import ARCH_LOAD, PRINT, arch

SHAKE = "*AMPLITUDE, NAME=SHAKE\n0., 0., 0.02, 300., 0.05, -300., 0.08, 200., 0.1, 0.\n"
MOTION = (
    "*STEP\n*DYNAMIC, DIRECT, ALPHA=-0.05\n0.002, 0.2\n"
    "*DAMPING, RATIO=0.05, F1=10, F2=100\n*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n*END STEP\n"
)


def built(cooling: str) -> str:
    """Two blocks, one after the other, cooled, grouted under pressure, then shaken."""
    model = arch("1e4").replace("*DENSITY", "*EXPANSION\n1e-5\n*DENSITY")
    return (
        model
        + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 10.\n"
        + SHAKE
        + step(remove("B") + ARCH_LOAD + PRINT)
        + step(add("B"))
        + step(f"*TEMPERATURE{cooling}")
        + step("*GROUT, JOINT=J, PRESSURE=1e4\n")
        + MOTION
    )


@pytest.mark.parametrize(
    "cooling",
    ["\nALL, 7.\n", ", AMPLITUDE=YEAR\nALL, 1.\n"],
    ids=["constant", "a history that has ended"],
)
def test_an_earthquake_after_stages(keyway, cooling):
    """Openings and energies are those of the full model; both start from the same state."""
    deck = built(cooling)
    if "YEAR" in cooling:
        year = "*AMPLITUDE, NAME=YEAR, TIME=TOTAL TIME\n0., 10., 3., 7.\n"
        deck = deck.replace("*STEP", year + "*STEP", 1)
    full = keyway(deck, name="full")
    run = keyway(deck.replace("*DYNAMIC,", "*DYNAMIC, REDUCED,"), name="reduced")
    tables = [r.csv("joint_J") for r in (full, run)]
    last = [t["step"] == 5 for t in tables]
    opening = [t["opening"][rows] for t, rows in zip(tables, last, strict=True)]
    assert opening[0].max() > 1e-5
    assert np.abs(opening[1] - opening[0]).max() <= ACCURACY * opening[0].max()
    start = [t["tn"][t["step"] == 4][-1] for t in tables]
    assert start[1] == pytest.approx(start[0], rel=1e-12)
    energy = [r.json["steps"][-1]["energy"] for r in (full, run)]
    for name in ("external", "strain", "stages", "temperature"):
        assert energy[1][name] == pytest.approx(
            energy[0][name], abs=0.03 * abs(energy[0]["external"])
        )
    assert energy[1]["error"] < 1e-6


def test_a_reduced_step_goes_on_after_stages(program_path, tmp_path):
    """Stopped in the last stage and in the motion, a run ends with the same tables."""
    deck = tmp_path / "job.inp"
    text = built("\nALL, 7.\n").replace("*DYNAMIC,", "*DYNAMIC, REDUCED,")
    deck.write_text(text.replace("*STATIC\n", "*STATIC\n*RESTART, WRITE\n", 1))

    assert stops_that_go_on(program_path, tmp_path, deck, (4, 50)) >= 1
