"""Pairs of blocks under exact solutions: loads and errors of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from exact_fields import Field
from harness import Run
from joint_decks import static
from mesh_pairs import Pair

FACET = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])  # corners in natural coordinates
BRICK = np.array([(*corner, k) for k in (-1, 1) for corner in FACET])
# Points of bricks in the order of the program: the first coordinate runs fastest.
POINTS = np.array([(i, j, k) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]) / np.sqrt(3.0)
COMPONENTS = ("11", "22", "33", "12", "13", "23")
# Down to round-off, where the iteration would stop at 1e-6 of the loads.
SHARP = "*CONTROLS, RESIDUAL=1e-12, INCREMENT=1e-11, ITERATIONS=50\n"


@dataclass
class Loaded:
    """Steps of a pair, each loaded on all its outer faces by the tractions of an exact solution and
    held on its far face where the solution has it."""

    pair: Pair
    fields: dict[str, Field]
    held: str = "FAR"
    more_forces: dict[str, np.ndarray] = field(default_factory=dict)  # by step (nodes, 3) [N]

    def displacement(self, name: str) -> np.ndarray:
        """Exact, at all nodes (nodes, 3) [m]."""
        x, solution = self.pair.local, self.fields[name]
        u = solution.displacement(x)
        upper = self.pair.high.ravel()
        u[upper] += solution.jump(x[upper])
        return u @ self.pair.turn.T

    def forces(self, name: str) -> np.ndarray:
        """Of the outer faces (nodes, 3) [N]."""
        facets = np.array(self.pair.outer_faces())
        total = np.zeros_like(self.pair.x)
        np.add.at(total, facets, traction_forces(self.pair.local[facets], self.fields[name].stress))
        return total @ self.pair.turn.T + self.more_forces.get(name, 0.0)

    def step(self, name: str, requests: str) -> str:
        """A static step."""
        held, u = self.pair.mesh.node_sets[self.held], self.displacement(name)
        forces = self.forces(name)
        forces[held] = 0.0
        supports = "".join(
            f"{n + 1}, {i + 1}, {i + 1}, {u[n, i]}\n" for n in held for i in range(3)
        )
        loaded = np.nonzero(np.abs(forces).max(axis=1))[0]
        loads = "".join(f"{n + 1}, {i + 1}, {forces[n, i]}\n" for n in loaded for i in range(3))
        cards = f"{SHARP}*BOUNDARY, OP=NEW\n{supports}*CLOAD, OP=NEW\n{loads}{requests}"
        return static(cards, name=f"S{name}")

    def deck(self, connection: str, requests: str = "") -> str:
        """The pair, what joins it, and the steps."""
        requests += (
            "*NODE PRINT, NSET=ALL\nU\n*EL PRINT, ELSET=LOWER\nS\n*EL PRINT, ELSET=UPPER\nS\n"
        )
        return self.pair.deck(
            connection + "".join(self.step(name, requests) for name in self.fields)
        )

    def wrong_displacement(self, run: Run, name: str) -> np.ndarray:
        """Error at the nodes of ALL (nodes, 3) at the end of a step."""
        table = run.csv("node_ALL")
        now = at_end(table, 1 + list(self.fields).index(name))
        u = np.stack([table[f"U{i}"][now] for i in (1, 2, 3)], axis=1)
        return u - self.displacement(name)[table["node"][now].astype(int) - 1]

    def found_stress(self, run: Run, name: str) -> np.ndarray:
        """At all points of both blocks (points, 6) at the end of a step."""
        tables = [run.csv(f"el_{block}") for block in ("LOWER", "UPPER")]
        number = 1 + list(self.fields).index(name)
        return np.concatenate(
            [np.stack([t[f"S{c}"][at_end(t, number)] for c in COMPONENTS], axis=1) for t in tables]
        )

    def errors_of_uniform_stress(self, run: Run) -> tuple[float, float]:
        """Largest errors of all steps: of a stress over the largest, of a displacement likewise."""
        worst_stress = worst_u = 0.0
        for name, solution in self.fields.items():
            local = solution.stress(np.zeros(3))
            exact = voigt(self.pair.turn @ local @ self.pair.turn.T)
            wrong = np.abs(self.found_stress(run, name) - exact).max() / np.abs(local).max()
            worst_stress = max(worst_stress, float(wrong))
            wrong = np.abs(self.wrong_displacement(run, name)).max()
            worst_u = max(worst_u, float(wrong / np.abs(self.displacement(name)).max()))
        return worst_stress, worst_u

    def energy_error(self, run: Run, name: str) -> float:
        """Error of the stress in the norm of its energy, over that of the stress."""
        x, weight = points_of_bricks(self.pair.local[self.pair.mesh.bricks])
        turn = self.pair.turn
        exact = voigt(turn @ self.fields[name].stress(x) @ turn.T).reshape(-1, 6)
        wrong = self.found_stress(run, name) - exact
        return float(np.sqrt(energy(wrong, weight, self.pair) / energy(exact, weight, self.pair)))

    def displacement_error(self, run: Run, name: str) -> float:
        """Root mean square of the error at the nodes, over that of the displacement."""
        wrong = self.wrong_displacement(run, name)
        right = self.displacement(name)
        return float(np.sqrt(np.mean(wrong**2) / np.mean(right**2)))


def points_of_bricks(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places (bricks, 8, 3) and weights (bricks * 8) of the points of bricks x (bricks, 8, 3)."""
    places, weights = [], []
    for point in POINTS:
        factor = 1.0 + BRICK * point
        places.append(np.einsum("a,eai->ei", factor.prod(axis=1) / 8.0, x))
        slope = BRICK * np.stack(
            [factor[:, 1] * factor[:, 2], factor[:, 0] * factor[:, 2], factor[:, 0] * factor[:, 1]],
            axis=1,
        )
        weights.append(np.linalg.det(np.einsum("ai,eaj->eij", slope / 8.0, x)))
    return np.stack(places, axis=1), np.stack(weights, axis=1).ravel()


