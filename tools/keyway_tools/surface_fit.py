"""Areas and distances of two meshed surfaces, for the checks of meshes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mesh_data import BrickMesh

_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
_NEIGHBOURS = 12  # facets searched for the nearest point
AREAS_APART = 0.02  # of the areas of two sides that meet, over the larger one
DISTANCE = 0.05  # of their largest distance over the root of the area


@dataclass(frozen=True)
class Fit:
    """Figures of a pair of surfaces."""

    slave_area: float  # [m2]
    master_area: float  # [m2]
    largest_distance: float  # of the slave's nodes and facet centres from the master [m]


def _shape(r: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shape functions of a quad and their derivatives, last axis 4."""
    values = np.stack(
        [(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)], axis=-1
    )
    by_r = np.stack([-(1 - s), 1 - s, 1 + s, -(1 + s)], axis=-1)
    by_s = np.stack([-(1 - r), -(1 + r), 1 + r, 1 - r], axis=-1)
    return values / 4.0, by_r / 4.0, by_s / 4.0


def facets_of(mesh: BrickMesh, surface: str) -> np.ndarray:
    """Corners of the facets of a surface, shape (facets, 4, 3)."""
    return np.array([mesh.x[mesh.face_nodes(*face)] for face in mesh.surfaces[surface]])


def area(facets: np.ndarray) -> float:
    """Area of bilinear facets."""
    total = 0.0
    for r in _GAUSS:
        for s in _GAUSS:
            _, by_r, by_s = _shape(np.array(r), np.array(s))
            normal = np.cross(by_r @ facets, by_s @ facets)
            total += float(np.linalg.norm(normal, axis=-1).sum())
    return total


def distance(points: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Distance of each point from the nearest of the facets, by Newton on each candidate."""
    centre = facets.mean(axis=1)
    found = np.empty(len(points))
    for number, point in enumerate(points):
        near = np.argsort(((centre - point) ** 2).sum(axis=1))[:_NEIGHBOURS]
        corners = facets[near]
        r, s = np.zeros(len(near)), np.zeros(len(near))
        for _ in range(20):
            shape, by_r, by_s = (f[:, None, :] @ corners for f in _shape(r, s))
            away = (point - shape)[:, 0]
            a, b = by_r[:, 0], by_s[:, 0]
            aa, ab, bb = (a * a).sum(-1), (a * b).sum(-1), (b * b).sum(-1)
            right_a, right_b = (a * away).sum(-1), (b * away).sum(-1)
            det = aa * bb - ab**2
            with np.errstate(divide="ignore", invalid="ignore"):  # of a facet without area: NaN
                r = np.clip(r + (bb * right_a - ab * right_b) / det, -1.0, 1.0)
                s = np.clip(s + (aa * right_b - ab * right_a) / det, -1.0, 1.0)
        nearest = (_shape(r, s)[0][:, None, :] @ corners)[:, 0]
        found[number] = np.linalg.norm(nearest - point, axis=-1).min()
    return found


def fit(mesh: BrickMesh, slave: str, master: str) -> Fit:
    """Figures of two surfaces of a mesh."""
    one, other = facets_of(mesh, slave), facets_of(mesh, master)
    points = np.unique(np.concatenate((one.reshape(-1, 3), one.mean(axis=1))), axis=0)
    return Fit(area(one), area(other), float(distance(points, other).max()))


def pairs_of(mesh: BrickMesh) -> dict[str, tuple[str, str]]:
    """Names of the surfaces that meet at joints and ties."""
    return {**mesh.surface_joints, **mesh.ties}


def check_fit(name: str, found: Fit) -> None:
    """Raises ValueError for two surfaces that do not lie on each other.

    Areas of different meshes of a curved face differ by less than AREAS_APART.
    """
    areas = found.slave_area, found.master_area
    is_level = abs(areas[0] - areas[1]) <= AREAS_APART * max(areas)  # False for NaN
    if not (is_level and found.largest_distance <= DISTANCE * max(areas) ** 0.5):
        raise ValueError(
            f"{name}: its two sides do not fit: areas {areas[0]:.6g} and {areas[1]:.6g} m2, "
            f"{found.largest_distance:.2g} m apart (nan: a face without area); expected equal "
            f"areas to {100 * AREAS_APART:g} % and sides that lie on each other"
        )


def fit_report(mesh: BrickMesh) -> str:
    """A line for every pair of surfaces that meet. Raises ValueError where two do not fit."""
    lines = []
    for name, (slave, master) in pairs_of(mesh).items():
        facets = len(mesh.surfaces[slave]), len(mesh.surfaces[master])
        found = fit(mesh, slave, master)
        check_fit(name, found)
        lines.append(
            f"{name}: {facets[0]} facets of {slave} on {facets[1]} of {master}, areas "
            f"{found.slave_area:.6g} and {found.master_area:.6g} m2, at most "
            f"{found.largest_distance:.1e} m apart"
        )
    return "\n".join(lines)
