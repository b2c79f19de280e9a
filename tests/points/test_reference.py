"""The reference against closed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from concretes import CRUSHING, JINPING, Material
from reference import closed_forms as exact
from reference import path
from reference.concrete import principal
from reference.path import Leg, Point, run
from reference.viscous import lag, relax
from scipy.optimize import brentq

# The integration's: 1e-9 of each step, some hundred steps; strains to 1e-13 of 1e-4.
INTEGRATION = 1e-6
# A leg's end is drawn to given stresses with a rate of 50 a leg, the rest is of the same size.
GIVEN_STRESS = 1e-6


def uniaxial(*ends: float) -> list[Leg]:
    return [Leg.of("ESSEEE", [end, 0.0, 0.0, 0.0, 0.0, 0.0]) for end in ends]


def segment_slopes(curve, row: int, plastic: float) -> tuple[float, float]:
    """Slopes of effective strength and damage of a straight segment, by its definition."""
    width = curve.plastic[row + 1] - curve.plastic[row]
    by_strength = (curve.strength[row + 1] - curve.strength[row]) / width
    by_damage = (curve.damage[row + 1] - curve.damage[row]) / width
    ahead = plastic - curve.plastic[row]
    strength, whole = (
        curve.strength[row] + by_strength * ahead,
        1.0 - curve.damage[row] - by_damage * ahead,
    )
    return (by_strength * whole + strength * by_damage) / whole**2, by_damage


def stress_at_yield(law, direction) -> np.ndarray:
    """Effective stress where a growing stress of a direction meets F = 0, by the reference's F."""
    direction = np.array(direction, dtype=float)
    size = brentq(lambda k: law.exceeds(k * direction, np.zeros(2)), 0.0, 1e10, rtol=1e-14)
    return size * direction


def test_plastic_strains_of_table_1():
    """paper_notes.md, 11 prints them to 1e-8."""
    printed = [0.0, 0.15578, 0.28843, 0.41757, 0.67392, 0.93020, 1.18263, 1.48298]
    assert JINPING.tension_curve.plastic * 1e3 == pytest.approx(printed, abs=5.1e-6)


def test_rows_of_table_1():
    """A uniaxial test returns the rows; strength and damage are those of the table."""
    law = JINPING.law()
    strain, stress = exact.uniaxial_rows(law, law.tension)
    history = run(law, uniaxial(*strain), rows=1)
    rows = slice(1, None)
    assert history.stress[rows, 0] == pytest.approx(stress, rel=INTEGRATION)
    assert history.damage[rows, 0] == pytest.approx(law.tension.damage, abs=INTEGRATION)
    assert history.hardening[rows, 0] == pytest.approx(history.plastic[rows, 0], rel=INTEGRATION)
    assert np.abs(history.stress[:, 1:]).max() <= GIVEN_STRESS * stress[0]


def test_rows_of_compression():
    law = Material(**CRUSHING).law()
    strain, stress = exact.uniaxial_rows(law, law.compression)
    history = run(law, uniaxial(*-strain), rows=1)
    assert -history.stress[1:, 0] == pytest.approx(stress, rel=INTEGRATION)
    assert history.damage[1:, 1] == pytest.approx(law.compression.damage, abs=INTEGRATION)


def test_energy_of_a_uniaxial_test():
    """Work, dissipation: quadrature of the closed form."""
    law = JINPING.law()
    strain, _ = exact.uniaxial_rows(law, law.tension)
    history = run(law, uniaxial(strain[-1]), rows=1)
    work, lost = exact.uniaxial_energy(law, law.tension, law.tension.plastic[-1])
    assert history.work[-1] == pytest.approx(work, rel=INTEGRATION)
    assert history.dissipated[-1] == pytest.approx(lost, rel=INTEGRATION)


def test_phases_end_at_rows_of_tables():
    """Each phase ends where a row is attained, so that the next one has the slopes after the row.

    The rows are those of Table 1; the plastic strain of an end is that of the row to round-off.
    """
    law = JINPING.law()
    strain, _ = exact.uniaxial_rows(law, law.tension)
    point, ends = Point(law), []
    follow_phase = point._follow_phase

    def recorded(*arguments):
        part = follow_phase(*arguments)
        ends.append(part.y[12, -1])
        return part

    point._follow_phase = recorded
    point.follow(uniaxial(1.1 * strain[-1])[0], np.array([1.0]))
    assert ends[1:-1] == pytest.approx(law.tension.plastic[1:], rel=1e-14)


