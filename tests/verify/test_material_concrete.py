"""keyway --material on concrete: the decks of input/material, and the results that a calibration
uses.

The references are the tables that the decks hold and closed forms of Eqs. 15-19.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from harness import ROOT

DECKS = ROOT / "input" / "material"

# Table 1 of the paper: strength [Pa], inelastic strain, damage; E of section 4.2.
YOUNG = 25e9
TABLE = np.array(
    [
        [2.480e6, 0.000e-3, 0.000],
        [0.858e6, 0.175e-3, 0.359],
        [0.545e6, 0.324e-3, 0.620],
        [0.415e6, 0.469e-3, 0.756],
        [0.294e6, 0.757e-3, 0.876],
        [0.234e6, 1.044e-3, 0.924],
        [0.198e6, 1.330e-3, 0.949],
        [0.169e6, 1.664e-3, 0.964],
    ]
)

TABLES = """*MATERIAL, NAME=C
*ELASTIC
30e9, 0.2
*CONCRETE DAMAGED PLASTICITY, RECOVERY=ENERGY
36., 0.1, 1.16, 0.6667, 1e-6
*CONCRETE COMPRESSION HARDENING
13e6, 0.
24e6, 1e-3
2e6, 5e-3
*CONCRETE COMPRESSION DAMAGE
0., 0.
0., 1e-3
0.8, 5e-3
*CONCRETE TENSION STIFFENING, TYPE=STRAIN
2.9e6, 0.
1.94e6, 0.066e-3
1.3e6, 0.12e-3
0.05e6, 0.6e-3
*CONCRETE TENSION DAMAGE, TYPE=STRAIN
0., 0.
0.38, 0.066e-3
0.6, 0.12e-3
0.9, 0.6e-3
"""

GFI = """*MATERIAL, NAME=C
*ELASTIC
30e9, 0.2
*CONCRETE DAMAGED PLASTICITY
31., 0.1, 1.16, 0.6666666666666667
*CONCRETE COMPRESSION HARDENING
30e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
3e6, 150.
"""


@pytest.fixture(scope="module")
def curves(tmp_path_factory, program_path):
    """Tables of all tests of a deck of input/material, and the summary."""
    from harness import Program

    program = Program(program_path, tmp_path_factory.mktemp("material"), 1)
    runs = {}

    def of(name: str):
        if name not in runs:
            run = program(DECKS / f"{name}.inp", "--material")
            summary = json.loads((run.folder / f"{name}_material.json").read_text())
            runs[name] = {t: run.csv(f"material_{t}") for t in summary["tests"]}, summary
        return runs[name]

    return of


def ends_of_legs(curve) -> np.ndarray:
    """The last row of each leg."""
    return np.flatnonzero(np.diff(curve["leg"], append=np.inf))[1:]


@pytest.mark.parametrize("name", sorted(p.stem for p in DECKS.glob("*.inp")))
def test_every_deck_of_materials_runs(curves, name):
    tables, summary = curves(name)
    assert summary["status"] == "finished"
    for table in tables.values():
        assert all(np.isfinite(column).all() for column in table.values())


def test_table_1_comes_back(curves):
    """All rows of Table 1 (0.2 % is allowed; the law is exact, the driver satisfies free sides to
    1e-9 of the strength)."""
    table = curves("table1_tension")[0]["TABLE"]
    rows = ends_of_legs(table)
    assert table["E11"][rows] == pytest.approx(TABLE[:, 0] / YOUNG + TABLE[:, 1], rel=1e-12)
    assert table["S11"][rows] == pytest.approx(TABLE[:, 0], rel=1e-6)
    assert table["DAMAGET"][rows] == pytest.approx(TABLE[:, 2], abs=1e-6)
    # paper_notes.md, 11
    plastic = TABLE[:, 1] - TABLE[:, 2] / (1 - TABLE[:, 2]) * TABLE[:, 0] / YOUNG
    assert table["PE11"][rows] == pytest.approx(plastic, abs=1e-9)
    # the area of the table between rows is that of straight lines in plastic strain, not in strain
    assert table["work"][-1] == pytest.approx(767.7, rel=0.03)


def test_unloading_has_the_damaged_stiffness(curves):
    table = curves("table1_tension")[0]["UNLOAD"]
    rows = ends_of_legs(table)
    loaded, free = rows[0::2], rows[1::2]
    slope = table["S11"][loaded] / (table["E11"][loaded] - table["E11"][free])
    assert slope == pytest.approx((1 - table["DAMAGET"][loaded]) * YOUNG, rel=1e-6)
    assert table["E11"][free] == pytest.approx(table["PE11"][free], abs=1e-12)


@pytest.mark.parametrize(
    ("name", "tension_recovery", "compression_recovery"),
    [("OPEN", 0.0, 1.0), ("CLOSED", 0.0, 0.0), ("HEALED", 1.0, 1.0)],
)
def test_recovery_of_stiffness(curves, name, tension_recovery, compression_recovery):
    """Slopes just past zero stress, Eqs. 15-16 with r = 1 in tension and 0 in compression."""
    table = curves("cyclic_uniaxial")[0][name]
    rows = ends_of_legs(table)
    stress, strain = table["S11"], table["E11"]

    def slope_after_crossing(first: int, last: int, sign: int) -> tuple[float, int]:
        i = first + int(np.argmax(sign * stress[first:last] > 0.0)) + 1
        return (stress[i + 1] - stress[i]) / (strain[i + 1] - strain[i]), i

    pressed, i = slope_after_crossing(rows[0], rows[1], -1)
    open_damage = table["DAMAGET"][i]
    assert pressed == pytest.approx(
        (1 - (1 - compression_recovery) * open_damage) * YOUNG, rel=1e-6
    )
    pulled, i = slope_after_crossing(rows[1], rows[-2], 1)
    by_tension, by_crushing = 1 - table["DAMAGET"][i], 1 - table["DAMAGEC"][i]
    by_crushing = 1 - (1 - tension_recovery) * (1 - by_crushing)
    assert pulled == pytest.approx(by_tension * by_crushing * YOUNG, rel=1e-6)


def test_strength_under_two_stresses(curves):
    """f_b0/f_c0 = 1.16; 1.289 under -1/-0.52. The largest of 200 rows misses the peak by less than
    a row's share of the slope, 0.3 %."""
    tables, _ = curves("kupfer")
    alpha = 0.16 / 1.32
    half = (1 - alpha) / (np.sqrt(1 - 0.52 + 0.52**2) - alpha * 1.52)
    for name, expected in (("ONE", 1.0), ("EQUAL", 1.16), ("HALF", half)):
        assert -tables[name]["S11"].min() / 32.06e6 == pytest.approx(expected, rel=3e-3), name
    crack = tables["CRACK"]
    assert crack["S22"] == pytest.approx(-19.23 * crack["S11"], rel=1e-6, abs=1.0)
    assert 0.4 < -crack["S22"].min() / 32.06e6 < 0.95  # tension beside it takes strength away


