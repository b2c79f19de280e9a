"""Folders and files that must not be written: exit 3 with the reason, before the analysis."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_stopped_run import DECK

NOBODY = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]


@pytest.fixture
def folder(program_path) -> Iterator[Path]:
    """A folder that another user can enter: modes do not stop root, who runs as nobody."""
    path = Path(tempfile.mkdtemp(prefix="keyway_read_only_"))
    path.chmod(0o777)
    (path / "job.inp").write_text(DECK.format(increments=100, duration=0.1, frequency=5))
    yield path
    for item in [path, *path.rglob("*")]:
        if item.is_dir():
            item.chmod(0o777)
    shutil.rmtree(path)


def run(program: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    prefix = NOBODY if os.geteuid() == 0 else []
    if prefix and shutil.which("setpriv") is None:
        pytest.skip("root can write everywhere, and setpriv is not there")
    command = [*prefix, program, "-q", "-j", "1", "-o", "out", "job.inp"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    if done.returncode in (126, 127):
        pytest.skip("another user cannot start the program")
    return done


def test_a_read_only_folder(program_path, folder):
    assert run(program_path, folder).returncode == 0
    out = folder / "out"
    before = {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()}
    out.chmod(0o555)
    done = run(program_path, folder)
    assert done.returncode == 3
    assert "cannot write in the folder 'out': Permission denied; allow writing" in done.stderr
    assert {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()} == before


def test_a_folder_that_cannot_be_made(program_path, folder):
    folder.chmod(0o555)
    done = run(program_path, folder)
    assert done.returncode == 3
    assert "cannot write in the folder 'out'" in done.stderr


@pytest.mark.parametrize("name", ["job.log", "job_energy.csv", "job.h5"])
def test_a_read_only_file(program_path, folder, name):
    """A file that no summary lists is not removed; the run does not start without it."""
    out = folder / "out"
    out.mkdir()
    out.chmod(0o777)
    (out / name).write_text("mine\n")
    (out / name).chmod(0o444)
    done = run(program_path, folder)
    assert done.returncode == 3
    assert f"cannot write 'out/{name}'" in done.stderr
    assert (out / name).read_text() == "mine\n"
    assert not (out / "job.json").exists()
    assert not (out / "job.lock").exists()


def test_a_read_only_mount(program_path, tmp_path):
    if os.geteuid() != 0:
        pytest.skip("mounting needs root")
    out = tmp_path / "out"
    out.mkdir()
    (tmp_path / "job.inp").write_text(DECK.format(increments=100, duration=0.1, frequency=5))
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", out]).returncode != 0:
        pytest.skip("the kernel does not let this process mount")
    try:
        command = [program_path, "-q", "-o", out, tmp_path / "job.inp"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 3
        assert "Read-only file system; allow writing" in done.stderr
    finally:
        subprocess.run(["umount", out], check=True)


def test_a_pipe_in_the_place_of_a_table(program_path, folder):
    """Without a reader an open pipe would be waited for without end."""
    (folder / "out").mkdir(mode=0o777)
    os.mkfifo(folder / "out" / "job_energy.csv")
    command = [program_path, "-q", "-j", "1", "-o", "out", "job.inp"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=60)
    assert done.returncode == 3
    assert "cannot write 'out/job_energy.csv'" in done.stderr
