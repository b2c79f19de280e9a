"""A column that is built in lifts, shaken until it cracks, stopped and continued within a stage."""

from __future__ import annotations

import numpy as np
import pytest
from stage_decks import GRAVITY, OUTPUT, add, lifts, remove, step
from stopped_runs import stops_that_go_on
from test_stages import CRACKING, WEIGHT

QUARTER = "0.25, 1., 0.25, 0.25\n"
LOAD = f"*DLOAD\nBODY, GRAV, {GRAVITY!r}, 0, 0, -1\n"
TABLES = OUTPUT.replace("S, E", "S, DAMAGET")
SHAKE = (
    "*STEP, INC=100000\n*DYNAMIC, DIRECT\n4e-4, 0.02\n"
    "*BASE MOTION, DOF=3, AMPLITUDE=SHAKE\n*END STEP\n"
)
HISTORY = "*AMPLITUDE, NAME=SHAKE\n0., 0., 0.002, -60., 0.006, 60., 0.01, -40., 0.014, 0.\n"


def column() -> str:
    """Three lifts of concrete that cracks at 20 kPa, each with four increments; then the motion."""
    return (
        lifts(3, CRACKING)
        + HISTORY
        + step(remove("L2", "L3") + LOAD + TABLES + "*RESTART, WRITE\n", data=QUARTER)
        + step(add("L2"), data=QUARTER)
        + step(add("L3"), data=QUARTER)
        + SHAKE
        + step(remove("L3"), data=QUARTER)
        + step(add("L3"), data=QUARTER)
    )


def end_of(run, number: int) -> dict[str, np.ndarray]:
    """The last rows of a step."""
    rows = run.csv("el_BODY")
    here = rows["step"] == number
    here &= rows["increment"] == rows["increment"][here].max()
    return {name: column[here] for name, column in rows.items()}


def test_a_column_that_cracks_in_motion(keyway):
    """Levels of weight before the motion; cracks in it; the lift that comes again has none.

    The energies balance to the residual of the increments.
    """
    run = keyway(column())
    before, shaken, without, again = (end_of(run, k) for k in (3, 4, 5, 6))
    for lift in (1, 2, 3):
        own = before["S33"][before["element"] == lift]
        assert own == pytest.approx((lift - 3.5) * WEIGHT, rel=1e-9)
    assert before["DAMAGET"].max() == 0.0
    assert shaken["DAMAGET"].max() > 0.1
    low = shaken["element"] < 3
    assert (without["DAMAGET"][low] >= shaken["DAMAGET"][low]).all()
    assert again["DAMAGET"][~low].max() == 0.0
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-5


def test_a_run_goes_on_within_a_stage_and_in_motion(program_path, tmp_path):
    """Stopped within the second stage and within the motion, a run ends with the same tables."""
    deck = tmp_path / "job.inp"
    deck.write_text(column())

    assert stops_that_go_on(program_path, tmp_path, deck, (6, 40)) >= 1
