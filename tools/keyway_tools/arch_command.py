"""Options of tools/make_dam.py on arches, joints, sizes and the law of the concrete."""

from __future__ import annotations

import argparse
from pathlib import Path

from .arch_blocks import BlockOptions
from .arch_curves import CURVES
from .arch_dam import DamOptions
from .arch_lattice import PartMesh
from .arch_size import MOST_UNKNOWNS
from .construction.options import add_construction_options
from .option_types import above_zero, count, finite
from .outlets.options import add_outlet_options, outlet_options_of


def add_arch_options(parser: argparse.ArgumentParser) -> None:
    """Options beside those of the shape, the mesh and the deck."""
    group = parser.add_argument_group("arches, joints and size")
    group.add_argument("--arches", choices=tuple(CURVES), default="circular")
    group.add_argument(
        "--abutment-thickening",
        type=above_zero,
        default=1.0,
        help="thickness at the abutment over that at the crown, at each height (1)",
    )
    group.add_argument(
        "--joint-places",
        type=finite,
        nargs="+",
        default=[],
        metavar="S",
        help="joints nearest to these places [m] along the crest from its left end, instead of "
        "equal parts",
    )
    group.add_argument(
        "--unknowns",
        type=count,
        help="scale all numbers of elements to have at least so many, as the program counts them "
        f"(up to {MOST_UNKNOWNS})",
    )
    group.add_argument(
        "--concrete-cards", type=Path, metavar="FILE", help="cards that follow *ELASTIC of the dam"
    )
    group.add_argument(
        "--static-time",
        type=above_zero,
        default=1.0,
        metavar="SECONDS",
        help="time of the static step, for concrete with a viscosity (1)",
    )
    group.add_argument(
        "--damping-base",
        choices=("INITIAL", "CURRENT"),
        default="INITIAL",
        help="stiffness of the Rayleigh damping: undamaged, or with its damage (INITIAL)",
    )
    group.add_argument(
        "--uplift",
        choices=("OPEN", "LINEAR"),
        help="water in the joints: full head where they are open from upstream on, or falling from "
        "the upstream to the downstream edge (none)",
    )
    group.add_argument(
        "--reduced",
        type=above_zero,
        metavar="ERROR",
        help="reduced model in the dynamic step, with this error of openings, and without fields "
        "and stresses in any step",
    )
    group.add_argument(
        "--histories",
        action="store_true",
        help="openings in time at crest, mid-height and base of the joints, not at the crest alone",
    )
    add_outlet_options(parser)
    add_construction_options(parser)


def fine_blocks(
    chosen: argparse.Namespace, thick: int
) -> tuple[tuple[int, ...], dict[int, PartMesh]]:
    """Blocks with separate meshes, and the meshes of single ones; `thick` where none is given."""
    blocks, own = [], {}
    expected = "--fine takes B, B:REFINE or B:REFINE:THICK, found"
    for text in chosen.fine:
        try:
            number, *counts = (int(word) for word in str(text).split(":"))
        except ValueError:
            raise ValueError(f"{expected} '{text}'") from None
        if len(counts) > 2:
            raise ValueError(f"{expected} '{text}'")
        blocks.append(number)
        if counts:
            own[number] = PartMesh(counts[0], (counts[1:] or [thick])[0], chosen.shift)
    return tuple(blocks), own


def block_options_of(chosen: argparse.Namespace, dam: DamOptions) -> BlockOptions | None:
    """BlockOptions from the command line; None for the classical dam of one mesh."""
    is_classical = chosen.refine == 1 and not chosen.fine and not chosen.tie_all
    num_blocks = len(dam.joint_places or range(dam.num_joints)) + 1
    outlets = outlet_options_of(chosen, num_blocks, chosen.crest_arc / num_blocks)
    if is_classical and chosen.join in ("auto", "auto-chain", "matching"):
        return None
    refine = 2 * chosen.refine if chosen.fine_refine is None else chosen.fine_refine
    thick = 2 * dam.num_thick if chosen.fine_thick is None else chosen.fine_thick
    blocks, own = fine_blocks(chosen, thick)
    return BlockOptions(
        refine=chosen.refine,
        fine=blocks,
        fine_mesh=PartMesh(refine, thick, chosen.shift),
        own_meshes=own,
        outlets=outlets,
        fine_above=chosen.fine_above,
        join=chosen.join,
        slave=chosen.slave,
        is_tied=chosen.tie_all,
    )
