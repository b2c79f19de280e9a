"""A dam that all programs can run, and what a run gives back."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from keyway_tools.mesh_data import BrickMesh

INCREMENT = 0.01  # [s]
ALPHA = -0.05  # of Hilber, Hughes and Taylor
CONCRETE = (22.0e9, 0.167, 2400.0)  # E [Pa], nu, rho [kg/m3]
ROCK = (20.0e9, 0.24)  # E [Pa], nu; massless
NORMAL_STIFFNESS = 1.0e11  # of a closed joint [Pa/m]
SHEAR_STIFFNESS = 4.0e10  # of a closed joint that sticks [Pa/m]
FRICTION = 0.6
GRAVITY = 9.81  # [m/s2]


@dataclass(frozen=True)
class PeerCase:
    """Weight, or a motion of the base from rest; with joints the weight acts first and stays."""

    name: str
    mesh: BrickMesh
    motion: np.ndarray  # acceleration along x at each increment, from 0 [m/s2]; empty: weight only

    @property
    def control_node(self) -> int:
        return int(self.mesh.node_sets["CROWN_CREST"][0])

    @property
    def has_weight(self) -> bool:
        return len(self.motion) == 0 or len(self.mesh.joints) > 0

    @property
    def num_increments(self) -> int:
        return max(len(self.motion) - 1, 0)

    @cached_property
    def pairs(self) -> JointPairs:
        return JointPairs.of(self.mesh)


@dataclass(frozen=True)
class JointPairs:
    """Joints as pairs of nodes."""

    master: np.ndarray  # (pairs) nodes
    slave: np.ndarray  # (pairs) nodes
    area: np.ndarray  # (pairs) [m2]
    normal: np.ndarray  # (pairs, 3) from master to slave

    @staticmethod
    def of(mesh: BrickMesh) -> JointPairs:
        area: dict[tuple[int, int], np.ndarray] = {}
        for element in mesh.joints:
            corners = mesh.x[element[:4]]
            whole = 0.5 * np.cross(corners[2] - corners[0], corners[3] - corners[1])
            for pair in zip(element[:4].tolist(), element[4:].tolist(), strict=True):
                area[pair] = area.get(pair, np.zeros(3)) + 0.25 * whole
        vectors = np.array(list(area.values())).reshape(-1, 3)
        sizes = np.linalg.norm(vectors, axis=1)
        pairs = np.array(list(area), dtype=int).reshape(-1, 2)
        normal = vectors / np.maximum(sizes, 1e-300)[:, None]
        return JointPairs(pairs[:, 0], pairs[:, 1], sizes, normal)


@dataclass(frozen=True)
class PeerRun:
    """Cost and answer of a run."""

    program: str
    wall: float  # [s]
    memory: float  # largest resident size [MB]
    displacement: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    failure: str = ""  # why there is no answer

    @property
    def largest(self) -> float:
        """Largest displacement of the control node [m]."""
        return float(np.abs(self.displacement).max(initial=0.0))


def stopped_after(limit: float, rows: np.ndarray) -> str:
    """What is said of a run that took too long."""
    done = f", {len(rows)} increments" if len(rows) else ""
    return f"stopped after {limit:g} s{done}"


def brick_lines(mesh: BrickMesh, members: np.ndarray, name: str, kind: str) -> list[str]:
    """Elements of a set for programs that have wedges of their own (C3D6)."""
    lines, wedges = [f"*ELEMENT, TYPE={kind}, ELSET={name}"], []
    for brick in members.tolist():
        nodes = (mesh.bricks[brick] + 1).tolist()
        if nodes[2] == nodes[3]:
            corners = [nodes[k] for k in (0, 1, 2, 4, 5, 6)]
            wedges.append(f"{brick + 1}, " + ", ".join(map(str, corners)))
        else:
            lines.append(f"{brick + 1}, " + ", ".join(map(str, nodes)))
    if wedges:
        lines += [f"*ELEMENT, TYPE=C3D6, ELSET={name}", *wedges]
    return lines


def write_text(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path
