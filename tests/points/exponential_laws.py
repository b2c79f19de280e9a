"""Tables of the exponential laws of Lee and Fenves (1998), from the numbers such a law is given by.

Strength and stiffness in a uniaxial test go with the plastic strain k by

    f = f0 ((1 + a) exp(-b k) - a exp(-2 b k))        1 - d = exp(-c k)

whose three constants follow from a point of the curve, its area and one value of the damage:

- area g = G/l below f over k, from 0 to infinity:  g = f0/b ((1 + a) - a/2), so
  b = f0/g (1 + a/2);
- with a > 1 f rises to f_m = f0 (1 + a)^2/(4 a), where exp(-b k) = (1 + a)/(2 a): the root above 1
  of that quadratic is a = 2 R - 1 + 2 sqrt(R^2 - R), R = f_m/f0;
- without a peak a is given by the first slope. It is f0^2/g (a + 2)(a - 1)/2, steepest with
  a = -1/2; a share s of the steepest one is (a + 2)(1 - a) = 9/4 s, so a = 3/2 sqrt(1 - s) - 1/2;
- c from the damage d_1 at a strain k_1: c = -log(1 - d_1)/k_1. At half the strength
  exp(-b k_1) = y is the root of (1 + a) y - a y^2 = 1/2 below 1; at the peak see above.

A table wants the inelastic strain eps - f/E = k + f/((1 - d) E) - f/E.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class ExponentialLaw:
    """Constants of f and d."""

    first: float  # f0 [Pa]
    shape: float  # a
    rate: float  # b
    damage_rate: float  # c

    @classmethod
    def with_peak(cls, first: float, peak: float, area: float, damage_at_peak: float):
        """A law that rises from `first` to `peak` [Pa]; `area` is G/l [J/m3]."""
        ratio = peak / first
        shape = 2.0 * ratio - 1.0 + 2.0 * np.sqrt(ratio**2 - ratio)
        rate = first / area * (1.0 + shape / 2.0)
        at_peak = -np.log((1.0 + shape) / (2.0 * shape)) / rate
        return cls(first, shape, rate, -np.log(1.0 - damage_at_peak) / at_peak)

    @classmethod
    def falling(cls, first: float, slope: float, area: float, damage_at_half: float):
        """A law that falls from the start, at first with a share `slope` of the steepest slope.

        `area` is G/l [J/m3].
        """
        shape = 1.5 * np.sqrt(1.0 - slope) - 0.5
        rate = first / area * (1.0 + shape / 2.0)
        half = (1.0 + shape - np.sqrt((1.0 + shape) ** 2 - 2.0 * shape)) / (2.0 * shape)
        at_half = -np.log(half) / rate
        return cls(first, shape, rate, -np.log(1.0 - damage_at_half) / at_half)

    def strength(self, plastic):
        """f [Pa]."""
        fade = np.exp(-self.rate * np.asarray(plastic))
        return self.first * fade * (1.0 + self.shape - self.shape * fade)

    def damage(self, plastic):
        """d."""
        return -np.expm1(-self.damage_rate * np.asarray(plastic))

    def tables(self, young: float, plastic: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows (strength, inelastic strain) and (damage, inelastic strain) at plastic strains."""
        strength, damage = self.strength(plastic), self.damage(plastic)
        inelastic = plastic + damage / (1.0 - damage) * strength / young
        return np.stack([strength, inelastic], axis=1), np.stack([damage, inelastic], axis=1)

    def stepped_tables(self, young: float, strains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tables of what a program finds that goes through total `strains` in coarse steps.

        It takes the dissipated share K of the area, dK = f/g dk, by the forward Euler rule, and
        the damage of the stress from the step before. Steps without yield leave no row.
        """
        area = self.first / self.rate * (1.0 + self.shape / 2.0)
        plastic, dissipated = 0.0, 0.0
        rows = [(self.first, 0.0, 0.0)]
        for strain in strains[strains > self.first / young]:
            before = self._plastic_at(dissipated)
            growth = self.strength(before) / area

            def excess(more, done=dissipated, old=plastic, growth=growth, strain=strain):
                """Effective stress less effective strength after more plastic strain."""
                there = self._plastic_at(done + growth * more)
                strength = self.strength(there) / (1.0 - self.damage(there))
                return young * (strain - old - more) - strength

            more = brentq(excess, 0.0, min(strain - plastic, 0.999 * (1.0 - dissipated) / growth))
            plastic, dissipated = plastic + more, dissipated + growth * more
            damage = self.damage(before)
            stress = (1.0 - damage) * young * (strain - plastic)
            rows.append((stress, damage, strain - stress / young))
        table = np.array(rows)
        return table[:, [0, 2]], table[:, [1, 2]]

    def _plastic_at(self, dissipated: float) -> float:
        """k at a dissipated share K: K is quadratic in exp(-b k)."""
        shape = self.shape
        fade = (1.0 + shape - np.sqrt(1.0 + shape * (2.0 + shape) * dissipated)) / shape
        return -np.log(fade) / self.rate
