"""Plastic-damage concrete: constants, yield function, flow and damage (Eqs. 14-25)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .curves import Curve

UNIT = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])  # of a stress
SHEARS = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # how often a component stands in the tensor
EQUAL = 1e-9  # difference of principal stresses, over their size, that is round-off
PLACES = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])  # of the components in the tensor


def principal(stress: np.ndarray) -> np.ndarray:
    """Eigenvalues, growing; stresses in the last index, any number of them before."""
    return np.linalg.eigvalsh(stress[..., PLACES])


def largest_principal(stress: np.ndarray) -> tuple[float, np.ndarray]:
    """The largest principal stress and its gradient (6).

    Where two or three are equal the gradient is the mean of theirs: stresses that stay equal, as on
    a path that treats those directions alike, then have the right rate.
    """
    values, axes = np.linalg.eigh(stress[PLACES])
    equal = values >= values[-1] - EQUAL * np.max(np.abs(values))
    normals = axes[:, equal]
    projection = normals @ normals.T / np.sum(equal)
    return values[-1], SHEARS * projection[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def weight(values: np.ndarray) -> np.ndarray:
    """Share of tension of Lee and Fenves, sum<s>/sum|s| (paper_notes.md, 8); 0 without stress."""
    whole = np.sum(np.abs(values), axis=-1)
    share = np.sum(np.maximum(values, 0.0), axis=-1)
    return share / np.where(whole > 0.0, whole, 1.0)


def pressure(stress: np.ndarray) -> np.ndarray:
    """Eq. 20 [Pa]."""
    return stress @ (-UNIT / 3.0)


def deviator(stress: np.ndarray) -> np.ndarray:
    """Eq. 22 [Pa]."""
    return stress + pressure(stress)[..., None] * UNIT


def mises(stress: np.ndarray) -> np.ndarray:
    """Eq. 21 [Pa]."""
    return np.sqrt(1.5 * deviator(stress) ** 2 @ SHEARS)


@dataclass(frozen=True)
class Concrete:
    """Constants of a concrete."""

    young: float  # [Pa]
    poisson: float
    tension: Curve
    compression: Curve
    dilation: float = 32.5  # psi of Eq. 25 [deg]
    offset: float = 0.1  # xi of Eq. 25
    biaxial_ratio: float = 1.125  # f_b0/f_c0
    meridian_ratio: float = 2.0 / 3.0  # K_c
    tension_recovery: float = 0.0  # w_t
    compression_recovery: float = 1.0  # w_c
    recovers_by_sign: bool = False  # Eq. 17, else the weight of Lee and Fenves

    @property
    def alpha(self) -> float:
        """Of Eq. 19, from first yield under equal biaxial compression."""
        return (self.biaxial_ratio - 1.0) / (2.0 * self.biaxial_ratio - 1.0)

    @property
    def gamma(self) -> float:
        """Of Eq. 19, paper_notes.md, 9."""
        return 3.0 * (1.0 - self.meridian_ratio) / (2.0 * self.meridian_ratio - 1.0)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """D_0 of Eq. 14 (6, 6) [Pa]."""
        shear = self.young / (2.0 * (1.0 + self.poisson))
        lame = 2.0 * shear * self.poisson / (1.0 - 2.0 * self.poisson)
        return lame * np.outer(UNIT, UNIT) + shear * np.diag(2.0 / SHEARS)

    def yield_value(self, stress, largest, strengths) -> np.ndarray:
        """F of Eqs. 19 and 23 [Pa] under effective stresses whose largest principal one is given.

        `strengths` are the effective ones, tensile and compressive, in the last index.
        """
        alpha, gamma = self.alpha, self.gamma
        tensile, compressive = strengths[..., 0], strengths[..., 1]
        beta = compressive / tensile * (1.0 - alpha) - (1.0 + alpha)
        shape = (
            mises(stress)
            - 3.0 * alpha * pressure(stress)
            + beta * np.maximum(largest, 0.0)
            - gamma * np.maximum(-largest, 0.0)
        )
        return shape / (1.0 - alpha) - compressive

    def strengths(self, plastic: np.ndarray) -> np.ndarray:
        """Effective strengths (2) [Pa] at tensile and compressive plastic strains."""
        return np.array(
            [self.tension.effective(plastic[0]), self.compression.effective(plastic[1])]
        )

    def exceeds(self, stress: np.ndarray, plastic: np.ndarray) -> float:
        """F at a state [Pa]."""
        largest = principal(stress)[-1]
        return float(self.yield_value(stress, largest, self.strengths(plastic)))

    def flow(self, stress: np.ndarray) -> np.ndarray:
        """Gradient of the potential of Eqs. 24-25 (6), a strain with engineering shears."""
        slope = np.tan(np.radians(self.dilation))
        # The strength is the tensile peak (paper_notes.md, 10).
        round_off = self.offset * self.tension.strength[0] * slope
        steepness = np.hypot(round_off, mises(stress))
        return 1.5 * SHEARS * deviator(stress) / steepness + slope / 3.0 * UNIT

    def growth(self, stress: np.ndarray, flow: np.ndarray) -> np.ndarray:
        """Growth of both plastic strains with the multiplier, tension first (paper_notes.md, 8)."""
        values = principal(flow / SHEARS)
        share = weight(principal(stress))
        return np.array([share * max(0.0, values[-1]), -(1.0 - share) * min(0.0, values[0])])

    def share(self, stress: np.ndarray) -> np.ndarray:
        """r of Eqs. 16-18, for the recovery of stiffness."""
        if self.recovers_by_sign:
            return np.where(np.sum(stress[..., :3], axis=-1) > 0.0, 1.0, 0.0)
        return weight(principal(stress))

    def loss(self, share, tensile, compressive):
        """d of Eqs. 15-16, from the share r and the damages of tension and compression."""
        active_compressive = 1.0 - self.tension_recovery * share
        active_tensile = 1.0 - self.compression_recovery * (1.0 - share)
        return 1.0 - (1.0 - active_compressive * compressive) * (1.0 - active_tensile * tensile)
