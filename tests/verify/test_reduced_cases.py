"""*DYNAMIC, REDUCED where the model or the step is another one than a dam on JOINT8 elements."""

from __future__ import annotations

import dataclasses
import re

import brick_on_rock
import numpy as np
import pytest
from dam_trials import DeckOptions, Trial
from keyway_tools.arch_blocks import BlockOptions
from keyway_tools.arch_lattice import PartMesh
from reduced_trials import ACCURACY, compare, decks, openings

DAMPED = DeckOptions(damping=(0.05, 2.0, 10.0))
SHAKEN = Trial(size=1.0, duration=2.0, is_coarse=True, options=DAMPED)
MODAL = "*DAMPING, MODAL, RATIO=0.05, MODES=12"
RAYLEIGH = "*DAMPING, RATIO=0.05, F1=2, F2=10"
LAST = "*BASE MOTION, DOF=1"
THIRD = PartMesh(refine=3, thick=3)
MESHES = {
    "surfaces": BlockOptions(refine=2, join="surfaces"),
    "surfaces, ties": BlockOptions(refine=2, fine=(2,), fine_mesh=THIRD),
}


@pytest.mark.parametrize("name", MESHES)
def test_joints_on_surfaces(keyway, name):
    compare(keyway, dataclasses.replace(SHAKEN, blocks=MESHES[name])).check()


def test_perimetral_joint(keyway):
    """A dam that nothing ties to its rock."""

    def loosened(text: str) -> str:
        changed, count = re.subn(r"\*TIE, NAME=(\w+)", r"*JOINT, NAME=\1, LAW=CONTRACTION", text)
        assert count > 0
        return changed

    trial = dataclasses.replace(SHAKEN, blocks=BlockOptions(refine=2, is_tied=True))
    compare(keyway, trial, change=loosened).check()


def test_load_that_jumps_at_the_start(keyway):
    """A force on the crest, at once at the start of the step, as in the full model."""
    pushed = (LAST, f"*CLOAD\nCROWN_CREST, 2, 2e7\n{LAST}")
    compare(keyway, dataclasses.replace(SHAKEN, edits=(pushed,))).check()


def test_support_that_is_removed(keyway):
    """Its reaction is a force that is not balanced at the start."""
    held = ("*DLOAD\n", "*BOUNDARY\nCROWN_CREST, 2, 2\n*DLOAD\n")
    freed = (LAST, f"*BOUNDARY, OP=NEW\nFIXED, 1, 3\n{LAST}")
    compare(keyway, dataclasses.replace(SHAKEN, edits=(held, freed))).check()


@pytest.mark.parametrize("value", ["-0.01", "0."])
def test_support_that_jumps_is_refused(keyway, value):
    """In the full model it moves at once at the start of the step."""
    before = "0." if value != "0." else "-0.01"
    held = ("*DLOAD\n", f"*BOUNDARY\nCROWN_CREST, 2, 2, {before}\n*DLOAD\n")
    moved = (LAST, f"*BOUNDARY\nCROWN_CREST, 2, 2, {value}\n{LAST}")
    _, deck, files = decks(dataclasses.replace(SHAKEN, edits=(held, moved)))
    run = keyway(deck, files=files, code=1)
    assert "a support of the step moves" in run.stderr


def test_support_that_stays_displaced(keyway):
    held = ("*DLOAD\n", "*BOUNDARY\nCROWN_CREST, 2, 2, -0.01\n*DLOAD\n")
    _, deck, files = decks(dataclasses.replace(SHAKEN, duration=0.05, edits=(held,)))
    keyway(deck, files=files)


def test_cut_increments(keyway):
    """One iteration to 1e-10: both models cut increments. Short ones sample the peaks alike."""
    cuttable = (", DIRECT, ALPHA=-0.05\n0.01, 2", ", ALPHA=-0.05\n0.01, 2, 1e-5, 0.01")
    strict = (LAST, f"*CONTROLS, ITERATIONS=1, RESIDUAL=1e-10, INCREMENT=1e-10\n{LAST}")
    full, deck, files = decks(dataclasses.replace(SHAKEN, size=6.0, edits=(cuttable, strict)))
    expected = openings(keyway(full, name="full", files=files), 2).max()
    run = keyway(deck, name="reduced", files=files)
    log = (run.folder / "reduced.log").read_text()
    cuts = [line for line in log.splitlines() if "cut-back:" in line]
    assert len(cuts) == run.json["steps"][-1]["cutbacks"] > 0
    assert all(re.search(r"increment \d+ of \S+ s from time .*; the next has", cut) for cut in cuts)
    assert "*CONTROLS, " in cuts[0]
    assert "; largest in joint " in cuts[0]
    assert run.json["steps"][-1]["energy"]["error"] <= 1e-6
    assert openings(run, 2).max() == pytest.approx(expected, rel=ACCURACY)


