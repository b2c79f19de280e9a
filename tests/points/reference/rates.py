"""Rates of a point: with F = 0 plastic flow is an ordinary differential equation.

With n = dF/ds, m = dG/ds and growth h of the plastic strains k, all at the present state,

    dl = n : D : deps / (n : D : m - dF/dk . h),   ds = D : (deps - m dl),   dk = h dl,

and the nominal stress follows (1 - d) s. Everything is linear in deps, so that strains not given
are found from the stresses that are. The gradients are central differences.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .concrete import Concrete, largest_principal

STEP = 1e-6  # of the central differences, over the size of the stress
PULL = 50.0  # of a drift, towards F = 0 and towards given stresses, over the length of a leg
MOVES = np.vstack([np.eye(8), -np.eye(8), np.zeros(8)])  # of six stresses and two strengths


@dataclass(frozen=True)
class Gradients:
    """F and r at a state, gradients of F by stress and plastic strains, of r by stress."""

    value: float
    share: float
    by_stress: np.ndarray
    by_plastic: np.ndarray
    share_by_stress: np.ndarray


def gradients(law: Concrete, stress: np.ndarray, plastic: np.ndarray) -> Gradients:
    """By central differences; a shear component changes both its places in the tensor."""
    strengths = law.strengths(plastic)
    step = STEP * (np.max(np.abs(stress)) + law.tension.strength[0])
    stresses = stress + step * MOVES[:, :6]
    moved = strengths * (1.0 + STEP * MOVES[:, 6:])
    largest, normal = largest_principal(stress)
    values = law.yield_value(stresses, largest + step * MOVES[:, :6] @ normal, moved)
    shares = law.share(stresses)
    change = (values[:8] - values[8:16]) / 2.0
    return Gradients(
        value=float(values[-1]),
        share=float(shares[-1]),
        by_stress=change[:6] / step,
        by_plastic=change[6:] / (STEP * strengths) * law.strength_slopes(plastic),
        share_by_stress=(shares[:6] - shares[8:14]) / (2.0 * step),
    )


@dataclass(frozen=True)
class Rates:
    """Of a point at a state, linear in the rate of strain."""

    law: Concrete
    stress: np.ndarray  # effective [Pa]
    plastic: np.ndarray  # (2), tensile and compressive
    value: float  # F [Pa]
    flow: np.ndarray  # m
    growth: np.ndarray  # h
    slope: np.ndarray  # dl = slope . deps [1]
    drift: float  # dl by which a drift of F is drawn back, over a leg
    nominal: np.ndarray  # [Pa]
    tangent_elastic: np.ndarray  # of the nominal stress while the flow rests (6, 6) [Pa]
    tangent_flow: np.ndarray  # its change with the multiplier (6) [Pa]
    lost_by_multiplier: float  # energy lost by damage [J/m3]

    def multiplier(self, strain_rate: np.ndarray) -> float:
        """dl without the correction of drift."""
        return float(self.slope @ strain_rate)


def rates_of(law: Concrete, elastic_strain: np.ndarray, plastic: np.ndarray) -> Rates:
    """All rates of a state."""
    stiffness = law.stiffness
    stress = stiffness @ elastic_strain
    found = gradients(law, stress, plastic)
    flow = law.flow(stress)
    growth = law.growth(stress, flow)
    modulus = found.by_stress @ stiffness @ flow - found.by_plastic @ growth
    if modulus <= 0.0:
        raise ArithmeticError("softens faster than the effective stress can follow")
    damages = np.array([law.tension.at(plastic[0])[1], law.compression.at(plastic[1])[1]])
    slopes = np.array([law.tension.slopes(plastic[0])[1], law.compression.slopes(plastic[1])[1]])
    recovery = split_rates if law.recovery == "ENERGY" else weighted_rates
    elastic, by_multiplier, lost = recovery(law, found, stress, damages, slopes * growth)
    return Rates(
        law=law,
        stress=stress,
        plastic=plastic,
        value=found.value,
        flow=flow,
        growth=growth,
        slope=found.by_stress @ stiffness / modulus,
        drift=PULL * found.value / modulus,
        nominal=law.nominal(stress, *damages),
        tangent_elastic=elastic,
        tangent_flow=-elastic @ flow + by_multiplier,
        lost_by_multiplier=lost,
    )


def weighted_rates(law: Concrete, found: Gradients, stress, damages, growth):
    """Eqs. 14-16: tangent at rest, change of stress and energy lost by the growth of damage."""
    share, (tensile, compressive) = found.share, damages
    damage = law.loss(share, tensile, compressive)
    # d is linear in d_t and in d_c, and quadratic in r: these differences are its slopes.
    by_damage = np.array(
        [
            law.loss(share, 1.0, compressive) - law.loss(share, 0.0, compressive),
            law.loss(share, tensile, 1.0) - law.loss(share, tensile, 0.0),
        ]
    )
    by_share = (
        law.loss(share + STEP, tensile, compressive) - law.loss(share - STEP, tensile, compressive)
    ) / (2.0 * STEP)
    by_stress = by_share * found.share_by_stress
    stored = 0.5 * stress @ np.linalg.solve(law.stiffness, stress)
    rate = np.sum(by_damage * growth)
    elastic = (1.0 - damage) * law.stiffness - np.outer(stress, by_stress @ law.stiffness)
    return elastic, -stress * rate, stored * rate


def split_rates(law: Concrete, found: Gradients, stress, damages, growth):
    """The same with RECOVERY=ENERGY, by central differences; the energy lost is that at rest."""
    step = STEP * (np.max(np.abs(stress)) + law.tension.strength[0])
    moved = law.nominal(stress + step * np.vstack([np.eye(6), -np.eye(6)]), *damages)
    elastic = (moved[:6] - moved[6:]).T / (2.0 * step) @ law.stiffness
    pressed, energies = law.split.parts(stress)
    short = STEP / (1.0 + np.max(growth))
    above, below = (law.left(*(damages + way * short * growth)) for way in (1.0, -1.0))
    rate = (above - below) / (2.0 * short)
    return elastic, rate[0] * (stress - pressed) + rate[1] * pressed, -float(rate @ energies)


def strain_rate(rates: Rates, flows: bool, given: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """The six rates of strain, where some are given and else those of the nominal stress are.

    `given` says which components are strains; `rate` holds rates of strain or stress.
    """
    tangent, constant = rates.tangent_elastic, np.zeros(6)
    if flows:
        tangent = tangent + np.outer(rates.tangent_flow, rates.slope)
        constant = rates.tangent_flow * rates.drift
    strain = np.where(given, rate, 0.0)
    free = ~given
    if np.any(free):
        needed = (rate - constant - tangent @ strain)[free]
        strain[free] = np.linalg.solve(tangent[np.ix_(free, free)], needed)
    return strain
