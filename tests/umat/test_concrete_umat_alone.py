"""The UMAT of concrete called without Keyway."""

from __future__ import annotations

import re

import numpy as np
import pytest
from harness import ROOT
from keyway_tools.concrete_constants import materials_of
from umat_alone import Point, compile_alone

MATERIALS = ROOT / "input" / "material"
# Table 1 of the paper: tensile strength [Pa], inelastic strain, tensile damage.
TABLE_1 = (
    (2.480e6, 0.000e-3, 0.000), (0.858e6, 0.175e-3, 0.359), (0.545e6, 0.324e-3, 0.620),
    (0.415e6, 0.469e-3, 0.756), (0.294e6, 0.757e-3, 0.876), (0.234e6, 1.044e-3, 0.924),
    (0.198e6, 1.330e-3, 0.949), (0.169e6, 1.664e-3, 0.964),
)  # fmt: skip
YOUNG, POISSON = 25e9, 0.167
# The side stresses are held to 1e-10; with a damage of 0.96 that is 3e-9 of the effective stress,
# and the return map's 1e-11 of 30 MPa is 1.2e-10 of 2.48 MPa.
EXACT = 1e-8


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return compile_alone(tmp_path_factory.mktemp("alone"))


def constants(deck: str, material: str) -> list[float]:
    return materials_of((MATERIALS / deck).read_text())[material]


JINPING = constants("table1_tension.inp", "JINPING")
CRUSHING = constants("cyclic_uniaxial.inp", "OPEN")
OPENING = constants("dam_concrete.inp", "DAM")


@pytest.mark.parametrize("increments", [1, 7])
def test_rows_of_table_1(library, increments):
    """At the strain sigma/E + inelastic strain each row is returned, in any number of
    increments."""
    point = Point(library, JINPING)
    for strength, inelastic, damage in TABLE_1:
        end = inelastic + strength / YOUNG
        for strain in np.linspace(point.strain[0], end, increments + 1)[1:]:
            answer = point.keep_uniaxial(strain)
        assert answer.stress[0] == pytest.approx(strength, abs=EXACT * 2.48e6)
        assert answer.state[8] == pytest.approx(damage, abs=EXACT)
        plastic = end - strength / YOUNG / (1 - damage)
        assert answer.state[[0, 6]] == pytest.approx([plastic, plastic], abs=EXACT * 1e-4)
        stored = 0.5 * answer.stress[0] * (end - plastic)
        assert answer.stored == pytest.approx(stored, rel=1e-6)
    assert answer.share == 1e3


def test_energy_of_table_1(library):
    """SSE + SPD is the work: 772.3 J/m3 by quadrature (input/material/table1_tension.inp)."""
    point = Point(library, JINPING)
    end = TABLE_1[-1][1] + TABLE_1[-1][0] / YOUNG
    for strain in np.linspace(0.0, end, 1001)[1:]:
        answer = point.keep_uniaxial(strain)
    assert answer.stored + answer.dissipated == pytest.approx(772.3, rel=1e-3)


def test_strengths_in_compression(library):
    """The constant 30 MPa under one pressure, f_b0 = 1.125 times as much under two."""
    point = Point(library, JINPING)
    for strain in (-1e-3, -4e-3):
        answer = point.keep_uniaxial(strain)
    assert answer.stress[0] == pytest.approx(-30e6, rel=EXACT)
    plate = Point(library, JINPING)
    for both in np.linspace(0.0, -4e-3, 11)[1:]:
        low, high = both, 6.0 * abs(both)  # E33: between pressure and a crack
        for _ in range(60):
            middle = 0.5 * (low + high)
            strain = np.array([both, both, middle, 0, 0, 0])
            low, high = (middle, high) if plate.call(strain).stress[2] < 0 else (low, middle)
        answer = plate.keep(strain)
    assert answer.stress[:2] == pytest.approx([-33.75e6, -33.75e6], rel=1e-6)


def test_an_opening_is_shared_by_the_length(library):
    """f_t 2.5 MPa, G_f 200 N/m: at an opening of 0.08 mm half of f_t, whatever the length."""
    for length, own in ((0.5, 0.0), (1.0, 0.0), (9.0, 0.5)):
        point = Point(library, [*OPENING[:13], own, *OPENING[14:]], length=length)
        width = own or length
        for strain in np.linspace(0.0, 0.08e-3 / width + 1.25e6 / YOUNG, 41)[1:]:
            answer = point.keep_uniaxial(strain)
        # The floor of the strength, a thousandth of f_t, bends the line by half of it at most.
        assert answer.stress[0] == pytest.approx(1.25e6, rel=2e-3)
        assert answer.state[10] == pytest.approx(width, rel=1e-12)


def slopes(point: Point, strain: np.ndarray, step: float) -> np.ndarray:
    """Central differences of STRESS."""
    columns = []
    for unit in np.eye(6):
        ends = [point.call(strain + side * step * unit).stress for side in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2.0 * step))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("viscosity", [0.0, 0.3])
