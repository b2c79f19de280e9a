"""Joint elements: between two coincident groups of faces, or where a group cuts the mesh open."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .faces import FaceOwners, corners_of, sorted_faces
from .grouped_mesh import GroupedMesh, MeshError

COINCIDENT = 1.0e-6  # distance of nodes at the same place, over the size of the joint


def split_mesh(mesh: GroupedMesh, names: list[str]) -> dict[str, np.ndarray]:
    """Cuts the mesh open along groups of faces inside it; joint elements (joints, 8) by group.

    Each node gets as many copies as the cuts make parts of the bricks around it. Nodes of an edge
    of a cut inside a body stay whole, as at the end of a crack.
    """
    owners = FaceOwners(mesh.bricks)
    cuts = {name: cut_faces(mesh, name, owners) for name in names}
    pairs = np.concatenate([np.array(c).reshape(-1, 2, 2) for c in cuts.values()])
    before = mesh.bricks.copy()
    separate(mesh, pairs)
    return {name: joint_elements(mesh, before, cut) for name, cut in cuts.items()}


def cut_faces(mesh: GroupedMesh, name: str, owners: FaceOwners) -> list:
    """The two (brick, face) pairs of each face of a group."""
    found = []
    for face in mesh.faces[group_of(mesh, name)]:
        pairs = owners.of(face)
        if len(pairs) != 2:
            centre = mesh.x[face[face >= 0]].mean(axis=0)
            raise MeshError(
                f"group {name}: {len(pairs)} solids have the face at {np.round(centre, 3).tolist()}"
                "; expected a face inside the mesh, between two solids"
            )
        if min(face) < 0:
            raise MeshError(f"group {name} has triangles; expected quads, for JOINT8 elements")
        found.append(pairs)
    return found


def group_of(mesh: GroupedMesh, name: str) -> np.ndarray:
    """The faces of a group."""
    if name not in mesh.face_groups:
        known = ", ".join(mesh.face_groups) or "none"
        raise MeshError(f"no group of faces '{name}'; the mesh has {known}")
    return mesh.face_groups[name]


def separate(mesh: GroupedMesh, cuts: np.ndarray) -> None:
    """Gives the parts of the bricks around each node of the cuts their own nodes.

    `cuts`: (faces, 2 sides, (brick, face)).
    """
    at_cut = np.zeros(len(mesh.x), dtype=bool)
    is_cut = {(int(b), int(f)) for b, f in cuts.reshape(-1, 2)}
    for brick, face in is_cut:
        at_cut[mesh.bricks[brick, list(corners_of(face))]] = True
    # a vertex of the graph is a (brick, node) near a cut; bricks that share a whole face are joined
    vertex, index = {}, []
    for brick in np.flatnonzero(at_cut[mesh.bricks].any(axis=1)):
        for node in np.unique(mesh.bricks[brick]):
            if at_cut[node]:
                vertex[(int(brick), int(node))] = len(index)
                index.append((int(brick), int(node)))
    links = shared_nodes(mesh, vertex, is_cut)
    ends = np.array(links, dtype=int).reshape(-1, 2).T
    graph = coo_matrix((np.ones(ends.shape[1]), tuple(ends)), shape=(len(index), len(index)))
    _, part = connected_components(graph, directed=False)
    copies: dict[tuple[int, int], int] = {}
    added: list[np.ndarray] = []
    first_part: dict[int, int] = {}
    original = mesh.bricks.copy()
    for (brick, node), own in zip(index, part.tolist(), strict=True):
        if first_part.setdefault(node, own) == own:
            continue
        if (node, own) not in copies:
            copies[(node, own)] = len(mesh.x) + len(added)
            added.append(mesh.x[node])
        mesh.bricks[brick][original[brick] == node] = copies[(node, own)]
    if added:
        mesh.x = np.concatenate([mesh.x, np.array(added)])
    for name, members in mesh.node_groups.items():
        own = set(members.tolist())
        more = [copy for (node, _), copy in copies.items() if node in own]
        mesh.node_groups[name] = np.unique(np.concatenate([members, np.array(more, dtype=int)]))


def shared_nodes(mesh: GroupedMesh, vertex: dict, is_cut: set) -> list[tuple[int, int]]:
    """Pairs of graph vertices: the same node of two bricks with a common face that is not cut."""
    bricks = sorted({brick for brick, _ in vertex})
    faces = sorted_faces(mesh.bricks[bricks])
    seen: dict[tuple[int, ...], int] = {}
    links = []
    for brick, rows in zip(bricks, faces.tolist(), strict=True):
        for face, nodes in enumerate(rows, 1):
            if nodes[0] == -2 or (brick, face) in is_cut:
                continue
            other = seen.setdefault(tuple(nodes), brick)
            if other == brick:
                continue
            for node in nodes:
                if (brick, node) in vertex:
                    links.append((vertex[(brick, node)], vertex[(other, node)]))
    return links


def joint_elements(mesh: GroupedMesh, before: np.ndarray, cut: list) -> np.ndarray:
    """Nodes of the first side, then the nodes at the same places of the second side."""
    rows = []
    for (brick, face), (other, _) in cut:
        corners = list(corners_of(face))
        places = before[brick, corners]
        second = [mesh.bricks[other, int(np.argmax(before[other] == node))] for node in places]
        rows.append([*mesh.bricks[brick, corners], *second])
    return np.array(rows, dtype=int).reshape(-1, 8)


def join_faces(
    mesh: GroupedMesh, master: list[tuple[int, int]], slave: list[tuple[int, int]]
) -> np.ndarray | None:
    """Joint elements between (brick, face) pairs of two sides whose nodes lie at the same places.

    None where the meshes of the two sides differ: a *JOINT between surfaces is then the way.
    Raises MeshError where the sides share nodes.
    """
    ours, theirs = (
        np.array([mesh.bricks[b, list(corners_of(f))] for b, f in side]) for side in (master, slave)
    )
    if np.intersect1d(ours, theirs).size:
        raise MeshError("they share nodes; expected two faces with nodes of their own (or --split)")
    nodes, own = np.unique(theirs), np.unique(ours)
    size = np.ptp(mesh.x[nodes], axis=0).max()
    distance, nearest = cKDTree(mesh.x[nodes]).query(mesh.x[own])
    if len(ours) != len(theirs) or distance.max() > COINCIDENT * size:
        return None
    partner = dict(zip(own.tolist(), nodes[nearest].tolist(), strict=True))
    faces = {tuple(sorted(face)) for face in theirs.tolist()}
    rows = [[*face, *(partner[node] for node in face)] for face in ours.tolist()]
    if any(tuple(sorted(row[4:])) not in faces for row in rows):
        return None
    return np.array(rows, dtype=int)
