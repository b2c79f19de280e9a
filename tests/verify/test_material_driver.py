"""keyway --material: one point of an elastic material, against Hooke's law in closed form.

Tolerances: the driver meets stresses to 1e-9 of the largest (TOLERANCE), the rest is roundoff.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

E, NU = 25.0e9, 0.2
G = E / (2.0 * (1.0 + NU))
MATERIAL = f"*MATERIAL, NAME=CONCRETE\n*ELASTIC\n{E}, {NU}\n"
NORMAL = ("11", "22", "33")


def curve_of(keyway, test: str):
    run = keyway(MATERIAL + "*MATERIAL TEST, NAME=T, " + test, "--material")
    return run.csv("material_T")


@pytest.mark.parametrize(
    ("test", "last"),
    [
        ("TYPE=UNIAXIAL\n1e-4\n", {"S11": 1e-4 * E, "E22": -NU * 1e-4, "S22": 0.0}),
        ("TYPE=UNIAXIAL, CONTROL=STRESS\n1e6\n", {"E11": 1e6 / E, "E33": -NU * 1e6 / E}),
        (
            "TYPE=BIAXIAL, RATIO=-0.1\n-1e-3\n",
            {"S11": -1e-3 * E / (1 + 0.1 * NU), "S22": 1e-4 * E / (1 + 0.1 * NU), "S33": 0.0},
        ),
        (
            "TYPE=TRIAXIAL, CONFINEMENT=2e6\n-1e-3\n",
            {"S11": -1e-3 * E - 2 * NU * 2e6, "S22": -2e6, "S33": -2e6, "time": 2.0},
        ),
        (
            "TYPE=OEDOMETER\n-1e-3, 20\n",
            {"S11": -1e-3 * E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)), "E22": 0.0},
        ),
        ("TYPE=SHEAR\n1e-4\n", {"S12": 1e-4 * G, "E11": 0.0, "S1": 1e-4 * G, "S3": -1e-4 * G}),
        ("TYPE=HYDROSTATIC\n1e-4\n", {f"S{c}": 1e-4 * E / (1 - 2 * NU) for c in NORMAL}),
        (
            "TYPE=HYDROSTATIC, CONTROL=STRESS\n1e6\n",
            {f"E{c}": 1e6 * (1 - 2 * NU) / E for c in NORMAL},
        ),
    ],
)
def test_named_tests(keyway, test, last):
    curve = curve_of(keyway, test)
    for column, value in last.items():
        scale = E * 1e-3 if column[0] == "S" else 1e-3
        assert curve[column][-1] == pytest.approx(value, rel=1e-8, abs=1e-9 * scale), column


def test_components_by_themselves(keyway):
    """Stress on all sides, then one strain; an empty field and an empty control keep their
    values."""
    legs = (
        "SSSEES, -1e6, -2e6, -3e6, 1e-5, 0., 1e5, 4\nESSEEE, -1e-3, , , , 2e-5, , 5\n"
        ", 0., , , , , , 2, 3.\n"
    )
    curve = curve_of(keyway, f"TYPE=GENERAL\n{legs}")
    end = np.flatnonzero(np.diff(curve["leg"], append=9) > 0)  # last row of each leg
    first, second, third = end[1:]
    assert [curve[f"S{c}"][first] for c in NORMAL] == pytest.approx([-1e6, -2e6, -3e6], rel=1e-8)
    assert curve["E23"][first] == pytest.approx(1e5 / G, rel=1e-8)
    assert curve["S12"][third] == pytest.approx(1e-5 * G, rel=1e-8)
    assert curve["S22"][second] == pytest.approx(-2e6, rel=1e-8)
    assert curve["S11"][second] == pytest.approx(-1e-3 * E - NU * 5e6, rel=1e-8)
    assert curve["S11"][third] == pytest.approx(-NU * 5e6, rel=1e-6)
    assert curve["E23"][third] == pytest.approx(1e5 / G, rel=1e-8)
    assert curve["time"][-1] == pytest.approx(5.0)
    assert len(curve["time"]) == 1 + 4 + 5 + 2


def test_cycles_and_energies(keyway):
    curve = curve_of(keyway, "CYCLES=3, INCREMENTS=4\n1e-4\n-1e-4, 8\n0.\n")
    assert len(curve["time"]) == 1 + 3 * 16
    assert curve["work"] == pytest.approx(0.5 * E * curve["E11"] ** 2, abs=1e-9 * E * 1e-8)
    assert curve["stored"] == pytest.approx(curve["work"], abs=1e-9 * E * 1e-8)
    assert not curve["fracture"].any()


def test_summary_and_several_materials(keyway):
    deck = (
        MATERIAL
        + "*MATERIAL, NAME=ROCK\n*ELASTIC\n10e9, 0.25\n"
        + "*MATERIAL TEST, NAME=A, MATERIAL=ROCK\n2e-4\n-1e-4\n"
        + "*MATERIAL TEST, NAME=B, MATERIAL=CONCRETE, TYPE=SHEAR, LENGTH=0.3\n1e-4, 7\n"
    )
    run = keyway(deck, "--material")
    summary = json.loads((run.folder / "job_material.json").read_text())
    assert summary["status"] == "finished"
    rock, concrete = summary["tests"]["A"], summary["tests"]["B"]
    assert rock["largest"]["stress"] == pytest.approx(2e6)
    assert rock["largest"]["strain"] == pytest.approx(2e-4)
    assert rock["smallest"] == pytest.approx({"stress": -1e6, "strain": -1e-4, "time": 2.0})
    assert rock["energy"]["work"] == pytest.approx(50.0)
    assert (concrete["component"], concrete["rows"]) == ("S12", 8)
    assert concrete["length"] == pytest.approx(0.3)
    assert (run.folder / concrete["file"]).exists()
    assert "PULL" not in run.stderr
    assert "S12" in run.stderr


def test_deck_of_an_analysis_may_hold_tests(keyway):
    """--material needs no complete model: this one has no section and no support."""
    deck = "*NODE\n1, 0., 0., 0.\n" + MATERIAL + "*MATERIAL TEST, NAME=T\n1e-4\n*STEP\n*STATIC\n"
    run = keyway(deck + "*END STEP\n", "--material")
    assert run.csv("material_T")["S11"][-1] == pytest.approx(1e-4 * E)


def test_check_lists_the_tests_and_runs_none(keyway):
    run = keyway(MATERIAL + "*MATERIAL TEST, NAME=T\n1e-4\n0., 20\n", "--material", "--check")
    assert "UNIAXIAL of CONCRETE, length 1 m, 2 legs, 120 increments" in run.stdout
    assert not run.folder.exists()
