"""The mesh of a dam for a number of unknowns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from .arch_dam import DamOptions
from .arch_stations import TooCoarseError
from .mesh_data import BrickMesh

FACTORS = np.geomspace(0.25, 16.0, 97)  # of the elements along each side
MOST_UNKNOWNS = 20_000_000  # that --unknowns takes
# A dam that is too coarse for its joints or outlets is refined up to so many unknowns, and to
# these times what is asked for.
SEARCHED, TIMES = 300_000, 8
STRIDE = 4  # factors from one refinement of this kind to the next


def unknowns_of(mesh: BrickMesh) -> int:
    """Three at each node that is neither fixed nor follows another surface by a tie, as the program
    counts them."""
    bound = [mesh.node_sets["FIXED"]]
    bound += [mesh.surface_nodes(slave) for slave, _ in mesh.ties.values()]
    return 3 * (len(mesh.x) - len(np.unique(np.concatenate(bound))))


def unknowns_about(dam: DamOptions, refine: int) -> int:
    """Unknowns without those of joints and finer blocks, from the numbers of elements."""
    arc, height, bottom = (refine * n for n in (dam.num_arc, dam.num_height, dam.num_bottom))
    stations = (arc + bottom) // 2  # as many as have the whole height
    nodes = stations * height * (dam.num_thick + 1)
    if dam.rock is not None:
        along = dam.rock.num_downstream + dam.num_thick + dam.rock.num_upstream - 1
        nodes += (arc + 1) * along * dam.rock.num_deep
    return 3 * nodes


def scaled(dam: DamOptions, factor: float) -> DamOptions:
    """The elements along each side of a dam and its rock times a factor."""

    def times(count: int, least: int = 1) -> int:
        return max(least, round(count * factor))

    def even(count: int) -> int:
        return 2 * max(1, round(count * factor / 2.0))

    bottom = even(dam.num_bottom) if dam.num_bottom else 0
    levels = times(dam.num_height, 2)
    # what the valley's slopes have more than one column for each level remains in proportion
    spare = even(dam.num_arc) - 2 * times(dam.num_height, 2) - bottom
    rock = dam.rock
    if rock is not None:
        rock = replace(
            rock,
            num_upstream=times(rock.num_upstream, 2),
            num_downstream=times(rock.num_downstream, 2),
            num_deep=times(rock.num_deep, 2),
        )
    return replace(
        dam,
        num_arc=2 * levels + bottom + max(0, spare),
        num_height=levels,
        num_thick=times(dam.num_thick),
        num_bottom=bottom,
        rock=rock,
    )


@dataclass
class _Search:
    """Meshes of a dam by the number of a factor."""

    dam: DamOptions
    unknowns: int  # that are asked for
    build: Callable[[DamOptions], BrickMesh]
    refine: int
    faults: dict[int, TooCoarseError] = field(default_factory=dict)

    def at(self, number: int) -> DamOptions:
        """The dam of a factor."""
        return scaled(self.dam, float(FACTORS[number]))

    def about(self, number: int) -> int:
        """Its unknowns, nearly."""
        return unknowns_about(self.at(number), self.refine)

    def is_enough(self, number: int) -> bool:
        """Whether it can be built and has the unknowns."""
        try:
            return unknowns_of(self.build(self.at(number))) >= self.unknowns
        except TooCoarseError as fault:
            self.faults[number] = fault
            return False

    def bracket(self) -> tuple[int, int]:
        """The least factor that may be enough, and one that is. Raises ValueError."""
        last = len(FACTORS) - 1
        low = 0
        high = next((n for n in range(last) if self.about(n) >= self.unknowns), last)
        most = min(MOST_UNKNOWNS, max(SEARCHED, TIMES * self.unknowns))
        while not self.is_enough(high):
            low, high = high + 1, min(high + STRIDE, last)
            if low > last or self.about(high) > most:
                raise self.faults.get(low - 1) or ValueError(
                    f"--unknowns {self.unknowns}: {FACTORS[-1]:g} times the elements along each "
                    "side have fewer; expected fewer unknowns, or more --arc and --levels"
                )
        return low, high


def sized_dam(
    dam: DamOptions, unknowns: int, build: Callable[[DamOptions], BrickMesh], refine: int = 1
) -> tuple[DamOptions, str]:
    """The smallest dam in the proportions of `dam` with at least so many unknowns.

    `refine`: elements along each side of a cell. Beside the dam a note where no mesh of these
    proportions is smaller, else nothing. Raises ValueError when no size can be built.
    """
    if unknowns > MOST_UNKNOWNS:
        raise ValueError(f"--unknowns {unknowns}: expected at most {MOST_UNKNOWNS}")
    search = _Search(dam, unknowns, build, refine)
    low, high = search.bracket()
    while low < high:
        middle = (low + high) // 2
        if search.is_enough(middle):
            high = middle
        else:
            low = middle + 1
    note = ""
    if low == 0:
        note = f"this is the smallest mesh, with {FACTORS[0]:g} of the elements along a side"
    elif low - 1 in search.faults:
        note = f"this is the smallest mesh; in a coarser one {search.faults[low - 1]}"
    return search.at(low), note and f"--unknowns {unknowns}: {note}"