def test_strength_under_confinement(curves):
    """Eq. 19 on the compressive meridian with alpha 0.1212, gamma 3: s = f_c + 4.828 p."""
    tables, _ = curves("triaxial")
    alpha = 0.16 / 1.32
    gain = (1 + 2 * alpha + 3) / (1 - alpha)
    for name, pressure in (("BARE", 0.0), ("P5", 5e6), ("P10", 10e6)):
        expected = 30e6 + gain * pressure
        assert -tables[name]["S11"].min() == pytest.approx(expected, rel=3e-3), name
        assert tables[name]["S22"][-1] == pytest.approx(-pressure, rel=1e-8, abs=1.0)


@pytest.mark.parametrize("length", [0.05, 0.5, 0.95])
def test_length_times_energy_is_fracture_energy(keyway, length):
    """Pulled until the crack is open: the dissipation per volume, times the length, is G_f. The
    strength never falls to zero (a floor of the curves), hence 1 %."""
    opening = 2 * 150.0 / 3e6
    test = f"*MATERIAL TEST, NAME=T, LENGTH={length}, INCREMENTS=400\n{1.02 * opening / length}\n"
    curve = keyway(GFI + test, "--material").csv("material_T")
    assert curve["S11"].max() == pytest.approx(3e6, rel=0.01)
    assert curve["fracture"][-1] * length == pytest.approx(150.0, rel=0.01)
    assert curve["work"][-1] == pytest.approx(
        curve["fracture"][-1] + curve["crushing"][-1] + curve["stored"][-1], rel=0.01
    )


def test_length_that_snaps_back_is_refused(keyway):
    """2 E G_f/f_t^2 = 1 m."""
    run = keyway(GFI + "*MATERIAL TEST, NAME=T, LENGTH=1.1\n1e-3\n", "--material", code=2)
    assert "snaps back in a length of 1.1; expected at most 1:" in run.stderr
    tougher = GFI.replace("150.", "300.")
    run = keyway(tougher + "*MATERIAL TEST, NAME=T\n1e-4\n", "--material")
    assert "LENGTH is not given" in run.stderr


def test_stress_past_the_peak_ends_with_the_rows_so_far(keyway):
    deck = GFI + "*MATERIAL TEST, NAME=T, CONTROL=STRESS, LENGTH=0.5, INCREMENTS=10\n4e6\n"
    deck += "*MATERIAL TEST, NAME=U, LENGTH=0.5, INCREMENTS=10\n1e-4\n"
    run = keyway(deck, "--material", code=1)
    assert "test T stops in leg 1, increment 8 of 10" in run.stderr
    assert "CONTROL=STRAIN" in run.stderr
    assert len(run.csv("material_T")["S11"]) == 8
    assert len(run.csv("material_U")["S11"]) == 11
    summary = json.loads((run.folder / "job_material.json").read_text())
    assert summary["status"] == "stopped"
    assert (summary["tests"]["T"]["status"], summary["tests"]["U"]["status"]) == (
        "stopped",
        "finished",
    )


def test_diverging_strain_is_reported(keyway):
    """A diverging iteration is reported as such, not as a fault of the law."""
    test = "*MATERIAL TEST, NAME=T, TYPE=OEDOMETER, LENGTH=0.2, CONTROL=STRESS\n1e20, 1\n"
    run = keyway(GFI + test, "--material", code=1)
    assert "no convergence of concrete at a point, for a change of strain of " in run.stderr


def test_a_test_whose_increments_are_cut_again_and_again_ends(keyway):
    """Each increment may take 20000 calls of the law, all of them 200 more in the mean.

    With 20000 in each of 100 increments this test took minutes.
    """
    test = "*MATERIAL TEST, NAME=T, TYPE=OEDOMETER, CONTROL=STRESS\n1e12\n"
    run = keyway(TABLES + test, "--material", code=1)
    assert "test T stops in leg 1" in run.stderr
    assert run.csv("material_T")["iterations"].sum() < 20000 + 100 * 200
