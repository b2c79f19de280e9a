"""What outlets look like, and how they are laid out on the elements of a block."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from ..arch_stations import TooCoarseError
from ..option_types import above_zero, count, count_from_zero


@dataclass(frozen=True)
class OutletOptions:
    """Outlets side by side in one block; lengths in metres, heights as z."""

    count: int
    block: int  # from 1 at the left end
    width: float
    sill: float
    roof: float
    pier_length: float  # of piers and corbel, downstream from the face of the dam
    pier_top: float
    corbel_depth: float  # below the sill
    corbel_tip: float = 0.4  # length of the corbel's lower edge over that of the piers
    num_layers: int = 3  # elements along piers and corbel

    def __post_init__(self) -> None:
        if self.count < 1 or self.num_layers < 1:
            raise ValueError("outlets and the layers of their piers must be at least 1")
        if not 0.0 < self.sill < self.roof <= self.pier_top:
            raise ValueError(
                f"--outlet-sill {self.sill:g}, --outlet-roof {self.roof:g}, --pier-top "
                f"{self.pier_top:g}: expected 0 < sill < roof <= top of the piers"
            )
        if min(self.width, self.pier_length, self.corbel_depth) <= 0.0:
            raise ValueError("width, length of piers and depth of the corbel must be > 0")
        if not 0.0 < self.corbel_tip <= 1.0:
            raise ValueError(f"corbel_tip must lie in 0..1, found {self.corbel_tip:g}")


@dataclass(frozen=True)
class Layout:
    """Outlets in elements of a part: columns from the part's left side, levels from z = 0."""

    spans: tuple[tuple[int, int], ...]  # columns of each outlet: first, one past the last
    built: tuple[int, int]  # columns with piers or corbel
    corbel: int  # lowest level of the corbel
    sill: int
    roof: int
    top: int  # of the piers

    def is_outlet(self, column: int) -> bool:
        """Whether a column lies in an outlet."""
        return any(first <= column < last for first, last in self.spans)

    def is_hole(self, column: int, level: int) -> bool:
        """Whether an element through the thickness is left out."""
        return self.sill <= level < self.roof and self.is_outlet(column)

    def is_built(self, column: int, level: int) -> bool:
        """Whether an element stands downstream of the face: corbel, or pier above it."""
        if not self.built[0] <= column < self.built[1]:
            return False
        is_corbel = self.corbel <= level < self.sill
        return is_corbel or (self.sill <= level < self.top and not self.is_outlet(column))


def too_wide(count: int, width: float, block_width: float) -> str:
    """What is wrong with outlets that are wider than their block."""
    return (
        f"{count} outlets of {width:g} m do not fit into a block of {block_width:.4g} m; expected "
        "fewer --outlets or a smaller --outlet-width"
    )


def spans_of(count: int, width: float, block_width: float, columns: int) -> list[tuple[int, int]]:
    """Columns of `count` outlets, symmetric about the middle of the block.

    Every outlet and every pier has at least one element; the rest goes to where the widths in
    metres require it. All piers have the same width in metres.
    """
    half, is_odd = columns // 2, count % 2 == 1
    pier = (block_width - count * width) / (count + 1)
    if pier <= 0.0:
        raise TooCoarseError(too_wide(count, width, block_width))
    if columns % 2 or half < count + 1:
        raise TooCoarseError(
            f"{count} outlets need an even number of elements across their block, at least "
            f"{2 * (count + 1)}, found {columns}"
        )
    steps = [pier if k % 2 == 0 else width for k in range(2 * count + 1)]
    borders = np.cumsum(steps[:count]) / (0.5 * block_width) * half  # of the left half, from 0
    found = [0]
    for k, border in enumerate(borders):
        least, most = found[-1] + 1, half - (count - k)
        found.append(int(np.clip(round(float(border)), least, most)))
    left = list(zip(found[1::2], found[2::2], strict=False))
    middle = [(found[-1], columns - found[-1])] if is_odd else []
    return left + middle + [(columns - b, columns - a) for a, b in reversed(left)]


