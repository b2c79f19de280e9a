"""Exact solutions of elasticity in a pair of blocks, in the axes of the pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mesh_pairs import Pair


@dataclass
class Field:
    """An exact solution in the axes of a pair, as functions of places x (..., 3)."""

    displacement: Callable[[np.ndarray], np.ndarray]  # of the lower block (..., 3) [m]
    stress: Callable[[np.ndarray], np.ndarray]  # (..., 3, 3) [Pa]
    # of the upper block against the lower one's field, which goes on in it; stress-free [m]
    jump: Callable[[np.ndarray], np.ndarray] = np.zeros_like


def uniform(stress: np.ndarray, pair: Pair, give: np.ndarray) -> Field:
    """One stress everywhere; the opening is `give` [m/Pa] (along a, b, c) times the traction."""
    strain = (1.0 + pair.poisson) * stress - pair.poisson * np.trace(stress) * np.eye(3)
    return Field(
        lambda x: x @ (strain / pair.young),
        lambda x: np.broadcast_to(stress, (*x.shape, 3)),
        lambda x: np.broadcast_to(give * stress[:, 2], x.shape),
    )


def bending(pair: Pair, largest: float, give: float = 0.0) -> Field:
    """Pure bending about b of the pair as a beam along c; the jump of the interface is `give`
    [m/Pa] times the traction, so that the upper block rotates rigidly. Exact in three dimensions.
    """
    curvature = 2.0 * largest / (pair.young * pair.size[0])
    poisson = pair.poisson

    def displacement(x):
        a, b, c = parts(x, pair)
        return curvature * np.stack(
            [-0.5 * (c**2 + poisson * (a**2 - b**2)), -poisson * a * b, a * c], axis=-1
        )

    def stress(x):
        found = np.zeros((*x.shape, 3))
        found[..., 2, 2] = pair.young * curvature * parts(x, pair)[0]
        return found

    def jump(x):
        a, _, c = parts(x, pair)
        turn = pair.young * curvature * give
        return turn * np.stack([-c, 0.0 * a, a], axis=-1)

    return Field(displacement, stress, jump)


def sheared_across(pair: Pair, largest: float) -> Field:
    """A cantilever along c, loaded along a at its upper end, held at the lower (nu = 0; exact)."""
    return cantilever(pair, largest, along=2, deep=0)


def sheared_along(pair: Pair, largest: float) -> Field:
    """A cantilever along a, loaded along c; the interface is its middle plane (nu = 0; exact)."""
    return cantilever(pair, largest, along=0, deep=2)


def cantilever(pair: Pair, largest: float, along: int, deep: int) -> Field:
    """Cantilever of Timoshenko's plane elasticity, exact in space where nu = 0: linear bending
    stress, parabolic shear; `largest` is the bending stress at the support [Pa].
    """
    assert pair.poisson == 0.0
    sizes = np.array([*pair.size, sum(pair.heights)])
    start = np.array([0.0, 0.0, -pair.heights[0]])
    long, half = sizes[along], 0.5 * sizes[deep]
    load = largest / (long * half)  # force over the second moment of area [Pa/m2]

    def places(x):
        return x[..., along] - start[along], x[..., deep] - start[deep] - half

    def displacement(x):
        s, z = places(x)
        u = np.zeros_like(x)
        u[..., along] = load * (z * (long * s - 0.5 * s**2) + z**3 / 3.0)
        u[..., deep] = -load * (0.5 * long * s**2 - s**3 / 6.0 + half**2 * s)
        return u / pair.young

    def stress(x):
        s, z = places(x)
        found = np.zeros((*x.shape, 3))
        found[..., along, along] = load * (long - s) * z
        found[..., along, deep] = found[..., deep, along] = 0.5 * load * (z**2 - half**2)
        return found

    return Field(displacement, stress)


def parts(x: np.ndarray, pair: Pair):
    """Coordinates from the axis of the pair as a beam along c."""
    return x[..., 0] - 0.5 * pair.size[0], x[..., 1] - 0.5 * pair.size[1], x[..., 2]
