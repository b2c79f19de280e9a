"""Proof that a saved static problem has no equilibrium: the safe theorem of limit analysis.

The jumps follow v = c + G W (k v - t), theory.md, 8 (W: weight times area). A motion of blocks y
that only the joints resist is a vector with G W k y = y. The product of both sides with W k y
leaves y . W t = y . W k c: tractions in equilibrium with the loads. No equilibrium exists where no
tractions within the limits of the joints fulfil these equations. A linear program finds the least
error that such tractions leave. Its cones of friction have flat sides outside the true cone, so
that an error above zero is a proof.

Source: Drucker, Prager & Greenberg (1952), Quarterly of Applied Mathematics 9, 381-389.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
from scipy import sparse
from scipy.optimize import linprog

SIDES = 16  # of the polygon around the circle of friction
FREE = 1e-8  # a motion with G W k y = (1 - FREE) y or more is one of free blocks


@dataclass
class Limits:
    """Of the points: stiffness (points, 3) [Pa/m], friction, cohesion and strength [Pa]."""

    stiffness: np.ndarray
    friction: np.ndarray
    cohesion: np.ndarray
    strength: np.ndarray


def least_error(path: Path, problem: int) -> float:
    """Least error of the equilibrium of all blocks with tractions within the limits of the joints.

    Relative to the load; 0 where such tractions exist.
    """
    with h5py.File(path) as file:
        weights = file["operator/weight"][()] * file["operator/area"][:]
        compliance = read_compliance(file)
        limits = read_limits(file, problem)
        closed = file[f"problem_{problem}/closed_jump"][:]
    root = np.sqrt(weights[:, None] * limits.stiffness).ravel()
    values, vectors = np.linalg.eigh(root[:, None] * compliance * root)
    free = vectors[:, values > 1.0 - FREE].T
    load = free @ (root * closed.ravel())
    forces = free * np.sqrt(weights[:, None] / limits.stiffness).ravel()
    scale = np.linalg.norm(load)
    return solve_program(forces / scale, load / scale, limits)


def read_compliance(file: h5py.File) -> np.ndarray:
    """G (rows, rows) [m/N], which is saved as the columns of its lower triangle."""
    size = 3 * len(file["operator/area"])
    compliance = np.zeros((size, size))
    rows, columns = np.triu_indices(size)
    compliance[rows, columns] = compliance[columns, rows] = file["operator/compliance"][:]
    return compliance


def read_limits(file: h5py.File, problem: int) -> Limits:
    """Laws of all points. The strength of a broken point is zero."""
    first = file["operator/first_point"][:] - 1
    points = first[-1]
    limits = Limits(np.zeros((points, 3)), *(np.zeros(points) for _ in range(3)))
    for joint, (start, end) in enumerate(pairwise(first), start=1):
        law = file[f"problem_{problem}/joint_{joint}"]
        limits.stiffness[start:end, 0] = law["normal_stiffness"][()]
        limits.stiffness[start:end, 1:] = law["tangent_stiffness"][()]
        limits.friction[start:end] = law["friction"][()]
        limits.cohesion[start:end] = law["cohesion"][()]
        limits.strength[start:end] = np.where(law["is_broken"][:] != 0, 0.0, law["strength"][()])
    if limits.strength.any():
        raise ValueError(
            "a bonded point has no limit of shear: the program does not have this case"
        )
    return limits


def solve_program(forces: np.ndarray, load: np.ndarray, limits: Limits) -> float:
    """Least s with |forces t - load| <= s and t in the cones: t_n <= 0, |t_t| <= c - mu t_n."""
    points = len(limits.friction)
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    sides = np.column_stack([np.zeros(SIDES), np.cos(angles), np.sin(angles)])
    cones = sparse.block_diag([sides + np.array([mu, 0.0, 0.0]) for mu in limits.friction])
    error = np.ones((len(load), 1))
    matrix = sparse.bmat([[cones, None], [forces, -error], [-forces, -error]], format="csr")
    bounds = np.concatenate([np.repeat(limits.cohesion, SIDES), load, -load])
    box = [(None, 0.0), (None, None), (None, None)] * points + [(0.0, None)]
    cost = np.zeros(3 * points + 1)
    cost[-1] = 1.0
    found = linprog(cost, A_ub=matrix, b_ub=bounds, bounds=box, method="highs")
    if found.status != 0:
        raise RuntimeError(f"the linear program has no solution: {found.message}")
    return found.fun
