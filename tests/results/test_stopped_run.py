"""A run that stops or is killed leaves complete files with its results so far."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import time
from pathlib import Path

import h5py
import pytest
import pyvista

DECK = """*HEADING
a column that swings
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 9
6, 1, 0, 9
7, 1, 1, 9
8, 0, 1, 9
*ELEMENT, TYPE=C3D8I, ELSET=COLUMN
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FOOT, GENERATE
1, 4
*NSET, NSET=HEAD
5
*MATERIAL, NAME=CONCRETE
*DENSITY
2400
*ELASTIC
20e9, 0.2
*SOLID SECTION, ELSET=COLUMN, MATERIAL=CONCRETE
*BOUNDARY
FOOT, 1, 3
*AMPLITUDE, NAME=PULSE
0, 0, 0.1, 1, 0.2, 0
*STEP, NAME=SWING, INC={increments}
*DYNAMIC, DIRECT
0.01, {duration}
*BASE MOTION, DOF=1, AMPLITUDE=PULSE
*NODE PRINT, NSET=HEAD, FREQUENCY={frequency}
U
*NODE FILE, FREQUENCY={frequency}
U
*EL FILE, FREQUENCY={frequency}
SP
*ENVELOPE
S1, U
*END STEP
"""


def test_a_stopped_run_says_what_it_has_found(keyway):
    """On the screen as in job.json, before the reason; -q leaves the reason alone."""
    deck = DECK.format(increments=27, duration=1, frequency=10)
    run = keyway(deck, code=1)
    lines = run.stderr.splitlines()
    first = lines.index("the run stopped at time 0.27, after these")
    found = run.json["envelopes"]["U"]["anywhere"]
    place = next(line for line in lines[first:] if line.startswith("largest displacement"))
    assert float(place.split()[2]) == pytest.approx(found["value"], rel=1e-3)  # four digits
    assert f"time {found['time']:g}" in place
    quiet = keyway(deck, "-q", code=1)
    assert "what it has computed" not in quiet.stderr
    assert quiet.json["message"] in quiet.stderr


def test_last_increment_of_a_stopped_run_is_written(keyway):
    run = keyway(DECK.format(increments=27, duration=1, frequency=10), code=1)
    assert list(run.csv("node_HEAD")["increment"]) == [0, 10, 20, 27]
    assert list(run.csv("energy")["increment"]) == list(range(28))
    reader = pyvista.PVDReader(run.folder / f"{run.job}.pvd")
    assert reader.time_values == pytest.approx([0, 0.1, 0.2, 0.27])
    assert run.json["status"] == "stopped"
    assert "27 increments" in run.json["message"]
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        assert list(file["steps/0001/increments"]) == ["000000", "000010", "000020", "000027"]
        assert file["history/energy"].shape[0] == 28
        assert file["steps/0001/envelopes/S1_MAX"][:].max() == pytest.approx(
            run.json["envelopes"]["S1"]["anywhere"]["value"]
        )


def test_killed_run_leaves_whole_files(program_path: Path, tmp_path: Path):
    deck = tmp_path / "job.inp"
    deck.write_text(DECK.format(increments=1_000_000, duration=10_000, frequency=1))
    out = tmp_path / "out"
    process = subprocess.Popen(
        [program_path, "-q", "-j", "1", "-o", out, deck], stderr=subprocess.DEVNULL
    )
    table = out / "job_node_HEAD.csv"
    give_up = time.monotonic() + 60
    while time.monotonic() < give_up and (not table.exists() or table.stat().st_size < 5000):
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    text = table.read_text()
    assert text.endswith("\n")
    rows = list(csv.reader(text.splitlines()))
    assert len(rows) > 50
    assert {len(row) for row in rows} == {7}
    assert json.loads((out / "job.json").read_text())["status"] == "running"
    reader = pyvista.PVDReader(out / "job.pvd")
    reader.set_active_time_point(len(reader.time_values) - 1)
    assert reader.read()[0].n_points == 8
    with h5py.File(out / "job.h5") as file:
        increments = list(file["steps/0001/increments"])
        assert len(increments) > 50
        assert file[f"steps/0001/increments/{increments[-2]}/U"].shape == (8, 3)


def test_a_run_at_its_last_increment_is_continued(keyway):
    """INC is the number of increments of the step, however often the run is continued; with a
    larger INC the step goes on as if it had not stopped."""
    deck = DECK.format(increments=25, duration=0.4, frequency=1)
    deck = deck.replace("*NODE PRINT", "*RESTART, WRITE, FREQUENCY=5\n*NODE PRINT")
    stopped = keyway(deck, code=1)
    again = keyway(deck, "--continue", code=1)
    assert again.json["message"] == stopped.json["message"]
    assert list(again.csv("node_HEAD")["increment"]) == list(range(26))
    ended = keyway(deck.replace("INC=25", "INC=40"), "--continue")
    whole = keyway(deck.replace("INC=25", "INC=40"), name="whole")
    assert list(ended.csv("node_HEAD")["increment"]) == list(range(41))
    assert list(ended.csv("node_HEAD")["U1"]) == list(whole.csv("node_HEAD")["U1"])
    other = keyway(deck.replace("NAME=SWING", "NAME=SWAY"), "--continue", code=2)
    assert "*STEP is new or not as it was" in other.stderr
