"""Finer meshes of one arch dam: cells of a lattice, cut into equal elements.

The lattice is the developed mesh of arch_stations: columns between stations, levels, wedges at the
abutment. A cell is a trilinear brick (the wedge: a prism), so that cells cut into 2, 3 or 4 along
each side fill exactly the same volume and their faces coincide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arch_shape import ArchShape
from .arch_stations import Stations


@dataclass(frozen=True)
class PartMesh:
    """How finely cells are cut."""

    refine: int = 1  # elements along each side of a cell, along the arc and over the height
    thick: int = 3  # elements through the thickness
    shift: float = 0.0  # of the levels above the abutment, in elements; largest halfway up

    def __post_init__(self) -> None:
        if self.refine < 1 or self.thick < 1:
            raise ValueError("a cell must have at least one element along each side")
        if not abs(self.shift) < 1.0:
            raise ValueError(f"levels must shift by less than an element, found {self.shift}")


# Face on top of an element of a column by the ends at which it has a side; a wedge has one side.
TOP_OF = {"left right": 5, "left": 4, "right": 6}


def in_cells(place: int, refine: int) -> float:
    """A number of elements as a coordinate in cells; whole cells have no round-off."""
    cell, inside = divmod(abs(place), refine)
    return (-1.0 if place < 0 else 1.0) * (cell + inside / refine)


class Lattice:
    """Points of the body by cell coordinates."""

    def __init__(self, shape: ArchShape, stations: Stations):
        self.shape, self.stations = shape, stations
        self.top = len(stations.levels) - 1

    def foot(self, station: int, refine: int) -> int:
        """Lowest level of a station; both count elements, the station from the crown."""
        cell, inside = divmod(abs(station), refine)
        slot = self.stations.foot_slot
        climbs = inside > 0 and slot[cell + 1] > slot[cell]
        return int(slot[cell]) * refine + (inside if climbs else 0)

    def line(self, station: float, level: float, share: np.ndarray) -> np.ndarray:
        """Points through the thickness at a station (from the crown) and a level, in cells."""
        column = int(abs(station))
        a = abs(station) - column
        row = min(int(level), self.top - 1)
        b = level - row
        weights = self._weights(column, row, a, b)
        points = sum(w * self._corner(c, k, share) for (c, k), w in weights.items() if w != 0.0)
        return points * np.array([-1.0 if station < 0 else 1.0, 1.0, 1.0])

    def _weights(self, column: int, row: int, a: float, b: float) -> dict[tuple[int, int], float]:
        """Weights of a cell's corners; a along the arc, b up."""
        if a == 0.0:
            return {(column, row): 1.0 - b, (column, row + 1): b}
        slot = self.stations.foot_slot
        low, high = (column, row), (column + 1, row + 1)
        if slot[column + 1] > slot[column] == row:  # the wedge over the climbing abutment
            return {low: 1.0 - b, (column, row + 1): b - a, high: a}
        return {
            low: (1.0 - a) * (1.0 - b),
            (column + 1, row): a * (1.0 - b),
            (column, row + 1): (1.0 - a) * b,
            high: a * b,
        }

    def _corner(self, column: int, row: int, share: np.ndarray) -> np.ndarray:
        at = self.stations
        is_foot = row == at.foot_slot[column]
        z = at.foot_z[column] if is_foot else at.levels[row]
        return self.shape.point(at.angle[column], z, share)

    def levels(self, mesh: PartMesh, fixed: int) -> np.ndarray:
        """Levels of a part in cells; those above `fixed` (in cells) may be shifted."""
        levels = np.array([in_cells(j, mesh.refine) for j in range(self.top * mesh.refine + 1)])
        if mesh.shift:
            above = levels > fixed
            rise = (levels[above] - fixed) / (self.top - fixed)
            levels[above] += mesh.shift / mesh.refine * np.sin(np.pi * rise) ** 2
            levels[-1] = self.top
        return levels


