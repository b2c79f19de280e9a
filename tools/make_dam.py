#!/usr/bin/env python3
r"""Write the deck of a parametric double-curvature arch dam in a V-shaped valley.

The deck is NAME.inp with its mesh in NAME_mesh.inp. Without options: a dam of 135.5 m with two
contraction joints. Example:

    tools/make_dam.py -o my_dam/dam.inp --height 200 --crest-arc 500 --joints 4 \
        --motion acc_x.txt acc_y.txt acc_z.txt

Blocks between joints may have separate meshes, here the middle one 3:2:

    tools/make_dam.py -o dam.inp --arc 16 --levels 7 --bottom 2 --thick 2 --joints 2 \
        --refine 2 --fine 2 --fine-refine 3 --fine-thick 3

Outlets stand in a block with a separate mesh, here the fourth of seven above 55 % of the height:

    tools/make_dam.py -o dam.inp --arc 34 --levels 14 --bottom 4 --joints 6 --arches parabolic \
        --fine 4 --fine-above 0.55 --join auto-chain --outlets 3 --unknowns 20000
"""

from __future__ import annotations

import argparse
import os
import sys
from functools import partial
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway_tools.arch_blocks import JOINS, build_block_dam
from keyway_tools.arch_checks import check_deck_options, check_mesh, check_motion_options
from keyway_tools.arch_command import add_arch_options, block_options_of
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck, title_of
from keyway_tools.arch_header import header
from keyway_tools.arch_rock import RockOptions
from keyway_tools.arch_shape import ArchShape
from keyway_tools.arch_size import sized_dam, unknowns_of
from keyway_tools.command import Parser, command, write_file
from keyway_tools.construction.heat import name_campaigns
from keyway_tools.construction.lifts import name_lifts
from keyway_tools.construction.options import construction_of, temperatures_of
from keyway_tools.deck_text import mesh_deck
from keyway_tools.joint_points import name_joint_points
from keyway_tools.mesh_data import BrickMesh
from keyway_tools.mesh_quality import report
from keyway_tools.option_types import (
    above_zero,
    count,
    count_from_zero,
    deck_path,
    finite,
    from_zero,
)
from keyway_tools.records.for_deck import motion_files
from keyway_tools.records.record import FACTORS
from keyway_tools.surface_fit import fit_report

ELEMENT_TYPES = ("C3D8", "C3D8B", "C3D8I", "C3D8R")


def add_shape_options(parser: argparse.ArgumentParser) -> None:
    """Options that become an ArchShape."""
    default = ArchShape()
    group = parser.add_argument_group("shape of the dam and the valley [m, deg]")
    for name, kind, text in (
        ("height", above_zero, "of the crown cantilever"),
        ("crest-arc", above_zero, "length of the crest along its upstream edge"),
        ("crest-thickness", above_zero, "at the crest"),
        ("base-thickness", above_zero, "at the foot of the crown"),
        ("crest-angle", above_zero, "central angle of the crest"),
        ("base-radius-ratio", above_zero, "upstream radius at the base over that at the crest"),
        ("crest-overhang", finite, "slope of the upstream crown at the crest"),
        ("vertical-tangent", above_zero, "depth over height where the upstream crown is vertical"),
        ("bottom-width", from_zero, "of the valley; 0 for a sharp V"),
    ):
        value = getattr(default, name.replace("-", "_"))
        group.add_argument(f"--{name}", type=kind, default=value, help=f"{text} ({value:g})")


