"""A run that is killed and continued leaves the files of the run that was not."""

from __future__ import annotations

import json
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from restart_case import (
    LAST,
    continue_killed,
    deck,
    differences,
    kill_at,
    random_kills,
    rows_of,
    start,
)

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"


@pytest.fixture(scope="module")
def umat(program_path: Path, tmp_path_factory) -> Path:
    """The UMAT of the deck, built once."""
    library = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return library


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    """The deck."""
    path = tmp_path_factory.mktemp("deck") / "job.inp"
    path.write_text(deck())
    return path


@pytest.fixture(scope="module", params=[1, 2], ids=["one-thread", "two-threads"])
def options(request, umat: Path) -> list[str]:
    return ["-j", str(request.param), "--umat", str(umat)]


@pytest.fixture(scope="module")
def whole(program_path: Path, case: Path, options: list[str], tmp_path_factory) -> Path:
    """The folder of the run that is not killed."""
    out = tmp_path_factory.mktemp("whole")
    subprocess.run([program_path, "-q", "-o", out, *options, case], check=True)
    return out


@pytest.fixture
def stopped(program_path: Path, case: Path, umat: Path, tmp_path: Path) -> tuple[Path, list]:
    """The folder of a run that SIGTERM has stopped in the third step, and how to go on with it."""
    arguments = ["-q", "-o", tmp_path, "-j", "1", "--umat", umat]
    process = start(program_path, *arguments, case)
    kill_at(process, tmp_path / "job_energy.csv", 40, signal.SIGTERM, 0.0)
    assert process.wait() == 1
    return tmp_path, [program_path, *arguments, "--continue"]


def call(arguments: list) -> subprocess.CompletedProcess[str]:
    return subprocess.run(arguments, capture_output=True, text=True)


def check_kills(program_path, case, options, whole, out, kills) -> int:
    num_killed = continue_killed(program_path, case, out, options, kills)
    assert differences(whole, out) == []
    summaries = [json.loads((folder / "job.json").read_text()) for folder in (whole, out)]
    for summary in summaries:
        for name in ("ledger", "deck"):
            summary.pop(name)
    assert summaries[0] == summaries[1]
    assert not (out / "job.lock").exists()
    return num_killed


def test_the_case_has_what_it_is_for(whole: Path):
    summary = json.loads((whole / "job.json").read_text())
    assert summary["damage"]["DAMAGET"]["value"] > 0.5  # concrete cracks
    assert all(j["opening"]["anywhere"]["value"] > 1e-5 for j in summary["joints"].values())
    assert (whole / "job.ckpt.h5").exists() and (whole / "job.ckpt_old.h5").exists()
    with h5py.File(whole / "job.h5") as file:
        last = sorted(file["steps/0003/increments"])[-1]
        points = file[f"steps/0003/increments/{last}/points"]
        steel = file["points/material"][:][points["row"][:]] == 1
        assert abs(points["SDV"][:][steel]).max() > 1e-6  # the UMAT yields


# Row 5 is in the first static step, row 10 its end; modes and the dynamic step follow.
@pytest.mark.parametrize("row", [5, 10])
def test_killed_in_and_after_a_static_step(program_path, case, options, whole, tmp_path, row):
    assert check_kills(program_path, case, options, whole, tmp_path, [(row, 0.002)]) == 1


@pytest.mark.parametrize("seed", range(3))
def test_killed_at_random(program_path, case, options, whole, tmp_path, seed):
    kills = random_kills(seed, rows_of(whole / "job_energy.csv"))
    check_kills(program_path, case, options, whole, tmp_path, kills)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(100, 150))
def test_killed_at_random_many_times(program_path, case, options, whole, tmp_path, seed):
    kills = random_kills(seed, rows_of(whole / "job_energy.csv"))
    check_kills(program_path, case, options, whole, tmp_path, kills)


def test_consistent_tangent_goes_on(program_path, umat, tmp_path):
    """The matrix of the last tangent lives from increment to increment."""
    path = tmp_path / "job.inp"
    path.write_text(deck(controls="*CONTROLS, TANGENT=CONSISTENT\n"))
    options = ["-j", "1", "--umat", str(umat)]
    out = tmp_path / "whole"
    subprocess.run([program_path, "-q", "-o", out, *options, path], check=True)
    kills = [(7, 0.001), (30, 0.001), (70, 0.001)]
    check_kills(program_path, path, options, out, tmp_path / "killed", kills)


def test_stopped_run_says_so_and_goes_on(stopped, case, umat, program_path, tmp_path_factory):
    out, again = stopped
    summary = json.loads((out / "job.json").read_text())
    assert summary["status"] == "stopped"
    assert "stopped by SIGTERM after increment" in summary["message"]
    assert "keyway --continue" in summary["message"]
    assert not (out / "job.lock").exists()
    with h5py.File(out / "job.h5") as file:
        assert "S1_MAX" in file["steps/0003/envelopes"]
        assert len(file["history/energy"]) == rows_of(out / "job_energy.csv")
    assert call([*again, case]).returncode == 0
    straight = tmp_path_factory.mktemp("straight")
    call([program_path, "-q", "-o", straight, "-j", "1", "--umat", umat, case])
    assert differences(straight, out) == []


