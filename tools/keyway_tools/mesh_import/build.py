"""From a mesh with groups to the mesh part of a deck."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..mesh_data import BrickMesh
from ..mesh_quality import volumes
from .faces import FaceOwners, corners_of
from .grouped_mesh import GroupedMesh, MeshError
from .joints import join_faces, split_mesh

# Corners of a brick whose bottom and top are exchanged.
TURNED = (4, 5, 6, 7, 0, 1, 2, 3)


@dataclass
class Imported:
    """The mesh for a deck, and what was done to that of the file."""

    mesh: BrickMesh
    element_sets: dict[str, np.ndarray] = field(default_factory=dict)  # further sets of bricks
    notes: list[str] = field(default_factory=list)


def import_mesh(
    grouped: GroupedMesh, splits: list[str], pairs: dict[str, tuple[str, str]]
) -> Imported:
    """Bricks by group, joints, surfaces and sets of nodes. Raises MeshError.

    `splits`: groups of faces along which the mesh is cut open; `pairs`: master and slave group of
    joints between faces at the same place.
    """
    notes = [*grouped.notes, *turn_bricks(grouped)]
    surfaces = find_surfaces(grouped, splits, notes)
    joints = split_mesh(grouped, splits) if splits else {}
    sides: dict[str, tuple[str, str]] = {}
    for name, (master, slave) in pairs.items():
        elements = join_sides(grouped, surfaces, name, master, slave)
        if elements is None:
            sides[name] = (slave, master)
            notes.append(f"joint {name}: the meshes of {master} and {slave} differ")
        else:
            joints[name] = elements
    node_sets = nodes_of(grouped, surfaces) | grouped.node_groups
    order, sets, more = arrange(grouped)
    place = np.empty(len(order), dtype=int)
    place[order] = np.arange(len(order))
    grouped.bricks = grouped.bricks[order]
    mesh = drop_unused(grouped, joints, node_sets, notes)
    mesh.surfaces = {n: sorted((int(place[b]), f) for b, f in s) for n, s in surfaces.items()}
    mesh.brick_sets, mesh.surface_joints = sets, sides
    return Imported(mesh, more, notes)


def join_sides(
    grouped: GroupedMesh, surfaces: dict, name: str, master: str, slave: str
) -> np.ndarray | None:
    """Joint elements between two surfaces, or None where their meshes differ."""
    for side in (master, slave):
        if side not in surfaces:
            known = ", ".join(surfaces) or "none"
            raise MeshError(f"joint {name}: no group of faces '{side}'; the mesh has {known}")
    try:
        return join_faces(grouped, surfaces[master], surfaces[slave])
    except MeshError as fault:
        raise MeshError(f"joint {name}, {master} and {slave}: {fault}") from None


def nodes_of(grouped: GroupedMesh, surfaces: dict) -> dict[str, np.ndarray]:
    """Nodes of every surface, which serve as sets for supports."""
    return {
        name: np.unique([grouped.bricks[b, list(corners_of(f))] for b, f in pairs])
        for name, pairs in surfaces.items()
    }


def turn_bricks(grouped: GroupedMesh) -> list[str]:
    """Turns bricks that are inside out; what was done."""
    shape = BrickMesh(grouped.x, grouped.bricks, np.zeros((0, 8), dtype=int))
    volume = volumes(shape)
    inverted = volume < 0.0
    if not inverted.any():
        return []
    grouped.bricks[inverted] = grouped.bricks[inverted][:, TURNED]
    return [f"{int(inverted.sum())} solids were inside out and have been turned"]


def arrange(grouped: GroupedMesh) -> tuple[np.ndarray, dict, dict]:
    """An order of the bricks in which sets follow each other, the sets, and those that overlap.

    A brick belongs to the smallest of its groups; bricks of no group are the set SOLID, or SOLID_2
    where a group has this name.
    """
    count = len(grouped.bricks)
    owner = np.full(count, -1)
    names = sorted(grouped.brick_groups, key=lambda name: len(grouped.brick_groups[name]))
    for k, name in enumerate(names):
        members = grouped.brick_groups[name]
        free = members[owner[members] < 0]
        owner[free] = k
    order = np.argsort(np.where(owner < 0, len(names), owner), kind="stable")
    place = np.empty(count, dtype=int)
    place[order] = np.arange(count)
    sets, more = {}, {}
    for k, name in enumerate(names):
        members = np.sort(place[grouped.brick_groups[name]])
        if np.array_equal(members, own := np.flatnonzero(owner[order] == k)) and own.size:
            sets[name] = own
        else:
            if own.size:
                sets[free_name(f"{name}_REST", [*names, *sets])] = own
            more[name] = members
    rest = np.flatnonzero(owner[order] < 0)
    if rest.size:
        sets[free_name("SOLID", [*names, *sets])] = rest
    return order, sets, more


def free_name(name: str, taken: list[str]) -> str:
    """The name, or with the first number from 2 that makes it a new one."""
    number = 1
    found = name
    while found in taken:
        number += 1
        found = f"{name}_{number}"
    return found


def find_surfaces(grouped: GroupedMesh, splits: list[str], notes: list[str]) -> dict:
    """Faces of bricks for every group of faces but those that are cut."""
    owners, surfaces = FaceOwners(grouped.bricks), {}
    cut = {face for name in splits for face in grouped.face_groups.get(name, [])}
    for name, members in grouped.face_groups.items():
        if cut.issuperset(members.tolist()):
            continue
        found = [owners.of(face) for face in grouped.faces[members]]
        inside = sum(len(pairs) > 1 for pairs in found)
        outside = sum(not pairs for pairs in found)
        if inside:
            notes.append(
                f"group {name}: {inside} faces lie inside the mesh, between two solids; no surface "
                f"(--split {name} makes a joint there)"
            )
            continue
        if outside == len(found):
            notes.append(f"group {name}: no solid has these faces; left out")
            continue
        if outside:
            raise MeshError(f"group {name}: {outside} of {len(found)} faces belong to no solid")
        surfaces[name] = [pairs[0] for pairs in found]
    return surfaces


def drop_unused(grouped: GroupedMesh, joints: dict, node_sets: dict, notes: list[str]) -> BrickMesh:
    """The mesh without nodes of no brick; new positions everywhere."""
    used = np.zeros(len(grouped.x), dtype=bool)
    used[grouped.bricks] = True
    place = np.cumsum(used) - 1
    if not used.all():
        notes.append(f"{int((~used).sum())} nodes belong to no solid; left out")
    mesh = BrickMesh(grouped.x[used], place[grouped.bricks], np.zeros((0, 8), dtype=int))
    for name, elements in joints.items():
        first = len(mesh.joints)
        mesh.joints = np.concatenate([mesh.joints, place[elements]])
        mesh.joint_sets[name] = np.arange(first, len(mesh.joints))
    for name, members in node_sets.items():
        kept = members[used[members]]
        if kept.size:
            mesh.node_sets[name] = place[kept]
        else:
            notes.append(f"set of nodes {name}: no solid has these nodes; left out")
    return mesh