def add_mesh_options(parser: argparse.ArgumentParser) -> None:
    """Options that become DamOptions and RockOptions."""
    dam, rock = DamOptions(), RockOptions()
    group = parser.add_argument_group("mesh")
    for name, value, text in (
        ("arc", dam.num_arc, "elements along the arc, even, at least 2 * HEIGHT + BOTTOM"),
        ("levels", dam.num_height, "elements over the height"),
        ("thick", dam.num_thick, "elements through the thickness"),
        ("bottom", dam.num_bottom, "elements on the valley's flat bottom, even"),
        ("joints", dam.num_joints, "contraction joints"),
        ("rock-upstream", rock.num_upstream, "layers of rock upstream of the heel"),
        ("rock-downstream", rock.num_downstream, "layers of rock downstream of the toe"),
        ("rock-deep", rock.num_deep, "layers of rock below and beside the dam"),
    ):
        kind = count_from_zero if name in ("bottom", "joints") else count
        group.add_argument(f"--{name}", type=kind, default=value, help=f"{text} ({value})")
    group.add_argument(
        "--extent", type=above_zero, default=rock.extent, help="of the rock, in dam heights (1)"
    )
    group.add_argument("--no-rock", action="store_true", help="fix the abutment instead")
    group.add_argument(
        "--element", choices=ELEMENT_TYPES, default="C3D8", help="of dam and rock (C3D8)"
    )


def add_block_options(parser: argparse.ArgumentParser) -> None:
    """Options that become BlockOptions."""
    group = parser.add_argument_group(
        "blocks with separate meshes; the elements above are then cells of a lattice"
    )
    group.add_argument("--refine", type=count, default=1, help="elements along a cell's side (1)")
    group.add_argument(
        "--fine",
        nargs="+",
        default=[],
        metavar="B",
        help="blocks, 1 at the left end; B:REFINE:THICK for a mesh of that block alone",
    )
    group.add_argument(
        "--fine-refine", type=count, help="elements along a cell's side there (twice)"
    )
    group.add_argument("--fine-thick", type=count, help="through the thickness there (twice)")
    group.add_argument(
        "--fine-above", type=from_zero, default=0.0, help="only above this share of the height (0)"
    )
    group.add_argument(
        "--shift", type=finite, default=0.0, help="levels there by this part of an element (0)"
    )
    group.add_argument(
        "--join",
        choices=JOINS,
        default="auto",
        help="JOINT8 between equal meshes, joints on surfaces, the paper's chain; auto: surfaces "
        "where meshes differ; auto-chain: the chain there",
    )
    group.add_argument(
        "--slave", choices=("fine", "coarse"), default="fine", help="side of such joints (fine)"
    )
    group.add_argument("--tie-all", action="store_true", help="tie all blocks to the rock")
    group.add_argument(
        "--interface-stiffness", type=above_zero, help="of the chain [Pa/m] (E of the concrete)"
    )


def add_deck_options(parser: argparse.ArgumentParser) -> None:
    """Options that become DeckOptions."""
    group = parser.add_argument_group("materials, loads and steps (SI)")
    group.add_argument("--title", default=DeckOptions.title)
    group.add_argument(
        "--note", action="append", default=[], help="'Head: text' for the header; may be repeated"
    )
    group.add_argument(
        "--concrete", type=finite, nargs=3, metavar=("E", "NU", "RHO"), default=DeckOptions.concrete
    )
    group.add_argument(
        "--rock", type=finite, nargs=2, metavar=("E", "NU"), default=DeckOptions.rock
    )
    group.add_argument(
        "--kn", type=above_zero, help="normal stiffness of the joints [Pa/m] (E / 0.02 m)"
    )
    group.add_argument("--kt", type=above_zero, help="shear stiffness [Pa/m] (kn / (2 (1 + nu)))")
    group.add_argument(
        "--strength", type=from_zero, default=0.0, help="tensile strength of the joints [Pa] (0)"
    )
    group.add_argument("--friction", type=from_zero, default=0.6, help="of the joints (0.6)")
    group.add_argument("--cohesion", type=from_zero, default=0.0, help="of the joints [Pa] (0)")
    group.add_argument(
        "--bonded", action="store_true", help="joints that never open, as a run without joints"
    )
    group.add_argument(
        "--water", type=from_zero, help="depth of the water [m]; 0: empty (105/135.5 of the height)"
    )
    group.add_argument("--added-mass", choices=("DIAGONAL", "NORMAL"), default="DIAGONAL")
    group.add_argument(
        "--motion",
        nargs="+",
        default=[],
        type=Path,
        metavar="FILE",
        help="accelerations along x, y, z: one value a line [m/s2], or any record that "
        "make_motion.py --record reads",
    )
    group.add_argument(
        "--motion-dt",
        type=above_zero,
        help="time between values of one column [s] (0.01)",
    )
    group.add_argument(
        "--motion-unit", type=str.upper, choices=tuple(FACTORS), help="where records name none"
    )
    group.add_argument(
        "--duration", type=above_zero, default=10.0, help="of the dynamic step [s] (10)"
    )
    group.add_argument(
        "--increment", type=above_zero, default=0.01, help="of the dynamic step [s] (0.01)"
    )
    group.add_argument(
        "--controls", default=DeckOptions.controls, help="parameters of its *CONTROLS (none)"
    )
    group.add_argument(
        "--damping",
        type=from_zero,
        nargs=3,
        default=DeckOptions.damping,
        metavar=("RATIO", "F1", "F2"),
    )
    group.add_argument(
        "--picture-every",
        type=count,
        default=DeckOptions.picture_frequency,
        metavar="N",
        help="increments between two states of the fields (10)",
    )
    group.add_argument(
        "--modes", type=count_from_zero, default=0, help="natural modes, in a separate step (0)"
    )


