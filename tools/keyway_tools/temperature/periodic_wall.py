"""Steady periodic conduction through a wall whose two faces have given temperatures.

For a face temperature that is a sum of waves exp(i w t), conduction dT/dt = a d2T/dx2 through the
thickness L has the closed form (Carslaw and Jaeger 1959, sections 2.6 and 3.6)

  T(x, t) = Tu + (Td - Tu) x/L + Re sum_k exp(i w_k t) [Uk sinh q_k (L - x) + Dk sinh q_k x]
                                                      / sinh q_k L,   q_k = (1 + i) sqrt(w_k/2a).

A thick wall has U exp(-q x) at its upstream face: the wave falls by e over sqrt(2a/w), 3.2 m for
concrete of 1e-6 m2/s and one year. A thin wall has the straight line between its faces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SAMPLES = 384  # of a year, for the harmonics of a face


@dataclass(frozen=True)
class Waves:
    """Temperatures over the year: the mean, and complex amplitudes of its harmonics."""

    mean: np.ndarray  # (points)
    amplitude: np.ndarray  # (points, harmonics)

    def at(self, part_of_year: np.ndarray) -> np.ndarray:
        """Temperatures at parts of the year, shape (points, times)."""
        return self.mean[:, None] + (self.amplitude @ turns(part_of_year, self.count)).real

    @property
    def count(self) -> int:
        """Number of harmonics."""
        return self.amplitude.shape[1]


def turns(part_of_year: np.ndarray, count: int) -> np.ndarray:
    """exp(i w_k t), shape (harmonics, times)."""
    return np.exp(2j * np.pi * np.outer(np.arange(1, count + 1), part_of_year))


def waves_of(samples: np.ndarray, count: int) -> Waves:
    """The first harmonics of temperatures sampled evenly over a year, shape (points, samples)."""
    number = samples.shape[1]
    if not 1 <= count < number / 2:
        raise ValueError(f"harmonics: {count}; expected 1 to {(number - 1) // 2}")
    spectrum = np.fft.rfft(samples, axis=1)[:, : count + 1] / number
    return Waves(spectrum[:, 0].real, 2.0 * spectrum[:, 1:])


def share_of_face(depth: np.ndarray, thickness: np.ndarray, q: complex) -> np.ndarray:
    """sinh q (L - x)/sinh q L for depths x below a face of a wall of thickness L.

    Written with negative exponents: no thickness overflows, and a thin wall keeps its digits.
    """
    safe = _safe(thickness)
    share = np.exp(-q * depth) * np.expm1(-2.0 * q * (safe - depth)) / np.expm1(-2.0 * q * safe)
    return np.where(thickness > 0.0, share, 0.5)


def mean_share(thickness: np.ndarray, q: complex) -> np.ndarray:
    """Mean of `share_of_face` through the thickness, tanh(q L/2)/(q L)."""
    return np.where(thickness > 0.0, np.tanh(0.5 * q * thickness) / (q * _safe(thickness)), 0.5)


def slope_share(thickness: np.ndarray, q: complex) -> np.ndarray:
    """Slope of `share_of_face`, 12/L^2 times the integral of (x - L/2) sinh q (L - x)/sinh q L."""
    length = _safe(thickness)
    over_sinh = 2.0 * np.exp(-q * length) / -np.expm1(-2.0 * q * length)
    moment = 1.0 / q**2 - length * over_sinh / q - 0.5 * length * np.tanh(0.5 * q * length) / q
    return np.where(thickness > 0.0, 12.0 * moment / length**2, -1.0)


def _safe(thickness: np.ndarray) -> np.ndarray:
    return np.where(thickness > 0.0, thickness, 1.0)


@dataclass(frozen=True)
class Wall:
    """Depths of points below the upstream face, and the thickness of the wall there [m]."""

    depth: np.ndarray
    thickness: np.ndarray
    diffusivity: float  # [m2/s]
    year: float  # [s]

    def __post_init__(self) -> None:
        if self.diffusivity <= 0.0:
            raise ValueError(f"diffusivity: {self.diffusivity:g} m2/s; expected > 0")

    @property
    def place(self) -> np.ndarray:
        """Depth over thickness."""
        return np.where(self.thickness > 0.0, self.depth / _safe(self.thickness), 0.5)

    def wave_number(self, harmonic: int) -> complex:
        """q of a harmonic, from 1 [1/m]."""
        omega = 2.0 * np.pi * harmonic / self.year
        return (1.0 + 1.0j) * np.sqrt(omega / (2.0 * self.diffusivity))


def inside_wall(wall: Wall, upstream: Waves, downstream: Waves) -> Waves:
    """Temperatures inside a wall whose faces have given ones at each point."""
    mean = upstream.mean + (downstream.mean - upstream.mean) * wall.place
    amplitude = np.empty_like(upstream.amplitude)
    for k in range(upstream.count):
        q = wall.wave_number(k + 1)
        near = share_of_face(wall.depth, wall.thickness, q)
        far = share_of_face(wall.thickness - wall.depth, wall.thickness, q)
        amplitude[:, k] = upstream.amplitude[:, k] * near + downstream.amplitude[:, k] * far
    return Waves(mean, amplitude)


def linear_inside_wall(wall: Wall, upstream: Waves, downstream: Waves) -> Waves:
    """The straight line through the thickness with the mean and the first moment of the field.

    It has the same thrust and the same moment in a wall whose sections stay plane.
    """
    mean = upstream.mean + (downstream.mean - upstream.mean) * wall.place
    amplitude = np.empty_like(upstream.amplitude)
    for k in range(upstream.count):
        q = wall.wave_number(k + 1)
        middle, slope = mean_share(wall.thickness, q), slope_share(wall.thickness, q)
        near = middle + slope * (wall.place - 0.5)
        far = middle - slope * (wall.place - 0.5)
        amplitude[:, k] = upstream.amplitude[:, k] * near + downstream.amplitude[:, k] * far
    return Waves(mean, amplitude)
