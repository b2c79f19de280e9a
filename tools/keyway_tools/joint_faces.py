"""The faces of joints as in job.h5: polygons, and the facets of the slave side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mesh_data import BRICK_FACES


@dataclass(frozen=True)
class JointFaces:
    """Polygons whose corners are weighted sums of nodes of the slave face."""

    rings: list[np.ndarray]  # corners of each polygon, from 0
    first: np.ndarray  # (corners) where a corner's nodes start
    node: np.ndarray  # positions in the mesh
    weight: np.ndarray
    facets: np.ndarray  # the slave facets whole, node positions, shape (facets, 4)

    def on_corners(self, values: np.ndarray) -> np.ndarray:
        """A quantity of all nodes (values[node], or rows) on the corners."""
        weight = self.weight if values.ndim == 1 else self.weight[:, None]
        return np.add.reduceat(weight * values[self.node], self.first, axis=0)

    @property
    def triangles(self) -> np.ndarray:
        """The polygons cut into triangles, shape (triangles, 3)."""
        return np.array(
            [(r[0], r[k], r[k + 1]) for r in self.rings for k in range(1, len(r) - 1)], dtype=int
        ).reshape(-1, 3)


def read_joint_faces(group, position: dict[int, int], mesh) -> JointFaces | None:
    """Reads the group of a joint in job.h5; None for a joint without polygons.

    `position` finds nodes by the deck's numbers; `mesh` has element_id, element_types and
    connectivity.
    """
    if "cells" not in group or len(group["cells/element"]) == 0:
        return None
    cells = group["cells"]
    rings = np.split(cells["corner"][:] - 1, cells["first"][1:-1] - 1)
    node = np.array([position[int(number)] for number in cells["node"][:]])
    elements = np.flatnonzero(np.isin(mesh.element_id, cells["element"][:]))
    facets = _slave_facets(elements, np.unique(node), mesh)
    return JointFaces(rings, cells["first_node"][:-1] - 1, node, cells["weight"][:], facets)


def _slave_facets(elements: np.ndarray, slave: np.ndarray, mesh) -> np.ndarray:
    """Slave faces of JOINT8 elements; those of solids whose nodes all belong to the joint."""
    found = []
    for element in elements:
        nodes = mesh.connectivity[element]
        if mesh.element_types[element] == "JOINT8":
            found.append(nodes[4:])
            continue
        for corners in BRICK_FACES:
            face = nodes[list(corners)]
            if len(set(face.tolist())) > 2 and np.isin(face, slave).all():
                found.append(face)
    return np.array(found, dtype=int).reshape(-1, 4)
