"""A run with a reduced model goes on from its checkpoint bit by bit."""

import pytest
from restart_case import continue_killed, differences
from test_reduced_model import SHAKEN, decks


@pytest.mark.parametrize("estimate", ["ON", "OFF"])
def test_continued_run(program_path, tmp_path, estimate):
    _, deck, files = decks(SHAKEN, ", MODES=60")
    cards = f"*RESTART, WRITE, FREQUENCY=40\n*CONTROLS, ERROR ESTIMATE={estimate}\n"
    deck = deck.replace("*DYNAMIC,", cards + "*DYNAMIC,")
    for name, text in (files | {"dam.inp": deck}).items():
        (tmp_path / name).write_text(text)
    path, options = tmp_path / "dam.inp", ["-j", "1"]
    assert continue_killed(program_path, path, tmp_path / "whole", options, []) == 0
    assert continue_killed(program_path, path, tmp_path / "parts", options, [(90, 0.0)]) == 1
    assert not differences(tmp_path / "whole", tmp_path / "parts")
