"""Mesh of a double-curvature arch dam with contraction joints on a block of rock.

from keyway_tools.arch_dam import DamOptions, build_arch_dam
mesh = build_arch_dam(ArchShape(), DamOptions(num_joints=2))
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .arch_rock import RockOptions, build_rock
from .arch_shape import ArchShape
from .arch_stations import Stations, joint_stations, place_stations
from .mesh_data import BrickMesh


@dataclass(frozen=True)
class DamOptions:
    """Numbers of elements and joints."""

    num_arc: int = 28
    num_height: int = 12
    num_thick: int = 3
    num_bottom: int = 4  # of num_arc, on the flat bottom of the valley
    num_joints: int = 2
    joint_places: tuple[float, ...] = ()  # [m] along the crest from its left end; else equal parts
    # None: no rock, the abutment is the fixed boundary
    rock: RockOptions | None = field(default_factory=RockOptions)

    def __post_init__(self) -> None:
        for name in ("num_arc", "num_height", "num_thick"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, found {getattr(self, name)}")


class DamNodes:
    """Numbers of the dam's nodes by station, slot and place in the thickness.

    A station with a joint has two nodes at each place above the foot. Both sides share the foot, so
    that the joint ends in the rock.
    """

    def __init__(
        self, shape: ArchShape, stations: Stations, options: DamOptions, joints: list[int]
    ):
        self.stations, self.num_thick = stations, options.num_thick
        self.top = options.num_height
        self.joints = joints
        self.x: list[np.ndarray] = []
        self.left: dict[tuple[int, int], np.ndarray] = {}
        self.right: dict[tuple[int, int], np.ndarray] = {}
        share = np.linspace(0.0, 1.0, options.num_thick + 1)
        half = [
            [shape.point(stations.angle[s], z, share) for z in stations.height_of(s)]
            for s in range(stations.count + 1)
        ]
        for station in range(-stations.count, stations.count + 1):
            self._add_station(station, half[abs(station)])

    def _add_station(self, station: int, points: list[np.ndarray]) -> None:
        foot = self.foot(station)
        mirror = np.array([-1.0 if station < 0 else 1.0, 1.0, 1.0])
        for slot, line in enumerate(points, start=foot):
            self.left[station, slot] = self._add_line(line * mirror)
            is_parted = station in self.joints and slot > foot
            self.right[station, slot] = (
                self._add_line(line * mirror) if is_parted else self.left[station, slot]
            )

    def _add_line(self, line: np.ndarray) -> np.ndarray:
        first = sum(len(part) for part in self.x)
        self.x.append(line)
        return np.arange(first, first + len(line))

    def foot(self, station: int) -> int:
        """Slot of the station's lowest node."""
        return int(self.stations.foot_slot[abs(station)])

    def at_station(self, station: int, slots: range) -> np.ndarray:
        """All nodes of a station in some slots, both sides of a joint, each once."""
        lines = [side[station, k] for side in (self.left, self.right) for k in slots]
        return np.unique(np.concatenate(lines))

    def abutment(self) -> np.ndarray:
        """Foot nodes: shape (2 count + 1, num_thick + 1), from the left end to the right end."""
        count = self.stations.count
        return np.array([self.left[s, self.foot(s)] for s in range(-count, count + 1)])


def _column_polygons(nodes: DamNodes, column: int) -> list[list[np.ndarray]]:
    """Node lines (through the thickness) around each element of the column station..station+1.

    Counter-clockwise in a view from upstream: along the arc, then up.
    """
    left_foot, right_foot = nodes.foot(column), nodes.foot(column + 1)
    start = max(left_foot, right_foot)
    low, high = nodes.right, nodes.left  # the column lies right of its first station
    polygons = []
    if left_foot < right_foot:  # the abutment climbs to the right
        edge = low[column, start]
        polygons.append([low[column, left_foot], high[column + 1, start], edge, edge])
    elif left_foot > right_foot:
        edge = high[column + 1, start]
        polygons.append([low[column, start], high[column + 1, right_foot], edge, edge])
    for k in range(start, nodes.top):
        polygons.append(
            [low[column, k], high[column + 1, k], high[column + 1, k + 1], low[column, k + 1]]
        )
    return polygons


