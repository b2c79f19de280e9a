"""A mesh file as nodes, bricks and quads with their groups (meshio reads all but decks)."""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import dataclass, field
from pathlib import Path

import meshio
import numpy as np

from ..deck_bytes import capitals
from .deck_mesh import read_deck_mesh
from .mesh_error import MeshError
from .names import merged_names, physical_names, shared_names

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
DIMENSIONS = {
    **dict.fromkeys(CORNERS, 3), **dict.fromkeys(FACES, 2), "line": 1, "vertex": 0
}  # fmt: skip
NUMBERED = ("gmsh:physical", "cell_tags", "medit:ref")  # data that number the groups of cells


@dataclass
class GroupedMesh:
    """Positions count from 0. A triangle has -1 as fourth node."""

    x: np.ndarray  # (nodes, 3)
    bricks: np.ndarray  # (bricks, 8)
    faces: np.ndarray  # (faces, 4)
    brick_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of bricks
    face_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of faces
    node_groups: dict[str, np.ndarray] = field(default_factory=dict)  # positions of nodes
    notes: list[str] = field(default_factory=list)  # what the user should know


def deck_name(name: str) -> str:
    """A name that a deck may use: capital letters, digits and underscores."""
    word = re.sub(r"[^A-Z0-9_]+", "_", name.strip().upper()).strip("_") or "GROUP"
    return word if word[0].isalpha() else f"G{word}"


def read_grouped_mesh(path: Path, scale: float = 1.0) -> GroupedMesh:
    """Nodes, bricks, faces and groups of a mesh file. Raises MeshError."""
    if path.is_dir():
        raise MeshError(f"{path}: a folder; expected a mesh file")
    if not path.is_file():
        raise MeshError(f"{path}: no such file")
    if not scale > 0.0:
        raise MeshError(f"--scale {scale:g}: expected a factor above 0")
    is_deck = path.suffix.lower() == ".inp"
    mesh, notes = read_deck_mesh(path) if is_deck else (read_mesh(path), [])
    if np.ndim(mesh.points) != 2 or mesh.points.shape[1] > 3:
        raise MeshError(f"{path}: no nodes; expected a mesh of solids")
    refuse_cells(path, mesh)
    x = np.zeros((len(mesh.points), 3))
    x[:, : mesh.points.shape[1]] = scale * mesh.points
    refuse_coordinates(path, x)
    found = GroupedMesh(x, *(gather(mesh, kinds) for kinds in (CORNERS, FACES)))
    origins = names_of_groups(mesh)
    groups = groups_of_cells(mesh)
    found.notes = notes + renamed_groups(origins) + lost_members(groups, mesh)
    found.notes += shared_names(physical_of(mesh)) + merged_names(spellings(mesh))
    found.brick_groups = select(groups, mesh, CORNERS)
    found.face_groups = select(groups, mesh, FACES)
    found.node_groups = groups_of_points(mesh, groups)
    found.bricks, found.brick_groups = once(found.bricks, found.brick_groups)
    found.faces, found.face_groups = once(found.faces, found.face_groups)
    if not len(found.bricks):
        raise MeshError(f"{path}: no hexahedra and no wedges; expected a mesh of solids")
    return found


def read_mesh(path: Path) -> meshio.Mesh:
    """The mesh of a file by meshio, which prints some reasons and exits. Raises MeshError."""
    if not path.stat().st_size:
        raise MeshError(f"{path}: not a mesh that meshio reads: the file is empty")
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(io.StringIO()):
            mesh = meshio.read(path)
        if path.suffix.lower() == ".msh":
            mesh.physical_names = physical_names(path)
        return mesh
    except SystemExit:
        lines = dict.fromkeys(line.strip() for line in said.getvalue().splitlines())
        reason = (
            "; ".join(line for line in lines if line)
            or f"its contents are not those of {path.suffix}"
        )
    except KeyError as fault:  # an element names a node that is not there
        reason = f"nothing has the number or name {fault.args[0] if fault.args else ''}"
    except Exception:  # meshio raises errors of many kinds, whose texts are those of Python
        reason = f"it is cut, or its contents are not those of {path.suffix}"
    raise MeshError(f"{path}: not a mesh that meshio reads: {reason}")


def refuse_coordinates(path: Path, x: np.ndarray) -> None:
    """Error: coordinates that are infinite or no numbers."""
    bad = np.flatnonzero(~np.isfinite(x).all(axis=1))
    if bad.size:
        found = ", ".join(f"{value:g}" for value in x[bad[0]])
        raise MeshError(
            f"{path}: node {bad[0] + 1} in the order of the file has the coordinates {found}; "
            "expected finite numbers"
        )


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


def names_of_groups(mesh: meshio.Mesh) -> dict[str, str]:
    """The names of the file by those in the deck. Error: two names that become one."""
    of_points = [name for name, members in mesh.point_sets.items() if len(members)]
    of_cells = [name for name, _ in [*named_groups(mesh), *numbered_groups(mesh)]]
    origins: dict[str, str] = {}
    for name in of_cells + of_points:
        word = deck_name(name)
        if capitals(origins.setdefault(word, name).strip()) != capitals(name.strip()):
            raise MeshError(
                f"groups '{origins[word]}' and '{name}' would both be {word}; expected names that "
                "differ in letters A to Z, digits and underscores"
            )
    return origins