class Part:
    """Nodes and bricks of a stretch of columns between two levels; numbers count from `first`."""

    def __init__(
        self,
        lattice: Lattice,
        mesh: PartMesh,
        columns: tuple[int, int],
        rows: tuple[int, int],
        fixed: int,
        first: int,
    ):
        """Columns between two stations (signed), rows between two levels, all in cells.

        Levels above `fixed` may be shifted, with the stations of the abutment.
        """
        self.lattice, self.mesh, self.rows = lattice, mesh, rows
        self.left, self.right = (c * mesh.refine for c in columns)
        self.top, self.bottom = rows[1] * mesh.refine, rows[0] * mesh.refine
        self.nodes: dict[tuple[int, int], np.ndarray] = {}
        self.faces: dict[str, list[tuple[int, int]]] = {}
        share = np.linspace(0.0, 1.0, mesh.thick + 1)
        height = lattice.levels(mesh, fixed)
        lines = []
        for i in range(self.left, self.right + 1):
            at_foot = lattice.foot(i, mesh.refine)
            shift = float(height[at_foot]) - in_cells(at_foot, mesh.refine)
            station = in_cells(i, mesh.refine) + (-shift if i < 0 else shift)
            for j in range(self.foot(i), self.top + 1):
                self.nodes[i, j] = first + len(lines) * len(share) + np.arange(len(share))
                lines.append(lattice.line(station, float(height[j]), share))
        self.x = np.concatenate(lines)
        self.bricks = self._build_bricks()

    def foot(self, station: int) -> int:
        """Lowest level of a station in this part."""
        return max(self.lattice.foot(station, self.mesh.refine), self.bottom)

    def foot_line(self) -> np.ndarray:
        """Nodes of the lowest level: shape (stations, thickness + 1)."""
        return np.array([self.nodes[i, self.foot(i)] for i in range(self.left, self.right + 1)])

    def side(self, station: int) -> list[np.ndarray]:
        """Faces of a station as node quads: downstream, up, upstream; their normal points right."""
        quads = []
        for j in range(self.foot(station), self.top):
            low, high = self.nodes[station, j], self.nodes[station, j + 1]
            for k in range(self.mesh.thick):
                quads.append([low[k], high[k], high[k + 1], low[k + 1]])
        return np.array(quads)

    def _build_bricks(self) -> np.ndarray:
        bricks: list[list[int]] = []
        for column in range(self.left, self.right):
            polygons = self._polygons(column)
            for place, (polygon, ends) in enumerate(polygons):
                sides = {"DOWNSTREAM": 1, "UPSTREAM": 2}
                faces = {"BASE": 3} if place == 0 else {}
                if place == len(polygons) - 1:
                    faces["TOP"] = TOP_OF[ends]
                if column == self.left and "left" in ends:
                    faces["LEFT"] = 6
                if column == self.right - 1 and "right" in ends:
                    faces["RIGHT"] = 4
                for k in range(self.mesh.thick):
                    for name, face in faces.items():
                        self._add_face(name, len(bricks), face)
                    if k == 0:
                        self._add_face("DOWNSTREAM", len(bricks), sides["DOWNSTREAM"])
                    if k == self.mesh.thick - 1:
                        self._add_face("UPSTREAM", len(bricks), sides["UPSTREAM"])
                    bricks.append([n[k] for n in polygon] + [n[k + 1] for n in polygon])
        return np.array(bricks)

    def _add_face(self, name: str, brick: int, face: int) -> None:
        self.faces.setdefault(name, []).append((brick, face))

    def _polygons(self, column: int) -> list[tuple[list[np.ndarray], str]]:
        """Node lines around each element of a column, upwards, and its ends with a side."""
        left, right = self.foot(column), self.foot(column + 1)
        start = max(left, right)
        at = self.nodes
        found = []
        if left < right:
            edge = at[column, start]
            found.append(([at[column, left], at[column + 1, start], edge, edge], "left"))
        elif left > right:
            edge = at[column + 1, start]
            found.append(([at[column, start], at[column + 1, right], edge, edge], "right"))
        for j in range(start, self.top):
            lines = [at[column, j], at[column + 1, j], at[column + 1, j + 1], at[column, j + 1]]
            found.append((lines, "left right"))
        return found
