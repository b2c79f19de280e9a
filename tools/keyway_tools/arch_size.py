"""The mesh of a dam for a number of unknowns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .arch_dam import DamOptions
from .mesh_data import BrickMesh

FACTORS = np.geomspace(0.25, 16.0, 97)  # of the elements along each side


def unknowns_of(mesh: BrickMesh) -> int:
    """Three at each node that is not fixed."""
    return 3 * (len(mesh.x) - len(mesh.node_sets["FIXED"]))


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


def sized_dam(
    dam: DamOptions, unknowns: int, build: Callable[[DamOptions], BrickMesh]
) -> DamOptions:
    """The smallest dam in the proportions of `dam` with at least so many unknowns.

    Raises ValueError when no size can be built.
    """
    low, high = 0, len(FACTORS) - 1
    why: ValueError | None = None
    while low < high:
        middle = (low + high) // 2
        try:
            is_enough = unknowns_of(build(scaled(dam, float(FACTORS[middle])))) >= unknowns
        except ValueError as fault:  # too coarse for its joints or outlets
            is_enough, why = False, fault
        if is_enough:
            high = middle
        else:
            low = middle + 1
    chosen = scaled(dam, float(FACTORS[low]))
    if low == len(FACTORS) - 1:
        raise why or ValueError(f"{unknowns} unknowns are too many for this dam")
    return chosen
