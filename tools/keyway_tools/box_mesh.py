"""Meshes of mapped boxes: bars, blocks and slices for small decks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .mesh_data import BrickMesh


def box_mesh(
    counts: tuple[int, int, int], place: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
) -> tuple[BrickMesh, np.ndarray]:
    """A box of bricks and its node numbers, shape (nx + 1, ny + 1, nz + 1).

    `place` turns the shares 0..1 along the box's three directions into coordinates (..., 3) [m].
    """
    shares = np.meshgrid(*(np.linspace(0.0, 1.0, count + 1) for count in counts), indexing="ij")
    number = np.arange(np.prod([count + 1 for count in counts])).reshape(shares[0].shape)
    low, high = slice(None, -1), slice(1, None)
    ring = ((low, low), (high, low), (high, high), (low, high))
    corners = [number[i, j, k] for k in (low, high) for i, j in ring]
    bricks = np.stack(corners, axis=-1).reshape(-1, 8)
    x = place(*shares).reshape(-1, 3).round(9)  # readable decks
    return BrickMesh(x, bricks, np.zeros((0, 8), dtype=int)), number


def stretched(length: tuple[float, float, float]):
    """Place of a straight box with one corner at the origin."""
    return lambda a, b, c: np.stack([a * length[0], b * length[1], c * length[2]], axis=-1)


def add_base_joint(mesh: BrickMesh, bottom: np.ndarray) -> np.ndarray:
    """Put the box on a joint: master nodes of their own below the bottom nodes (nx + 1, ny + 1).

    The normal points up, from the base (master) into the box (slave). Returns the base's nodes.
    """
    base = len(mesh.x) + np.arange(bottom.size).reshape(bottom.shape)
    mesh.x = np.concatenate((mesh.x, mesh.x[bottom.ravel()]))
    faces = [
        np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
        for n in (base, bottom)
    ]
    mesh.joints = np.concatenate(faces, axis=1)
    return base


def quads(n: np.ndarray) -> list[tuple[int, int, int, int]]:
    """Corner nodes of the facets of a grid of nodes."""
    rows, columns = n.shape
    return [
        (int(n[i, j]), int(n[i + 1, j]), int(n[i + 1, j + 1]), int(n[i, j + 1]))
        for i in range(rows - 1)
        for j in range(columns - 1)
    ]