def _dam_bricks(nodes: DamNodes) -> tuple[np.ndarray, list[tuple[int, int]], list[tuple[int, int]]]:
    """Bricks of the dam and its upstream and downstream surfaces."""
    bricks, upstream, downstream = [], [], []
    for column in range(-nodes.stations.count, nodes.stations.count):
        for polygon in _column_polygons(nodes, column):
            for j in range(nodes.num_thick):
                if j == 0:
                    downstream.append((len(bricks), 1))
                if j == nodes.num_thick - 1:
                    upstream.append((len(bricks), 2))
                bricks.append([line[j] for line in polygon] + [line[j + 1] for line in polygon])
    return np.array(bricks), upstream, downstream


def _joint_elements(nodes: DamNodes, station: int) -> np.ndarray:
    """JOINT8 elements of one station: master on the left, normal to the right."""
    left, right, elements = nodes.left, nodes.right, []
    for k in range(nodes.foot(station), nodes.top):
        for j in range(nodes.num_thick):
            # downstream -> up -> upstream: the right-hand rule points to the right block
            corners = [(k, j), (k + 1, j), (k + 1, j + 1), (k, j + 1)]
            master = [left[station, slot][place] for slot, place in corners]
            slave = [right[station, slot][place] for slot, place in corners]
            elements.append(master + slave)
    return np.array(elements)


def build_arch_dam(shape: ArchShape, options: DamOptions | None = None) -> BrickMesh:
    """The whole mesh, exactly symmetric left to right."""
    options = options or DamOptions()
    stations = place_stations(shape, options.num_arc, options.num_height, options.num_bottom)
    parted = joint_stations(shape, stations, options.num_joints, options.joint_places)
    nodes = DamNodes(shape, stations, options, parted)
    bricks, upstream, downstream = _dam_bricks(nodes)
    mesh = BrickMesh(np.concatenate(nodes.x), bricks, np.zeros((0, 8), dtype=int))
    mesh.brick_sets["DAM"] = np.arange(len(bricks))
    mesh.surfaces = {"UPSTREAM": upstream, "DOWNSTREAM": downstream}
    _name_dam_nodes(mesh, nodes)
    for number, station in enumerate(parted, start=1):
        _add_joint(mesh, nodes, number, station)
    mesh.node_sets["ABUTMENT"] = np.unique(nodes.abutment())
    if options.rock is None:
        mesh.node_sets["FIXED"] = mesh.node_sets["ABUTMENT"]
    else:
        build_rock(mesh, nodes.abutment(), shape, options.rock)
    return mesh


def _name_dam_nodes(mesh: BrickMesh, nodes: DamNodes) -> None:
    """Sets of the crest, the crown and the points whose histories are printed."""
    count, top = nodes.stations.count, nodes.top
    crest = [nodes.at_station(s, range(top, top + 1)) for s in range(-count, count + 1)]
    mesh.node_sets["CREST"] = np.unique(np.concatenate(crest))
    mesh.node_sets["CROWN"] = nodes.at_station(0, range(nodes.foot(0), top + 1))
    mesh.node_sets["CROWN_CREST"] = nodes.left[0, top][-1:]  # upstream edge


def _add_joint(mesh: BrickMesh, nodes: DamNodes, number: int, station: int) -> None:
    """Append the elements of one joint and name them and their nodes at the crest."""
    elements = _joint_elements(nodes, station)
    first = len(mesh.joints)
    mesh.joints = np.concatenate((mesh.joints, elements))
    mesh.joint_sets[f"JOINT{number}"] = np.arange(first, first + len(elements))
    line = nodes.left[station, nodes.top]
    mesh.node_sets[f"JOINT{number}_CREST"] = line[[0, -1]]  # downstream and upstream edge