def energy(stress: np.ndarray, weight: np.ndarray, pair: Pair) -> float:
    """Twice the complementary energy of stresses (points, 6) [J]."""
    trace = stress[:, :3].sum(axis=1)
    squares = (stress[:, :3] ** 2).sum(axis=1) + 2.0 * (stress[:, 3:] ** 2).sum(axis=1)
    density = ((1.0 + pair.poisson) * squares - pair.poisson * trace**2) / pair.young
    return float(density @ weight)


def at_end(table, step: int) -> np.ndarray:
    """Rows of the last increment of a step."""
    rows = table["step"] == step
    assert rows.any()
    return rows & (table["increment"] == table["increment"][rows].max())


def traction_forces(x: np.ndarray, stress: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Forces (facets, 4, 3) of the tractions stress * n on facets x, outward by their order.

    3 x 3 points: exact on flat or twisted facets for uniform stresses, and up to cubic ones on
    parallelograms.
    """
    total = np.zeros_like(x)
    places, weights = np.polynomial.legendre.leggauss(3)
    for (xi, w1), (eta, w2) in product(zip(places, weights, strict=True), repeat=2):
        factor = 1.0 + FACET * np.array([xi, eta])
        shape = 0.25 * factor.prod(axis=1)
        along = np.einsum("a,fai->fi", 0.25 * FACET[:, 0] * factor[:, 1], x)
        across = np.einsum("a,fai->fi", 0.25 * FACET[:, 1] * factor[:, 0], x)
        traction = np.einsum("fij,fj->fi", stress(shape @ x), np.cross(along, across))
        total += w1 * w2 * shape[:, None] * traction[:, None, :]
    return total


def bare_forces(pair: Pair, stress: np.ndarray) -> np.ndarray:
    """Forces (nodes, 3) of a uniform stress on those parts of the two faces that lie bare, for
    grids whose lines are parallel to the outline; `stress` in the axes of the pair."""
    local = pair.local
    boxes = [local[n[:, :, k]][..., :2].reshape(-1, 2) for n, k in ((pair.low, -1), (pair.high, 0))]
    low = np.maximum(boxes[0].min(axis=0), boxes[1].min(axis=0))
    high = np.minimum(boxes[0].max(axis=0), boxes[1].max(axis=0))
    total = np.zeros_like(local)
    for name in ("LOWER", "UPPER"):
        for brick, face in pair.mesh.surfaces[name]:
            nodes = pair.outward(brick, face)
            total[nodes] += traction_forces(local[nodes][None], lambda x: stress[None])[0]
            total[nodes] -= covered_forces(local[nodes], stress, low, high)
    return total @ pair.turn.T


def covered_forces(x: np.ndarray, stress: np.ndarray, low, high) -> np.ndarray:
    """Forces (4, 3) of a uniform stress on the part of a rectangular facet within low..high (2)."""
    first, last = x[:, :2].min(axis=0), x[:, :2].max(axis=0)
    start, end = np.maximum(first, low), np.minimum(last, high)
    if (end <= start).any():
        return np.zeros((4, 3))
    middle, size = 0.5 * (start + end), end - start
    # bilinear over a rectangle: the middle of it times its area
    share = np.where(x[:, :2] > 0.5 * (first + last), middle - first, last - middle) / (
        last - first
    )
    normal = np.cross(x[2] - x[0], x[3] - x[1])
    return np.outer(share.prod(axis=1) * size.prod(), stress @ (normal / np.linalg.norm(normal)))


def voigt(tensor: np.ndarray) -> np.ndarray:
    """11, 22, 33, 12, 13, 23 of symmetric tensors (..., 3, 3)."""
    return tensor[..., [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
