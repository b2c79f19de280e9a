"""tools/accuracy: names with a comma within quotes."""

import pytest
from keyway_tools.study.deck_cards import fields_of
from keyway_tools.study.refined_mesh import refine
from test_study_values import brick, deck_of, model, run, with_all_nodes
from tied_blocks import node_set, state_of


@pytest.mark.parametrize(
    ("line", "fields"),
    [
        ('"FOOT, LEFT", 1, 3', ['"FOOT, LEFT"', " 1", " 3"]),
        ("'A,B',,2,", ["'A,B'", "", "2", ""]),
        ("DON'T, 1", ["DON'T", " 1"]),
        ("", [""]),
    ],
)
def test_commas_within_quotes_belong_to_a_name(line, fields):
    assert fields_of(line) == fields


def test_sets_with_commas_in_their_names_are_refined(keyway, tmp_path):
    """A cube of 1 m stands on one set and is held sideways by another: its weight of 24 kN stays on
    the base."""
    blocks = brick()
    above = sorted(set(blocks.side("A", "X0")) - set(blocks.side("A", "Z0")))
    cards = node_set("SIDE", above) + "*BOUNDARY\nSIDE, 1\n*ELSET, ELSET=WHOLE\nA\n"
    step = "*STEP\n*STATIC\n1., 1.\n*DLOAD\nWHOLE, GRAV, 10., 0., 0., -1.\n*END STEP\n"
    text = model(blocks, cards) + step
    for name in ("BASE", "SIDE", "WHOLE"):
        text = text.replace(name, f'"{name}, LEFT"')
    fine, _ = with_all_nodes(refine(deck_of(tmp_path, text)), "RF")
    reaction = state_of(run(keyway, fine, "fine"), "EVERY", "RF")
    assert reaction[:, 2].sum() == pytest.approx(24e3, rel=1e-9)  # round-off of the solution
