"""Faces of bricks: which bricks own a face, and which faces two bricks share."""

from __future__ import annotations

import numpy as np

from ..mesh_data import BRICK_FACES


def corners_of(face: int) -> tuple[int, ...]:
    """Corner positions of face 1..6 of a brick."""
    return BRICK_FACES[face - 1]


def sorted_faces(bricks: np.ndarray) -> np.ndarray:
    """Nodes of the faces 1..6 of all bricks, ascending; shape (bricks, 6, 4).

    A face of three corners repeats one of them, which becomes -1 so that it equals a triangle. A
    face of two corners (the edge of a wedge) is all -2.
    """
    faces = np.sort(bricks[:, np.array(BRICK_FACES)], axis=2)
    repeated = faces[:, :, 1:] == faces[:, :, :-1]
    count = repeated.sum(axis=2)
    faces[:, :, 1:][repeated] = -1
    faces[count > 1] = -2
    return np.sort(faces, axis=2)


class FaceOwners:
    """Looks up the bricks of a face by its nodes."""

    def __init__(self, bricks: np.ndarray) -> None:
        faces = sorted_faces(bricks)
        self._owners: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        for brick, rows in enumerate(faces.tolist()):
            for face, nodes in enumerate(rows, 1):
                if nodes[0] != -2:
                    self._owners.setdefault(tuple(nodes), []).append((brick, face))

    def of(self, face: np.ndarray) -> list[tuple[int, int]]:
        """(brick, face 1..6) of each brick with this face."""
        return self._owners.get(tuple(sorted(face.tolist())), [])
