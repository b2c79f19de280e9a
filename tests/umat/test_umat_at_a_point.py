"""UMATs of many styles at one point: each follows the contract.

The sources in this folder are linear elasticity in several styles; E = 200 GPa, nu = 0.25, a bar
pulled to a strain of 1e-3 in ten increments unless a test says otherwise. Round-off: sums of ten
terms.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
YOUNG, POISSON = 200e9, 0.25
EXACT = 1e-12  # round-off of ten increments, relative


def deck(
    constants: int = 2, depvar: int = 0, *, third: float = 0.0, leg: str = "0.001", more=""
) -> str:
    """A bar that is pulled; PROPS(3) is `third` where there are three constants."""
    values = f"{YOUNG}, {POISSON}" + (f", {third}" if constants > 2 else "")
    lines = ["*MATERIAL, NAME=Plain", f"*USER MATERIAL, CONSTANTS={constants}{more}", values]
    lines += ["*DEPVAR", str(depvar)] if depvar else []
    return "\n".join([*lines, "*MATERIAL TEST, NAME=PULL, INCREMENTS=10", leg, ""])


def pull(keyway, source: str, text: str, *options: str, code: int = 0):
    return keyway(text, "--umat", str(HERE / source), *options, "--material", code=code)


def check_elastic(run) -> None:
    """The curve is Hooke's."""
    table = run.csv("material_PULL")
    assert np.allclose(table["S11"], YOUNG * table["E11"], rtol=EXACT, atol=1e-3)
    assert np.allclose(table["E22"], -POISSON * table["E11"], rtol=1e-9, atol=1e-18)
    assert table["E11"][-1] == pytest.approx(1e-3, rel=EXACT)


@pytest.mark.parametrize(
    ("source", "depvar"),
    [
        ("old_habits.for", 2),
        ("free_in_for.for", 0),
        ("told_form.for", 0),
        ("includes.f", 0),
        ("own_names.for", 0),
        ("by_name.for", 0),
    ],
)
def test_sources_of_all_manners_run_unchanged(keyway, source, depvar):
    check_elastic(pull(keyway, source, deck(depvar=depvar)))


def test_common_and_save_persist_and_state_starts_converged(keyway):
    table = pull(keyway, "old_habits.for", deck(depvar=2)).csv("material_PULL")
    # STATEV(1) counts calls in COMMON, STATEV(2) by itself: iterations must not add to it.
    assert list(table["SDV2"]) == list(range(11))
    assert table["SDV1"][-1] > 10


def test_the_name_of_the_material_selects_the_law(keyway):
    text = deck() + deck().replace("Plain", "Twice").replace("PULL", "DOUBLE, MATERIAL=TWICE")
    text = text.replace("NAME=PULL,", "NAME=PULL, MATERIAL=PLAIN,")
    run = pull(keyway, "by_name.for", text)
    check_elastic(run)
    assert run.csv("material_DOUBLE")["S11"][-1] == pytest.approx(2 * YOUNG * 1e-3, rel=EXACT)


@pytest.mark.parametrize("depvar", [0, 3])
def test_a_write_past_the_state_variables_is_reported(keyway, depvar):
    run = pull(keyway, "writes_past.for", deck(depvar=depvar), code=1)
    assert f"the routine writes outside of its {depvar} state variables" in run.stderr
    assert "increment 6 of 10" in run.stderr
    assert np.isfinite(np.array(list(run.csv("material_PULL").values()), dtype=float)).all()


@pytest.mark.parametrize(
    ("where", "word"),
    [
        (1, "STRESS(2) is not a number"),
        (2, "DDSDDE(3,2) is not a number"),
        (3, "STATEV(2) is not a number"),
        (4, "SSE, SPD or SCD is not a number"),
        (5, "STRESS(6) is not a number"),
    ],
)
def test_nan_stops_the_path_and_is_not_written(keyway, where, word):
    run = pull(keyway, "gives_nan.for", deck(3, 2, third=where), code=1)
    assert f"UMAT: {word}" in run.stderr
    table = run.csv("material_PULL")
    assert table["E11"][-1] == pytest.approx(0.5e-3, rel=1e-9)
    assert np.isfinite(np.array(list(table.values()), dtype=float)).all()


