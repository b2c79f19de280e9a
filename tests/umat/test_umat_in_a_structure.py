"""UMATs in solids: the guards cut the increment and name the place, histories follow the steps.

Two cubes of 1 m in a row, pulled by a strain of 1e-3 in a static step of one second; the UMATs of
this folder fail beyond 0.5e-3. E = 200 GPa, nu = 0.25.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
YOUNG = 200e9
NODES = [(x, y, z) for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)]
PLACE = {x: i + 1 for i, x in enumerate(NODES)}
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def ids(axis: int, value: int) -> str:
    return ", ".join(str(PLACE[x]) for x in NODES if x[axis] == value)


def deck(constants: str, depvar: int = 0, *, unsymm: bool = False, steps: str | None = None) -> str:
    number = constants.count(",") + 1
    lines = ["*NODE"]
    lines += [f"{PLACE[x]}, {x[0]}, {x[1]}, {x[2]}" for x in NODES]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BAR"]
    for e, shift in ((101, 0), (205, 1)):
        nodes = [PLACE[x + shift, y, z] for x, y, z in CORNERS]
        lines += [f"{e}, " + ", ".join(map(str, nodes))]
    for name, axis, value in (("LEFT", 0, 0), ("RIGHT", 0, 2), ("SIDE", 1, 0), ("BOTTOM", 2, 0)):
        lines += [f"*NSET, NSET={name}", ids(axis, value)]
    lines += ["*MATERIAL, NAME=Plain", "*DENSITY", "7850."]
    lines += [f"*USER MATERIAL, CONSTANTS={number}" + (", UNSYMM" if unsymm else ""), constants]
    lines += ["*DEPVAR", str(depvar)] if depvar else []
    lines += ["*SOLID SECTION, ELSET=BAR, MATERIAL=PLAIN"]
    lines += ["*BOUNDARY", "LEFT, 1", "SIDE, 2", "BOTTOM, 3"]
    return "\n".join([*lines, steps or pull(), ""])


def pull(increment: float = 0.1, controls: str = "") -> str:
    return "\n".join(
        [
            "*STEP, NAME=PULL",
            "*STATIC",
            f"{increment}, 1., 0.001, {increment}",
            *([f"*CONTROLS, {controls}"] if controls else []),
            "*BOUNDARY",
            "RIGHT, 1, 1, 0.002",
            "*EL PRINT, ELSET=BAR",
            "S, E, SDV",
            "*END STEP",
        ]
    )


def start(keyway, source: str, text: str, *options: str, code: int = 0):
    return keyway(text, "--umat", str(HERE / source), *options, code=code)


def all_numbers(run) -> np.ndarray:
    return np.concatenate([np.ravel(c).astype(float) for c in run.csv("el_BAR").values()])


@pytest.mark.parametrize(
    ("source", "constants", "depvar", "word"),
    [
        ("gives_nan.for", f"{YOUNG}, 0.25, 1", 2, "STRESS(2) is not a number"),
        ("gives_nan.for", f"{YOUNG}, 0.25, 2", 2, "DDSDDE(3,2) is not a number"),
        ("gives_nan.for", f"{YOUNG}, 0.25, 3", 2, "STATEV(2) is not a number"),
        ("writes_past.for", f"{YOUNG}, 0.25", 0, "writes outside of its 0 state variables"),
        ("gives_up.for", f"{YOUNG}, 0.25, 1", 0, "XIT was called"),
        ("gives_up.for", f"{YOUNG}, 0.25, 3", 0, "STOP here"),
    ],
)
def test_a_fault_cuts_the_increment_and_ends_the_run(keyway, source, constants, depvar, word):
    run = start(keyway, source, deck(constants, depvar), code=1)
    reported = r": UMAT: .*" + re.escape(word)
    assert re.search(r"material PLAIN, element (101|205), point [1-8]" + reported, run.stderr)
    assert run.json["status"] == "stopped"
    assert word in run.json["message"]
    cutbacks = run.json["steps"][0]["cutbacks"]
    assert cutbacks > 3
    log = (run.folder / "job.log").read_text()
    assert len(re.findall(rf"cut-back: step 1 .*{re.escape(word)}", log)) == cutbacks
    # As far as the increments could be halved, and no further.
    assert 0.5 - 0.002 < run.csv("el_BAR")["time"][-1] <= 0.5 + 1e-9
    assert np.isfinite(all_numbers(run)).all()
    summary = (run.folder / "job.json").read_text()
    assert not re.search(r"[:\[,]\s*-?(nan|inf|null)", summary, re.IGNORECASE)


def test_pnewdt_gives_the_requested_increment(keyway):
    text = deck(f"{YOUNG}, 0.25", 1, steps=pull(0.4))
    run = start(keyway, "wants_less.for", text)
    table = run.csv("el_BAR")
    assert run.json["steps"][0]["cutbacks"] >= 1
    times = np.unique(table["time"])
    assert np.diff(times, prepend=0.0).max() <= 0.1 * (1 + 1e-3)
    assert np.allclose(table["S11"], YOUNG * 1e-3 * table["time"], rtol=1e-9)
    # One call counted for each increment that stood, however many there were.
    assert set(table["SDV1"][table["time"] == times[-1]]) == {float(len(times))}


def test_pnewdt_without_strain_is_no_fault(keyway, tmp_path):
    """A routine that bounds DTIME asks for less in the call that gives the stiffness, too."""
    source = (HERE / "wants_less.for").read_text(encoding="utf-8")
    changed = re.sub(r"(?m)^  if \(biggest.*$", "  if (dtime > 0.06d0) pnewdt = 0.5d0", source)
    assert changed != source
    (tmp_path / "bounded.for").write_text(changed, encoding="utf-8")
    text = deck(f"{YOUNG}, 0.25", 1, steps=pull(0.4))
    run = keyway(text, "--umat", str(tmp_path / "bounded.for"))
    assert np.diff(np.unique(run.csv("el_BAR")["time"]), prepend=0.0).max() <= 0.06


def test_uexternaldb_is_called_for_increments_and_steps(keyway):
    second = pull(0.5).replace("PULL", "HOLD")
    text = deck(f"{YOUNG}, 0.25", 3, steps=pull(0.25) + "\n" + second)
    run = start(keyway, "history.for", text)
    table = run.csv("el_BAR")
    assert list(table["SDV1"]) == list(10 * table["element"] + table["point"])
    reported = [
        [float(word) for word in line.split()[1:]]
        for line in (run.folder / "job.msg").read_text().splitlines()
        if line.startswith("moment")
    ]
    moments = [line[0] for line in reported]
    assert moments == [0] + [1, 2] * 6 + [3]
    # LOP, restart, step, increment, step time, total time, size.
    assert reported[3] == [1, 0, 1, 2, 0.25, 0.25, 0.25]
    assert reported[4] == [2, 0, 1, 2, 0.5, 0.5, 0.25]
    assert reported[9] == [1, 0, 2, 1, 0, 1, 0.5]
    assert reported[-1][:2] == [3, 0]


def test_umats_get_number_and_place_of_the_point(keyway):
    run = start(keyway, "tells_arguments.for", deck(f"{YOUNG}, 0.25", 2, steps=pull(1.0)))
    reported: dict[str, list[list[float]]] = {}
    for line in (run.folder / "job.msg").read_text().splitlines():
        word, *rest = line.split()
        reported.setdefault(word, []).append([float(x) for x in rest if x[0] in "-.0123456789"])
    assert {tuple(line[:2]) for line in reported["who"][1:]} == {
        (e, q) for e in (101, 205) for q in range(1, 9)
    }
    gauss = 0.5 * (1 - 1 / np.sqrt(3))
    place = {tuple(w[:2]): x for w, x in zip(reported["who"], reported["where"], strict=True)}
    assert place[205, 1] == pytest.approx([1 + gauss, gauss, gauss, 1.0], abs=1e-6)
    # du/dx = strain where nothing turns: 1e-3, and -nu 1e-3 across.
    assert reported["dfgrd"][-1][9:] == pytest.approx(
        [1.001, 0, 0, 0, 0.99975, 0, 0, 0, 0.99975], abs=1e-5
    )


@pytest.mark.parametrize("kind", ["CONSISTENT", "SECANT", "ELASTIC", "AUTO"])
def test_the_kind_of_tangent_does_not_change_the_answer(keyway, kind):
    steps = pull(0.5, f"TANGENT={kind}")
    run = start(
        keyway, "unsymmetric.for", deck(f"{YOUNG}, 0.25, 0.1", unsymm=True, steps=steps)
    )  # fmt: skip
    table = run.csv("el_BAR")
    # DDSDDE(1,2) is wrong by a tenth, the stress is made with the right one: any tangent will do.
    assert np.allclose(table["S11"], YOUNG * 1e-3 * table["time"], rtol=1e-5)


def test_threads_change_nothing(keyway):
    text = deck(f"{YOUNG}, 0.25")
    tables = [
        start(keyway, "free_in_for.for", text, *options).csv("el_BAR")
        for options in (["-j", "1"], ["-j", "2"], ["-j", "2", "--umat-threadsafe"])
    ]
    for name in tables[0]:
        for other in tables[1:]:
            assert np.array_equal(tables[0][name], other[name]), name


def test_the_check_is_in_the_summary(keyway):
    text = deck(f"{YOUNG}, 0.25, 0.5", unsymm=True, steps=pull(0.5, "TANGENT=ELASTIC"))
    run = start(keyway, "unsymmetric.for", text, "--umat-check")
    check = run.json["umat"]["check"]
    assert check["compared"] > 0
    assert (check["row"], check["column"]) == (1, 2)
    assert check["given"] == pytest.approx(1.2e11, rel=1e-6)
    assert check["found"] == pytest.approx(0.8e11, rel=1e-6)
    assert check["error"] == pytest.approx(0.4 / 2.4, rel=1e-6)
    assert check["element"] in (101, 205)
    assert "largest error" in run.stderr


def test_a_vibration_is_that_of_elastic(keyway):
    """A dynamic step from rest: the same as *ELASTIC, energy kept."""
    steps = "\n".join(
        [
            "*STEP",
            "*DYNAMIC",
            "1e-4, 2e-3",
            "*CLOAD",
            "RIGHT, 1, 1e6",
            "*EL PRINT, ELSET=BAR",
            "S",
            "*END STEP",
        ]
    )
    text = deck(f"{YOUNG}, 0.25", steps=steps)
    found = start(keyway, "free_in_for.for", text)
    builtin = keyway(text.replace("*USER MATERIAL, CONSTANTS=2", "*ELASTIC"), name="builtin")
    expected = builtin.csv("el_BAR")["S11"]
    assert np.allclose(found.csv("el_BAR")["S11"], expected, atol=1e-9 * np.abs(expected).max())
    assert found.json["steps"][0]["energy"]["error"] < 1e-6
