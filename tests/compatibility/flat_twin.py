"""Decks with parts and their flat twins, for the tests: blocks of solids, moved and rotated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from harness import Run


def last_field(run: Run, name: str) -> np.ndarray:
    """A field of nodes (nodes, components) at the last increment that job.h5 holds."""
    found = [
        group[name][:]
        for step in run.results.file["steps"].values()
        for group in step.get("increments", {}).values()
        if name in group
    ]
    return found[-1]


@dataclass(frozen=True)
class Block:
    """A block of n[0] x n[1] x n[2] solids with the lengths of `size` [m]."""

    n: tuple[int, int, int]
    size: tuple[float, float, float]

    @property
    def nodes(self) -> np.ndarray:
        """(nodes, 3) coordinates; x runs first."""
        axes = [np.linspace(0, s, k + 1) for s, k in zip(self.size, self.n, strict=True)]
        grid = np.meshgrid(*axes, indexing="ij")
        return np.stack([g.ravel(order="F") for g in grid], axis=1)

    @property
    def solids(self) -> np.ndarray:
        """(elements, 8) numbers of nodes from 1."""
        a, b, c = (k + 1 for k in self.n)
        number = np.arange(1, a * b * c + 1).reshape((a, b, c), order="F")
        low = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
        corners = [layer[..., :-1] for layer in low] + [layer[..., 1:] for layer in low]
        return np.stack([k.ravel(order="F") for k in corners], axis=1)

    def nodes_at(self, axis: int, value: float) -> list[int]:
        """Numbers of the nodes of a plane."""
        return [int(k) + 1 for k in np.flatnonzero(self.nodes[:, axis] == value)]

    def layer(self, top: bool) -> list[int]:
        """Numbers of the elements of the lowest or the highest layer."""
        per_layer = self.n[0] * self.n[1]
        first = per_layer * (self.n[2] - 1) if top else 0
        return list(range(first + 1, first + per_layer + 1))


def turn(x: np.ndarray, point, axis, degrees: float) -> np.ndarray:
    """Points (n, 3) rotated about an axis, by Rodrigues' rotation matrix."""
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    skew = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    angle = np.radians(degrees)
    matrix = np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
    return (x - point) @ matrix.T + point


def node_lines(x: np.ndarray, first: int = 1) -> str:
    rows = (f"{first + k}, {p[0]:.17g}, {p[1]:.17g}, {p[2]:.17g}" for k, p in enumerate(x))
    return "\n".join(rows)


def element_lines(solids: np.ndarray, first: int = 1) -> str:
    return "\n".join(f"{first + k}, " + ", ".join(map(str, row)) for k, row in enumerate(solids))


def id_lines(ids, per_line: int = 16) -> str:
    """Ids as Abaqus/CAE writes them."""
    ids = list(ids)
    rows = (ids[k : k + per_line] for k in range(0, len(ids), per_line))
    return "\n".join(", ".join(map(str, row)) for row in rows)
