"""Smallest increments, and what the message names where an increment has no equilibrium."""

import re

import pytest
from concrete_decks import Bar, paper_concrete, pull
from joint_decks import Block, static, weight

PULL = "*CLOAD\nTOP, 3, 1e9\n"  # [N] on each node: the block is lifted off its bed


def checked_increments(keyway, line: str, procedure: str) -> str:
    """The line of --check with the increments of a step."""
    deck = Block((1.0, 1.0, 1.0)).deck(f"*STEP, INC=1000000\n*{procedure}\n{line}\n*END STEP\n")
    shown = keyway(deck, "--check").stdout
    return next(row for row in shown.splitlines() if "duration" in row)


@pytest.mark.parametrize("duration", ["5", "60", "600"])
def test_smallest_dynamic_increment_does_not_depend_on_the_duration(keyway, duration):
    assert "(1e-5 to 0.01)" in checked_increments(keyway, f"0.01, {duration}", "DYNAMIC")


@pytest.mark.parametrize(
    "line, smallest", [("0.1, 1", "1e-5"), ("1e-5, 1", "1e-8"), ("1, 1, 0.5", "0.5")]
)
def test_smallest_static_increment(keyway, line, smallest):
    assert f"({smallest} to" in checked_increments(keyway, line, "STATIC")


def message_of(keyway, steps: str, **block) -> str:
    return keyway(Block((1.0, 1.0, 1.0), **block).deck(steps), code=1).json["message"]


def test_message_names_direct(keyway):
    step = static(PULL, "0.5, 1").replace("*STATIC", "*STATIC, DIRECT")
    assert "the increment is fixed (DIRECT): leave DIRECT out" in message_of(keyway, step)


def test_message_names_iterations(keyway):
    """One iteration with the tangent is too few for concrete that cracks."""
    controls = "*CONTROLS, ITERATIONS=1, TANGENT=CONSISTENT\n"
    deck = Bar(paper_concrete()).deck(pull([1e-3], dt=0.5, controls=controls))
    message = keyway(deck, code=1).json["message"]
    assert "leave DIRECT out" in message
    assert "or allow more than ITERATIONS=1 (*CONTROLS)" in message


def test_message_names_the_criterion_that_is_not_met(keyway):
    """RESIDUAL=1 is met by any iterate; one correction of a cracking bar is more than 1e-9."""
    controls = "*CONTROLS, ITERATIONS=1, TANGENT=CONSISTENT, RESIDUAL=1, INCREMENT=1e-9\n"
    deck = Bar(paper_concrete()).deck(pull([1e-3], dt=0.5, controls=controls))
    message = keyway(deck, code=1).json["message"]
    assert re.search(
        r"the last correction is \S+ of the increment \(tolerance 1.00E-09, \*CONTROLS, "
        r"INCREMENT; residual \S+ is within its tolerance\) after 1 iteration with",
        message,
    )
    assert "or name a larger INCREMENT (*CONTROLS)" in message


def test_message_names_a_residual_below_round_off(keyway):
    """Forces of 1e4 N on joints of 1e12 Pa/m cannot balance to 1e-15 of them in 16 digits."""
    controls = "*CONTROLS, PRECISION=SINGLE, RESIDUAL=1e-15, INCREMENT=1e-15\n"
    push = "*CLOAD\nTOP, 1, 300.\n"
    block = {"law": "KN=1e12, FRICTION=0.3", "counts": (3, 3, 3), "meshes": (2, 2)}
    message = message_of(keyway, static(weight() + controls + push, "0.5, 1"), **block)
    assert re.search(r"residual \S+ \(tolerance 1.00E-15, \*CONTROLS, RESIDUAL\) after", message)
    assert "; name PRECISION=DOUBLE, or name a larger RESIDUAL (*CONTROLS)" in message
    assert "ITERATIONS" not in message


def test_message_names_the_smallest_increment(keyway):
    message = message_of(keyway, static(weight() + PULL, "0.5, 1, 0.1"))
    assert "the smallest increment of the step is 0.1 s: name a smaller one" in message
    assert "on the data line of *STATIC" in message


def test_a_step_without_an_increment_is_in_the_summary(keyway):
    """The second step stops in its first increment; the summary counts the cut-backs of the log.
    The message says what no setting of the iteration changes.
    """
    run = keyway(
        Block((1.0, 1.0, 1.0)).deck(static(weight()) + static(PULL, "0.5, 1, 0.1")), code=1
    )
    first, second = run.json["steps"]
    assert (first["increments"], first["cutbacks"]) == (1, 0)
    assert (second["increments"], second["time"]) == (0, 0.0)
    text = (run.folder / "job.log").read_text(encoding="utf-8")
    assert second["cutbacks"] == text.count("cut-back:")
    assert f", {second['cutbacks']} cut-backs" in text
    assert "a block may have become free, or the load may exceed" in run.json["message"]


def test_message_names_the_finer_slave(keyway):
    """A block of 9 nodes below on a base of one facet."""
    message = message_of(keyway, static(PULL), meshes=(1, 1), counts=(3, 3, 1))
    assert ", whose slave has the finer mesh: make the coarser surface the slave" in message
    message = message_of(keyway, static(PULL), meshes=(3, 3), counts=(1, 1, 1))
    assert "finer mesh" not in message


def test_many_increments_end_with_the_step(keyway):
    """The sum of 20000 times 5e-5 s is 1 s less 1e-13 s: no increment of 1e-13 s follows."""
    step = f"*STEP, INC=1000000\n*DYNAMIC\n5e-5, 1.\n{weight()}*END STEP\n"
    run = keyway(Block((1.0, 1.0, 1.0)).deck(step))
    assert run.json["steps"][0]["increments"] == 20000
