"""Folders that vanish or move, processes that pause, kills in checkpoints (docs/reliability.md)."""

from __future__ import annotations

import json
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from restart_case import deck, differences, kill_at, rows_of, start
from test_stopped_run import DECK

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
RESTART = "*RESTART, WRITE, FREQUENCY=25\n*DYNAMIC"


@pytest.fixture(scope="module")
def umat(program_path: Path, tmp_path_factory) -> Path:
    library = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return library


def long_deck(folder: Path, *, increments: int = 100_000) -> Path:
    path = folder / "job.inp"
    text = DECK.format(increments=increments, duration=increments / 100, frequency=50)
    path.write_text(text.replace("*DYNAMIC", RESTART))
    return path


@pytest.mark.parametrize("is_made_again", [False, True])
def test_the_folder_is_removed_in_mid_run(program_path, tmp_path, is_made_again):
    """The next file that cannot be made ends the run with its name."""
    path, out = long_deck(tmp_path), tmp_path / "out"
    process = start(program_path, "-q", "-j", "1", "-o", out, path)
    kill_at(process, out / "job_energy.csv", 60, 0, 0.0)
    out.rename(tmp_path / "gone")
    shutil.rmtree(tmp_path / "gone", ignore_errors=True)  # the run, too, removes its lock
    if is_made_again:
        out.mkdir()
    _, text = process.communicate(timeout=60)
    assert process.returncode == 3, text
    assert f"'{out}/job" in text or f"'{out}' was removed" in text
    assert "Fortran runtime error" not in text
    if is_made_again:
        summary = out / "job.json"
        assert not summary.exists() or json.loads(summary.read_text())["status"] == "stopped"
    else:
        assert not out.exists()


def test_the_folder_is_moved_and_the_run_goes_on_there(program_path, tmp_path):
    """Results of a stopped run may move to another folder, with or without the deck."""
    path, whole = long_deck(tmp_path, increments=400), tmp_path / "whole"
    subprocess.run([program_path, "-q", "-j", "1", "-o", whole, path], check=True)
    one, other = tmp_path / "one", tmp_path / "other"
    process = start(program_path, "-q", "-j", "1", "-o", one, path)
    kill_at(process, one / "job_energy.csv", 110, signal.SIGKILL, 0.0)
    process.communicate()
    one.rename(other)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    path.rename(elsewhere / "job.inp")
    subprocess.run(
        [program_path, "-q", "-j", "1", "-o", "../other", "--continue", "job.inp"],
        check=True,
        cwd=elsewhere,
    )
    assert differences(whole, other) == []


def test_a_deck_that_moves_takes_its_files_along(program_path, tmp_path):
    """Files that a deck names are found beside the deck; a missing or different file is named."""
    home, new, out = tmp_path / "home", tmp_path / "new", tmp_path / "out"
    for folder in (home, new):
        folder.mkdir()
    path = long_deck(home, increments=400)
    nodes, rest = path.read_text().split("*MATERIAL", 1)
    (home / "mesh.inp").write_text(nodes)
    pulse = "0, 0, 0.1, 1, 0.2, 0\n"
    rest = rest.replace(
        "*AMPLITUDE, NAME=PULSE\n" + pulse, "*AMPLITUDE, NAME=PULSE, INPUT=pulse.txt\n"
    )
    (home / "pulse.txt").write_text(pulse)
    path.write_text("*INCLUDE, INPUT=mesh.inp\n*MATERIAL" + rest)
    whole = tmp_path / "whole"
    subprocess.run([program_path, "-q", "-j", "1", "-o", whole, path], check=True)
    process = start(program_path, "-q", "-j", "1", "-o", out, path)
    kill_at(process, out / "job_energy.csv", 110, signal.SIGKILL, 0.0)
    process.communicate()
    again = [program_path, "-q", "-j", "1", "-o", out, "--continue", new / "job.inp"]
    shutil.copy(path, new)
    done = subprocess.run(again, capture_output=True, text=True)
    assert done.returncode == 2
    assert "mesh.inp" in done.stderr
    shutil.copy(home / "mesh.inp", new)
    (new / "pulse.txt").write_text(pulse.replace("1", "2"))
    done = subprocess.run(again, capture_output=True, text=True)
    assert done.returncode == 2
    assert "pulse.txt" in done.stderr or "*AMPLITUDE is new or not as it was" in done.stderr
    shutil.copy(home / "pulse.txt", new)
    done = subprocess.run(again, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert differences(whole, out) == []


def test_a_pause_changes_nothing(program_path, tmp_path):
    path, whole, out = long_deck(tmp_path, increments=400), tmp_path / "whole", tmp_path / "out"
    subprocess.run([program_path, "-q", "-j", "1", "-o", whole, path], check=True)
    process = start(program_path, "-q", "-j", "1", "-o", out, path)
    for row in (20, 100, 200, 300):
        kill_at(process, out / "job_energy.csv", row, signal.SIGSTOP, 0.0)
        time.sleep(0.1)
        second = subprocess.run(
            [program_path, "-q", "-o", out, "--continue", path], capture_output=True, text=True
        )
        if process.poll() is None:
            assert second.returncode == 3
            assert f"process {process.pid} on host " in second.stderr
        process.send_signal(signal.SIGCONT)
    _, text = process.communicate(timeout=60)
    assert process.returncode == 0, text
    assert differences(whole, out) == []


def kill_in_checkpoint(process: subprocess.Popen, out: Path, row: int, delay: float) -> None:
    """Kills a run a moment after it has begun a checkpoint at or after a row of its table."""
    begun = out / "job.ckpt_new.h5.part"
    kill_at(process, out / "job_energy.csv", row, 0, 0.0)
    while process.poll() is None and not begun.exists():
        time.sleep(0.0002)
    time.sleep(delay)
    process.kill()
    _, text = process.communicate()
    assert process.returncode == -signal.SIGKILL, text


@pytest.mark.parametrize(
    ("threads", "kills"),
    [("1", 6), ("2", 6), *(pytest.param(n, 100, marks=pytest.mark.full) for n in "12")],
)
def test_kills_in_checkpoints(program_path, umat, tmp_path, threads, kills):
    """A checkpoint an increment: while it is written, when it is renamed, or just after."""
    path, whole, out = tmp_path / "job.inp", tmp_path / "whole", tmp_path / "out"
    path.write_text(deck(frequency=1))
    arguments = ["-q", "-j", threads, "--umat", umat]
    subprocess.run([program_path, *arguments, "-o", whole, path], check=True)
    chance = random.Random(f"checkpoints {threads}")
    more: list[str] = []
    num_in_checkpoints = 0
    for _ in range(kills):
        row = rows_of(out / "job_energy.csv") + 1
        if row > 100:
            shutil.rmtree(out)
            more, row = [], 1
        process = start(program_path, *arguments, *more, "-o", out, path)
        kill_in_checkpoint(process, out, row, 0.01 * chance.random())
        num_in_checkpoints += bool(list(out.glob("job.ckpt_new.h5*")))
        is_saved = list(out.glob("*.ckpt.h5")) or list(out.glob("*.ckpt_old.h5"))
        more = ["--continue"] if is_saved else []
    print(f"{kills} kills, {num_in_checkpoints} of them in a checkpoint")  # noqa: T201
    assert num_in_checkpoints > 0
    subprocess.run([program_path, *arguments, *more, "-o", out, path], check=True)
    assert differences(whole, out) == []