def read_options(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "-o", "--output", type=deck_path, default=Path("arch_dam.inp"), help="deck (arch_dam.inp)"
    )
    parser.add_argument("--picture", action="store_true", help="draw the mesh to NAME_mesh.png")
    add_shape_options(parser)
    add_mesh_options(parser)
    add_block_options(parser)
    add_arch_options(parser)
    add_deck_options(parser)
    return parser.parse_args(arguments)


def mesh_options_of(chosen: argparse.Namespace) -> DamOptions:
    """DamOptions from the command line."""
    rock = RockOptions(
        extent=chosen.extent,
        num_upstream=chosen.rock_upstream,
        num_downstream=chosen.rock_downstream,
        num_deep=chosen.rock_deep,
    )
    return DamOptions(
        num_arc=chosen.arc,
        num_height=chosen.levels,
        num_thick=chosen.thick,
        num_bottom=chosen.bottom,
        num_joints=len(chosen.joint_places) or chosen.joints,
        joint_places=tuple(chosen.joint_places),
        rock=None if chosen.no_rock else rock,
    )


def read_cards(file: Path | None) -> tuple[str, ...]:
    """Lines of a file with cards, without comments."""
    if file is None:
        return ()
    if not file.is_file():
        raise ValueError(f"there is no file of cards '{file}'")
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as fault:
        raise ValueError(f"{file}: {fault}; expected text") from None
    lines = (line.rstrip() for line in text.splitlines())
    return tuple(line for line in lines if line and not line.startswith("**"))


def deck_options_of(chosen: argparse.Namespace) -> DeckOptions:
    """DeckOptions from the command line; motion files relative to the deck."""
    check_deck_options(chosen)
    folder = chosen.output.parent
    water = chosen.water
    if water is None:
        water = round(chosen.height * 105.0 / 135.5, 3)
    if not 0.0 <= water <= chosen.height:
        raise ValueError(f"--water {water:g}: expected 0 to {chosen.height:g} m, the --height")
    prefix = chosen.output.with_name(f"{chosen.output.stem}_motion")
    motions, motion_dt = motion_files(chosen.motion, chosen.motion_unit, chosen.motion_dt, prefix)
    return DeckOptions(
        title=chosen.title,
        element_type=chosen.element,
        concrete_cards=read_cards(chosen.concrete_cards),
        static_time=chosen.static_time,
        concrete=tuple(chosen.concrete),
        rock=tuple(chosen.rock),
        normal_stiffness=chosen.kn,
        shear_stiffness=chosen.kt,
        tensile_strength=chosen.strength,
        friction=chosen.friction,
        interface_stiffness=chosen.interface_stiffness or chosen.concrete[0],
        cohesion=chosen.cohesion,
        has_joint_law=not chosen.bonded,
        water_depth=water if water > 0.0 else None,
        added_mass_direction=chosen.added_mass,
        motions=tuple(Path(os.path.relpath(file, folder)).as_posix() for file in motions),
        motion_dt=motion_dt,
        duration=chosen.duration,
        increment=chosen.increment,
        controls=chosen.controls,
        damping=tuple(chosen.damping),
        damping_base=chosen.damping_base,
        uplift=chosen.uplift,
        reduced=chosen.reduced,
        num_modes=chosen.modes,
        picture_frequency=chosen.picture_every,
        construction=construction_of(chosen),
        heat=temperatures_of(chosen),
    )


