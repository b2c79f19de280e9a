"""Petersson's beam by another method: two elastic halves and a cohesive crack between them.

Half of the beam is elastic (plane, four-node quadrilaterals with incompatible modes); the traction
of the ligament at mid-span depends on the opening. The elastic half is condensed to the ligament,
which leaves one nonlinear equation for each of its nodes. No part of the program is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from keyway_tools.deck_petersson import DEPTH, NOTCH, POISSON, SPAN, STRENGTH, THICKNESS, YOUNG
from scipy import sparse
from scipy.sparse.linalg import splu

CONTACT = 1e15  # stiffness before the crack and when it closes [Pa/m]; 3 nm at the strength
Law = Callable[[float], tuple[float, float]]  # traction [Pa] and slope [Pa/m] at an opening [m]


@dataclass(frozen=True)
class BeamCurve:
    """By steps: deflection of the load, of the notch's tip [m], load [N]."""

    load_point: np.ndarray
    tip: np.ndarray
    load: np.ndarray

    def at_tip(self, deflection: float) -> float:
        """Load [N] at a deflection of the notch's tip."""
        return float(np.interp(deflection, self.tip, self.load))


def piecewise(curve: np.ndarray) -> Law:
    """Traction from rows of stress [Pa], opening [m]; constant past the last."""
    stress, opening = curve[:, 0], curve[:, 1]
    slopes = np.append(np.diff(stress) / np.diff(opening), 0.0)

    def law(w: float) -> tuple[float, float]:
        k = max(int(np.searchsorted(opening, w, side="right")) - 1, 0)
        return float(stress[k] + slopes[k] * (w - opening[k])), float(slopes[k])

    return law


def plane_stress() -> np.ndarray:
    """Elastic matrix [Pa]."""
    ratio = [[1.0, POISSON, 0.0], [POISSON, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - POISSON)]]
    return YOUNG / (1.0 - POISSON**2) * np.array(ratio)


def brick(a: float, b: float, d: np.ndarray) -> np.ndarray:
    """Stiffness (8, 8) of a rectangle a x b with four incompatible modes, condensed."""
    k = np.zeros((12, 12))
    for xi in (-(3.0**-0.5), 3.0**-0.5):
        for eta in (-(3.0**-0.5), 3.0**-0.5):
            along = np.array([-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)]) / (2.0 * a)
            up = np.array([-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]) / (2.0 * b)
            strain = np.zeros((3, 12))
            strain[0, 0:8:2], strain[1, 1:8:2] = along, up
            strain[2, 0:8:2], strain[2, 1:8:2] = up, along
            strain[0, 8] = strain[2, 9] = -4.0 * xi / a
            strain[1, 11] = strain[2, 10] = -4.0 * eta / b
            k += strain.T @ d @ strain * (0.25 * a * b * THICKNESS)
    return k[:8, :8] - k[:8, 8:] @ np.linalg.solve(k[8:, 8:], k[8:, :8])


def half_beam(num: int) -> tuple[sparse.csc_matrix, np.ndarray]:
    """Stiffness of the half x > 0 and its node numbers (x, z); `num` cells up the ligament."""
    cell = (DEPTH - NOTCH) / num
    sizes = cell * 1.12 ** np.arange(int(np.log(1.0 + 0.06 * SPAN / cell) / np.log(1.12)) + 1)
    x = np.concatenate(([0.0], np.cumsum(sizes))) * 0.5 * SPAN / sizes.sum()
    lower = np.linspace(0.0, NOTCH, num // 2 + 1)
    z = np.concatenate((lower, np.linspace(NOTCH, DEPTH, num + 1)[1:]))
    number = np.arange(len(x) * len(z)).reshape(len(x), len(z))
    rows, columns, values = [], [], []
    for i, j in np.ndindex(len(x) - 1, len(z) - 1):
        corners = number[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1]]
        dofs = np.stack((2 * corners, 2 * corners + 1), axis=1).ravel()
        rows.append(np.repeat(dofs, 8))
        columns.append(np.tile(dofs, 8))
        values.append(brick(x[i + 1] - x[i], z[j + 1] - z[j], plane_stress()).ravel())
    places = (np.concatenate(rows), np.concatenate(columns))
    size = 2 * number.size
    return sparse.csc_matrix((np.concatenate(values), places), shape=(size, size)), number


def cohesive_beam(law: Law, deflection: float, num: int = 40, steps: int = 200) -> BeamCurve:
    """Moves the load down to `deflection` [m] in equal steps."""
    stiffness, number = half_beam(num)
    ligament = number[0, num // 2 :]
    area = np.full(num + 1, (DEPTH - NOTCH) / num * THICKNESS)
    area[[0, -1]] *= 0.5
    loaded, tip = 2 * number[0, -1] + 1, 2 * ligament[0] + 1
    free = np.setdiff1d(np.arange(2 * number.size), [loaded, 2 * number[-1, 0] + 1])
    held = sparse.lil_matrix(stiffness)
    held[2 * ligament, 2 * ligament] += 2.0 * CONTACT * area
    factor = splu(held.tocsc()[free][:, free])
    place = np.searchsorted(free, 2 * ligament)
    ends = np.zeros((len(free), num + 1))
    ends[place, np.arange(num + 1)] = 1.0
    by_force = factor.solve(ends)
    by_load = factor.solve(-stiffness[free][:, [loaded]].toarray().ravel())
    u, widest, rows = np.zeros(num + 1), np.full(num + 1, STRENGTH / CONTACT), []
    whole = np.zeros(2 * number.size)
    for down in -deflection * np.arange(1, steps + 1) / steps:
        for _ in range(50):
            traction, slope = tractions(law, 2.0 * u, widest)
            left = (
                u
                - by_force[place] @ (area * (2.0 * CONTACT * u - traction))
                - by_load[place] * down
            )
            change = (area * 2.0 * (CONTACT - slope)) * by_force[place]
            correction = np.linalg.solve(np.eye(num + 1) - change, left)
            u = u - correction
            if np.abs(correction).max() < 1e-12:
                break
        else:
            raise ArithmeticError("the cohesive beam does not converge")
        widest = np.maximum(widest, 2.0 * u)
        traction, _ = tractions(law, 2.0 * u, widest)
        whole[free] = by_force @ (area * (2.0 * CONTACT * u - traction)) + by_load * down
        whole[loaded] = down
        rows.append((-down, -whole[tip], -2.0 * (stiffness[loaded] @ whole)[0]))
    return BeamCurve(*np.array(rows).T)


def tractions(law: Law, opening: np.ndarray, widest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Traction and slope: stiff before the crack, on the law beyond its widest opening so far,
    between them on the line to the origin.
    """
    results = []
    for w, largest in zip(opening, widest, strict=True):
        first = STRENGTH / CONTACT
        if w >= largest:
            results.append(law(w - first))
        else:
            slope = law(largest - first)[0] / largest if w > 0.0 else CONTACT
            results.append((slope * w, slope))
    return tuple(np.array(results).T)
