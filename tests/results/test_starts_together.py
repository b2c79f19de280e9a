"""Runs of one job that start together in one folder: one goes on, the others are refused."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest
from restart_case import deck, rows_of, start
from test_stopped_run import DECK

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
NUM_RUNS, NUM_ROUNDS = 6, 5
LONG_STEP = "*STEP, INC=1000000\n*DYNAMIC, DIRECT\n0.001, 1000.\n*END STEP\n"


@pytest.fixture(scope="module")
def library(program_path: Path, tmp_path_factory) -> Path:
    library = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return library


@pytest.fixture(params=["elastic", "library", "source"])
def options(request, library: Path, tmp_path: Path) -> list:
    """The deck takes minutes; with a UMAT that is loaded, or compiled first, and without one."""
    path = tmp_path / "job.inp"
    if request.param == "elastic":
        path.write_text(DECK.format(increments=100_000, duration=1000, frequency=50))
        return ["-q", "-j", "1", path]
    path.write_text(deck(last=LONG_STEP))
    return ["-q", "-j", "1", "--umat", library if request.param == "library" else UMAT, path]


def test_one_goes_on(program_path, options, tmp_path):
    for round_number in range(NUM_ROUNDS):
        out = tmp_path / f"out{round_number}"
        runs = [start(program_path, "-o", out, *options) for _ in range(NUM_RUNS)]
        winner = await_one(runs)
        for run in runs:
            if run is winner:
                continue
            _, text = run.communicate()
            assert run.returncode == 3, text
            assert f"process {winner.pid} on host " in text
            assert "Fortran runtime error" not in text
        while rows_of(out / "job_energy.csv") < 2:
            assert winner.poll() is None, winner.communicate()[1]
            time.sleep(0.001)
        winner.send_signal(signal.SIGTERM)
        assert winner.wait(60) == 1
        assert "stopped by SIGTERM" in json.loads((out / "job.json").read_text())["message"]
        lines = (out / "job_energy.csv").read_text().splitlines()[1:]
        rows = [tuple(map(int, line.split(",")[:2])) for line in lines]  # step, increment
        assert rows == sorted(set(rows)), "each increment has one row"
        for step in {step for step, _ in rows}:
            of_step = [increment for number, increment in rows if number == step]
            assert of_step == list(range(of_step[0], of_step[0] + len(of_step)))
        assert not (out / "job.lock").exists()


def await_one(runs: list[subprocess.Popen]) -> subprocess.Popen:
    """The run that is left when all others have ended."""
    latest = time.monotonic() + 120
    while sum(run.poll() is None for run in runs) > 1:
        assert time.monotonic() < latest, "more than one run goes on"
        time.sleep(0.005)
    left = [run for run in runs if run.poll() is None]
    assert left, [run.communicate()[1] for run in runs]
    return left[0]


def test_a_refused_run_leaves_the_summary(program_path, library, tmp_path):
    """job.json of the run that goes on is not taken for that of an earlier deck."""
    path, out = tmp_path / "job.inp", tmp_path / "out"
    path.write_text(deck(last=LONG_STEP))
    arguments = ["-q", "-j", "1", "--umat", library, "-o", out, path]
    first = start(program_path, *arguments)
    while rows_of(out / "job_energy.csv") < 2:
        assert first.poll() is None
        time.sleep(0.001)
    for more in ([], ["--continue"], ["--check"]):
        second = subprocess.run(
            [program_path, *arguments, *more], capture_output=True, text=True, timeout=60
        )
        assert second.returncode == 3
        assert f"process {first.pid} on host " in second.stderr
        assert json.loads((out / "job.json").read_text())["status"] == "running"
    first.kill()
    first.communicate()
    path.write_text(deck())
    third = subprocess.run(
        [program_path, *arguments[1:]], capture_output=True, text=True, check=True
    )
    assert f"the earlier run of this job (process and host: {first.pid} " in third.stderr


def test_the_lock_goes_with_each_end(program_path, library, tmp_path):
    """A check, a test of a material, and a wrong deck leave no lock."""
    path, out = tmp_path / "job.inp", tmp_path / "out"
    path.write_text(deck())
    call = [program_path, "-q", "-j", "1", "--umat", library, "-o", out]
    subprocess.run([*call, "--check", path], check=True, stdout=subprocess.DEVNULL)
    assert not list(out.iterdir())
    path.write_text(deck().replace("*DENSITY", "*DENSITTY"))
    done = subprocess.run([*call, path], capture_output=True)
    assert done.returncode == 2
    assert not list(out.iterdir())
    path.write_text(deck())
    done = subprocess.run([*call, "--umat", tmp_path / "none.f90", path], capture_output=True)
    assert done.returncode in (2, 3)
    assert not (out / "job.lock").exists()
