"""A mesh file as nodes, bricks and quads with their groups (meshio reads the file)."""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import dataclass, field
from pathlib import Path

import meshio
import numpy as np

CORNERS = {
    "hexahedron": (0, 1, 2, 3, 4, 5, 6, 7),
    "wedge": (0, 1, 2, 2, 3, 4, 5, 5),  # two corners stand for one
}
# What cannot be computed, and what the user can do.
REFUSED = {
    "tetra": "recombine the mesh into hexahedra, or extrude a mesh of quads",
    "pyramid": "mesh the volume with hexahedra and wedges alone",
    "hexahedron20": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "hexahedron27": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "wedge15": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "wedge18": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "tetra10": "write a mesh of first order and of hexahedra",
    "quad8": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "quad9": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
    "triangle6": "write a mesh of first order (Gmsh: Mesh.ElementOrder = 1)",
}
FACES = {"quad": 4, "triangle": 3}
NUMBERED = ("gmsh:physical", "cell_tags", "medit:ref")  # data that number the groups of cells


class MeshError(ValueError):
    """A mesh that cannot become a deck, and what is expected."""


@dataclass
class GroupedMesh:
    """Positions count from 0. A triangle has -1 as fourth node."""

    x: np.ndarray  # (nodes, 3)
    bricks: np.ndarray  # (bricks, 8)
    faces: np.ndarray  # (faces, 4)
    brick_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of bricks
    face_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of faces
    node_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of nodes


def deck_name(name: str) -> str:
    """A name that a deck may use: capital letters, digits and underscores."""
    word = re.sub(r"[^A-Z0-9_]+", "_", name.strip().upper()).strip("_") or "GROUP"
    return word if word[0].isalpha() else f"G{word}"


def read_grouped_mesh(path: Path, scale: float = 1.0) -> GroupedMesh:
    """Nodes, bricks, faces and groups of a mesh file. Raises MeshError."""
    if not path.is_file():
        raise MeshError(f"{path}: no such file")
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # meshio prints what it does not know
            mesh = meshio.read(path)
    except (Exception, SystemExit) as fault:  # meshio raises errors of many kinds, and exits
        raise MeshError(f"{path}: not a mesh that meshio reads ({fault})") from None
    refuse_cells(path, mesh)
    x = np.zeros((len(mesh.points), 3))
    x[:, : mesh.points.shape[1]] = scale * mesh.points
    found = GroupedMesh(x, *(gather(mesh, kinds) for kinds in (CORNERS, FACES)))
    groups = groups_of_cells(mesh)
    found.brick_groups = select(groups, mesh, CORNERS)
    found.face_groups = select(groups, mesh, FACES)
    found.node_groups = {
        deck_name(name): np.unique(np.asarray(members, dtype=int))
        for name, members in mesh.point_sets.items()
        if len(members)
    }
    found.bricks, found.brick_groups = once(found.bricks, found.brick_groups)
    found.faces, found.face_groups = once(found.faces, found.face_groups)
    if not len(found.bricks):
        raise MeshError(f"{path}: no hexahedra and no wedges; expected a mesh of solids")
    return found


def refuse_cells(path: Path, mesh: meshio.Mesh) -> None:
    """Error: cells that Keyway has no element for."""
    for block in mesh.cells:
        if block.type in REFUSED and len(block.data):
            raise MeshError(
                f"{path}: {len(block.data)} cells of the kind {block.type}; expected hexahedra "
                f"and wedges of 8 and 6 nodes: {REFUSED[block.type]}"
            )


def gather(mesh: meshio.Mesh, kinds: dict) -> np.ndarray:
    """All cells of some kinds, in the order of the file."""
    rows = []
    for block in mesh.cells:
        if block.type not in kinds:
            continue
        if kinds is CORNERS:
            rows.append(block.data[:, CORNERS[block.type]])
        else:
            missing = 4 - FACES[block.type]
            rows.append(np.pad(block.data, ((0, 0), (0, missing)), constant_values=-1))
    width = 8 if kinds is CORNERS else 4
    return np.concatenate(rows).astype(int) if rows else np.zeros((0, width), dtype=int)


def groups_of_cells(mesh: meshio.Mesh) -> dict[str, list[np.ndarray]]:
    """For each named group its cells in each block, by position in the block."""
    groups: dict[str, list[np.ndarray]] = {}
    for name, members in mesh.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        own = [np.asarray(m, dtype=int) if m is not None else np.zeros(0, int) for m in members]
        if any(m.size for m in own):
            groups[deck_name(name)] = own
    for data in NUMBERED:
        if data not in mesh.cell_data:
            continue
        for name, numbers in names_of_numbers(mesh, data).items():
            own = [np.flatnonzero(np.isin(v, numbers)) for v in mesh.cell_data[data]]
            if deck_name(name) not in groups and any(m.size for m in own):
                groups[deck_name(name)] = own
    return groups


def names_of_numbers(mesh: meshio.Mesh, data: str) -> dict[str, list[int]]:
    """Names of the groups that a field numbers; a number without a name is its own."""
    used = {int(v) for values in mesh.cell_data[data] for v in np.unique(values)} - {0}
    names: dict[str, list[int]] = {}
    if data == "cell_tags":  # MED: a family of cells may be in several groups
        for number, own in getattr(mesh, "cell_tags", {}).items():
            for name in own:
                names.setdefault(name, []).append(int(number))
        return names
    known = {int(number): name for name, (number, _) in mesh.field_data.items()}
    for number in sorted(used):
        names.setdefault(known.get(number, f"GROUP_{number}"), []).append(number)
    return names


def once(cells: np.ndarray, groups: dict) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Cells without repetition, in order: some formats write a cell for each of its groups."""
    _, first, place = np.unique(
        np.sort(cells, axis=1), axis=0, return_index=True, return_inverse=True
    )
    kept = np.sort(first)
    rank = np.searchsorted(kept, first)[place.ravel()]
    return cells[kept], {name: np.unique(rank[members]) for name, members in groups.items()}


def select(groups: dict, mesh: meshio.Mesh, kinds: dict) -> dict[str, np.ndarray]:
    """Groups with cells of some kinds, by position among all cells of these kinds."""
    found = {name: positions(members, mesh, kinds) for name, members in groups.items()}
    return {name: members for name, members in found.items() if members.size}


def positions(members: list[np.ndarray], mesh: meshio.Mesh, kinds: dict) -> np.ndarray:
    """Positions of a group among all cells of some kinds."""
    found, first = [np.zeros(0, dtype=int)], 0
    for block, own in zip(mesh.cells, members, strict=True):
        if block.type not in kinds:
            continue
        found.append(first + own)
        first += len(block.data)
    return np.concatenate(found)