@pytest.mark.parametrize(
    ("way", "word"),
    [
        (1, "XIT was called"),
        (2, "strain 0.5"),
        (3, "STOP here"),
        (4, "ERROR STOP 7"),
        (5, "CALL EXIT(3)"),
        (6, "XIT was called"),
    ],
)
def test_a_umat_that_stops_returns_to_the_program(keyway, way, word):
    run = pull(keyway, "gives_up.for", deck(3, third=way), code=1)
    assert word in run.stderr
    assert "increment 6 of 10" in run.stderr
    if way == 2:
        assert re.search(r"strain 0\.[56]\d+E-0?3 is too large at element 1", run.stderr)
        assert "fatal error: strain" in (run.folder / "job.msg").read_text()


def test_pnewdt_cuts_the_increment(keyway):
    text = deck(depvar=1, leg="0.001, 4")
    table = pull(keyway, "wants_less.for", text).csv("material_PULL")
    assert np.allclose(table["S11"], YOUNG * table["E11"], rtol=EXACT, atol=1e-3)
    assert table["SDV1"][-1] >= 10  # increments of at most 1e-4 that stood


def test_sdvini_and_uexternaldb_are_called(keyway):
    run = pull(keyway, "history.for", deck(depvar=3))
    table = run.csv("material_PULL")
    assert list(table["SDV1"]) == [11.0] * 11
    assert list(table["SDV3"]) == list(range(11))
    lines = (run.folder / "job.msg").read_text().splitlines()
    assert lines[0] == "job job;"
    assert lines[1] == f"folder {run.folder.resolve()};"
    assert lines[2] == "process  0  1"
    moments = [line.split()[1] for line in lines[3:]]
    assert moments[0] == "0"
    assert moments[-1] == "3"


def test_utilities_and_messages(keyway):
    run = pull(keyway, "utilities.for", deck(depvar=1))
    check_elastic(run)
    lines = set((run.folder / "job.msg").read_text().splitlines())
    assert "note: told 1, 2.500000 and words" in lines
    assert "warning: warned of 1" in lines
    assert "error: wrong by 2.500000 %" in lines
    assert "warning: GETVRM is not provided" in lines
    assert "warning: GETPARTINFO is not provided" in lines
    assert "errors to the .msg file" in run.stderr


def test_without_output_there_is_no_message_file(keyway):
    run = pull(keyway, "free_in_for.for", deck())
    assert not (run.folder / "job.msg").exists()


def test_the_arguments(keyway):
    run = pull(keyway, "tells_arguments.for", deck(3, 5).replace("INC", "LENGTH=0.5, INC"))
    reported: dict[str, list[list[float]]] = {}
    for line in (run.folder / "job.msg").read_text().splitlines():
        word, *rest = line.split()
        reported.setdefault(word, []).append([float(x) for x in rest if x[0] in "-.0123456789"])
    assert reported["sizes"][-1] == [3, 3, 6, 5, 3]
    assert reported["who"][-1] == [1, 1, 1, 1, 1, 10]
    assert reported["time"][-1] == pytest.approx([0.9, 0.9, 0.1, 0, 0, 0, 0], abs=1e-9)
    assert reported["where"][-1] == pytest.approx([0, 0, 0, 0.5])
    assert reported["drot"][-1] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    e = np.diag([1, -POISSON, -POISSON])
    expected = np.concatenate([(np.eye(3) + s * e).ravel() for s in (0.9e-3, 1e-3)])
    assert reported["dfgrd"][-1] == pytest.approx(list(expected), abs=1e-5)
    side = -POISSON
    strains = [x * s for s in (0.9e-3, 0.1e-3) for x in (1, side, side, 0, 0, 0)]
    assert reported["strain"][-1] == pytest.approx(strains, abs=1e-9)
    assert "the UMAT greets" in run.stdout


def test_a_leg_is_a_step(keyway):
    """KSTEP, KINC; TIME of the leg and of the test, and DTIME."""
    run = pull(keyway, "tells_arguments.for", deck(leg="0.001, 2, 1.\n0.002, 2, 4."))
    lines = [line.split() for line in (run.folder / "job.msg").read_text().splitlines()]
    steps = [tuple(map(int, line[5:7])) for line in lines if line[0] == "who"][1:]
    times = [tuple(map(float, line[1:4])) for line in lines if line[0] == "time"][1:]
    assert list(dict.fromkeys(steps)) == [(1, 1), (1, 2), (2, 1), (2, 2)]
    assert list(dict.fromkeys(times)) == [(0, 0, 0.5), (0.5, 0.5, 0.5), (0, 1, 2), (2, 3, 2)]


