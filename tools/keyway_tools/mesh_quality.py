"""Checks of a brick mesh: Jacobians, shape, volumes, fit of neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mesh_data import BrickMesh

_CORNER = np.array(
    [
        (-1, -1, -1),
        (1, -1, -1),
        (1, 1, -1),
        (-1, 1, -1),
        (-1, -1, 1),
        (1, -1, 1),
        (1, 1, 1),
        (-1, 1, 1),
    ],
    dtype=float,
)
_EDGES = np.array(
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
)


def shape_derivatives(point: np.ndarray) -> np.ndarray:
    """Derivatives of the eight shape functions at a local point; shape (3, 8)."""
    terms = 1.0 + _CORNER * point
    rows = [_CORNER[:, i] * np.delete(terms, i, axis=1).prod(axis=1) / 8.0 for i in range(3)]
    return np.array(rows)


def jacobians(mesh: BrickMesh, points: np.ndarray) -> np.ndarray:
    """Determinant of each brick's map at some local points; shape (bricks, points) [m3]."""
    derivatives = np.array([shape_derivatives(point) for point in points])
    maps = np.einsum("qia,eaj->eqij", derivatives, mesh.x[mesh.bricks])
    return np.linalg.det(maps)


def corner_jacobians(mesh: BrickMesh) -> np.ndarray:
    """Determinants at the corners; NaN at the collapsed corners of wedges, where they are zero."""
    found = jacobians(mesh, _CORNER)
    for corner, other in ((2, 3), (3, 2), (6, 7), (7, 6)):
        found[mesh.bricks[:, corner] == mesh.bricks[:, other], corner] = np.nan
    return found


def gauss_points() -> np.ndarray:
    """The 2x2x2 rule: points; every weight is 1."""
    return _CORNER / np.sqrt(3.0)


def volumes(mesh: BrickMesh) -> np.ndarray:
    """Volume of each brick [m3]."""
    return jacobians(mesh, gauss_points()).sum(axis=1)


@dataclass(frozen=True)
class Quality:
    """Figures of one set of bricks."""

    name: str
    count: int
    wedges: int
    volume: float  # [m3]
    smallest_jacobian: float  # at corners and integration points [m3]
    smallest_scaled: float  # corner Jacobian over the product of its three edges; 1 is a box
    scaled_5_percent: float
    largest_aspect: float  # longest over shortest edge of a brick
    mean_edge: float  # [m]


def measure(mesh: BrickMesh, name: str) -> Quality:
    """Figures of the bricks of one set."""
    members = mesh.brick_sets[name]
    part = BrickMesh(mesh.x, mesh.bricks[members], mesh.joints)
    corner = corner_jacobians(part)
    inside = jacobians(part, gauss_points())
    edge = np.linalg.norm(
        part.x[part.bricks[:, _EDGES[:, 0]]] - part.x[part.bricks[:, _EDGES[:, 1]]], axis=2
    )
    edge[edge == 0.0] = np.nan
    scaled = np.full(corner.shape, np.nan)
    for k in range(8):
        sides = [e for e, ends in enumerate(_EDGES) if k in ends]
        scaled[:, k] = 8.0 * corner[:, k] / edge[:, sides].prod(axis=1)
    return Quality(
        name=name,
        count=len(members),
        wedges=int((part.bricks[:, 2] == part.bricks[:, 3]).sum()),
        volume=float(inside.sum()),
        smallest_jacobian=float(min(np.nanmin(corner), inside.min())),
        smallest_scaled=float(np.nanmin(scaled)),
        scaled_5_percent=float(np.percentile(np.nanmin(scaled, axis=1), 5.0)),
        largest_aspect=float((np.nanmax(edge, axis=1) / np.nanmin(edge, axis=1)).max()),
        mean_edge=float(np.nanmean(edge)),
    )


def find_faults(mesh: BrickMesh) -> list[str]:
    """Faults of a mesh as text; an empty list without faults."""
    faults = []
    corner = corner_jacobians(mesh)
    for brick, place in np.argwhere(corner <= 0.0)[:5]:
        faults.append(
            f"brick {brick + 1}: Jacobian {corner[brick, place]:.3g} m3 at corner {place + 1}"
        )
    if len(mesh.joints):
        gap = np.abs(mesh.x[mesh.joints[:, :4]] - mesh.x[mesh.joints[:, 4:]]).max()
        if gap > 0.0:
            faults.append(f"joint faces do not coincide: distance {gap:.3g} m")
    used = np.zeros(len(mesh.x), dtype=bool)
    used[mesh.bricks] = True
    used[mesh.quads] = True
    if not used.all():
        faults.append(f"{(~used).sum()} nodes belong to no brick or quad")
    return faults


def report(mesh: BrickMesh) -> str:
    """Table of the figures of every set, for the screen and the deck's header."""
    heads = ("set", "bricks", "wedges", "volume m3", "min Jac. m3", "min scaled", "5 % scaled")
    heads += ("max aspect", "mean edge m")
    rows = [heads]
    for name in mesh.brick_sets:
        q = measure(mesh, name)
        row = (name, f"{q.count}", f"{q.wedges}", f"{q.volume:.6g}", f"{q.smallest_jacobian:.4g}")
        row += (f"{q.smallest_scaled:.3f}", f"{q.scaled_5_percent:.3f}")
        rows.append((*row, f"{q.largest_aspect:.1f}", f"{q.mean_edge:.2f}"))
    widths = [max(len(row[k]) for row in rows) for k in range(len(heads))]
    return "\n".join(
        "  ".join(word.rjust(width) for word, width in zip(row, widths, strict=True))
        for row in rows
    )
