"""Batches on Slurm, with a script in place of sbatch, and on a local cluster of Dask."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import dask
import pytest
from dask_cluster import Cluster
from harness import ROOT
from keyway.batch.on_slurm import ranges_of
from keyway.commands import batch
from made_up_program import write_program

# Runs the tasks of the array one after the other, as Slurm would.
SBATCH = """import os, re, subprocess, sys
script = sys.argv[-1]
text = open(script).read()
array = re.search(r"--array=([0-9,-]+)%", text)[1]
numbers = []
for part in array.split(","):
    first, _, last = part.partition("-")
    numbers += range(int(first), int(last or first) + 1)
codes = []
for number in numbers:
    os.environ["SLURM_ARRAY_TASK_ID"] = str(number)
    codes.append(subprocess.run(["sh", script]).returncode)
with open("arrays.txt", "a") as file:
    print(array, file=file)
sys.exit(max(codes))
"""


@pytest.fixture
def place(tmp_path, monkeypatch) -> Path:
    """A folder with the made-up program, in which the batch runs."""
    write_program(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def template(place: Path, line: str, values: list[str]) -> list[str]:
    """Words for a batch of a template and its values; the first line of the deck tells what to do.

    The line is a comment, so that *STEP has the values too.
    """
    (place / "dam.inp").write_text(f"** {line}\n*STEP, NAME=S{{VALUE}}\n")
    (place / "values.csv").write_text("\n".join(["VALUE", *values, ""]))
    return ["dam.inp", "--table", "values.csv", "-o", "out", "--program", "keyway"]


def statuses(place: Path) -> list[str]:
    rows = (place / "out/batch.csv").read_text().splitlines()
    column = rows[0].split(",").index("status")
    return [row.split(",")[column] for row in rows[1:]]


@pytest.fixture
def sbatch(place, monkeypatch) -> None:
    """A script in place of sbatch in the PATH."""
    folder = place / "bin"
    folder.mkdir()
    (folder / "fake_sbatch.py").write_text(SBATCH)
    start = f'exec "{sys.executable}" "{folder}/fake_sbatch.py" "$@"'
    (folder / "sbatch").write_text(f"#!/bin/sh\n{start}\n")
    (folder / "sbatch").chmod(0o755)
    monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)


@pytest.mark.usefixtures("sbatch")
def test_the_forecast_of_the_program_is_asked_for(place, program_path):
    """Two frictions of a block, run by the program: some MB and less than a second each."""
    deck = (ROOT / "input/block_on_joint.inp").read_text()
    (place / "block.inp").write_text(deck.replace("FRICTION=0.6", "FRICTION={FRICTION}"))
    (place / "values.csv").write_text("FRICTION\n0.6\n0.8\n")
    words = ["block.inp", "--table", "values.csv", "-o", "out", "--program", str(program_path)]
    assert batch.main([*words, "--on", "slurm"]) == 0
    assert statuses(place) == ["finished"] * 2
    script = (place / "out/batch.sbatch").read_text()
    assert "#SBATCH --time=11\n" in script  # 10 minutes and three times less than 20 s
    command = [program_path, "--check", place / "out/block_001/block_001.inp"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    memory = float(re.search(r"memory +about (\S+) MB", text)[1])
    asked = float(re.search(r"--mem=(\d+)M", script)[1])
    assert asked == pytest.approx(1.5 * memory + 200.0, rel=0.05)  # rounding of the forecast


@pytest.mark.usefixtures("sbatch")
def test_an_array_of_slurm_runs_what_is_unfinished(place):
    words = [*template(place, "ok {VALUE}", ["1", "2", "3", "4"]), "--on", "slurm"]
    words += ["--threads", "4", "--sbatch=--partition=long"]
    assert batch.main(words) == 0
    assert statuses(place) == ["finished"] * 4
    script = (place / "out/batch.sbatch").read_text()
    for line in ("--array=0-3%20", "--cpus-per-task=4", "--partition=long"):
        assert f"#SBATCH {line}\n" in script
    # The forecast of the program is 100 s and 1000 MB.
    assert "#SBATCH --time=15\n" in script
    assert "#SBATCH --mem=1700M\n" in script
    assert "-j 4" in (place / "out/calls.txt").read_text()
    (place / "values.csv").write_text("VALUE\n1\n2\n5\n4\n")
    assert batch.main(words) == 0
    assert (place / "arrays.txt").read_text().split() == ["0-3", "2"]
    assert batch.main(words) == 0  # nothing is left to submit
    assert len((place / "arrays.txt").read_text().split()) == 2


def test_ranges():
    assert ranges_of([0, 1, 2, 5, 7, 8]) == "0-2,5,7-8"


def test_no_sbatch_is_named(place, monkeypatch, capsys):
    words = template(place, "ok {VALUE}", ["1"])
    monkeypatch.setenv("PATH", str(place))
    assert batch.main([*words, "--on", "slurm", "--minutes", "1", "--memory", "100"]) == 2
    assert "there is no sbatch in the PATH" in capsys.readouterr().err


@pytest.fixture
def cluster(place):
    cluster = Cluster(place)
    yield cluster
    cluster.end()


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    return state != "Z"


def test_a_worker_of_dask_is_lost(place, cluster):
    """Both workers are in a run when one is killed: its run ends, another worker repeats it."""
    words = template(place, "sleep 3", ["1", "2", "3", "4"])
    address = cluster.address.replace("tcp://", "dask://")
    command = [sys.executable, ROOT / "tools/batch.py", *words, "--on", address]
    child = subprocess.Popen(command, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    calls, processes = place / "out/calls.txt", place / "out/processes.txt"
    cluster.wait_for(lambda: processes.exists() and len(processes.read_text().split()) >= 2)
    running = [int(word) for word in processes.read_text().split()]
    cluster.workers[0].send_signal(signal.SIGKILL)
    cluster.workers[0].wait()
    cluster.wait_for(lambda: sum(map(is_alive, running)) < 2, 3.0)
    text, _ = child.communicate(timeout=120)
    assert child.returncode == 0, text.decode()
    assert statuses(place) == ["finished"] * 4
    assert len(calls.read_text().splitlines()) == 5
    subprocess.run(command, cwd=place, capture_output=True, check=True, timeout=120)
    assert len(calls.read_text().splitlines()) == 5  # nothing was run again


def test_no_scheduler_is_named(place, capsys):
    words = template(place, "ok {VALUE}", ["1"])
    with dask.config.set({"distributed.comm.timeouts.connect": "1s"}):
        assert batch.main([*words, "--on", "dask://127.0.0.1:9"]) == 2
    assert "127.0.0.1:9" in capsys.readouterr().err