@pytest.mark.parametrize("recovery", [0.0, 1.0, 2.0])
def test_tangent(library, viscosity, recovery):
    """DDSDDE along paths with reversals against differences: 1e-6 of the largest entry.

    The step of 2e-9 reaches over no more than a hundred-thousandth of the strains at which curves
    bend (1e-4); the tangent at a kink is that of one side: few points, which are skipped.
    """
    numbers = [*CRUSHING[:6], viscosity, recovery, *CRUSHING[8:]]
    random = np.random.default_rng(3)
    apart, flowing = [], 0
    for _ in range(12):
        point = Point(library, numbers)
        way = random.standard_normal(6) * 2e-4
        for _ in range(6):
            strain = point.strain + way + random.standard_normal(6) * 1e-4
            answer = point.call(strain)
            expected = slopes(point, strain, 2e-9)
            apart.append(np.abs(answer.tangent - expected).max() / np.abs(expected).max())
            flowing += int(np.any(answer.state[6:8] > point.last.state[6:8]))
            point.keep(strain)
    apart = np.sort(apart)
    assert flowing > len(apart) // 2
    assert apart[-2] < 1e-6


def with_constant(number: int, value: float) -> list[float]:
    changed = list(JINPING)
    changed[number - 1] = value
    return changed


SCALARS = [
    (1, 0.0, "E_0 > 0"), (1, float("nan"), "E_0 > 0"), (2, 0.5, "nu between"),
    (3, 60.0, "degrees between"), (4, 0.0, "an offset > 0"), (5, 0.9, "f_b0/f_c0 >= 1"),
    (6, 0.5, "K_c above 0.5"), (7, -1.0, "a viscosity >= 0"), (8, 3.0, "recovery 0, 1 or 2"),
    (9, 1.5, "w_t between"), (10, -0.5, "w_c between"), (11, 3.0, "tension against"),
    (12, 2.0, "tension damage against"), (13, 2.0, "long elements"), (14, -1.0, "a width >= 0"),
    (15, 0.0, "a number of rows"), (16, -1.0, "a number of rows"), (17, 0.0, "a number of rows"),
    (18, -2.0, "a number of rows"),
]  # fmt: skip
FAULTS = [
    *((with_constant(n, x), f"constant {n} is .*; expected {word}") for n, x, word in SCALARS),
    (JINPING[:17], "fewer than 18 constants"),
    (JINPING[:-1], "constants; expected .* by the numbers of rows"),
    (with_constant(19, -1.0), "CONCRETE TENSION STIFFENING, row 1"),
    (with_constant(22, 0.0), "CONCRETE TENSION STIFFENING, row 2: .*more than"),
    (with_constant(37, 1.0), "CONCRETE TENSION DAMAGE, row 2: .*a damage below 1"),
    (with_constant(37, 0.99), "CONCRETE TENSION DAMAGE, row"),
    (with_constant(51, 1e6), "CONCRETE COMPRESSION HARDENING, row 1: .*beta of Eq. 23"),
    (with_constant(12, 1.0), "CONCRETE TENSION DAMAGE, row 0: .*expected TYPE=STRAIN"),
]  # fmt: skip


@pytest.mark.parametrize("case", range(len(FAULTS)))
def test_wrong_constants_are_reported(library, capfd, case):
    """A message that names the constant or the row, and NaN as stress."""
    numbers, word = FAULTS[case]
    answer = Point(library, numbers).call(np.zeros(6))
    reported = capfd.readouterr().out
    assert np.isnan(answer.stress).all()
    assert re.search(word, " ".join(reported.split())), reported
    assert "element 7, point 3" in reported
    assert reported.startswith("CONCRETE ")


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"num_state": 16}, "fewer than 17 state variables"),
        ({"num_direct": 3, "num_shear": 1}, "without six stress components"),
        ({"num_direct": 2, "num_shear": 1}, "without six stress components"),
    ],
)
def test_unsupported_elements_are_reported(library, capfd, changes, word):
    answer = Point(library, JINPING, **changes).call(np.zeros(6))
    assert np.isnan(answer.stress).all()
    assert word in capfd.readouterr().out


@pytest.mark.parametrize(
    ("length", "word"), [(2.0, "a crack band of 2; expected at most 1.6"), (0.0, "no width")]
)
def test_a_length_above_the_limit_is_reported(library, capfd, length, word):
    """2 E G_f/f_t^2 = 1.6 m; 1.6 may be written as 1.5999."""
    answer = Point(library, OPENING, length=length).call(np.zeros(6))
    reported = capfd.readouterr().out
    assert np.isnan(answer.stress).all()
    assert word in reported or word.replace("1.6", "1.5") in reported, reported


def test_a_failed_point_requests_a_smaller_increment(library):
    """A quarter of the increment, and an unchanged state."""
    point = Point(library, JINPING)
    point.keep_uniaxial(0.2e-3)
    before = point.last
    answer = point.call([float("nan"), 0, 0, 0, 0, 0])
    assert answer.share == 0.25
    assert np.array_equal(answer.stress, before.stress)
    assert np.array_equal(answer.state, before.state)
    assert answer.dissipated == before.dissipated
