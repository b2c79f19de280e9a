"""Conduction through a wall with periodic temperatures of its faces, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from keyway_tools.temperature.field import YEAR
from keyway_tools.temperature.periodic_wall import (
    Wall,
    Waves,
    inside_wall,
    linear_inside_wall,
    waves_of,
)
from scipy.integrate import quad
from scipy.special import ive, kve

DIFFUSIVITY = 1.0e-6  # of concrete [m2/s]
OMEGA = 2.0 * np.pi / YEAR
FALL = np.sqrt(2.0 * DIFFUSIVITY / OMEGA)  # the wave falls by e over this depth, 3.17 m
ROUND_OFF = 1e-12  # of a few operations, over the amplitude


def face(mean: float, amplitude: complex, number: int) -> Waves:
    """The same face temperature at all points: mean + Re amplitude exp(i w t)."""
    return Waves(np.full(number, mean), np.full((number, 1), amplitude, dtype=complex))


def wall(depth, thickness: float) -> Wall:
    depth = np.asarray(depth, dtype=float)
    return Wall(depth, np.full(len(depth), thickness), DIFFUSIVITY, YEAR)


def test_a_thick_wall_has_the_wave_of_a_half_space():
    """T = A exp(-x/d) cos(w t - x/d), d = sqrt(2a/w) (Carslaw and Jaeger 1959, 2.6).

    The other face is 40 d away; its share is exp(-20) at the deepest point.
    """
    depth = np.linspace(0.0, 20.0 * FALL, 50)
    field = inside_wall(wall(depth, 60.0 * FALL), face(0.0, 8.0, 50), face(0.0, 8.0, 50))
    part = np.linspace(0.0, 1.0, 24)
    exact = 8.0 * np.exp(-depth / FALL)[:, None]
    exact = exact * np.cos(2.0 * np.pi * part[None, :] - depth[:, None] / FALL)
    assert np.abs(field.at(part) - exact).max() < 8.0 * ROUND_OFF
    assert pytest.approx(3.17, abs=0.005) == FALL


def test_a_very_thick_wall_does_not_overflow():
    field = inside_wall(wall([0.0, 5e3, 1e4], 1e4), face(5.0, 8.0, 3), face(1.0, 2.0, 3))
    assert field.at(np.zeros(1))[:, 0] == pytest.approx([13.0, 3.0, 3.0], rel=ROUND_OFF)


def test_a_thin_wall_has_a_straight_line():
    """The deviation from the line between the faces falls with the square of the thickness."""
    errors = []
    for thickness in (0.4, 0.2, 0.1):
        depth = np.linspace(0.0, thickness, 11)
        field = inside_wall(wall(depth, thickness), face(3.0, 8.0, 11), face(5.0, 2j, 11))
        line = field.amplitude[0, 0] + (2j - 8.0) * depth / thickness
        errors.append(np.abs(field.amplitude[:, 0] - line).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.02)
    assert field.mean == pytest.approx(np.linspace(3.0, 5.0, 11), rel=ROUND_OFF)


def test_a_symmetric_wall():
    """Equal faces give a symmetric field whose middle has U/cosh(q L/2)."""
    thickness = 4.0 * FALL
    depth = np.linspace(0.0, thickness, 21)
    field = inside_wall(wall(depth, thickness), face(4.0, 8.0, 21), face(4.0, 8.0, 21))
    assert np.abs(field.amplitude - field.amplitude[::-1]).max() < 8.0 * ROUND_OFF
    q = (1.0 + 1.0j) / FALL
    assert field.amplitude[10, 0] == pytest.approx(8.0 / np.cosh(0.5 * q * thickness), rel=1e-12)
    assert field.mean == pytest.approx(4.0, rel=ROUND_OFF)


def test_the_error_of_a_curved_wall_falls_with_its_curvature():
    """A hollow cylinder (Bessel functions) against the plane wall: order 1 in L/R.

    T = [I0(q r) K0(q b) - K0(q r) I0(q b)]/[I0(q a) K0(q b) - K0(q a) I0(q b)] for a unit wave at
    r = a and none at r = b (Carslaw and Jaeger 1959, 13.4); exponents are taken together.
    """
    thickness, q = 8.0, (1.0 + 1.0j) / FALL
    depth = np.linspace(0.0, thickness, 17)
    plane = inside_wall(wall(depth, thickness), face(0.0, 1.0, 17), face(0.0, 0.0, 17))
    errors = []
    for radius in (50.0, 100.0, 200.0):
        a, b, r = q * radius, q * (radius + thickness), q * (radius + depth)

        def pair(one, other):
            first = ive(0, one) * kve(0, other) * np.exp(one.real - other)
            return first - kve(0, one) * ive(0, other) * np.exp(other.real - one)

        errors.append(np.abs(pair(r, b) / pair(a, b) - plane.amplitude[:, 0]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(1.0, abs=0.05)
    assert errors[1] < 0.006  # of the amplitude, for L/R = 0.08: docs/temperature.md


@pytest.mark.parametrize("thickness", [0.5, 8.0, 35.0])
def test_the_straight_line_keeps_mean_and_moment(thickness):
    """Mean and first moment through the thickness, by quadrature of the closed form."""
    ends = linear_inside_wall(
        wall([0.0, thickness], thickness), face(3.0, 8.0, 2), face(5.0, 2j, 2)
    )
    first, last = ends.amplitude[:, 0]

    def exact(x: float) -> complex:
        return inside_wall(
            wall([x], thickness), face(3.0, 8.0, 1), face(5.0, 2j, 1)
        ).amplitude[0, 0]  # fmt: skip

    def integral(weight) -> complex:
        whole = quad(lambda x: weight(x) * exact(x), 0.0, thickness, complex_func=True)
        return whole[0]

    mean = integral(lambda x: 1.0) / thickness
    moment = integral(lambda x: x - 0.5 * thickness)
    assert 0.5 * (first + last) == pytest.approx(mean, rel=1e-8)
    assert (last - first) * thickness**2 / 12.0 == pytest.approx(moment, rel=1e-8)
    assert ends.mean.tolist() == pytest.approx([3.0, 5.0])


def test_harmonics_of_a_year():
    """Samples of waves give their amplitudes back; the file of a year repeats."""
    month = np.arange(48) / 48.0
    samples = 3.0 + 2.0 * np.cos(2 * np.pi * month) - np.sin(4 * np.pi * month)
    waves = waves_of(samples[None, :], 3)
    assert waves.mean == pytest.approx(3.0)
    assert waves.amplitude[0] == pytest.approx([2.0, 1.0j, 0.0], abs=ROUND_OFF)
    assert waves.at(month)[0] == pytest.approx(samples, abs=10 * ROUND_OFF)
    assert waves.at(month + 1.0)[0] == pytest.approx(samples, abs=100 * ROUND_OFF)
    with pytest.raises(ValueError, match=r"harmonics: 24; expected 1 to 23"):
        waves_of(samples[None, :], 24)
