"""Every end of the program removes job.lock: one that stays is of a process that was killed."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
from pathlib import Path

import pytest
from restart_case import rows_of, start
from test_interrupted_run import SHORT, block_deck
from test_stopped_run import DECK

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"


@pytest.fixture(scope="module")
def umat(program_path: Path, tmp_path_factory) -> Path:
    library = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return library


def check_next_run(program: Path, out: Path, path: Path) -> None:
    """The next run of the job finds no trace of a process that was killed."""
    assert not (out / "job.lock").exists()
    path.write_text(SHORT)
    done = subprocess.run([program, "-o", out, path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "was killed" not in done.stderr


def steel(text: str) -> str:
    """The deck with the material of the UMAT."""
    return text.replace(
        "*ELASTIC\n20e9, 0.2\n",
        "*USER MATERIAL, CONSTANTS=6\n20e9, 0.2, 1e9, 0., 0., 0.\n*DEPVAR\n7\n",
    )


@pytest.mark.parametrize("has_umat", [False, True])
def test_missing_memory(program_path, umat, tmp_path, has_umat):
    """The limit falls on the process when its results are open."""
    path, out = tmp_path / "job.inp", tmp_path / "out"
    text = block_deck(24)
    path.write_text(steel(text) if has_umat else text)
    options = ["--umat", umat] if has_umat else []
    process = start(program_path, "-q", "-j", "1", "-o", out, *options, path)
    while not (out / "job.json").exists():
        assert process.poll() is None
    resource.prlimit(process.pid, resource.RLIMIT_AS, (2**20, 2**20))
    _, text = process.communicate(timeout=60)
    assert process.returncode == 3, text
    assert "not enough memory in part '" in text or "no memory for " in text
    assert json.loads((out / "job.json").read_text())["status"] == "stopped"
    check_next_run(program_path, out, path)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("*NODES\n", 2),
        (SHORT.replace("*DYNAMIC", "*DYNAMICS"), 2),
        (SHORT.replace("*NODE FILE", "*INCLUDE, INPUT=none.inp\n*NODE FILE"), 2),
        (SHORT.replace("20e9, 0.2", "20e9, 0.2\n*INCLUDE, INPUT=out/job_energy.csv"), 2),
        (SHORT.replace("INC=100", "INC=27").replace("0.01, 0.1", "0.01, 1"), 1),
    ],
)
@pytest.mark.parametrize("has_umat", [False, True])
def test_wrong_decks_and_runs_that_stop(program_path, umat, tmp_path, text, code, has_umat):
    """After an earlier run; with a UMAT the lock is taken before the deck is read."""
    path, out = tmp_path / "job.inp", tmp_path / "out"
    path.write_text(SHORT)
    subprocess.run([program_path, "-q", "-o", out, path], check=True)
    path.write_text(steel(text) if has_umat else text)
    options = ["--umat", umat] if has_umat else []
    done = subprocess.run([program_path, "-q", "-o", out, *options, path], capture_output=True)
    assert done.returncode == code, done.stderr
    check_next_run(program_path, out, path)


def test_sources_that_do_not_compile(program_path, tmp_path):
    path, out = tmp_path / "job.inp", tmp_path / "out"
    path.write_text(steel(SHORT))
    (tmp_path / "bad.f90").write_text("subroutine umat(\n")
    arguments = ["-q", "-o", out, "--umat", tmp_path / "bad.f90", path]
    assert subprocess.run([program_path, *arguments], capture_output=True).returncode == 2
    check_next_run(program_path, out, path)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_before_the_results_are_open(program_path, tmp_path, number):
    """A UMAT that includes a pipe is never compiled: it holds the run between its lock and its
    results."""
    path, out, source = tmp_path / "job.inp", tmp_path / "out", tmp_path / "never.f90"
    path.write_text(steel(SHORT))
    os.mkfifo(tmp_path / "pipe.inc")
    source.write_text(f"include '{tmp_path}/pipe.inc'\n")
    # Tests that run under nohup would give their ignored SIGHUP to the program.
    heard = ["env", "--default-signal=HUP"]
    process = subprocess.Popen(
        [*heard, program_path, "-q", "-o", out, "--umat", source, path], start_new_session=True
    )
    while not (out / "job.lock").exists() or not (out / "job.lock").read_text():
        assert process.poll() is None
    os.killpg(process.pid, number)
    assert process.wait(10) == -number
    check_next_run(program_path, out, path)


# Holds a process for half a second where it has the lock of its file and has not noted it yet.
SLOW_LOCK = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/file.h>
#include <time.h>
int flock(int file, int way)
{
  struct timespec left = {0, 500000000};
  int answer = ((int (*)(int, int))dlsym(RTLD_NEXT, "flock"))(file, way);
  while ((way & LOCK_EX) && nanosleep(&left, &left) != 0) continue;
  return answer;
}
"""


def test_a_signal_while_the_lock_is_taken(program_path, tmp_path):
    """Threads of OpenBLAS are there already, and the system may give them the signal."""
    path, out, library = tmp_path / "job.inp", tmp_path / "out", tmp_path / "slow_lock.so"
    path.write_text(SHORT)
    (tmp_path / "slow_lock.c").write_text(SLOW_LOCK)
    command = ["gcc", "-shared", "-fPIC", "-o", library, tmp_path / "slow_lock.c", "-ldl"]
    subprocess.run(command, check=True)
    process = subprocess.Popen(
        [program_path, "-q", "-o", out, path],
        env={**os.environ, "LD_PRELOAD": str(library), "OPENBLAS_NUM_THREADS": "2"},
    )
    while not (out / "job.lock").exists():
        assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    assert process.wait(10) == -signal.SIGTERM
    check_next_run(program_path, out, path)


def test_continued_without_checkpoint(program_path, tmp_path):
    path, out = tmp_path / "job.inp", tmp_path / "out"
    path.write_text(SHORT)
    arguments = [program_path, "-q", "-o", out, "--continue", path]
    assert subprocess.run(arguments, capture_output=True).returncode == 2
    check_next_run(program_path, out, path)


def test_the_lock_of_a_folder_that_moves(program_path, tmp_path):
    """The lock goes with its folder; a lock that another run takes at the old place stays."""
    path, out, moved = tmp_path / "job.inp", tmp_path / "out", tmp_path / "moved"
    path.write_text(DECK.format(increments=100_000, duration=1000, frequency=50))
    first = start(program_path, "-q", "-j", "1", "-o", out, path)
    while rows_of(out / "job_energy.csv") < 20:
        assert first.poll() is None
    out.rename(moved)
    second = start(program_path, "-q", "-j", "1", "-o", out, path)
    while rows_of(out / "job_energy.csv") < 20:
        assert second.poll() is None
    first.send_signal(signal.SIGTERM)
    first.communicate(timeout=60)
    assert not (moved / "job.lock").exists()
    assert second.poll() is None
    assert (out / "job.lock").read_text().startswith(f"{second.pid} ")
    second.send_signal(signal.SIGTERM)
    second.communicate(timeout=60)
    assert not (out / "job.lock").exists()
