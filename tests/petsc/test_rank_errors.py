"""Errors of several processes: one message, one exit code, readable files."""

from __future__ import annotations

import re

import pytest
from block_decks import Pair
from rank_decks import QUAKE, WEIGHT, BlockOnRock


@pytest.mark.parametrize("ranks", [2, 4])
def test_wrong_deck(keyway, on_ranks, ranks):
    """The message of the plain program, once."""
    deck = BlockOnRock().deck(WEIGHT).replace("*STATIC", "*STATICS")
    plain, divided = keyway(deck, code=2), on_ranks(ranks)(deck, code=2)
    places = re.compile(r"\S*job\.inp")
    assert places.sub("job.inp", divided.stderr) == places.sub("job.inp", plain.stderr)


def test_unknown_option(on_ranks):
    """The command line is judged by one process."""
    run = on_ranks(2)(BlockOnRock().deck(WEIGHT), "--colour", code=2)
    assert run.stderr.count("unknown option '--colour'") == 1


@pytest.mark.parametrize("solver", ["DIRECT", "ITERATIVE"])
def test_free_body(keyway, on_ranks, solver):
    """A block that hangs on the rock by one displacement moves freely: an error with both solvers,
    and the summary says so.
    """
    block = BlockOnRock(coupling="*EQUATION\n2\n1, 3, 1., 160, 3, -1.\n")
    keyway(block.deck(WEIGHT), code=1)
    run = on_ranks(2)(block.deck(WEIGHT), "--solver", solver, code=1)
    assert "free to move" in run.stderr
    assert run.json["status"] == "stopped"


@pytest.mark.parametrize(
    ("steps", "words"),
    [
        ("*STEP\n*FREQUENCY\n3\n*END STEP\n", "*FREQUENCY"),
        (QUAKE + "*STEP\n*DYNAMIC, SCHEME=REDUCED\n0.01, 0.1\n*END STEP\n", "reduced models"),
    ],
)
def test_steps_that_one_process_takes(on_ranks, steps, words):
    """Refused in one sentence, never run wrongly."""
    run = on_ranks(2)(BlockOnRock().deck(steps), code=2)
    assert words in run.stderr
    assert "in one process only" in run.stderr


def test_joints_need_one_process(keyway, on_ranks):
    """Joints are refused on two ranks; the same program runs them on one."""
    step = "*STEP\n*STATIC\n*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n*END STEP\n"
    deck = Pair().deck(step)
    assert "joints work in one process only" in on_ranks(2)(deck, code=2).stderr
    assert on_ranks(1)(deck).json["status"] == "finished"


def test_failing_disk_ends_all(on_ranks, tmp_path):
    """Rank 0 cannot write: its message ends all ranks with its code."""
    program = on_ranks(2)
    (program.folder / "results_job").write_text("a file where the folder should be")
    assert program(BlockOnRock().deck(WEIGHT), code=3).stderr.count("results_job") == 1


def test_plain_program_names_the_build(keyway):
    """--solver needs PETSc."""
    run = keyway(BlockOnRock().deck(WEIGHT), "--solver", "ITERATIVE", code=2)
    assert "--preset petsc" in run.stderr
