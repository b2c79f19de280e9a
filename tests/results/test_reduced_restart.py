"""A run with a reduced model goes on from its checkpoint bit by bit."""

import h5py
import numpy as np
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


def test_modes_of_other_signs(keyway):
    """The model is built anew, and round-off may turn a mode around, with other threads or ranks.
    Here the checkpoint has every second mode the other way around: the motion of the nodes decides.
    """
    _, deck, files = decks(SHAKEN, ", MODES=60")
    deck = deck.replace("*DYNAMIC,", "*RESTART, WRITE, FREQUENCY=40\n*DYNAMIC,")
    stopped = deck.replace("INC=1000000", "INC=90")
    assert stopped != deck
    checkpoint = keyway(stopped, files=files, code=1).folder / "job.ckpt.h5"
    with h5py.File(checkpoint, "r+") as file:
        found = []
        file.visit(lambda name: found.append(name) if name.endswith("modal/y") else None)
        (modal,) = (file[name].parent for name in found)
        for name in ("y", "rate", "acceleration"):
            values = modal[name][()]
            values[::2] *= -1.0
            modal[name][...] = values
    went_on = keyway(deck, "--continue", files=files)
    whole = keyway(deck, name="whole", files=files)
    for table in ("joint_JOINT1", "joint_JOINT2"):
        expected = whole.csv(table)["opening"]
        # Round-off of one solve and one product with the modes.
        assert went_on.csv(table)["opening"] == pytest.approx(expected, abs=1e-9 * expected.max())
    assert np.max(whole.csv("joint_JOINT1")["opening"]) > 1e-3