def spellings(mesh: meshio.Mesh) -> dict[tuple[str, int | None], list[str]]:
    """Names of the file by those in the deck and the dimension of their cells; points: None."""
    found: dict[tuple[str, int | None], list[str]] = {}
    own = [(name, None) for name, members in mesh.point_sets.items() if len(members)]
    own += [
        (name, DIMENSIONS[block.type])
        for name, members in [*named_groups(mesh), *numbered_groups(mesh)]
        for block, cells in zip(mesh.cells, members, strict=True)
        if cells.size and block.type in DIMENSIONS
    ]
    for name, dimension in dict.fromkeys(own):
        found.setdefault((deck_name(name), dimension), []).append(name.strip())
    return found


def renamed_groups(origins: dict[str, str]) -> list[str]:
    """Notes on groups that have another name in the deck."""
    return [
        f"group '{name}' is {word} in the deck"
        for word, name in origins.items()
        if capitals(name.strip()) != word
    ]


def lost_members(groups: dict[str, list[np.ndarray]], mesh: meshio.Mesh) -> list[str]:
    """Notes on cells of groups that are no solids, faces or nodes."""
    notes = []
    for name, members in groups.items():
        lost: dict[str, int] = {}
        for block, own in zip(mesh.cells, members, strict=True):
            if block.type not in {*CORNERS, *FACES, "vertex"} and len(own):
                lost[block.type] = lost.get(block.type, 0) + len(own)
        notes += [
            f"group {name}: {n} cells of the kind {kind}; left out" for kind, n in lost.items()
        ]
    return notes


def groups_of_cells(mesh: meshio.Mesh) -> dict[str, list[np.ndarray]]:
    """For each named group its cells in each block, by position in the block."""
    groups: dict[str, list[np.ndarray]] = {}
    for name, own in [*named_groups(mesh), *numbered_groups(mesh)]:
        word = deck_name(name)
        # A name may be that of volumes and of faces, or of a set that is also numbered.
        before = groups.get(word, [np.zeros(0, dtype=int)] * len(own))
        groups[word] = [np.union1d(old, new) for old, new in zip(before, own, strict=True)]
    return groups


def named_groups(mesh: meshio.Mesh) -> list[tuple[str, list[np.ndarray]]]:
    """Groups that the file names, with their cells in each block."""
    found = []
    for name, members in mesh.cell_sets.items():
        own = [np.asarray(m, dtype=int) if m is not None else np.zeros(0, int) for m in members]
        if not name.startswith("gmsh:") and any(m.size for m in own):
            found.append((name, own))
    return found


def numbered_groups(mesh: meshio.Mesh) -> list[tuple[str, list[np.ndarray]]]:
    """Groups that a field numbers. A number is that of one dimension: a volume and a surface may
    have the same."""
    found = []
    for data in (name for name in NUMBERED if name in mesh.cell_data):
        for (name, dimension), numbers in names_of_numbers(mesh, data).items():
            own = [
                np.flatnonzero(np.isin(values, numbers) & fits(block.type, dimension))
                for block, values in zip(mesh.cells, mesh.cell_data[data], strict=True)
            ]
            if any(m.size for m in own):
                found.append((name, own))
    return found


def fits(kind: str, dimension: int | None) -> bool:
    """Whether cells of a kind are of a dimension; None: any."""
    return dimension is None or DIMENSIONS.get(kind) == dimension


def physical_of(mesh: meshio.Mesh) -> dict[tuple[int, int], str]:
    """Names of the numbers of a field, by number and dimension."""
    known = {(int(number), int(dim)): name for name, (number, dim) in mesh.field_data.items()}
    return known | getattr(mesh, "physical_names", {})


def names_of_numbers(mesh: meshio.Mesh, data: str) -> dict[tuple[str, int | None], list[int]]:
    """Names and dimensions of the groups that a field numbers; a number without a name is its
    own."""
    names: dict[tuple[str, int | None], list[int]] = {}
    if data == "cell_tags":  # MED: a family of cells may be in several groups
        for number, own in getattr(mesh, "cell_tags", {}).items():
            for name in own:
                names.setdefault((name, None), []).append(int(number))
        return names
    known = physical_of(mesh)
    for block, values in zip(mesh.cells, mesh.cell_data[data], strict=True):
        dimension = DIMENSIONS.get(block.type)
        for number in {int(v) for v in np.unique(values)} - {0}:
            name = known.get((number, dimension), f"GROUP_{number}")
            own = names.setdefault((name, dimension), [])
            if number not in own:
                own.append(number)
    return names


def groups_of_points(mesh: meshio.Mesh, groups: dict) -> dict[str, np.ndarray]:
    """Named groups of points: sets of the file, and groups of cells of one point."""
    found: dict[str, np.ndarray] = {}
    for name, members in mesh.point_sets.items():
        if len(members):
            before = found.get(deck_name(name), np.zeros(0, dtype=int))
            found[deck_name(name)] = np.union1d(before, np.asarray(members, dtype=int))
    for name, members in groups.items():
        own = [block.data[m].ravel() for block, m in zip(mesh.cells, members, strict=True)
               if block.type == "vertex"]  # fmt: skip
        nodes = np.unique(np.concatenate([np.zeros(0, dtype=int), *own])).astype(int)
        if nodes.size:
            found[name] = np.union1d(found.get(name, np.zeros(0, dtype=int)), nodes)
    return found


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
