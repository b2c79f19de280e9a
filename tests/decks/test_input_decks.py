"""Every deck under input/ runs through tools/batch.py, and a second run gives the same numbers."""

from pathlib import Path

import make_input
import pytest
from harness import ROOT
from keyway.batch.cases import has_step
from keyway.commands import batch, compare
from keyway_tools.results import Results

# User materials need --umat: tests/umat runs them. The meshes of Jinping are not kept.
OTHERS = {"umat", "jinping"}
# Decks that take longer than a minute.
LONG = {"xingbiling", "xingbiling_matching", "xingbiling_different", "built_in_lifts"}
DECKS = {
    p.stem: p
    for p in sorted((ROOT / "input").rglob("*.inp"))
    if has_step(p) and p.parent.name not in OTHERS
}
SHORT = [name for name in DECKS if name not in LONG]


def run_batch(names: list[str], folder: Path, program: Path, *options: str) -> int:
    decks = [str(DECKS[name]) for name in names]
    return batch.main([*decks, "-o", str(folder), "--program", str(program), *options])


@pytest.fixture(scope="module")
def first_runs(tmp_path_factory, program_path) -> Path:
    folder = tmp_path_factory.mktemp("input_decks")
    assert run_batch(SHORT, folder, program_path, "-j", "2", "--threads", "1") == 0
    return folder


@pytest.mark.skipif(not SHORT, reason="no decks")
def test_a_second_batch_runs_nothing(first_runs, program_path, capsys):
    assert run_batch(SHORT, first_runs, program_path, "--threads", "1") == 0
    assert capsys.readouterr().out.count("(kept)") == len(SHORT)


@pytest.mark.parametrize(
    "name",
    # test_concrete_motion.py compares threads on this monolith as well.
    [pytest.param(n, marks=[pytest.mark.full] if n == "cracking_monolith" else []) for n in SHORT],
)
def test_a_run_on_two_threads_agrees(first_runs, program_path, tmp_path, name):
    assert run_batch([name], tmp_path, program_path, "--threads", "2") == 0
    same = [str(first_runs / name), str(tmp_path / name)]
    # Sums over threads differ in the last digits; a joint carries that as far as the convergence
    # test lets it, 1e-6 of the forces: about 1 Pa of the tractions here. It may also take an
    # iteration more, which history/increments counts. Where a stress is zero at several times, the
    # last digits decide which of them is the time of its extreme.
    tolerances = ["--by-column", "--rel", "1e-5", "--abs", "1e-9", "--tol", "joint_*:t?=1e-5,1"]
    ignored = ["*iterations", "history/increments", "*.x.*", "*error", "*_TIME"]
    options = [*tolerances, *(f"--ignore={column}" for column in ignored)]
    assert compare.main([*same, *options]) == 0


def test_joints_of_the_gmsh_arch_open_alike(first_runs):
    """The dam and its motion are symmetric; 13.6 mm is what docs/gmsh.md says."""
    joints = Results(first_runs / "gmsh_arch").find("joints")
    first, second = (joints[name]["opening"]["anywhere"]["value"] for name in ("JOINT1", "JOINT2"))
    assert first == pytest.approx(second, rel=1e-6)
    assert first == pytest.approx(13.6e-3, abs=0.05e-3)


@pytest.mark.full
@pytest.mark.parametrize("name", sorted(LONG & DECKS.keys()))
def test_long_deck_runs(tmp_path, program_path, name):
    if name == "xingbiling":  # its mesh is not kept
        make_input.main(["--only", "main"])
    assert run_batch([name], tmp_path, program_path) == 0
