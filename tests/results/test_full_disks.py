"""A disk that fills while a run writes: nothing is lost, and the run goes on later.

The disk is that of full_disk.c, so the tests need no rights and no file system of their own.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from full_disks import DISKS, UMAT, Disk, build_library, rows_in_h5, run_on, unreadable
from restart_case import deck, differences, rows_of

# Disks on which the run cannot open its results; all others fill in the middle of the run.
AT_THE_START = {
    "first table", "h5 at its start", "json at its start", "log at its start", "lock", "nothing",
    "nothing but inodes",
}  # fmt: skip
WITHOUT_CHECKPOINT = AT_THE_START | {"checkpoint"}


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> Path:
    return build_library(tmp_path_factory.mktemp("disk"))


@pytest.fixture(scope="module")
def command(program_path: Path, tmp_path_factory) -> list:
    """The program with its options; the folder of results and the deck are still missing."""
    umat = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", umat], check=True)
    return [program_path, "-q", "-j", "1", "--umat", umat]


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("deck") / "job.inp"
    path.write_text(deck())
    return path


@pytest.fixture(scope="module")
def whole(command, case, tmp_path_factory) -> Path:
    """The folder of the run whose disk is large enough."""
    out = tmp_path_factory.mktemp("whole")
    subprocess.run([*command, "-o", out, case], check=True)
    return out


@pytest.mark.parametrize("name", DISKS)
def test_full_disk(command, library, case, whole, tmp_path, name):
    out = tmp_path / "out"
    done = run_on(DISKS[name], library, out, [*command, "-o", out, case])
    assert done.returncode == 3, done.stderr
    assert "cannot write '" in done.stderr or "cannot write in the folder '" in done.stderr
    assert "; make room on the disk" in done.stderr
    assert unreadable(out) == []
    path = out / "job.json"
    if name in AT_THE_START:
        assert not path.exists()
        return
    if name != "input and output error":  # then job.json is removed: it cannot be written over
        summary = json.loads(path.read_text())
        assert summary["status"] == "stopped"
        assert summary["message"] + " [disk-full]" == done.stderr.strip()
    assert rows_in_h5(out) > 0
    if name in WITHOUT_CHECKPOINT:
        assert not list(out.glob("*.ckpt*"))
        return
    assert "keyway --continue goes on from the last checkpoint" in done.stderr
    again = subprocess.run(
        [*command, "-o", out, "--continue", case], capture_output=True, text=True
    )
    assert again.returncode == 0, again.stderr
    assert differences(whole, out) == []


def test_the_disk_is_full_again_when_the_run_goes_on(command, library, case, whole, tmp_path):
    out = tmp_path / "out"
    run_on(DISKS["h5"], library, out, [*command, "-o", out, case])
    for size in (0, 5_000, 40_000, 400_000):
        disk = Disk("", size)
        done = run_on(disk, library, out, [*command, "-o", out, "--continue", case])
        assert done.returncode == 3
        assert json.loads((out / "job.json").read_text())["status"] == "stopped"
    subprocess.run([*command, "-o", out, "--continue", case], check=True)
    assert differences(whole, out) == []


def test_the_summary_of_an_earlier_run_does_not_say_finished(command, library, case, tmp_path):
    out = tmp_path / "out"
    subprocess.run([*command, "-o", out, case], check=True)
    done = run_on(Disk("job.h5", 20_000), library, out, [*command, "-o", out, case])
    assert done.returncode == 3
    path = out / "job.json"  # removed where it has no room for the message
    assert not path.exists() or json.loads(path.read_text())["status"] == "stopped"


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting a small disk needs root")
def test_a_real_small_disk(command, case, whole, tmp_path):
    """A file system of 2 MB, where removed files give their room back."""
    out = tmp_path / "disk"
    out.mkdir()
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", out])
    if mount.returncode != 0:
        pytest.skip("the kernel does not let this process mount")
    try:
        done = subprocess.run([*command, "-o", out, case], capture_output=True, text=True)
        assert done.returncode == 3
        assert unreadable(out) == []
        assert json.loads((out / "job.json").read_text())["status"] == "stopped"
        assert rows_in_h5(out) > 0 and rows_of(out / "job_energy.csv") > 0
        subprocess.run(["mount", "-o", "remount,size=20m", out], check=True)
        subprocess.run([*command, "-o", out, "--continue", case], check=True)
        assert differences(whole, out) == []
    finally:
        subprocess.run(["umount", out], check=True)
