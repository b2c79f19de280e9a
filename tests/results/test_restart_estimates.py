"""A run that is killed and continued has the estimates of errors of the run that was not."""

import json
import signal

import h5py
import numpy as np
import pytest
from restart_case import continue_killed, kill_at, start
from test_opening_time_errors import shaken


@pytest.mark.parametrize("controls", ["", "*CONTROLS, ERROR ESTIMATE=OFF\n"], ids=["on", "off"])
def test_goes_on(program_path, tmp_path, controls):
    """Modes are found again; what has added up is in the checkpoint."""
    deck = shaken("near resonance", 0.01, controls=controls + "*RESTART, WRITE, FREQUENCY=50\n")
    path = tmp_path / "job.inp"
    path.write_text(deck)
    found = []
    for name, kills in (("whole", []), ("killed", [(180, 0.0), (390, 0.0)])):
        out = tmp_path / name
        continue_killed(program_path, path, out, ["-j", "1"], kills)
        found.append(json.loads((out / "job.json").read_text())["accuracy"]["estimates"])
    assert found[0] == found[1]
    assert ("opening" in found[0]) == (not controls)
    assert ("displacement" in found[0]) == (not controls)


def test_modes_of_other_signs(program_path, tmp_path):
    """The modes are found anew, and round-off may turn one around, with other threads or ranks: in
    symmetric dams the largest displacement of a mode comes twice. Here the checkpoint has every
    second mode the other way around; the motion of the checkpoint decides.
    """
    path = tmp_path / "job.inp"
    path.write_text(shaken("near resonance", 0.01, controls="*RESTART, WRITE, FREQUENCY=50\n"))
    found = []
    for name in ("whole", "turned"):
        out = tmp_path / name
        if name == "turned":
            process = start(program_path, "-q", "-o", out, "-j", "1", path)
            kill_at(process, out / "job_energy.csv", 180, signal.SIGKILL, 0.0)
            process.communicate()
            assert process.returncode == -signal.SIGKILL
            with h5py.File(out / "job.ckpt.h5", "r+") as file:
                turn_modes(file)
        assert (
            continue_killed(program_path, path, out, ["-j", "1"], [], goes_on=name == "turned") == 0
        )
        found.append(json.loads((out / "job.json").read_text())["accuracy"]["estimates"])
    for goal in ("opening", "displacement"):
        old, new = ({k: v for k, v in f[goal].items() if k != "joint"} for f in found)
        assert old["history"] > 0.0
        assert new == pytest.approx(old, rel=1e-9), goal  # round-off of products with the modes


def turn_modes(file: h5py.File) -> None:
    """Turns every second mode of the errors in time of a checkpoint."""
    timing = file["state/status/timing"]
    turn = np.where(np.arange(timing["exact"].size) % 2, 1.0, -1.0)
    assert np.abs(timing["exact"][()][0]) > 0.0
    for name, item in timing.items():
        if item.shape == turn.shape and name != "stiffening":
            item[...] = turn * item[()]
        elif item.shape == 2 * turn.shape:
            item[...] = np.outer(turn, turn) * item[()]
