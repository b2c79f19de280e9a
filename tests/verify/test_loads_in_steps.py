"""Loads that change from step to step, by equilibrium: the reactions of a column of two bricks are
the loads, in each of the four increments of a static step."""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from heat_decks import OUTPUT, brick, law, model
from keyway_tools.box_mesh import box_mesh, stretched
from stage_decks import step
from tied_blocks import node_set

HISTORIES = """*AMPLITUDE, NAME=CLOCK, TIME=TOTAL TIME
0., 0., 9., 9.
*AMPLITUDE, NAME=ONE
0., 1., 1., 1.
*AMPLITUDE, NAME=RISE
0., 0., 1., 1.
"""
PUSH = "*CLOAD{}\nTOP, 1, {}\n"
PRESS = "*DLOAD{}\n{}, {}\n"
RAMP = np.array([0.25, 0.5, 0.75, 1.0])
FULL = np.ones(4)

# The loads of each step, with cards before it if any, and the force along x in each increment.
CASES = {
    # A history over total time goes on in steps that name no loads.
    "forces by the clock": (
        (PUSH.format(", AMPLITUDE=CLOCK", 1.0), "", ""),
        (4.0 * RAMP, 4.0 * (1.0 + RAMP), 4.0 * (2.0 + RAMP)),
    ),
    # A history replaces a constant force at once.
    "a force gets a history": (
        (PUSH.format("", 1.0), PUSH.format(", AMPLITUDE=ONE", 1.0)),
        (4.0 * RAMP, 4.0 * FULL),
    ),
    "a history gets another": (
        (PUSH.format(", AMPLITUDE=RISE", 1.0), PUSH.format(", AMPLITUDE=ONE", 3.0)),
        (4.0 * RAMP, 12.0 * FULL),
    ),
    # Without a history the force goes linearly from where the history has ended.
    "a history ends": (
        (PUSH.format(", AMPLITUDE=RISE", 1.0), PUSH.format("", 3.0)),
        (4.0 * RAMP, 4.0 + 8.0 * RAMP),
    ),
    "one node of a force by the clock is given again": (
        (PUSH.format(", AMPLITUDE=CLOCK", 1.0), "*CLOAD\nCORNER, 1, 5.\n"),
        (4.0 * RAMP, 3.0 * (1.0 + RAMP) + 1.0 + 4.0 * RAMP),
    ),
    "water gets another height and a history": (
        (PRESS.format("", "ALL_BRICKS", "HP6, 2., 2., 0."),
         PRESS.format(", AMPLITUDE=ONE", "ALL_BRICKS", "HP6, 1., 1., 0.")),
        (2.0 * RAMP, 0.5 * FULL),
    ),
    "water gets another height": (
        (PRESS.format("", "ALL_BRICKS", "HP6, 2., 2., 0."),
         PRESS.format("", "ALL_BRICKS", "HP6, 1., 1., 0.")),
        (2.0 * RAMP, 2.0 - 1.5 * RAMP),
    ),
    "a set has grown": (
        (PRESS.format("", "LOW", "P6, 3."),
         ("*ELSET, ELSET=LOW\n2\n", PRESS.format("", "LOW", "P6, 3.")),
         PRESS.format("", "LOW", "P6, 5.")),
        (3.0 * RAMP, 3.0 + 3.0 * RAMP, 6.0 + 4.0 * RAMP),
    ),
    "an element by two spellings": (
        (PRESS.format("", "01", "P6, 3."), PRESS.format("", "1", "P6, 4.")),
        (3.0 * RAMP, 3.0 + RAMP),
    ),
    # Lines of one card that change loads of the step before.
    "two pressures are given again": (
        ("*DSLOAD\nSIDE, P, 5.\nLOWER, P, 2.\n", "*DSLOAD\nSIDE, P, 6.\nLOWER, P, 4.\n"),
        (7.0 * RAMP, 7.0 + 3.0 * RAMP),
    ),
    # What OP=NEW has cleared leaves nothing to the next load, of its own kind or of another one.
    "a cleared pressure is given again": (
        (PRESS.format("", "1", "P6, 3."), "*DLOAD, OP=NEW\n", PRESS.format("", "1", "P6, 5.")),
        (3.0 * RAMP, 3.0 * RAMP[::-1] - 0.75, 5.0 * RAMP),
    ),
    "another kind of load after two cleared ones": (
        (PRESS.format("", "1", "P6, 3.") + "2, P6, 4.\n", "*DLOAD, OP=NEW\n1, P6, 1.\n",
         "*DSLOAD\nSIDE, P, 5.\n"),
        (7.0 * RAMP, 7.0 - 6.0 * RAMP, 1.0 + 5.0 * RAMP),
    ),
}  # fmt: skip


