"""The law in the program against the reference: paths in six components, mixed control, random.

The program's increments are backward Euler steps, of first order: the difference halves with them.
The reference has an error of 1e-7 or less. Differences are measured as the largest of all stress
components at the ends of the legs, over the largest stress of the path.
"""

from __future__ import annotations

import numpy as np
from concretes import CRUSHING, JINPING, Material
from point_decks import PointDeck
from reference import path
from reference.path import Leg

EVERYTHING = Material(**CRUSHING, tension_recovery=0.5)
SWITCH = Material(**CRUSHING, recovery="SIGN")


def straight(*ends) -> list[Leg]:
    return [Leg.of("EEEEEE", np.array(end) * 1e-4) for end in ends]


PATHS = {
    "tension_cycle": (EVERYTHING, [Leg.of("ESSEEE", [e, 0, 0, 0, 0, 0])
                                   for e in (3e-4, -2e-3, 4e-4, -4e-3)]),
    "biaxial_equal": (EVERYTHING, [Leg.of("EESEEE", [-4e-3, -4e-3, 0, 0, 0, 0])]),
    "biaxial_mixed": (EVERYTHING, [Leg.of("EESEEE", [-2e-3, 2e-4, 0, 0, 0, 0])]),
    "plane_strain": (EVERYTHING, [Leg.of("EEEEEE", [-4e-3, 0, 3e-4, 0, 0, 0])]),
    "confined": (EVERYTHING, [Leg.of("SSSEEE", [-1e7, -1e7, -1e7, 0, 0, 0]),
                              Leg.of("ESSEEE", [-8e-3, -1e7, -1e7, 0, 0, 0])]),
    "shear": (EVERYTHING, [Leg.of("SSSESS", [0, 0, 0, g, 0, 0]) for g in (6e-4, -6e-4)]),
    "shear_held": (EVERYTHING, straight([0, 0, 0, 8, 0, 0], [0, 0, 0, -8, 0, 0])),
    "oedometer": (EVERYTHING, straight([5, 0, 0, 0, 0, 0], [-30, 0, 0, 0, 0, 0])),
    "rotating": (EVERYTHING, straight([1.5, 0, 0, 0, 0, 0], [2.5, 3.5, 0, 3, 0, 0],
                                      [2.5, 4, 1, 6, 3, 2])),
    "crush_then_twist": (EVERYTHING, straight([-20, 0, 0, 0, 0, 0], [-20, 3, 3, 12, 5, -8])),
    "paper": (JINPING, straight([2, 0, 0, 1, 0, 0], [4, 1, 0, 4, 2, 0])),
}  # fmt: skip


def random_paths() -> dict[str, tuple[Material, list[Leg]]]:
    """Thirty paths of three legs in all six components; some with two or three equal strains."""
    found = {}
    for seed in range(30):
        rng = np.random.default_rng(1000 + seed)
        ends = rng.normal(size=(3, 6)) * 10.0 ** rng.uniform(0.3, 1.2)
        if seed % 5 == 3:
            ends[:, 1] = ends[:, 0]
            ends[:, 3:] = 0.0
        elif seed % 5 == 4:
            ends[0, :3] = ends[0, 0]
            ends[0, 3:] = 0.0
        found[f"random_{seed}"] = (EVERYTHING if seed % 3 else JINPING, straight(*ends))
    return found


def reference_ends(law, legs) -> np.ndarray:
    return path.run(law, legs, rows=1).stress[1:]


def differences(keyway, material, legs, expected, increments, name="job") -> np.ndarray:
    """Largest difference at the ends of the legs over the largest stress, per number of increments.

    `expected` are the stresses there; the last value is that of the two finest results
    extrapolated to increments of no size.
    """
    deck = PointDeck()
    for count in increments:
        deck.add(f"N{count}", material, legs, count)
    curves = deck.run(keyway, name)
    ends = [curves[f"N{n}"].at_legs(curves[f"N{n}"].stress, n) for n in increments]
    ends.append(2.0 * ends[-1] - ends[-2])
    return np.array([np.abs(e - expected).max() for e in ends]) / np.abs(expected).max()
