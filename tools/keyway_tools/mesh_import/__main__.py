"""Turn the mesh of another program into the mesh part of a deck.

    tools/mesh dam.msh [-o dam_mesh.inp] [--split JOINT1] [--joint JOINT2=FACE_A,FACE_B]

Reads what meshio reads: Gmsh (.msh), Abaqus and CalculiX (.inp), VTK (.vtk, .vtu), MED (.med), ...
Hexahedra become C3D8, wedges too, with repeated nodes. Named groups of volumes become element sets,
those of faces become surfaces and node sets, those of points node sets.

A contraction joint is a group of faces inside the mesh (--split), along which the mesh is cut open,
or a pair of groups at the same place (--joint). Where the meshes of the pair differ, the deck
needs a *JOINT between the two surfaces.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..command import Parser, command
from ..deck_text import id_lines, mesh_deck
from ..mesh_quality import find_faults, report
from ..option_types import above_zero
from ..program import command_name
from .build import Imported, import_mesh
from .grouped_mesh import MeshError, deck_name, read_grouped_mesh

KINDS = ("C3D8", "C3D8B", "C3D8I", "C3D8R")


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(
        prog=command_name("mesh"),
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, help="the mesh")
    parser.add_argument("-o", "--output", type=Path, help="mesh part of the deck (FILE_mesh.inp)")
    parser.add_argument("--element", choices=KINDS, default="C3D8", help="kind of solids (C3D8)")
    parser.add_argument(
        "--scale", type=above_zero, default=1.0, help="of coordinates: 0.001 for mm"
    )
    parser.add_argument(
        "--split", nargs="+", default=[], metavar="GROUP", help="faces that become JOINT8 elements"
    )
    parser.add_argument(
        "--joint",
        action="append",
        default=[],
        metavar="NAME=MASTER,SLAVE",
        help="two groups of faces at the same place that become a joint",
    )
    return parser.parse_args(arguments)


def pairs_of(words: list[str]) -> dict[str, tuple[str, str]]:
    """NAME=MASTER,SLAVE of all joints."""
    pairs = {}
    for word in words:
        name, _, sides = word.partition("=")
        groups = [deck_name(side) for side in sides.split(",") if side.strip()]
        if len(groups) != 2 or not name.strip():
            raise MeshError(f"--joint {word}: expected NAME=MASTER,SLAVE")
        pairs[deck_name(name)] = (groups[0], groups[1])
    return pairs


@command("mesh")
def main(arguments: list[str] | None = None) -> int:
    """Read, build, write; say what was found."""
    chosen = parse(arguments)
    output = chosen.output or chosen.file.with_name(f"{chosen.file.stem}_mesh.inp")
    try:
        if output.resolve() == chosen.file.resolve():
            raise MeshError(f"{output}: the output would overwrite the mesh; give -o FILE")
        grouped = read_grouped_mesh(chosen.file, chosen.scale)
        splits = [deck_name(name) for name in chosen.split]
        imported = import_mesh(grouped, splits, pairs_of(chosen.joint))
    except MeshError as fault:
        print(f"mesh: {fault}", file=sys.stderr)
        return 2
    faults = find_faults(imported.mesh)
    if faults:
        print("mesh: the mesh has faults:\n  " + "\n  ".join(faults), file=sys.stderr)
        return 1
    write(output, imported, chosen)
    show(output, imported)
    return 0


def write(output: Path, imported: Imported, chosen: argparse.Namespace) -> None:
    """The mesh part of the deck."""
    mesh = imported.mesh
    text = mesh_deck(
        mesh,
        dict.fromkeys(mesh.brick_sets, chosen.element),
        f"Mesh of {chosen.file.name}, made by tools/mesh",
    )
    for name, members in imported.element_sets.items():
        text += "\n".join([f"*ELSET, ELSET={name}", *id_lines(members)]) + "\n"
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(text)


def show(output: Path, imported: Imported) -> None:
    """The quality of the mesh, what was done, and the names for the deck."""
    mesh = imported.mesh
    print(report(mesh))
    low, high = mesh.x.min(axis=0), mesh.x.max(axis=0)
    spans = ", ".join(f"{a} {p:.6g} to {q:.6g}" for a, p, q in zip("xyz", low, high, strict=True))
    counts = f"{len(mesh.x)} nodes, {len(mesh.bricks)} solids, {len(mesh.joints)} joint elements"
    print(f"{counts}; {spans}")
    for note in imported.notes:
        print(f"note: {note}")
    sets = {**mesh.brick_sets, **imported.element_sets}
    print("element sets:", names(sets))
    print("node sets:   ", names(mesh.node_sets))
    print("surfaces:    ", names(mesh.surfaces))
    for name in mesh.joint_sets:
        print(f"in the deck: *JOINT, NAME={name}, ELSET={name}, LAW=...")
    for name, (slave, master) in mesh.surface_joints.items():
        print(f"in the deck: *JOINT, NAME={name}, LAW=... with the line {slave}, {master}")
    print(f"wrote {output}; in the deck: *INCLUDE, INPUT={output.name}")


def names(sets: dict) -> str:
    """Names with their counts."""
    return ", ".join(f"{name} ({len(members)})" for name, members in sets.items()) or "none"


if __name__ == "__main__":
    sys.exit(main())