def column(steps: tuple) -> str:
    """Each step is its loads, or the cards before it and its loads."""
    mesh, number = box_mesh((1, 1, 2), stretched((1.0, 1.0, 2.0)))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:, :, 2].ravel()
    mesh.node_sets["CORNER"] = number[:1, :1, 2].ravel()
    cards = elastic(1e6, 0.2) + "*BOUNDARY\nBASE, 1, 3\n" + HISTORIES
    cards += "*SURFACE, NAME=SIDE\n2, S6\n*SURFACE, NAME=LOWER\n1, S6\n"
    cards += "*ELSET, ELSET=ALL_BRICKS\n1, 2\n*ELSET, ELSET=LOW\n1\n"
    for loads in steps:
        between, inside = loads if isinstance(loads, tuple) else ("", loads)
        cards += f"{between}*STEP\n*STATIC, DIRECT\n0.25, 1.\n{inside}"
        cards += "*NODE PRINT, NSET=BASE\nRF\n*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


@pytest.mark.parametrize("case", CASES)
def test_reactions_are_the_loads(keyway, case):
    steps, expected = CASES[case]
    table = keyway(column(steps)).csv("node_BASE")
    forces = -table["RF1"].reshape(-1, 4).sum(axis=1)
    # Residuals leave less than 1e-9 of the loads.
    assert forces == pytest.approx(np.concatenate(expected), rel=1e-8)


def test_a_pressure_under_another_name_is_warned_of(keyway):
    """Both act, as the message says."""
    steps = (PRESS.format("", "1", "P6, 3."), PRESS.format("", "ALL_BRICKS", "P6, 4."))
    run = keyway(column(steps))
    assert "element 1 keeps the pressure '1 P6' of an earlier step" in run.stderr
    table = run.csv("node_BASE")
    assert -table["RF1"][-4:].sum() == pytest.approx(11.0, rel=1e-8)


def weights(run, direction: int) -> np.ndarray:
    """The forces on the column in the increments of its last step."""
    return -run.csv("node_BASE")[f"RF{direction}"].reshape(-1, 4).sum(axis=1)[-4:]


def test_a_weight_is_replaced_by_one_of_another_direction(keyway):
    """The column has 2 m3 and weighs 2 kg/m3; a message says what does not act any more."""
    down, along = (
        "*DLOAD\nALL_BRICKS, GRAV, 10., 0., 0., -1.\n",
        "ALL_BRICKS, GRAV, 3., 1., 0., 0.\n",
    )
    text = column((down, "*DLOAD\n" + along)).replace("*ELASTIC", "*DENSITY\n2.\n*ELASTIC", 1)
    run = keyway(text)
    assert "'ALL_BRICKS GRAV' of an earlier step ends" in run.stderr
    assert weights(run, 1) == pytest.approx(12.0 * RAMP, rel=1e-8)
    assert weights(run, 3) == pytest.approx(-40.0 * (1.0 - RAMP), rel=1e-8, abs=1e-8)


