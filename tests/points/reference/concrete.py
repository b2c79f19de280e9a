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


class Split:
    """The closest point of no tension to a stress, in the energy norm, by trial of all faces.

    In principal directions the stresses without tension are a cone of eight faces: on each a set of
    components is zero. The closest point of a face's plane follows from linear algebra; the closest
    one of the cone is the nearest of those that have no tension.
    """

    def __init__(self, stiffness: np.ndarray):
        self.stiffness = stiffness  # (3, 3) of principal strains [Pa]
        self.compliance = np.linalg.inv(stiffness)
        self.faces = [self._face([bool(mask & bit) for bit in (1, 2, 4)]) for mask in range(8)]
        self._bar = self._face([True, False, False])  # of a bar pulled along the first axis

    def _face(self, is_open: list[bool]) -> np.ndarray:
        """Stiffness (3, 3) of the plane where the open components of stress are zero."""
        opened = np.flatnonzero(is_open)
        columns = self.stiffness[:, opened]
        inner = self.stiffness[np.ix_(opened, opened)]
        return self.stiffness - columns @ np.linalg.solve(inner, columns.T)

    def parts(self, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part without tension [Pa], and the energies [J/m3] of the rest and of this part."""
        values, axes = np.linalg.eigh(stress[..., PLACES])
        strains = values @ self.compliance
        trials = np.stack([strains @ face for face in self.faces], axis=-2)
        away = values[..., None, :] - trials
        distances = 0.5 * np.einsum("...i,ij,...j", away, self.compliance, away)
        size = np.max(np.abs(values), axis=-1, initial=0.0)[..., None]
        distances = np.where(trials.max(axis=-1) > 1e-12 * size, np.inf, distances)
        best = np.argmin(distances, axis=-1)[..., None]
        pressed = np.take_along_axis(trials, best[..., None], axis=-2)[..., 0, :]
        tensor = np.einsum("...ij,...j,...kj->...ik", axes, pressed, axes)
        whole = 0.5 * np.sum(values * strains, axis=-1)
        rest = np.take_along_axis(distances, best, axis=-1)[..., 0]
        components = tensor[..., [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        return components, np.stack([rest, whole - rest], axis=-1)

    def fraction_of_bar(self, modulus: float, pressed: float) -> float:
        """Fraction of the opened stiffness for which a bar in tension has a modulus [Pa].

        Both parts are orthogonal, so that the compliance of the bar is the sum of theirs.
        """
        own = self.compliance @ self._bar @ self.compliance
        rest = self.compliance - own
        return rest[0, 0] / (1.0 / modulus - own[0, 0] / pressed)

    def of_bar(self, left: np.ndarray) -> np.ndarray:
        """Principal effective stresses of a bar under a nominal stress of 1, along the first."""
        nominal = left[0] * (self.stiffness - self._bar) + left[1] * self._bar
        return self.stiffness @ np.linalg.solve(nominal, [1.0, 0.0, 0.0])


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
    recovery: str = "LEE-FENVES"  # or SIGN (Eq. 17), ENERGY

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
        tensile = self.tension.effective(plastic[0])
        compressive = self.compression.effective(plastic[1])
        if self.recovery == "ENERGY":
            tensile = self._strength_of_bar(*self.tension.at(plastic[0]))
        return np.array([tensile, compressive])

    def _strength_of_bar(self, nominal: float, damage: float) -> float:
        """Effective strength for which a bar with free sides yields under a nominal stress."""
        left = self.left(damage, 0.0)
        opened = self.split.of_bar(left)
        stress = np.concatenate([nominal * opened, np.zeros(3)])
        compressive = self.compression.strength[0]
        far, near = (  # F is linear in 1/t (Eqs. 19, 23)
            self.yield_value(stress, stress[0], np.array([nominal / inverse, compressive]))
            for inverse in (1.0, 2.0)
        )
        return float(nominal * (near - far) / (near - 2.0 * far))

    def strength_slopes(self, plastic: np.ndarray) -> np.ndarray:
        """Derivatives of the effective strengths by their plastic strains [Pa]."""
        found = [self.tension.slopes(plastic[0])[0], self.compression.slopes(plastic[1])[0]]
        if self.recovery == "ENERGY" and found[0] != 0.0:  # 0 behind the last row
            step = 1e-9  # Of strains of 1e-4
            ends = (self.strengths(plastic + np.array([way, 0.0]))[0] for way in (step, -step))
            above, below = ends
            found[0] = (above - below) / (2.0 * step)
        return np.array(found)

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
        if self.recovery == "SIGN":
            return np.where(np.sum(stress[..., :3], axis=-1) > 0.0, 1.0, 0.0)
        return weight(principal(stress))

    @cached_property
    def split(self) -> Split:
        """Of RECOVERY=ENERGY."""
        return Split(self.stiffness[:3, :3])

    def left(self, tensile: float, compressive: float) -> np.ndarray:
        """Fractions of both stiffnesses, of the opened part first (RECOVERY=ENERGY).

        Uniaxial tension without crushing has the stiffness (1 - d_t) E.
        """
        pressed = 1.0 - (1.0 - self.compression_recovery) * tensile
        opened = self.split.fraction_of_bar((1.0 - tensile) * self.young, pressed)
        still = 1.0 - (1.0 - self.tension_recovery) * compressive
        return np.array([opened * still, pressed * (1.0 - compressive)])

    def nominal(self, stress: np.ndarray, tensile: float, compressive: float) -> np.ndarray:
        """Nominal stress of effective ones; stresses in the last index."""
        if self.recovery == "ENERGY":
            left = self.left(tensile, compressive)
            pressed, _ = self.split.parts(stress)
            return left[0] * (stress - pressed) + left[1] * pressed
        return (1.0 - self.loss(self.share(stress), tensile, compressive))[..., None] * stress

    def loss(self, share, tensile, compressive):
        """d of Eqs. 15-16, from the share r and the damages of tension and compression."""
        active_compressive = 1.0 - self.tension_recovery * share
        active_tensile = 1.0 - self.compression_recovery * (1.0 - share)
        return 1.0 - (1.0 - active_compressive * compressive) * (1.0 - active_tensile * tensile)