def layout_of(
    options: OutletOptions, columns: int, block_width: float, heights: np.ndarray
) -> Layout:
    """The outlets on elements whose levels are at `heights` [m]."""

    def nearest(z: float) -> int:
        return int(np.argmin(np.abs(heights - z)))

    spans = spans_of(options.count, options.width, block_width, columns)
    sill = nearest(options.sill)
    roof = max(nearest(options.roof), sill + 1)
    corbel = min(nearest(options.sill - options.corbel_depth), sill - 1)
    top = max(nearest(options.pier_top), roof)
    if corbel < 0 or top >= len(heights):
        raise TooCoarseError("outlets need levels below their sill and above their roof")
    margin = 1 if spans[0][0] > 1 else 0
    return Layout(tuple(spans), (margin, columns - margin), corbel, sill, roof, top)


def add_outlet_options(parser: argparse.ArgumentParser) -> None:
    """Options that become OutletOptions."""
    group = parser.add_argument_group(
        "outlets through a block with a separate mesh (--fine); heights over the crown's foot [m]"
    )
    group.add_argument(
        "--outlets", type=count_from_zero, default=0, help="side by side in one block (0)"
    )
    group.add_argument("--outlet-block", type=count, help="from 1 at the left end (the middle one)")
    for name, text in (
        ("outlet-width", "width (7 %% of the width of the crest between joints)"),
        ("outlet-sill", "height of the sill (0.72 of the dam)"),
        ("outlet-roof", "height of the roof (0.78 of the dam)"),
        ("pier-length", "piers and corbel, downstream of the face (0.06 of the dam)"),
        ("pier-top", "height of the top of the piers (0.84 of the dam)"),
        ("corbel-depth", "depth of the corbel below the sill (0.06 of the dam)"),
    ):
        group.add_argument(f"--{name}", type=above_zero, help=text)
    group.add_argument(
        "--pier-layers", type=count, default=3, help="elements along piers and corbel (3)"
    )


def outlet_options_of(
    chosen: argparse.Namespace, num_blocks: int, block_width: float
) -> OutletOptions | None:
    """OutletOptions from the command line; None for a dam without outlets."""
    if chosen.outlets == 0:
        return None

    def height(value: float | None, share: float) -> float:
        return share * chosen.height if value is None else value

    block = (num_blocks + 1) // 2 if chosen.outlet_block is None else chosen.outlet_block
    width = 0.07 * block_width if chosen.outlet_width is None else chosen.outlet_width
    _check_block(chosen, block, num_blocks)
    _check_room(chosen, block, width, block_width)
    return OutletOptions(
        count=chosen.outlets,
        block=block,
        width=width,
        sill=height(chosen.outlet_sill, 0.72),
        roof=height(chosen.outlet_roof, 0.78),
        pier_length=height(chosen.pier_length, 0.06),
        pier_top=height(chosen.pier_top, 0.84),
        corbel_depth=height(chosen.corbel_depth, 0.06),
        num_layers=chosen.pier_layers,
    )


def _check_block(chosen: argparse.Namespace, block: int, num_blocks: int) -> None:
    """Raises ValueError for outlets in a block that cannot have them."""
    if not 1 < block < num_blocks:
        raise ValueError(
            f"--outlets {chosen.outlets}: block {block} of {num_blocks} is not between two joints "
            "and meets the rock up to the crest; expected 2 --joints or more, with an "
            "--outlet-block between two of them"
        )
    if block not in (int(text.split(":")[0]) for text in chosen.fine):
        raise ValueError(
            f"--outlets {chosen.outlets}: block {block} has no separate mesh; expected --fine "
            f"{block} with a --fine-above that is above the rock, as --fine-above 0.55"
        )


def _check_room(chosen: argparse.Namespace, block: int, width: float, block_width: float) -> None:
    """Raises ValueError for outlets that are wider than their block, or higher than the dam."""
    places = sorted(chosen.joint_places)
    room = places[block - 1] - places[block - 2] if places else block_width
    if chosen.outlets * width >= room:
        raise ValueError(too_wide(chosen.outlets, width, room))
    for name in ("outlet_roof", "pier_top"):
        given = getattr(chosen, name)
        if given is not None and given > chosen.height:
            raise ValueError(
                f"--{name.replace('_', '-')} {given:g}: expected at most the height of the dam, "
                f"{chosen.height:g} m"
            )
