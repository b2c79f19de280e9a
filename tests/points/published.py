"""Published experiments on concrete: few numbers of each, with their sources.

Karsan, I.D. & Jirsa, J.O. 1969, Behavior of concrete under compressive loadings, J. Struct. Div.
ASCE 95(12): 2543-2563. Kupfer, H., Hilsdorf, H.K. & Rusch, H. 1969, Behavior of concrete under
biaxial stresses, ACI Journal 66(8): 656-666. Points of both as digitised by Chen, Mobasher, Zheng &
Waisman 2025, Int. J. Rock Mech. Min. Sci. 186: 106007 (the data beside their analytical solution,
github.com/chenhhu/NLDamPla_Constitutive_Relation); every second or third of them. Compression
positive, strain in 1e-3, stress in MPa.
"""

from __future__ import annotations

import numpy as np

KARSAN_JIRSA_ENVELOPE = np.array(
    [
        [0.314, 10.08],
        [0.549, 15.61],
        [0.871, 21.05],
        [1.122, 23.93],
        [1.365, 25.89],
        [1.616, 27.05],
        [1.863, 27.55],
        [2.114, 27.55],
        [2.374, 27.25],
        [2.864, 25.86],
        [3.362, 23.83],
        [3.873, 21.38],
        [4.367, 18.83],
        [4.870, 16.44],
    ]
)


def karsan_jirsa_residual(strain, peak_strain):
    """Strain left when the load is taken off at a strain of the envelope: their fit.

    eps_p/eps_c = 0.145 (eps/eps_c)^2 + 0.13 eps/eps_c, eps_c the strain at the peak.
    """
    ratio = np.asarray(strain) / peak_strain
    return (0.145 * ratio**2 + 0.13 * ratio) * peak_strain


KUPFER_UNIAXIAL = np.array(
    [
        [0.246, 7.93],
        [0.492, 15.01],
        [0.739, 19.99],
        [0.985, 24.02],
        [1.232, 27.50],
        [1.491, 29.59],
        [1.742, 31.52],
        [1.998, 32.02],
        [2.492, 31.60],
        [2.994, 30.08],
        [3.579, 27.00],
        [4.187, 23.37],
        [5.093, 18.41],
    ]
)
KUPFER_EQUAL = np.array(  # both stresses equal
    [
        [0.503, 17.14],
        [0.746, 23.08],
        [0.995, 27.04],
        [1.244, 30.52],
        [1.492, 33.04],
        [1.736, 34.75],
        [1.975, 36.04],
        [2.249, 36.73],
        [2.503, 37.05],
        [2.741, 36.25],
        [3.234, 33.52],
    ]
)
KUPFER_HALF = np.array(  # the other stress 0.52 of this
    [
        [0.503, 15.13],
        [0.745, 21.82],
        [0.992, 26.80],
        [1.339, 31.90],
        [1.752, 35.20],
        [2.218, 37.98],
        [2.490, 38.93],
        [3.000, 39.61],
        [3.246, 39.01],
        [3.517, 37.81],
    ]
)

KUPFER_RATIOS = ((0.0, KUPFER_UNIAXIAL), (0.52, KUPFER_HALF), (1.0, KUPFER_EQUAL))


def kupfer_gerstle(ratio):
    """Larger stress at failure over f_c under two compressions: the fit of Kupfer & Gerstle.

    1973, J. Eng. Mech. Div. ASCE 99(4): 853-866: (1 + 3.65 a)/(1 + a)^2, a the ratio of stresses.
    """
    ratio = np.asarray(ratio)
    return (1.0 + 3.65 * ratio) / (1.0 + ratio) ** 2


def gopalaratnam_shah(opening):
    """Tensile stress over its peak at a crack opening [m]: the fit of Gopalaratnam & Shah.

    1985, Softening response of plain concrete in direct tension, ACI Journal 82(3): 310-323:
    exp(-k w^1.01), k = 1.544e-3 with w in millionths of an inch (constants as quoted elsewhere).
    """
    return np.exp(-1.544e-3 * (np.asarray(opening) / 25.4e-9) ** 1.01)


# Plastic-damage test of the blackbear suite: its results with increments of 1e-4 (strain, Pa).
BLACKBEAR_TENSION = np.array(
    [[2e-4, 3.4946693596e6], [1e-3, 2.8820799721e6], [5e-3, 0.8813618410e6]]
)
BLACKBEAR_COMPRESSION = np.array([[1.8e-3, 28.451219893e6], [5e-3, 3.2242550548e6]])
