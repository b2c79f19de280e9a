"""The law in the program against the reference: paths in six components, mixed control, random.

The program's increments are backward Euler steps, of first order: the difference halves with them.
The reference has an error of 1e-7 or less. Differences are measured as the largest of all stress
components at the ends of the legs, over the largest stress of the path.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from concretes import CRUSHING, JINPING, Material
from point_decks import Curve, PointDeck
from reference import path
from reference.path import Leg
from reference.viscous import relax

EVERYTHING = Material(**CRUSHING, tension_recovery=0.5)
SWITCH = Material(**CRUSHING, recovery="SIGN")
SPLIT = Material(**CRUSHING, recovery="ENERGY")
SPLIT_HALF = replace(SPLIT, tension_recovery=0.5, compression_recovery=0.5, poisson=0.3)


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
    "switch": (SWITCH, straight([2, -1, 0, 3, 0, 0], [-9, 2, 1, 5, 1, 0], [-2, 4, 0, 3, 0, 0])),
    "split_tension": (SPLIT, [Leg.of("ESSEEE", [e, 0, 0, 0, 0, 0]) for e in (3e-4, 1e-4, 8e-4)]),
    "split_shear": (SPLIT, straight([0, 0, 0, 8, 0, 0], [0, 0, 0, -8, 0, 0])),
    "split_oedometer": (SPLIT, straight([5, 0, 0, 0, 0, 0], [-30, 0, 0, 0, 0, 0])),
    "split_rotating": (SPLIT_HALF, straight([2, -1, 0, 3, 0, 0], [-9, 2, 1, 5, 1, 0],
                                            [-2, 4, 0, 3, 0, 0])),
    "split_twist": (SPLIT_HALF, straight([-20, 0, 0, 0, 0, 0], [-20, 3, 3, 12, 5, -8])),
    "split_paper": (replace(JINPING, recovery="ENERGY"), straight([4, 1, 0, 4, 2, 0],
                                                                  [-2, 0, 0, 2, -3, 0])),
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


ALL_PATHS = {**PATHS, **random_paths()}
# Paths through states near the apex: with an offset of 0.01 the flow turns there within a strain of
# 1e-7, so that increments show their order only when they are as short.
SHARP = ("rotating", *(f"random_{n}" for n in (9, 11, 13, 14, 18, 19)))
INCREMENTS = (200, 400, 800)  # a leg
# Below this a difference is that of the reference and of given stresses, not of the increments.
FLOOR = 1e-6


def curves_of(keyway, name: str, increments) -> list[Curve]:
    material, legs = ALL_PATHS[name]
    deck = PointDeck()
    for count in increments:
        deck.add(f"N{count}", material, legs, count)
    curves = deck.run(keyway)
    return [curves[f"N{count}"] for count in increments]


def differences(curves: list[Curve], increments, expected: np.ndarray) -> np.ndarray:
    """Largest difference at the ends of the legs over the largest stress, by increments.

    `expected` are the stresses there; the last value is that of the two finest results
    extrapolated to increments of no size.
    """
    ends = [c.at_legs(c.stress, n) for c, n in zip(curves, increments, strict=True)]
    ends.append(2.0 * ends[-1] - ends[-2])
    return np.array([np.abs(e - expected).max() for e in ends]) / np.abs(expected).max()


@pytest.mark.parametrize("name", ALL_PATHS)
def test_path(keyway, name):
    """First-order convergence to the reference; energy is never gained.

    A difference of 1/3 over the number of increments is what backward Euler leaves where half the
    strength goes in a leg. Extrapolated, what is left is of second order: 3e-6, a few times
    (1/3/400)^2.
    """
    material, legs = ALL_PATHS[name]
    curves = curves_of(keyway, name, INCREMENTS)
    history = path.run(material.law(), legs, rows=1)
    found = differences(curves, INCREMENTS, history.stress[1:])
    assert found[2] <= 1.0 / 3.0 / INCREMENTS[-1]
    if name not in SHARP and found[2] > FLOOR:
        assert np.log2(found[:2] / found[1:3]) == pytest.approx([1.0, 1.0], abs=0.1)
        assert found[3] <= 3.0 * FLOOR
    lost = curves[-1].dissipated
    assert np.min(np.diff(lost)) >= -1e-12 * lost[-1]
    ends = curves[-1].at_legs(lost, INCREMENTS[-1])
    assert ends == pytest.approx(history.dissipated[1:], abs=2e-3 * history.dissipated[-1])


@pytest.mark.full
@pytest.mark.parametrize("name", SHARP)
def test_sharp_path(keyway, name):
    """Near the apex, with increments in the range of convergence."""
    material, legs = ALL_PATHS[name]
    increments = (6400, 12800)
    history = path.run(material.law(), legs, rows=1)
    found = differences(curves_of(keyway, name, increments), increments, history.stress[1:])
    assert found[1] <= 0.7 * found[0]
    assert found[2] <= 3.0 * FLOOR


def test_viscosity(keyway):
    """Duvaut and Lions' lag, implicit in the program, exact in the reference: of first order."""
    material = replace(EVERYTHING, viscosity=0.2)
    law = material.law()
    legs = straight([2, -0.3, -0.3, 1, 0, 0], [-8, 1, 1, 4, 0, 0])
    rows = 400
    history = path.run(law, legs, rows=rows)
    late = relax(law, history, np.linspace(0.0, 2.0, 2 * rows + 1), material.viscosity)
    expected = late.stress[rows::rows]
    deck = PointDeck()
    for count in INCREMENTS:
        deck.add(f"N{count}", material, legs, count, time=1.0)
    curves = deck.run(keyway)
    found = differences([curves[f"N{n}"] for n in INCREMENTS], INCREMENTS, expected)
    assert np.log2(found[:2] / found[1:3]) == pytest.approx([1.0, 1.0], abs=0.1)
    # The reference is piecewise linear over 400 rows: an error of their square, 1e-5.
    assert found[3] <= 1e-5