@pytest.mark.parametrize(("strength", "breaks"), [(2e5, True), (5e7, False)])
def test_bonds_that_break(keyway, strength, breaks):
    """A bond may break an increment earlier or later than in the full model: a warning says that
    the estimate does not show this. Bonds that hold give none."""
    options = dataclasses.replace(DAMPED, tensile_strength=strength)
    _, deck, files = decks(dataclasses.replace(SHAKEN, duration=1.0, options=options))
    run = keyway(deck, files=files)
    said = [text for text in run.json["warnings"] if "bonds of joints break" in text]
    assert len(said) == breaks
    assert (openings(run, 2).max() > 1e-3) == breaks


@pytest.mark.parametrize(("modes", "is_small"), [(60, True), (40, False)])
def test_note_on_small_models(keyway, modes, is_small):
    """A dam of 1122 unknowns: fewer than 20 for each of 60 modes, more for each of 40."""
    _, deck, files = decks(dataclasses.replace(SHAKEN, duration=0.05), f", MODES={modes}")
    run = keyway(deck, files=files)
    log = (run.folder / f"{run.job}.log").read_text()
    assert ("without REDUCED may take less time" in log) == is_small


def test_modal_damping(keyway):
    """Modal damping beside a little Rayleigh damping."""
    little = "*DAMPING, RATIO=0.02, F1=2, F2=10"
    trial = dataclasses.replace(SHAKEN, edits=((RAYLEIGH, f"{little}\n{MODAL}"),))
    compare(keyway, trial).check()


def test_two_steps_in_a_row(keyway):
    """The second step starts from displacements, velocities and open joints of the first one."""
    trial = dataclasses.replace(SHAKEN, duration=1.2)
    full, reduced, files = decks(trial)
    again = "*STEP, NAME=AGAIN\n*DYNAMIC, DIRECT, ALPHA=-0.05\n0.01, 0.8\n*END STEP\n"
    runs = {
        "full": keyway(full + again, name="full", files=files),
        "reduced": keyway(
            reduced + again.replace("*DYNAMIC,", "*DYNAMIC, REDUCED,"), name="reduced", files=files
        ),
        "mixed": keyway(reduced + again, name="mixed", files=files),
    }
    expected = openings(runs["full"], 2)
    for name in ("reduced", "mixed"):
        found = openings(runs[name], 2)
        assert found == pytest.approx(expected, abs=3.0 * ACCURACY * expected.max()), name
        for step in runs[name].json["steps"]:
            assert step["energy"]["error"] <= 1e-6


def test_a_material_of_no_element(keyway):
    """Its law is not that of the model."""
    plastic = "*MATERIAL, NAME=STEEL\n*ELASTIC\n2e11, 0.3\n*PLASTIC\n3e8, 0.\n4e8, 0.1\n*BOUNDARY"
    text = brick_on_rock.deck(brick_on_rock.shaken(0.1, ", REDUCED"), 2600.0)
    run = keyway(text.replace("*BOUNDARY", plastic, 1))
    assert run.json["steps"][1]["increments"] == 10


@pytest.mark.parametrize(("rock_density", "tied"), [(0.0, True), (2600.0, True), (2600.0, False)])
def test_a_model_of_few_unknowns(keyway, rock_density, tied):
    """24 unknowns with or without mass, and a joint that stays closed: round-off is no shape.

    ACCURACY is that of openings, of which there are none; displacements are off by up to 2.2 %.
    With shapes of round-off they were off by 7 % to 1600 times, or not numbers."""
    tables = []
    for options in (", DIRECT", ", REDUCED"):
        steps = brick_on_rock.shaken(0.1, options)
        run = keyway(brick_on_rock.deck(steps, rock_density, tied), name=options[2:])
        tables.append(run.csv("node_CREST"))
        if options == ", REDUCED":
            (found,) = run.json["accuracy"]["reduced"].values()
            assert found["estimated_error"] <= ACCURACY
    full, reduced = (np.stack([t[name] for name in ("U1", "U2", "U3")]) for t in tables)
    assert np.abs(reduced - full).max() <= 0.1 * np.abs(full).max()
