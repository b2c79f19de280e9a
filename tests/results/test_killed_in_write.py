"""A run that is killed while it writes job.h5, before any of its writes (kill_in_write.c): the file
stays readable, and the folder takes another run at once.

HDF5 changes its own structures in place with many writes; the file driver of the program holds
them back until a flush, and a child process then writes them (src/base/system/undo_driver.c)."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest
from full_disks import build_library
from killed_files import open_h5
from test_stopped_run import DECK

SOURCE = Path(__file__).with_name("kill_in_write.c")
# Writes of some 15 increments, each of which flushes the file; the first writes make the file.
FIRST, LAST = 60, 360


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> Path:
    return build_library(tmp_path_factory.mktemp("kill"), SOURCE)


def settings_of(library: Path, number: int) -> dict[str, str]:
    """The environment of a program that is killed before this write into job.h5."""
    killing = {"LD_PRELOAD": str(library), "KILL_NAME": "job.h5", "KILL_AT": str(number)}
    return {**os.environ, **killing}


def increments_of(path: Path) -> list[str]:
    """The increments of the step, after all their fields were read."""
    with open_h5(path) as file:
        group = file["steps/0001/increments"]
        for name in group:
            assert group[name]["U"][:].shape == (8, 3)
        assert file["history/increments"][:].shape[1] == 6
        return list(group)


def test_file_is_readable_before_any_write(program_path: Path, library: Path, tmp_path: Path):
    deck = tmp_path / "job.inp"
    deck.write_text(DECK.format(increments=1000, duration=10, frequency=1))
    ended = 0
    counts = []
    for number in range(FIRST, LAST, 5):
        out = tmp_path / f"out{number}"
        done = subprocess.run(
            [program_path, "-q", "-j", "1", "-o", out, deck],
            stderr=subprocess.PIPE,
            env=settings_of(library, number),
        )
        ended += done.returncode == -signal.SIGKILL
        counts.append(len(increments_of(out / "job.h5")))
    assert ended == len(counts)
    assert counts == sorted(counts)
    assert counts[-1] > counts[0]


def test_folder_takes_another_run_at_once(program_path: Path, library: Path, tmp_path: Path):
    deck, out = tmp_path / "job.inp", tmp_path / "out"
    deck.write_text(DECK.format(increments=1000, duration=10, frequency=1))
    run = [program_path, "-q", "-j", "1", "-o", out, deck]
    for number in range(FIRST, FIRST + 20):
        done = subprocess.run(run, stderr=subprocess.PIPE, env=settings_of(library, number))
        assert done.returncode == -signal.SIGKILL
    deck.write_text(DECK.format(increments=1000, duration=0.1, frequency=1))
    subprocess.run(run, check=True)
    assert len(increments_of(out / "job.h5")) > 1