def test_later_steps_may_change(stopped, umat, program_path, tmp_path_factory):
    folder, again = stopped
    new = tmp_path_factory.mktemp("new") / "job.inp"
    added = "*AMPLITUDE, NAME=SLOW\n0., 0., 1., 1.\n*NSET, NSET=CREST\n305\n"
    last = added + LAST.format(force=300).replace("*CLOAD", "*CLOAD, AMPLITUDE=SLOW")
    new.write_text(deck(last=last + "*STEP\n*FREQUENCY\n1\n*END STEP\n"))
    done = call([*again, new])
    assert done.returncode == 0, done.stderr
    straight = tmp_path_factory.mktemp("straight")
    call([program_path, "-q", "-o", straight, "-j", "1", "--umat", umat, new])
    assert differences(straight, folder) == []


def test_later_steps_may_change_in_any_spelling(umat, program_path, tmp_path):
    """Blanks and capitals of *STEP and *END STEP do not count."""

    def write(name: str, last: str) -> Path:
        path = tmp_path / name / "job.inp"
        path.parent.mkdir()
        path.write_text(deck(last=last).replace("*END STEP", "*EndStep").replace("*STEP", "* step"))
        return path

    out = tmp_path / "out"
    arguments = ["-q", "-o", out, "-j", "1", "--umat", umat]
    process = start(program_path, *arguments, write("old", LAST.format(force=100)))
    kill_at(process, out / "job_energy.csv", 40, signal.SIGTERM, 0.0)
    assert process.wait() == 1
    done = call([program_path, *arguments, "--continue", write("new", LAST.format(force=300))])
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("20e9, 0.2\n*CONCRETE", "21e9, 0.2\n*CONCRETE", "*ELASTIC is new or not as it was"),
        ("0.09, 1., 0.12", "0.09, 1.1, 0.12", "*AMPLITUDE is new or not as it was"),
        ("GRAV, 9.81", "GRAV, 9.8", "*DLOAD is new or not as it was"),
        ("*BASE MOTION, DOF=1", "*BASE MOTION, DOF=2", "*BASE MOTION is new or not as it was"),
        ("*NSET, NSET=TOP", "*NSET, NSET=CREST\n5\n*NSET, NSET=TOP", ""),
        (
            "*EL PRINT, ELSET=FOOT, FREQUENCY=2\nS, DAMAGET\n",
            "",
            "*EL PRINT FOOT of the checkpoint is missing",
        ),
    ],
)
def test_changed_deck_is_refused(stopped, tmp_path_factory, old, new, says):
    out, again = stopped
    text = deck()
    assert text.count(old) == 1
    changed = tmp_path_factory.mktemp("changed") / "job.inp"
    changed.write_text("** a comment\n" + text.replace(old, new))
    before = {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()}
    done = call([*again, changed])
    if not says:
        assert done.returncode == 0, done.stderr
        return
    assert done.returncode == 2
    assert (
        "--continue: the checkpoint does not belong to this run: the deck has changed"
        in done.stderr
    )
    assert says in done.stderr
    assert {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()} == before


def test_other_program_is_refused(stopped, case):
    out, again = stopped
    with h5py.File(out / "job.ckpt.h5", "r+") as file:
        file["identity/program"][7] += 1
    done = call([*again, case])
    assert done.returncode == 2
    assert "it was written by Keyway " in done.stderr


def test_damaged_checkpoint_is_left_for_the_one_before(stopped, case, whole, options):
    out, again = stopped
    path = out / "job.ckpt.h5"
    content = bytearray(path.read_bytes())
    content[len(content) // 2 : len(content) // 2 + 64] = bytes(64 * [0x5A])
    path.write_bytes(content)
    done = call([word for word in [*again, case] if word != "-q"])
    assert done.returncode == 0, done.stderr
    assert "the checkpoint before it is used" in done.stderr
    if options[1] == "1":
        assert differences(whole, out) == []


def test_without_a_sound_checkpoint(stopped, case):
    out, again = stopped
    for name in ("job.ckpt.h5", "job.ckpt_old.h5"):
        (out / name).write_bytes((out / name).read_bytes()[:1000])
    done = call([*again, case])
    assert done.returncode == 3
    assert "truncated or damaged" in done.stderr
    for name in ("job.ckpt.h5", "job.ckpt_old.h5"):
        (out / name).unlink()
    done = call([*again, case])
    assert done.returncode == 2
    assert "there is no checkpoint" in done.stderr
