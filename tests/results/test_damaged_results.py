"""Results that were damaged or removed between two runs: --continue refuses them, or warns."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest
from restart_case import deck, differences, kill_at, start

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"


@pytest.fixture(scope="module")
def command(program_path: Path, tmp_path_factory) -> tuple[list, Path]:
    """The program with its options but -o, and the deck."""
    folder = tmp_path_factory.mktemp("deck")
    (folder / "job.inp").write_text(deck())
    library = folder / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return [program_path, "-j", "1", "--umat", library], folder / "job.inp"


@pytest.fixture(scope="module")
def whole(command, tmp_path_factory) -> Path:
    """The folder of a run that has finished."""
    out = tmp_path_factory.mktemp("whole")
    subprocess.run([*command[0], "-q", "-o", out, command[1]], check=True)
    return out


@pytest.fixture(scope="module")
def stopped(command, tmp_path_factory) -> Path:
    """The folder of a run that SIGTERM has stopped in the third step."""
    out = tmp_path_factory.mktemp("stopped")
    process = start(*command[0], "-q", "-o", out, command[1])
    kill_at(process, out / "job_energy.csv", 40, signal.SIGTERM, 0.0)
    process.communicate()
    assert process.returncode == 1
    return out


@pytest.fixture
def out(stopped: Path, tmp_path: Path) -> Path:
    """A copy of the folder."""
    return Path(shutil.copytree(stopped, tmp_path / "out"))


def go_on(command, out: Path) -> subprocess.CompletedProcess[str]:
    arguments = [*command[0], "-o", out, "--continue", command[1]]
    return subprocess.run(arguments, capture_output=True, text=True)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip(path: Path, place: int) -> None:
    """Turns all bits of 64 bytes."""
    content = bytearray(path.read_bytes())
    content[place : place + 64] = bytes(255 - byte for byte in content[place : place + 64])
    path.write_bytes(content)


def flip_a_field(path: Path) -> None:
    """Changes stresses of the first step: HDF5 itself has no checksum of them."""
    with h5py.File(path) as file:
        increments = file["steps/0001/increments"]
        place = increments[min(increments)]["S"].id.get_offset()
    flip(path, place)


SHORT = "the file is shorter than at the checkpoint"
CHANGED = "the file is not as it was at the checkpoint"
NO_JOURNAL = "is missing, or it does not belong to the checkpoint"

DAMAGES: dict[str, tuple[Callable[[Path], object], str]] = {
    "job.h5 is cut": (lambda out: cut(out / "job.h5"), SHORT),
    "job.h5 is empty": (lambda out: (out / "job.h5").write_bytes(b""), SHORT),
    "job.h5 is removed": (lambda out: (out / "job.h5").unlink(), "the file is missing"),
    "a field is changed": (lambda out: flip_a_field(out / "job.h5"), CHANGED),
    "job.undo is changed": (
        lambda out: flip(out / "job.undo", (out / "job.undo").stat().st_size // 2),
        "job.undo' is damaged",
    ),
    "job.undo is cut": (lambda out: cut(out / "job.undo"), CHANGED),
    "job.undo is empty": (lambda out: (out / "job.undo").write_bytes(b""), NO_JOURNAL),
    "job.undo is removed": (lambda out: (out / "job.undo").unlink(), NO_JOURNAL),
    "job.undo is another one": (
        lambda out: shutil.copy(out / "job.undo_old", out / "job.undo"),
        NO_JOURNAL,
    ),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_results_are_refused(command, out: Path, name: str):
    damage, says = DAMAGES[name]
    damage(out)
    h5, undo = (out / "job.h5", out / "job.undo")
    before = [path.read_bytes() for path in (h5, undo) if path.exists()]
    done = go_on(command, out)
    assert done.returncode == 3, done.stderr
    assert f"cannot continue '{h5}': " in done.stderr
    assert says in done.stderr
    assert "put back the files that the run has left" in done.stderr
    assert "[continue]" in done.stderr
    assert [path.read_bytes() for path in (h5, undo) if path.exists()] == before


def test_any_change_of_job_h5_is_found_or_undone(command, out: Path, whole: Path):
    """A page that the journal has is written back, every other one is found."""
    size = (out / "job.h5").stat().st_size
    content = (out / "job.h5").read_bytes()
    num_refused = 0
    for eighth in range(8):
        again = Path(shutil.copytree(out, out.with_name(f"out_{eighth}")))
        (again / "job.h5").write_bytes(content)
        flip(again / "job.h5", size * eighth // 8)
        done = go_on(command, again)
        assert done.returncode in (0, 3), done.stderr
        if done.returncode == 0:
            assert differences(whole, again) == []
        else:
            assert CHANGED in done.stderr
            num_refused += 1
    assert num_refused > 0


def test_the_checkpoint_before_needs_both_journals(command, out: Path, whole: Path):
    cut(out / "job.ckpt.h5")
    without = Path(shutil.copytree(out, out.with_name("without")))
    (without / "job.undo").unlink()
    done = go_on(command, without)
    assert done.returncode == 3
    assert NO_JOURNAL in done.stderr
    assert go_on(command, out).returncode == 0
    assert differences(whole, out) == []


@pytest.mark.parametrize("is_old_kept", [True, False])
def test_killed_while_journals_change_their_names(command, out: Path, whole: Path, is_old_kept):
    """The checkpoint has its name already, its journal not yet."""
    (out / "job.undo").rename(out / "job.undo_new")
    if not is_old_kept:
        (out / "job.undo_old").rename(out / "job.undo")
    done = go_on(command, out)
    assert done.returncode == 0, done.stderr
    assert differences(whole, out) == []
    assert not (out / "job.undo_new").exists()


def test_missing_vtk_files_are_a_warning(command, out: Path):
    lost = ["job_vtk/job_0002.vtu", "job_vtk/job_0003.vtu", "job_vtk/job_envelope_step1.vtu"]
    for name in lost:
        (out / name).unlink()
    done = go_on(command, out)
    assert done.returncode == 0, done.stderr
    says = (
        "files of the results from before the checkpoint are missing "
        f"({len(lost)}, the first is '{out / lost[0]}')"
    )
    warnings = json.loads((out / "job.json").read_text())["warnings"]
    assert sum(says in text for text in warnings) == 1
    assert says in (out / "job.log").read_text()


def closing_lines(out: Path) -> list[str]:
    """The closing lines of the last run in the log, without times."""
    lines = (out / "job.log").read_text().split("results in the units of the deck:")[-1]
    return lines.split("\ntime:")[0].splitlines()


def test_run_at_its_end_keeps_its_summary(command, whole: Path, tmp_path: Path):
    """A run without a further increment has the summary and the closing lines of the first."""
    again = Path(shutil.copytree(whole, tmp_path / "again"))
    assert go_on(command, again).returncode == 0
    assert differences(whole, again) == []
    summaries = [json.loads((folder / "job.json").read_text()) for folder in (whole, again)]
    for summary in summaries:
        summary.pop("ledger")
    assert "law" in summaries[0]["accuracy"]["estimates"]
    assert summaries[0] == summaries[1]
    assert any("error of the increments in the law" in line for line in closing_lines(whole))
    assert closing_lines(again) == closing_lines(whole)