@pytest.mark.parametrize("limit", ["MOST_PHASES", "MOST_EVALUATIONS"])
def test_integration_without_end_fails(limit, monkeypatch):
    """With the limit of a leg below what the leg needs."""
    monkeypatch.setattr(path, limit, 2)
    with pytest.raises(ArithmeticError, match="more than 2"):
        run(JINPING.law(), uniaxial(1e-3))


def test_extended_segments():
    """A segment is the curve between its rows; beyond, strength and 1 - d lose a tenth at most."""
    curve = JINPING.tension_curve
    for row, (begin, end) in enumerate(pairwise(curve.plastic)):
        segment = curve.limited(row)
        inside = 0.7 * begin + 0.3 * end
        assert segment.at(inside) == pytest.approx(curve.at(inside), rel=1e-12)
        assert segment.slopes(inside) == pytest.approx(curve.slopes(inside), rel=1e-12)
        assert segment.slopes(end) == pytest.approx(segment_slopes(curve, row, end), rel=1e-12)
        strength, damage = segment.at(10.0 * end)
        assert strength >= 0.9 * (1.0 - 1e-12) * curve.strength[row + 1]
        assert 1.0 - damage >= 0.9 * (1.0 - 1e-12) * (1.0 - curve.damage[row + 1])
        assert segment.slopes(10.0 * end) == (0.0, 0.0)


