"""Stiffness of a box of equal bricks, for checks that need matrices the program does not write."""

from __future__ import annotations

import numpy as np
from keyway_tools.box_mesh import box_mesh, stretched
from loaded_pairs import BRICK, POINTS
from scipy import sparse


def brick_stiffness(size: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """(24, 24) of a brick with edges `size` [m], 2 x 2 x 2 points; unknowns by node, then axis."""
    shear = young / (2.0 * (1.0 + poisson))
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    law = np.diag([2.0 * shear] * 3 + [shear] * 3)
    law[:3, :3] += lame
    total = np.zeros((24, 24))
    for point in POINTS:
        factor = 1.0 + BRICK * point
        others = np.stack([factor[:, [1, 2]], factor[:, [0, 2]], factor[:, [0, 1]]], axis=1)
        slope = BRICK * others.prod(axis=2) / 8.0 * (2.0 / size)
        strain = np.zeros((6, 8, 3))
        for row, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
            strain[row, :, i] += slope[:, j]
            if i != j:
                strain[row, :, j] += slope[:, i]
        b = strain.reshape(6, 24)
        total += b.T @ law @ b * size.prod() / 8.0
    return total


def box_stiffness(counts, size, young: float, poisson: float):
    """Sparse stiffness of a straight box and its node numbers (na + 1, nb + 1, nc + 1)."""
    mesh, number = box_mesh(counts, stretched(size))
    one = brick_stiffness(np.array(size) / np.array(counts), young, poisson)
    unknowns = (3 * mesh.bricks[:, :, None] + np.arange(3)).reshape(-1, 24)
    rows = np.repeat(unknowns, 24, axis=1).ravel()
    columns = np.tile(unknowns, (1, 24)).ravel()
    values = np.tile(one.ravel(), len(unknowns))
    return sparse.coo_matrix((values, (rows, columns))).tocsc(), number
