"""Errors of several processes: one message, one exit code, readable files."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from full_disks import DISKS, build_library, settings_of
from harness import ROOT
from rank_decks import LAUNCH, MOTION, QUAKE, WEIGHT, BlockOnRock


@pytest.mark.parametrize("ranks", [2, 4])
def test_wrong_deck(keyway, on_ranks, ranks):
    """The message of the plain program, once."""
    deck = BlockOnRock().deck(WEIGHT).replace("*STATIC", "*STATICS")
    plain, divided = keyway(deck, code=2), on_ranks(ranks)(deck, code=2)
    places = re.compile(r"\S*job\.inp")
    assert places.sub("job.inp", divided.stderr) == places.sub("job.inp", plain.stderr)


def test_unknown_option(on_ranks):
    """The command line is judged by one process."""
    run = on_ranks(2)(BlockOnRock().deck(WEIGHT), "--colour", code=2)
    assert run.stderr.count("unknown option '--colour'") == 1


@pytest.mark.parametrize("solver", ["DIRECT", "ITERATIVE"])
def test_free_body(keyway, on_ranks, solver):
    """A block that hangs on the rock by one displacement moves freely: an error with both solvers,
    and the summary says so. The node without elements leaves the error to them: without it the
    deck is refused.
    """
    coupling = "*NODE\n9999, 0., 0., 20.\n*EQUATION\n2\n1, 3, 1., 160, 3, -1.\n"
    block = BlockOnRock(coupling=f"{coupling}2\n9999, 1, 1., 1, 1, -1.\n")
    keyway(block.deck(WEIGHT), code=1)
    run = on_ranks(2)(block.deck(WEIGHT), "--solver", solver, code=1)
    assert "free to move" in run.stderr
    assert run.json["status"] == "stopped"


@pytest.mark.parametrize("solver", ["DIRECT", "ITERATIVE"])
def test_free_body_without_mass(on_ranks, solver):
    """A block without mass that nothing holds, with a force in motion: no rank knows the place, and
    none waits for it.
    """
    motion = MOTION.replace("*BASE", "*CLOAD\n45, 1, 1e4\n*BASE", 1)
    block = BlockOnRock((2, 2, 4), (2, 2, 2), coupling="")
    deck = block.deck(QUAKE + motion).replace("*DENSITY\n2400.0\n", "")
    run = on_ranks(2)(deck, "--solver", solver, code=1)
    assert "free to move" in run.stderr
    assert run.json["status"] == "stopped"


@pytest.mark.parametrize("option", [(), ("--check",)], ids=["run", "check"])
@pytest.mark.parametrize("precision", ["SINGLE", "MIXED"])
def test_single_precision_is_for_one_process(keyway, on_ranks, option, precision):
    """Two processes warn, once and in job.json, and solve as if PRECISION were DOUBLE. The bound is
    that of `test_ranks`.
    """
    deck = BlockOnRock().deck(QUAKE + MOTION)
    controls = f"*CONTROLS, PRECISION={precision}\n*DAMPING"
    deck = deck.replace("*DAMPING", controls)
    line = deck.splitlines().index("*DYNAMIC, DIRECT") + 1
    run = on_ranks(2)(deck, *option)
    warning = f"job.inp:{line}: *DYNAMIC: warning: PRECISION={precision} of *CONTROLS has no effect"
    assert run.stderr.count(warning) == 1
    if option:
        return
    assert any("PRECISION" in str(remark) for remark in run.json["warnings"])
    plain = keyway(deck.replace(controls, "*DAMPING"), "-j", "1")
    for name in ("U1", "U3", "A1"):
        found, expected = (r.csv("node_TOP")[name] for r in (run, plain))
        assert found == pytest.approx(expected, rel=0, abs=1e-8 * abs(expected).max())


@pytest.mark.parametrize("ranks", [2, 4])
def test_check(on_ranks, ranks):
    """One process checks: what it prints is that of the plain program, but for the times."""
    deck = BlockOnRock().deck(WEIGHT)
    plain, divided = on_ranks(0)(deck, "--check"), on_ranks(ranks)(deck, "--check")
    cost = "Cost on this machine"
    assert divided.stdout.split(cost)[0] == plain.stdout.split(cost)[0]
    assert divided.stdout.count(f"{cost}, when it is idle, in one process") == 1


def test_material(on_ranks):
    """One process follows the paths of a material."""
    deck = (ROOT / "input/umat/plastic_j2.inp").read_text(encoding="utf-8")
    umat = ("--umat", str(ROOT / "input/umat/plastic_j2.f90"))
    curves = []
    for ranks in (0, 2):
        program = on_ranks(ranks)
        program(deck, "--material", *umat)
        curves.append(sorted(program.folder.rglob("*_material_*.csv")))
    plain, divided = curves
    assert plain
    assert [file.read_text() for file in divided] == [file.read_text() for file in plain]


def test_a_file_in_place_of_the_folder_ends_all(on_ranks):
    """Rank 0 cannot make the folder, which the command line names: its message ends all ranks."""
    program = on_ranks(2)
    (program.folder / "results_job").write_text("a file where the folder should be")
    stderr = program(BlockOnRock().deck(WEIGHT), code=2).stderr
    assert stderr.count("a file has this name") == 1


@pytest.mark.parametrize("kind", ["nothing", "energy"])
def test_failing_disk_ends_all(on_ranks, tmp_path, monkeypatch, kind):
    """Rank 0 cannot write, from the start or later: its message ends all ranks with its code."""
    program = on_ranks(2)
    disk = replace(DISKS[kind], size=min(DISKS[kind].size, 100))
    out = program.folder / "results_job"
    for name, value in settings_of(disk, build_library(tmp_path), out).items():
        monkeypatch.setenv(name, value)
    stderr = program(BlockOnRock().deck(WEIGHT), code=3).stderr
    assert stderr.count("No space left on device") == 1


@pytest.mark.parametrize("ranks", [2, 4])
def test_no_checkpoint_to_go_on_from(keyway, on_ranks, ranks):
    """The message of the plain program, once, and at once: no rank waits for the others."""
    deck = BlockOnRock().deck(WEIGHT)
    plain, divided = keyway(deck, "--continue", code=2), on_ranks(ranks)(deck, "--continue", code=2)
    assert "there is no checkpoint" in divided.stderr
    assert divided.stderr.count("--continue") == plain.stderr.count("--continue")


def process_of_rank(rank: int, launcher: int) -> int | None:
    """The process of a rank below a launcher, if it has started."""
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "environ").read_bytes().split(b"\0")
            parent = int((folder / "stat").read_text().rsplit(")", 1)[1].split()[1])
        except OSError:
            continue
        if parent == launcher and f"OMPI_COMM_WORLD_RANK={rank}".encode() in words:
            return int(folder.name)
    return None


@contextmanager
def long_run(program) -> Iterator[tuple[subprocess.Popen, Path]]:
    """A run of two ranks that has begun with its increments, and its summary."""
    deck = BlockOnRock((8, 8, 10)).deck(QUAKE + MOTION.replace("0.01, 0.1", "0.0001, 10."))
    (program.folder / "job.inp").write_text(deck, encoding="utf-8")
    words = ["mpiexec", "-q", "--oversubscribe", "-n", "2", str(program.path), "-q", "-j", "1"]
    summary = program.folder / "results_job/job.json"
    table = summary.with_name("job_energy.csv")
    with subprocess.Popen(
        [*words, "-o", str(summary.parent), "job.inp"],
        cwd=program.folder,
        env={**os.environ, **LAUNCH},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as launcher:
        while launcher.poll() is None and not (
            table.exists() and table.read_text().count("\n") > 3
        ):
            time.sleep(0.1)
        yield launcher, summary


def test_a_rank_that_is_killed_ends_all(on_ranks):
    """The launcher ends all ranks; what was written stays readable."""
    with long_run(on_ranks(2)) as (launcher, summary):
        rank = process_of_rank(1, launcher.pid)
        assert rank is not None
        os.kill(rank, signal.SIGKILL)
        assert launcher.wait(timeout=60) != 0
    assert json.loads(summary.read_text())["status"] in {"running", "stopped"}


@pytest.mark.parametrize("numbers", [(1, 0), (1,)], ids=["all", "one"])
def test_a_signal_to_ranks_stops_the_run(on_ranks, numbers):
    """To all as the launcher of a cluster sends it at the end of the time, although the others have
    it before rank 0; to one as a machine gets it that is taken back. Rank 0 ends the run after an
    increment, with a checkpoint.
    """
    with long_run(on_ranks(2)) as (launcher, summary):
        for number in numbers:
            rank = process_of_rank(number, launcher.pid)
            assert rank is not None
            os.kill(rank, signal.SIGTERM)
        assert launcher.wait(timeout=60) == 1
    content = json.loads(summary.read_text())
    assert content["status"] == "stopped"
    assert "stopped by SIGTERM after increment" in content["message"]
    assert summary.with_name("job.ckpt.h5").exists()


def test_plain_program_names_the_build(keyway):
    """--solver needs PETSc."""
    run = keyway(BlockOnRock().deck(WEIGHT), "--solver", "ITERATIVE", code=2)
    assert "--preset petsc" in run.stderr