def build_dam(chosen: argparse.Namespace, shape: ArchShape, dam: DamOptions) -> BrickMesh:
    """The mesh: classical, or of blocks with separate meshes."""
    blocks = block_options_of(chosen, dam)
    if blocks is None:
        return build_arch_dam(shape, dam)
    return build_block_dam(shape, dam, blocks)


@command("make_dam")
def main(arguments: list[str] | None = None) -> int:
    """Write the deck and its mesh; print the report."""
    chosen = read_options(arguments)
    names = list(ArchShape.__dataclass_fields__)
    note = ""
    try:
        shape = ArchShape(**{name: getattr(chosen, name) for name in names})
        mesh_options, options = mesh_options_of(chosen), deck_options_of(chosen)
        check_motion_options(chosen)
        build = partial(build_dam, chosen, shape)
        if chosen.unknowns:
            mesh_options, note = sized_dam(mesh_options, chosen.unknowns, build, chosen.refine)
        mesh, blocks = build(mesh_options), block_options_of(chosen, mesh_options)
        if options.construction:
            if mesh.interfaces:
                raise ValueError("--lifts with a chain: expected --join auto or surfaces")
            name_lifts(mesh, mesh_options.num_height, options.construction.num_lifts)
            name_campaigns(mesh, options.construction)
        check_mesh(mesh, shape)
        if chosen.histories:
            name_joint_points(mesh)
        building = (options.construction, options.heat)
        title, notes = title_of(mesh, options.title), tuple(chosen.note)
        heading = header(mesh, shape, mesh_options, title, notes, blocks, *building)
    except ValueError as fault:
        print(f"make_dam: {fault}", file=sys.stderr)
        return 2
    mesh_file = write_deck(chosen, mesh, heading, options)
    show(chosen, mesh, mesh_file)
    if note:
        print(f"note: {note}")
    return 0


def write_deck(
    chosen: argparse.Namespace, mesh: BrickMesh, heading: str, options: DeckOptions
) -> Path:
    """Write the deck and its mesh, and return the file of the mesh."""
    mesh_file = chosen.output.with_name(chosen.output.stem + "_mesh.inp")
    types = dict.fromkeys(mesh.brick_sets, options.element_type)
    words = f"Mesh of {chosen.output.name}, made by tools/make_dam.py"
    write_file(mesh_file, mesh_deck(mesh, types, words))
    write_file(chosen.output, arch_dam_deck(mesh, heading, mesh_file.name, options))
    return mesh_file


def show(chosen: argparse.Namespace, mesh: BrickMesh, mesh_file: Path) -> None:
    """Print the report on the mesh, and draw the mesh if requested."""
    print(report(mesh))
    if mesh.surface_joints or mesh.ties:
        print(fit_report(mesh))
    counts = f"{len(mesh.x)} nodes, {len(mesh.bricks)} bricks, {len(mesh.joints)} joint elements"
    counts += f", {len(mesh.quads)} interface quads" if len(mesh.quads) else ""
    print(f"{counts}, {unknowns_of(mesh)} unknowns")
    print(f"wrote {chosen.output} and {mesh_file}")
    if chosen.picture:
        from keyway_tools.picture_mesh import picture_mesh  # VTK is slow to load

        print("wrote", picture_mesh(mesh, mesh_file.with_suffix(".png")))


if __name__ == "__main__":
    sys.exit(main())
