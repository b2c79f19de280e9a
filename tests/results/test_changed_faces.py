"""Runs that go on with other faces of the dam: a reservoir in the steps that are appended.

One brick, or two with a joint between them. The step WEIGHT leaves a checkpoint; the deck that goes
on has a step WATER. What goes on is compared with the same deck in one run.
"""

from __future__ import annotations

import json
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from restart_case import contents, kill_at, start

MODEL = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
11, 0, 0, 1
12, 1, 0, 1
13, 1, 1, 1
14, 0, 1, 1
15, 0, 0, 2
16, 1, 0, 2
17, 1, 1, 2
18, 0, 1, 2
*ELEMENT, TYPE=C3D8I, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 11, 12, 13, 14, 15, 16, 17, 18
*SURFACE, NAME=LOW
1, S2
*SURFACE, NAME=HIGH
2, S1
*MATERIAL, NAME=M
*DENSITY
2000
*ELASTIC
1e9, 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*JOINT LAW, NAME=DRY, KN=1e10, KT=1e10, FRICTION=0.7
*JOINT, NAME=BED, LAW=DRY
HIGH, LOW
*NSET, NSET=BASE
1, 2, 3, 4
*SURFACE, NAME=WEST
E, S6
*BOUNDARY
BASE, 1, 3
"""
WEIGHT = """*STEP, NAME=WEIGHT
*RESTART, WRITE
*STATIC, DIRECT
0.5, 1
*DLOAD
E, GRAV, 9.81, 0, 0, -1
*CLOAD
16, 1, 3e3
17, 1, 3.1e3
15, 1, 2e3
*ENVELOPE
U, S3, OPENING
*NODE FILE
U
*END STEP
"""
WATER = """*STEP, NAME=WATER
*STATIC, DIRECT
0.5, 1
*CLOAD, OP=NEW
*RESERVOIR, NAME=LAKE, SURFACE={surface}, LEVEL=2, BED=0{up}
*ENVELOPE
U, S3, OPENING
*END STEP
"""
MORE = """*NSET, NSET=NEW
6, 7
*ELSET, ELSET=ONE
1
*SURFACE, NAME=EAST
E, S4
*BOUNDARY
"""
FIRST = MODEL + WEIGHT
WHOLE = MODEL.replace("*BOUNDARY\n", MORE) + WEIGHT + WATER.format(surface="EAST", up=", UP=3")
SAYS = "the upstream and downstream faces of the dam are not those of the checkpoint"


def run(program: Path, folder: Path, deck: str, *options: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "job.inp").write_text(deck)
    arguments = [program, "-q", "-j", "1", "-o", folder, *options, folder / "job.inp"]
    subprocess.run(arguments, check=True, capture_output=True, text=True)
    return folder


def summary(folder: Path) -> dict:
    return json.loads((folder / "job.json").read_text())


def warnings(folder: Path) -> list[str]:
    return [text for text in map(str, summary(folder)["warnings"]) if SAYS in text]


@pytest.fixture(scope="module")
def whole(program_path: Path, tmp_path_factory) -> Path:
    return run(program_path, tmp_path_factory.mktemp("whole"), WHOLE)


@pytest.fixture(scope="module")
def appended(program_path: Path, tmp_path_factory) -> Path:
    folder = run(program_path, tmp_path_factory.mktemp("appended"), FIRST)
    return run(program_path, folder, WHOLE, "--continue")


def test_the_file_is_that_of_one_run(whole, appended):
    assert contents(whole / "job.h5") == contents(appended / "job.h5")
    with h5py.File(appended / "job.h5") as file:
        assert set(file["sets/nodes"]) == {"BASE", "NEW"}
        assert file["faces/upstream"][:].sum() == 8
        assert file["joints/BED/upstream"][:].sum() == 2


def test_a_kill_leaves_the_model_of_the_checkpoint(program_path, whole, tmp_path):
    """The deck that goes on is killed before its first checkpoint; each deck then goes on."""
    steps = WATER.replace("0.5, 1", "1e-4, 1")
    killed = MODEL.replace("*BOUNDARY\n", MORE) + WEIGHT + steps.format(surface="EAST", up="")
    killed = killed.replace("*STEP, NAME=WATER", "*STEP, NAME=WATER, INC=20000")
    killed = killed.replace(
        "*STATIC, DIRECT\n1e-4", "*RESTART, WRITE, FREQUENCY=0\n*STATIC, DIRECT\n1e-4"
    )
    for deck in (FIRST, WHOLE):
        folder = run(program_path, tmp_path / "run", FIRST)
        before = contents(folder / "job.h5")
        (folder / "job.inp").write_text(killed)
        process = start(
            program_path, "-q", "-j", "1", "-o", folder, "--continue", folder / "job.inp"
        )
        kill_at(process, folder / "job_energy.csv", 10, signal.SIGKILL, 0.0)
        process.wait()
        run(program_path, folder, deck, "--continue")
        assert contents(folder / "job.h5") == (
            before if deck is FIRST else contents(whole / "job.h5")
        )


def test_maxima_on_the_new_faces(whole, appended):
    """Maxima anywhere are those of one run; those on faces count from the checkpoint, time 1."""
    one, two = summary(whole), summary(appended)
    assert len(warnings(appended)) == 1
    assert (
        "count from time 1 on (displacement, joints, envelope of OPENING)" in warnings(appended)[0]
    )
    assert SAYS in (appended / "job.log").read_text()
    assert one["displacement"]["anywhere"] == two["displacement"]["anywhere"]
    assert one["displacement"]["upstream"]["time"] >= 1.0
    bed = two["joints"]["BED"]
    for found in (two["displacement"], bed["opening"], bed["slip"], bed["pressure"]):
        for face in ("upstream", "downstream"):
            assert found[face]["time"] >= 1.0


def test_envelopes_on_nodes_lose_nothing(whole, appended):
    """The largest U upstream is in the first step, and comes from the values on the nodes."""
    one, two = summary(whole)["envelopes"], summary(appended)["envelopes"]
    assert one["S3"] == two["S3"]
    assert one["U"] == two["U"]
    assert min(found[face]["time"] for found in one.values() for face in found) <= 1.0
    assert two["OPENING"]["upstream"]["time"] >= 1.0


def test_another_reservoir(program_path, tmp_path):
    """Maxima upstream are those of nodes of the new face."""
    weight = WEIGHT.replace("WRITE", "WRITE, FREQUENCY=1000")
    both = MODEL.replace("*BOUNDARY\n", MORE) + weight + WATER
    first = both.format(surface="WEST", up="").replace("NAME=WATER", "NAME=WATER, INC=1")
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "job.inp").write_text(first)
    arguments = [program_path, "-q", "-o", folder, folder / "job.inp"]
    assert subprocess.run(arguments, capture_output=True).returncode == 1
    second = both.format(surface="EAST", up="")
    run(program_path, folder, second, "--continue")
    one = run(program_path, tmp_path / "one", second)
    assert contents(one / "job.h5") == contents(folder / "job.h5")
    found = summary(folder)
    assert found["displacement"]["upstream"]["x"][0] == 1.0
    assert found["displacement"]["downstream"]["x"][0] == 0.0
    assert found["envelopes"]["U"] == summary(one)["envelopes"]["U"]


def test_the_same_faces(program_path, tmp_path):
    """Steps that change no face give no warning and the summary of one run."""
    lake = "*RESERVOIR, NAME=LAKE, SURFACE=WEST, LEVEL=1, BED=0\n"
    first = MODEL + WEIGHT.replace("*ENVELOPE", lake + "*ENVELOPE")
    both = first + WATER.format(surface="WEST", up="")
    folder = run(program_path, tmp_path / "run", first)
    one = run(program_path, tmp_path / "one", both)
    run(program_path, folder, both, "--continue")
    a, b = summary(one), summary(folder)
    for name in ("ledger", "deck"):
        a.pop(name), b.pop(name)
    assert a == b
    assert contents(one / "job.h5") == contents(folder / "job.h5")
