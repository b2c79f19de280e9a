"""Closed forms of plastic-damage concrete."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import quad

from .concrete import Concrete
from .curves import Curve


def uniaxial_rows(law: Concrete, curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """Size of strain and nominal stress [Pa] at the rows of a curve, lateral faces free.

    Under one tension F is s sigma_c/sigma_t - sigma_c, under one compression |s| - sigma_c, so that
    the effective stress is the effective strength, and the plastic strain of the row is the axial
    one: eps = eps_pl + sigma / ((1 - d) E).
    """
    strain = curve.plastic + curve.strength / ((1.0 - curve.damage) * law.young)
    return strain, curve.strength


def uniaxial_energy(law: Concrete, curve: Curve, plastic: float) -> tuple[float, float]:
    """Work and dissipation [J/m3] of a uniaxial test up to a plastic strain.

    Dissipation is that of the plastic strain, sigma deps_pl, and of the damage, s^2/(2E) dd; work
    is that and what is stored.
    """

    def rate(value: float) -> float:
        effective = curve.effective(value)
        return curve.at(value)[0] + effective**2 / (2.0 * law.young) * curve.slopes(value)[1]

    inside = curve.plastic[(curve.plastic > 0.0) & (curve.plastic < plastic)]
    marks = [0.0, *inside, plastic]
    lost = sum(quad(rate, a, b, epsabs=0.0, epsrel=1e-12)[0] for a, b in pairwise(marks))
    strength = curve.at(plastic)[0]
    return lost + strength * curve.effective(plastic) / (2.0 * law.young), lost


def stiffness_after(law: Concrete, tensile: float, compressive: float, share: float) -> float:
    """Slope of a uniaxial test [Pa] in tension (share 1) or compression (share 0), Eqs. 15-16."""
    by_compression = 1.0 - (1.0 - law.tension_recovery * share) * compressive
    by_tension = 1.0 - (1.0 - law.compression_recovery * (1.0 - share)) * tensile
    return by_compression * by_tension * law.young


def beta(law: Concrete, tensile_strain: float = 0.0) -> float:
    """Eq. 23 after a tensile plastic strain, uncrushed."""
    ratio = law.compression.effective(0.0) / law.tension.effective(tensile_strain)
    return ratio * (1.0 - law.alpha) - (1.0 + law.alpha)


def biaxial_strength(law: Concrete) -> float:
    """First yield under two equal compressions [Pa]: q = f, p = 2f/3 in Eq. 19."""
    return law.biaxial_ratio * law.compression.effective(0.0)


def shear_strength(law: Concrete) -> float:
    """First yield in pure shear [Pa]: q = sqrt(3) t, p = 0, largest principal stress t."""
    return (1.0 - law.alpha) * law.compression.effective(0.0) / (np.sqrt(3.0) + beta(law))


def meridian_strengths(law: Concrete, pressure: float) -> tuple[float, float]:
    """q at first yield [Pa] on the tensile and the compressive meridian, all stresses compressive.

    The largest principal stress is -p + 2q/3 with one stress above two equal ones (tensile), and
    -p + q/3 with one below (compressive); their ratio tends to K_c with growing pressure.
    """
    held = (3.0 * law.alpha + law.gamma) * pressure
    held += (1.0 - law.alpha) * law.compression.effective(0.0)
    return held / (1.0 + 2.0 * law.gamma / 3.0), held / (1.0 + law.gamma / 3.0)


def hydrostatic_tension(law: Concrete, plastic: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Strain in each direction and stress [Pa] at tensile plastic strains, all directions pulled.

    At the apex q = 0 and the flow is the same in all directions; Eq. 19 is (3 alpha + beta) s =
    (1 - alpha) sigma_c.
    """
    compressive = law.compression.effective(0.0)
    effective = np.array(
        [(1.0 - law.alpha) * compressive / (3.0 * law.alpha + beta(law, k)) for k in plastic]
    )
    damage = np.array([law.tension.at(k)[1] for k in plastic])
    elastic = effective * (1.0 - 2.0 * law.poisson) / law.young
    return plastic + elastic, (1.0 - damage) * effective
