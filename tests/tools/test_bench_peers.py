"""The comparison of programs: its decks, and that Keyway and CalculiX give the same dam."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/bench"))

from peers.calculix_peer import deck_lines, read_displacements, run_calculix  # noqa: E402
from peers.comparison_of_peers import PeerOptions, make_cases, row_of  # noqa: E402
from peers.keyway_peer import run_keyway  # noqa: E402
from peers.peer_case import GRAVITY, PeerCase, PeerRun  # noqa: E402


@pytest.fixture(scope="module")
def cases() -> list[PeerCase]:
    options = PeerOptions(Path(), None, None, unknowns=600, increments=4, jointed_increments=3)
    return make_cases(options)


def test_cases_are_those_of_the_table(cases: list[PeerCase]):
    assert [case.num_increments for case in cases] == [0, 4, 3]
    assert [case.has_weight for case in cases] == [True, False, True]


def test_pairs_cover_the_joints(cases: list[PeerCase]):
    mesh, pairs = cases[2].mesh, cases[2].pairs
    corners = mesh.x[mesh.joints[:, :4]]
    diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = 0.5 * np.linalg.norm(np.cross(*diagonals), axis=1).sum()
    # The faces of a joint are plane, and so is each joint.
    assert pairs.area.sum() == pytest.approx(area, rel=1e-9)
    assert np.allclose(np.linalg.norm(pairs.normal, axis=1), 1.0)
    assert np.abs(mesh.x[pairs.master] - mesh.x[pairs.slave]).max() == 0.0


def test_wedges_are_wedges_in_calculix(cases: list[PeerCase]):
    lines = deck_lines(cases[2])
    bricks = cases[2].mesh.bricks
    wedges = int((bricks[:, 2] == bricks[:, 3]).sum())
    start = lines.index("*ELEMENT, TYPE=C3D6, ELSET=DAM")
    assert wedges > 0
    assert all(line.count(",") == 6 for line in lines[start + 1 : start + 1 + wedges])
    assert f"DAM, GRAV, {GRAVITY}, 0., 0., -1." in lines


def test_displacements_of_calculix_are_read(tmp_path: Path):
    text = " displacements (vx,vy,vz) for set CONTROL and time  0.1000000E+01\n\n"
    text += "       12 -1.000000E-03  2.500000E-04  3.000000E+00\n"
    (tmp_path / "case.dat").write_text(text)
    assert read_displacements(tmp_path / "case.dat").tolist() == [[-1e-3, 2.5e-4, 3.0]]


@pytest.mark.parametrize("number", [0, 1, 2])
def test_keyway_runs_the_cases(cases: list[PeerCase], number: int, program_path: Path, tmp_path):
    run = run_keyway(cases[number], tmp_path, program_path, 1, 60.0)
    assert run.failure == ""
    assert run.displacement.shape == (max(cases[number].num_increments, 1), 3)
    assert run.largest > 0.0


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_calculix_agrees(cases: list[PeerCase], program_path: Path, tmp_path: Path):
    runs = []
    for run, program in ((run_keyway, program_path), (run_calculix, "ccx")):
        folder = tmp_path / run.__name__
        folder.mkdir()
        runs.append(run(cases[0], folder, program, 1, 60.0))
    keyway, calculix = runs
    # Wedges are bricks with two equal corners in one program, elements of their own in the other.
    apart = np.abs(keyway.displacement - calculix.displacement).max()
    assert apart < 0.02 * keyway.largest


def test_a_run_without_an_answer_says_why(cases: list[PeerCase]):
    whole = PeerRun("Keyway", 1.0, 50.0, np.ones((4, 3)))
    part = PeerRun("Other", 9.0, 50.0, np.ones((2, 3)), "stopped after 9 s")
    row = row_of(cases[1], part, whole)
    assert row.endswith("|  |  | stopped after 9 s |")
