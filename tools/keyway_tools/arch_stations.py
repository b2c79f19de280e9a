"""Stations along an arch dam and the levels they own: the developed mesh of one half.

Stations are vertical planes, counted from the crown (0) to the end of the crest. A station's
lowest node lies on the abutment; above it come the common levels. Where the abutment climbs by a
level within one column of elements, the lowest element of that column is a wedge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arch_shape import ArchShape


class TooCoarseError(ValueError):
    """A dam that cannot be built with these elements, and may be with more of them."""


@dataclass(frozen=True)
class Stations:
    """One half of the developed mesh, crown included."""

    levels: np.ndarray  # heights [m], shape (levels + 1)
    angle: np.ndarray  # of each station [rad]
    foot_slot: np.ndarray  # level slot of each station's lowest node
    foot_z: np.ndarray  # its height [m]; between levels for the stations inside a step

    @property
    def count(self) -> int:
        """Number of columns of elements in the half."""
        return len(self.angle) - 1

    def height_of(self, station: int) -> np.ndarray:
        """Heights of the station's nodes from the foot to the crest [m]."""
        above = self.levels[self.foot_slot[station] + 1 :]
        return np.concatenate(([self.foot_z[station]], above))


def place_stations(shape: ArchShape, num_arc: int, num_height: int, num_bottom: int) -> Stations:
    """Stations of one half: num_arc columns in the whole dam, num_bottom of them on flat ground."""
    if num_arc % 2 or num_bottom % 2:
        raise ValueError("the numbers of elements along the arc and on the bottom must be even")
    if (shape.bottom_width > 0.0) != (num_bottom > 0):
        raise ValueError(
            "elements on the valley's bottom need a bottom width, and a bottom width needs elements"
        )
    flat, climbing = num_bottom // 2, (num_arc - num_bottom) // 2
    if climbing < num_height:
        raise ValueError(
            f"elements along the arc: at least {2 * num_height + num_bottom} are needed for "
            f"{num_height} over the height, found {num_arc}"
        )
    levels = np.linspace(0.0, shape.height, num_height + 1)
    foot_slot, foot_z, x = [0] * (flat + 1), [0.0] * (flat + 1), []
    columns_of_level = np.diff(np.linspace(0, climbing, num_height + 1).round().astype(int))
    for level, columns in enumerate(columns_of_level):
        for part in range(1, columns + 1):
            is_last = part == columns
            climb = levels[level + 1] - levels[level]
            foot_slot.append(level + 1 if is_last else level)
            foot_z.append(levels[level + 1] if is_last else levels[level] + climb * part / columns)
    x = np.linspace(0.0, shape.bottom_width / 2.0, flat + 1)
    on_bottom = shape.plane_angle(x, 0.0)
    on_slope = shape.abutment_angle(np.array(foot_z[flat + 1 :]))
    return Stations(
        levels, np.concatenate((on_bottom, on_slope)), np.array(foot_slot), np.array(foot_z)
    )


def joint_stations(
    shape: ArchShape, stations: Stations, num_joints: int, places: tuple[float, ...] = ()
) -> list[int]:
    """Signed stations (negative: left half) nearest to places along the crest's arc.

    `places` are metres from the left end of the crest; without them the joints part the crest
    equally.
    """
    arc = shape.crest_position(stations.angle)
    is_given = bool(places)
    if is_given:
        _check_places(shape, sorted(places))
    else:
        places = tuple(shape.crest_arc * (j + 1) / (num_joints + 1) for j in range(num_joints))
    found = []
    for place in sorted(places):
        target = place - 0.5 * shape.crest_arc
        station = int(np.argmin(np.abs(arc - abs(target))))
        found.append(station if target > 0.0 else -station)
    inside = [stations.foot_slot[abs(s)] < len(stations.levels) - 1 for s in found]
    if len(set(found)) < len(places) or not all(inside):
        reason = f"{len(places)} joints do not fit into {2 * stations.count} columns of elements"
        if is_given:
            reason = _why_not_there(shape, stations, sorted(places), found)
        raise TooCoarseError(reason)
    return found


def _check_places(shape: ArchShape, places: list[float]) -> None:
    """Raises ValueError for places of joints that no mesh has."""
    for k, place in enumerate(places):
        if not 0.0 < place < shape.crest_arc:
            raise ValueError(
                f"--joint-places: {place:g} m is not on the crest; expected 0 to "
                f"{shape.crest_arc:g} m from its left end, without both ends"
            )
        if k and place == places[k - 1]:
            raise ValueError(f"--joint-places: {place:g} m is there twice; expected it once")


def _why_not_there(
    shape: ArchShape, stations: Stations, places: list[float], found: list[int]
) -> str:
    """What is wrong with given places of joints, of which two are one, or one has no height."""
    arc = shape.crest_position(stations.angle)
    free = float(arc[stations.foot_slot < len(stations.levels) - 1].max())
    first, last = 0.5 * shape.crest_arc - free, 0.5 * shape.crest_arc + free
    step = float(np.diff(arc).min())
    for place, station in zip(places, found, strict=True):
        if abs(arc[abs(station)]) > free:
            return (
                f"--joint-places: {place:g} m is too near an end of the crest, or beyond it; "
                f"expected {first:.5g} to {last:.5g} m with these elements"
            )
    same = next(k for k in range(1, len(found)) if found[k] == found[k - 1])
    column = 0.5 * shape.crest_arc + np.sign(found[same]) * float(arc[abs(found[same])])
    return (
        f"--joint-places: {places[same - 1]:g} and {places[same]:g} m are nearest to one column of "
        f"nodes, at {column:.5g} m; expected different columns, from {first:.5g} to {last:.5g} m "
        f"and at least {step:.4g} m apart with these elements"
    )
