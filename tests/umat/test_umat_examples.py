"""The UMATs of input/umat and their decks against closed forms."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest
from harness import ROOT

FOLDER = ROOT / "input" / "umat"


def test_elastic_is_elastic(keyway):
    run = keyway(FOLDER / "elastic.inp", "--umat", str(FOLDER / "elastic.for"))
    text = (FOLDER / "elastic.inp").read_text()
    builtin = keyway(
        text.replace("*USER MATERIAL, CONSTANTS=2", "*ELASTIC"), code=0, name="builtin"
    )
    for table in ("node_TIP", "el_BEAM"):
        found, expected = run.csv(table), builtin.csv(table)
        for name in expected:
            # Round-off of stresses summed over increments, amplified by a beam's condition.
            scale = np.abs(expected[name]).max()
            assert np.allclose(found[name], expected[name], rtol=0, atol=1e-9 * scale), name
    energy = run.json["steps"][0]["energy"]
    assert energy["strain"] == pytest.approx(builtin.json["steps"][0]["energy"]["strain"], rel=1e-9)


def test_a_umat_does_not_damp_by_its_damage(keyway):
    """BASE=CURRENT has no effect in a UMAT: the run says so."""
    deck = (FOLDER / "elastic.inp").read_text().split("*STEP")[0]
    damping = "*DAMPING, RATIO=0.05, F1=2., F2=10., BASE=CURRENT\n"
    deck += f"*STEP\n*DYNAMIC\n0.01, 0.02\n{damping}*END STEP\n"
    run = keyway(deck, "--umat", str(FOLDER / "elastic.for"))
    assert "BASE=CURRENT has no effect in this material" in run.stderr


def test_j2_at_a_point_follows_the_table(keyway):
    run = keyway(
        FOLDER / "plastic_j2.inp", "--umat", str(FOLDER / "plastic_j2.f90"), "--material",
        "--umat-check",
    )  # fmt: skip
    table = run.csv("material_PULL")
    stress, p = np.abs(table["S11"]), table["SDV1"]
    flows = np.diff(p, prepend=0.0) > 0.0
    assert flows.sum() > 100
    # On the table wherever it flows; the driver holds the side stresses to 1e-9 of the largest.
    on_table = np.interp(p, [0.0, 0.01, 0.05], [200e6, 300e6, 320e6])
    assert np.allclose(stress[flows], on_table[flows], rtol=1e-8)
    assert np.all(stress <= on_table * (1 + 1e-8))
    assert np.allclose(table["E11"], table["S11"] / 200e9 + table["SDV2"], atol=1e-12)
    assert np.allclose(table["work"], table["stored"] + table["fracture"], rtol=1e-6, atol=1.0)
    peak = table["leg"] == 1
    assert table["S11"][peak][-1] == pytest.approx(2e9 / 7, rel=1e-8)  # 285.7143 MPa
    assert float(run.stderr.split("largest error ")[1].split()[0]) < 1e-6


def test_j2_bar_in_the_structure(keyway):
    run = keyway(FOLDER / "plastic_j2.inp", "--umat", str(FOLDER / "plastic_j2.f90"))
    table = run.csv("el_BAR")
    at = table["time"]
    assert np.allclose(table["S11"][at == 1.0], 2e9 / 7, rtol=1e-6)
    # Back to the first length; the plastic strain is 2 p1 - p after p1 = 0.06/7: on the second row
    # of the table, s = 295 MPa + 0.5 GPa p, from -s/E + 2 p1 - p = 0.
    p = (2 * 0.06 / 7 - 295e6 / 200e9) / (1 + 0.5e9 / 200e9)
    assert np.allclose(table["S11"][at == 2.0], -(295e6 + 0.5e9 * p), rtol=1e-6)


def test_a_library_can_be_kept(keyway, tmp_path):
    library = tmp_path / "kept.so"
    done = keyway.call(
        "--umat", str(FOLDER / "plastic_j2.f90"), "--umat-library", str(library)
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    run = keyway(FOLDER / "plastic_j2.inp", "--umat", str(library), "--material")
    assert run.csv("material_PULL")["S11"].max() == pytest.approx(2e9 / 7, rel=1e-8)


def test_the_function_of_cmake(keyway, program_path, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\nproject(laws NONE)\n"
        f'list(APPEND CMAKE_MODULE_PATH "{ROOT}/cmake")\ninclude(KeywayUmat)\n'
        f'keyway_add_umat(j2 SOURCES "{FOLDER}/plastic_j2.f90" FLAGS -O1 -g)\n'
    )
    build = tmp_path / "build"
    for command in (
        ["cmake", "-S", tmp_path, "-B", build, f"-DKEYWAY_PROGRAM={program_path.resolve()}"],
        ["cmake", "--build", build],
    ):
        subprocess.run(command, check=True, capture_output=True)
    run = keyway(FOLDER / "plastic_j2.inp", "--umat", str(build / "j2.so"), "--material")
    assert run.csv("material_PULL")["S11"].max() == pytest.approx(2e9 / 7, rel=1e-8)