@pytest.mark.parametrize("by_sign", [False, True])
@pytest.mark.parametrize("tension_recovery", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("compression_recovery", [0.0, 0.5, 1.0])
def test_recovery_of_stiffness(tension_recovery, compression_recovery, by_sign):
    """Slopes after cracking, of the compression after it, and of renewed tension after crushing."""
    law = Material(
        **CRUSHING,
        tension_recovery=tension_recovery,
        compression_recovery=compression_recovery,
        recovery="SIGN" if by_sign else "LEE-FENVES",
    ).law()
    point = Point(law)
    moments = np.array([0.5, 1.0])

    def slope(way: float) -> float:
        """Of a uniaxial test from here by a small strain."""
        here = point.state[0]
        states = point.follow(uniaxial(here + way)[0], moments)
        stress = [point.stress(s)[0] for s in states]
        return (stress[1] - stress[0]) / (states[1][0] - states[0][0])

    point.follow(uniaxial(3e-4)[0], moments)
    whole = law.tension.at(point.state[12])[1]
    assert slope(-2e-6) == pytest.approx(
        exact.stiffness_after(law, whole, 0.0, 1.0), rel=INTEGRATION
    )
    closed = point.state[6]
    point.follow(uniaxial(closed - 1e-6)[0], moments)
    pushed = exact.stiffness_after(law, whole, 0.0, 0.0)
    assert slope(-1e-5) == pytest.approx(pushed, rel=INTEGRATION)
    point.follow(uniaxial(-3e-3)[0], moments)
    crushed = law.compression.at(point.state[13])[1]
    assert crushed > 0.1
    point.follow(uniaxial(point.state[6] + 1e-6)[0], moments)
    pulled = exact.stiffness_after(law, whole, crushed, 1.0)
    assert slope(1e-6) == pytest.approx(pulled, rel=INTEGRATION)


@pytest.mark.parametrize("ratio", [1.05, 1.125, 1.16, 1.2])
def test_biaxial_strength(ratio):
    """First yield under equal compressions is f_b0 (paper_notes.md, 9); 1e-12 is round-off."""
    law = Material(biaxial_ratio=ratio).law()
    stress = stress_at_yield(law, [-1, -1, 0, 0, 0, 0])
    assert -stress[0] == pytest.approx(exact.biaxial_strength(law), rel=1e-12)


def test_shear_strength():
    law = JINPING.law()
    stress = stress_at_yield(law, [0, 0, 0, 0, 0, 1])
    assert stress[5] == pytest.approx(exact.shear_strength(law), rel=1e-12)
    assert principal(stress)[-1] == pytest.approx(stress[5], rel=1e-12)


@pytest.mark.parametrize("ratio", [0.6, 2.0 / 3.0, 0.8])
def test_meridians(ratio):
    """Triaxial compression: closed form of both meridians; under high pressure the ratio is K_c."""
    law = Material(meridian_ratio=ratio).law()
    pressure = 100e6
    found = []
    for shape in ([2, -1, -1, 0, 0, 0], [1, 1, -2, 0, 0, 0]):
        deviator = np.array(shape) / 3.0  # q = 1

        def value(q, deviator=deviator):
            stress = q * deviator - pressure * np.array([1, 1, 1, 0, 0, 0])
            return law.exceeds(stress, np.zeros(2))

        found.append(brentq(value, 0.0, 3.0 * pressure, rtol=1e-14))
    assert found == pytest.approx(exact.meridian_strengths(law, pressure), rel=1e-12)
    assert found[0] / found[1] == pytest.approx(ratio, rel=1e-12)


def test_hydrostatic_tension():
    """Through the apex: no deviator arises and the stress follows the closed form."""
    law = JINPING.law()
    plastic = np.array([2e-5, 1e-4, 1.5577866e-4, 4e-4, 1.2e-3])
    strain, stress = exact.hydrostatic_tension(law, plastic)
    history = run(law, [Leg.of("EEEEEE", [e, e, e, 0, 0, 0]) for e in strain], rows=1)
    assert history.stress[1:, :3] == pytest.approx(np.outer(stress, np.ones(3)), rel=INTEGRATION)
    assert history.hardening[1:, 0] == pytest.approx(plastic, rel=INTEGRATION)
    assert np.abs(history.hardening[:, 1]).max() == 0.0


def test_frame_does_not_matter():
    """A path rotated in space gives the rotated stresses: six components, no principal axes."""
    law = Material(**CRUSHING).law()
    rng = np.random.default_rng(5)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    ends = [rng.normal(size=6) * 5e-4 for _ in range(2)]

    def turned(vector, shear):
        tensor = vector[np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])] * (
            np.eye(3) + shear * (1 - np.eye(3))
        )
        there = turn @ tensor @ turn.T
        return there[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * np.array([1, 1, 1] + 3 * [1 / shear])

    here = run(law, [Leg.of("EEEEEE", end) for end in ends], rows=2)
    there = run(law, [Leg.of("EEEEEE", turned(end, 0.5)) for end in ends], rows=2)
    expected = np.array([turned(s, 1.0) for s in here.stress])
    scale = np.abs(expected).max()
    assert there.stress == pytest.approx(expected, abs=10 * INTEGRATION * scale)


def test_dissipation_grows():
    """Along random cycles the dissipated energy never decreases."""
    law = Material(**CRUSHING, tension_recovery=0.5).law()
    rng = np.random.default_rng(3)
    history = run(law, [Leg.of("EEEEEE", rng.normal(size=6) * 7e-4) for _ in range(3)], rows=20)
    assert np.min(np.diff(history.dissipated)) >= 0.0


def test_lag_of_a_ramp():
    """viscosity y' = t - y from rest: y = t - v (1 - exp(-t/v))."""
    times = np.linspace(0.0, 3.0, 7)
    late = lag(times[:, None], times, 0.7)[:, 0]
    assert late == pytest.approx(times - 0.7 * (1.0 - np.exp(-times / 0.7)), abs=1e-14)


def test_viscous_stress_between_elastic_and_rate_independent():
    law = JINPING.law()
    history = run(law, uniaxial(4e-4), rows=50)
    times = np.linspace(0.0, 1.0, 51)
    fast = relax(law, history, times, 1e9)
    assert fast.stress[:, 0] == pytest.approx((history.strain @ law.stiffness)[:, 0], rel=1e-6)
    slow = relax(law, history, times, 1e-9)
    assert slow.stress[:, 0] == pytest.approx(history.stress[:, 0], rel=1e-5, abs=1.0)