def test_an_unsymmetric_tangent_is_symmetrised_with_a_note(keyway):
    run = pull(keyway, "unsymmetric.for", deck(3, third=0.5))
    assert "DDSDDE of the UMAT is not symmetric (material PLAIN, element 1" in run.stderr
    run = pull(keyway, "unsymmetric.for", deck(3, third=0.5, more=", UNSYMM"))
    assert "not symmetric" not in run.stderr
    run = pull(keyway, "unsymmetric.for", deck(3, third=0.0))
    assert "not symmetric" not in run.stderr


def test_the_check_finds_the_wrong_entry(keyway):
    run = pull(keyway, "unsymmetric.for", deck(3, third=0.5, more=", UNSYMM"), "--umat-check")
    # DDSDDE(1,2) is 1.5 lambda, lambda = E nu/((1 + nu)(1 - 2 nu)) = 80 GPa; D11 = 240 GPa.
    assert "DDSDDE(1,2) = 1.2e11, difference quotient 8e10" in run.stderr
    assert re.search(r"largest error 0\.16666\d? of its largest entry", run.stderr)
    assert run.stderr.count("largest error") == 1
    run = pull(keyway, "unsymmetric.for", deck(3, third=0.0), "--umat-check")
    apart = float(re.search(r"largest error (\S+) of", run.stderr)[1])
    assert apart < 1e-8  # round-off of the differences


def test_a_library_is_loaded_as_it_is(keyway, tmp_path):
    library = tmp_path / "law.so"
    flags = ["-shared", "-fPIC", "-ffree-form", "-ffree-line-length-none"]
    subprocess.run(["gfortran", *flags, "-o", library, HERE / "told_form.for"], check=True)
    check_elastic(keyway(deck(), "--umat", str(library), "--material"))


def test_flags_of_the_user_and_several_sources(keyway, tmp_path):
    law = (HERE / "free_in_for.for").read_text().replace("matmul(ddsdde, dstran)", "PRODUCT(1d0)")
    (tmp_path / "one law.for").write_text(
        law.replace("stress = ", "call add(stress, ddsdde, dstran) !").replace("include", "include")
    )
    (tmp_path / "other.f").write_text(
        "      SUBROUTINE ADD(S, D, E)\n      REAL*8 S(6), D(6,6), E(6)\n"
        "#ifdef ADDS\n      S = S + MATMUL(D, E)\n#endif\n      END\n"
    )
    files = [str(tmp_path / "one law.for"), str(tmp_path / "other.f")]
    run = keyway(deck(), "--umat", *files, "--umat-flags", "-DADDS -O1", "--material")
    check_elastic(run)


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("does_not_compile.for", "Error: Syntax error"),
        ("is_not_there.for", "cannot read the UMAT"),
        ("no_umat.for", "have no SUBROUTINE UMAT"),
        ("with_heat.for", "coupled with temperature"),
        ("no_stiffness.for", "not positive definite for material PLAIN"),
    ],
)
def test_unusable_files_are_errors_of_usage(keyway, source, word):
    run = pull(keyway, source, deck(), code=2)
    assert word in run.stderr
    assert run.stderr.splitlines()[0].endswith("[umat-failed]")


def test_umat_without_option_is_an_error(keyway):
    run = keyway(deck(), "--material", code=2)
    assert "job.inp:2: *USER MATERIAL: no UMAT is given; expected the option --umat" in run.stderr


def test_options_and_routines_that_belong_together(keyway, tmp_path):
    run = keyway(deck(), "--umat-check", "--material", code=2)
    assert "--umat-check go with --umat" in run.stderr
    (tmp_path / "lacks.for").write_text("      SUBROUTINE UMAT\n      CALL NOSUCH\n      END\n")
    run = keyway(deck(), "--umat", str(tmp_path / "lacks.for"), "--material", code=2)
    assert "cannot load the UMAT" in run.stderr
    assert "undefined symbol: nosuch_" in run.stderr
    text = deck().replace("*USER MATERIAL, CONSTANTS=2", "*ELASTIC")
    run = pull(keyway, "free_in_for.for", text)
    assert "--umat is given, but no material uses it" in run.stderr
