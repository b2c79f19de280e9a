"""A hexahedral mesh with joints, sets and surfaces: the data that the tools exchange."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

# Corner positions (from 0) of the faces S1..S6 of an 8-node brick, as CalculiX numbers them.
BRICK_FACES = (
    (0, 1, 2, 3),
    (4, 7, 6, 5),
    (0, 4, 5, 1),
    (1, 5, 6, 2),
    (2, 6, 7, 3),
    (3, 7, 4, 0),
)


@dataclass
class BrickMesh:
    """Nodes, bricks and joints; positions count from 0, deck ids are position + 1."""

    x: np.ndarray  # coordinates [m], shape (nodes, 3)
    bricks: np.ndarray  # node positions, shape (bricks, 8); a wedge repeats corners 3-4 and 7-8
    joints: np.ndarray  # node positions, shape (joints, 8): master face, slave face
    brick_sets: dict[str, np.ndarray] = field(default_factory=dict)  # positions of bricks
    # further sets of bricks, which may share some: positions
    element_sets: dict[str, np.ndarray] = field(default_factory=dict)
    joint_sets: dict[str, np.ndarray] = field(default_factory=dict)  # positions of joint elements
    node_sets: dict[str, np.ndarray] = field(default_factory=dict)  # positions of nodes
    surfaces: dict[str, list[tuple[int, int]]] = field(default_factory=dict)  # (brick, face 1..6)
    # interface quads with nodes of their own (IFACE4), shape (quads, 4)
    quads: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), dtype=int))
    quad_sets: dict[str, np.ndarray] = field(default_factory=dict)  # positions of quads
    surface_joints: dict[str, tuple[str, str]] = field(default_factory=dict)  # slave, master
    ties: dict[str, tuple[str, str]] = field(default_factory=dict)  # slave, master surface
    interfaces: dict[str, tuple[str, str]] = field(default_factory=dict)  # quad set, surface

    @property
    def joint_names(self) -> list[str]:
        """Joints of elements and joints on surfaces, in order of their names."""
        return sorted([*self.joint_sets, *self.surface_joints], key=lambda name: (len(name), name))

    def face_nodes(self, brick: int, face: int) -> np.ndarray:
        """Nodes of face 1..6 of a brick."""
        return self.bricks[brick, BRICK_FACES[face - 1]]

    def surface_nodes(self, name: str) -> np.ndarray:
        """Nodes of a surface, ascending, each once."""
        faces = [self.face_nodes(brick, face) for brick, face in self.surfaces[name]]
        return np.unique(np.concatenate(faces))

    def exterior_faces(self) -> dict[frozenset[int], list[tuple[int, int]]]:
        """Faces by their nodes, with the (brick, face) pairs that own them; edges are left out."""
        owners: dict[frozenset[int], list[tuple[int, int]]] = {}
        for brick in range(len(self.bricks)):
            for face in range(1, 7):
                nodes = frozenset(self.face_nodes(brick, face).tolist())
                if len(nodes) > 2:
                    owners.setdefault(nodes, []).append((brick, face))
        return {nodes: pairs for nodes, pairs in owners.items() if len(pairs) == 1}
