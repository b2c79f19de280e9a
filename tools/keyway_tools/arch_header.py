"""The header of an arch dam's deck: its contents and all its assumptions."""

from __future__ import annotations

import textwrap

from .arch_blocks import BlockOptions
from .arch_dam import DamOptions
from .arch_shape import ArchShape
from .construction.heat import Temperatures, temperatures_in_words
from .construction.lifts import Construction, construction_in_words
from .mesh_data import BrickMesh
from .mesh_quality import report
from .surface_fit import fit_report

WIDTH = 96


def paragraph(head: str, text: str) -> list[str]:
    """Lines of a paragraph that starts with a bold word and hangs by two blanks."""
    return textwrap.wrap(f"{head}: {text}", WIDTH, subsequent_indent="  ", break_on_hyphens=False)


def header(
    mesh: BrickMesh,
    shape: ArchShape,
    options: DamOptions,
    title: str,
    notes: tuple[str, ...],
    blocks: BlockOptions | None = None,
    building: Construction | None = None,
    heat: Temperatures | None = None,
) -> str:
    """Title, axes, shape, mesh, rock, joints, notes and the report on the mesh."""
    lines = [title, ""]
    lines += paragraph("Axes", "x across the valley, y downstream, z up; z = 0 at the crown's foot")
    lines += _shape_lines(shape)
    lines += paragraph(
        "Mesh",
        f"{options.num_arc} x {options.num_height} x {options.num_thick} elements (arc, height, "
        "thickness), wedges (corners 3 = 4, 7 = 8) where the abutment climbs by a level; "
        "left-right symmetric to the last bit",
    )
    if blocks is not None:
        lines += _block_lines(mesh, options, blocks)
    if options.rock is not None:
        lines += paragraph(
            "Rock",
            f"to {options.rock.extent} dam heights beside, below, upstream and downstream; "
            "massless (no *DENSITY), linear, outer faces fixed, ground surface free, no initial "
            "stress, no water load on the valley (all assumed)",
        )
    if mesh.joint_names:
        has_one_mesh = not mesh.surface_joints and not mesh.interfaces
        ends = (
            "same mesh on both sides (classical joint); the foot row is shared with the rock, "
            "where the joint ends"
        )
        count = len(mesh.joint_names)
        planes = "1 vertical plane" if count == 1 else f"{count} vertical planes"
        lines += paragraph(
            "Joints",
            f"{planes} through the axis of the crest's upstream arc,"
            f" {_joint_places(options)} (places assumed)" + (f", {ends}" if has_one_mesh else ""),
        )
    at_once = "acts on the finished dam at once: no stages of building, no grouting (assumed)"
    lines += paragraph("Weight", construction_in_words(building) if building else at_once)
    if heat:
        lines += paragraph("Temperature", temperatures_in_words(heat))
    for note in notes:
        lines += paragraph(*note.split(": ", 1))
    lines += ["", report(mesh)]
    for line in fit_report(mesh).splitlines():
        lines += paragraph(*line.split(": ", 1))
    return "\n".join(lines)


def _block_lines(mesh: BrickMesh, options: DamOptions, blocks: BlockOptions) -> list[str]:
    """Lines on blocks with separate meshes and on their joints and ties."""
    own = blocks.fine_mesh
    text = (
        f"the elements above are cells of a lattice; blocks and rock have {blocks.refine} elements "
        f"along each side of a cell and {options.num_thick} through the thickness"
    )
    if blocks.fine:
        names = "block " if len(blocks.fine) == 1 else "blocks "
        names += ", ".join(map(str, blocks.fine))
        above = f"above {blocks.fine_above:g} of the height " if blocks.fine_above else ""
        shift = f", levels shifted by up to {own.shift:g} element" if own.shift else ""
        text += f"; {names} (from the left end) {above}{own.refine} and {own.thick}{shift}"
    lines = paragraph("Blocks", f"{text}. Cells are trilinear, so all meshes fill the same volume")
    if mesh.surface_joints:
        lines += paragraph(
            "Different meshes",
            f"{', '.join(mesh.surface_joints)} lie on surfaces: no joint elements, no interface "
            "elements (mortar, docs/different_meshes.md)",
        )
    if blocks.outlets is not None:
        lines += _outlet_lines(blocks)
    if mesh.interfaces:
        lines += paragraph(
            "Different meshes",
            "the paper's chain: fine face, *INTERFACE (Eq. 8; E of concrete as a number: "
            "paper_notes.md, 1), "
            "IFACE4 quads with nodes of their own on the coarse face, JOINT8, coarse face",
        )
    if mesh.ties:
        lines += paragraph(
            "Ties",
            f"{', '.join(mesh.ties)}: meshes that differ where concrete meets rock or concrete, "
            "held together by *TIE",
        )
    return lines


def _outlet_lines(blocks: BlockOptions) -> list[str]:
    """Lines on outlets, piers and corbel."""
    outlets = blocks.outlets
    sizes = (
        f"{outlets.count} through block {outlets.block}, {outlets.width:.4g} m wide, z "
        f"{outlets.sill:.4g} to {outlets.roof:.4g} m; piers beside them to z "
        f"{outlets.pier_top:.4g} m and a corbel {outlets.corbel_depth:.4g} m deep below the sill "
        f"stand {outlets.pier_length:.4g} m out of the downstream face. All edges lie at the "
        "nearest edges of elements. No gates: no water in the outlets nor on their walls"
    )
    return paragraph("Outlets (assumed)", sizes)


def _joint_places(options: DamOptions) -> str:
    """Where the joints are."""
    if not options.joint_places:
        return "at equal parts of the crest"
    places = ", ".join(f"{place:g}" for place in sorted(options.joint_places))
    return f"nearest to {places} m along the crest from its left end"


def _shape_lines(shape: ArchShape) -> list[str]:
    """Lines on the dam and its valley."""
    dam = (
        f"height {shape.height} m, crest arc {shape.crest_arc} m along its upstream edge, "
        f"thickness {shape.crest_thickness} m (crest) to {shape.base_thickness} m (base), "
        "linear between (the law between is assumed)"
    )
    if shape.abutment_thickening != 1.0:
        dam += (
            f"; at the abutment {shape.abutment_thickening:g} of that (assumed), growing with the "
            "square of the angle"
        )
    kind = "a crown" if shape.arches == "parabolic" else "an upstream"
    curves = (
        f"{shape.arches} arches; central angle of the crest {shape.crest_angle} deg, that is "
        f"{kind} radius of {shape.crest_radius:.3f} m; at the base {shape.base_radius_ratio} of "
        "that, linear between; the upstream face of the crown is a parabola in the depth d below "
        f"the crest, y = -{shape.crest_overhang} d "
        f"+ {shape.crest_overhang} d^2 / (2 * {shape.vertical_tangent} * height)"
    )
    valley = (
        f"V of straight walls (in x), {shape.bottom_width} m wide at the bottom and "
        f"{2.0 * shape.crest_half_width:.2f} m at the crest; up- and downstream of the dam it runs "
        "straight on along y"
    )
    lines = paragraph("Dam", dam) + paragraph("Curvature (assumed)", curves)
    return lines + paragraph("Valley (assumed)", valley)