def test_a_weight_goes_on_beside_another_direction(keyway):
    both = "*DLOAD\nALL_BRICKS, GRAV, 10., 0., 0., -1.\nALL_BRICKS, GRAV, 3., 1., 0., 0.\n"
    text = column((both.rsplit("ALL_BRICKS", 1)[0], both))
    run = keyway(text.replace("*ELASTIC", "*DENSITY\n2.\n*ELASTIC", 1))
    assert "of an earlier step ends" not in run.stderr
    assert weights(run, 1) == pytest.approx(12.0 * RAMP, rel=1e-8)
    assert weights(run, 3) == pytest.approx(-40.0 * FULL, rel=1e-8)


def test_a_temperature_given_again_stays(keyway):
    """A node leaves a history over total time for good; the others go on with it."""
    blocks = brick((1, 1, 1), (1.0, 1.0, 1.0))
    clock = "*AMPLITUDE, NAME=CLOCK, TIME=TOTAL TIME\n0., 10., 10., 110.\n"
    first = int(blocks.side("A", "X0")[0])
    cards = node_set("ONE", np.array([first])) + clock + "*BOUNDARY\nALL, 1, 3\n"
    steps = step("*TEMPERATURE, AMPLITUDE=CLOCK\nALL, 1.\n" + OUTPUT)
    steps += step("*TEMPERATURE\nONE, 7.\n") + step()
    table = keyway(model(blocks, cards, law(0.0)) + steps).csv("node_ALL")
    mine = table["node"] == first + 1
    assert table["TEMP"][mine] == pytest.approx([20.0, 7.0, 7.0])
    assert table["TEMP"][~mine] == pytest.approx(np.repeat([20.0, 30.0, 40.0], 7))


@pytest.mark.parametrize(("push", "is_large"), [(1e3, False), (1e6, True)])
def test_displacements_larger_than_the_model(keyway, push, is_large):
    """E is 1e6 Pa; the model is 2.4 m across."""
    run = keyway(column((PUSH.format("", push),)))
    largest = run.json["accuracy"]["estimates"]["displacement"]["value"]
    assert (largest > np.sqrt(6.0)) == is_large
    warned = [text for text in run.json["warnings"] if "larger than the model" in text]
    assert len(warned) == is_large


def test_a_load_given_in_a_step_of_modes(keyway):
    """It acts from the next step on, with what it replaces gone: as if that step had its card."""
    high = PRESS.format("", "ALL_BRICKS", "HP6, 2., 2., 0.")
    low = PRESS.format(", AMPLITUDE=ONE", "ALL_BRICKS", "HP6, 1., 1., 0.")
    deck = column((high, low)).replace("*ELASTIC", "*DENSITY\n1.\n*ELASTIC")
    modes = f"*STEP\n*FREQUENCY\n1\n{low}*END STEP\n"
    head, tail = deck.rsplit("*STEP\n", 1)
    table = keyway(head + modes + "*STEP\n" + tail.replace(low, "")).csv("node_BASE")
    last = table["step"] == 3
    forces = -table["RF1"][last].reshape(-1, 4).sum(axis=1)
    assert forces == pytest.approx(0.5 * FULL, rel=1e-8)


@pytest.mark.parametrize("card", ["", ", OP=NEW", ", AMPLITUDE=CLOCK"])
def test_a_temperature_in_a_step_of_modes_has_no_effect(keyway, card):
    """As its warning says: a history over total time goes on."""
    blocks = brick((1, 1, 1), (1.0, 1.0, 1.0))
    clock = "*AMPLITUDE, NAME=CLOCK, TIME=TOTAL TIME\n0., 10., 10., 110.\n"
    cards = clock + "*BOUNDARY\nALL, 1, 2\n1, 3, 3\n"
    steps = step("*TEMPERATURE, AMPLITUDE=CLOCK\nALL, 1.\n" + OUTPUT)
    steps += f"*STEP\n*FREQUENCY\n1\n*TEMPERATURE{card}\nALL, 7.\n*END STEP\n" + step()
    run = keyway(model(blocks, cards, law(0.0)) + steps)
    table = run.csv("node_ALL")
    assert "no effect in a step *FREQUENCY" in run.stderr
    assert table["TEMP"] == pytest.approx(np.repeat([20.0, 30.0], 8))
