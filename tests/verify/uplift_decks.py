"""Decks of blocks and dam sections on a joint with water in it, in plane strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from joint_decks import material
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh

GRAVITY = 9.81  # [m/s2]
WATER = 1000.0  # [kg/m3]


def joined(*meshes: tuple[BrickMesh, np.ndarray]) -> tuple[BrickMesh, list[np.ndarray]]:
    """Several boxes as one mesh without common nodes, and their node numbers."""
    x, bricks, numbers, nodes = [], [], [], 0
    for mesh, number in meshes:
        x.append(mesh.x)
        bricks.append(mesh.bricks + nodes)
        numbers.append(number + nodes)
        nodes += len(mesh.x)
    empty = np.zeros((0, 8), dtype=int)
    return BrickMesh(np.concatenate(x), np.concatenate(bricks), empty), numbers


def facets(number: np.ndarray) -> np.ndarray:
    """Corner nodes of the facets of a grid of nodes (n, 4)."""
    ring = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    return np.stack(ring, axis=-1).reshape(-1, 4)


@dataclass
class Section:
    """A slice 1 m thick, upstream face upright at x = 0, on a joint at z = 0 with its ground.

    The ground is a box; where its columns differ from those of the dam the joint is made of two
    surfaces, the dam's the slave.
    """

    base: float = 5.0  # [m]
    crest: float = 5.0
    height: float = 10.0
    counts: tuple[int, int] = (20, 4)  # along x and z
    grading: float = 1.0  # the columns lie at share**grading of the width
    young: float = 1e13  # [Pa]
    density: float = 2400.0  # [kg/m3]
    law: str = "KN=1e8, KT=1e8"
    integration: str = "NODES"
    ground_is_slave: bool = False
    beside: tuple[float, int] = (0.0, 0)  # ground on either side [m], in so many columns
    depth: tuple[float, int] = (1.0, 1)  # of the ground [m], in so many rows
    ground_counts: int = 0  # columns of the ground under the dam, 0 for the dam's own

    def place(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Of the dam: shares along the stream, across it and up, to coordinates."""
        width = self.base + (self.crest - self.base) * c
        return np.stack([a**self.grading * width, b, self.height * c], axis=-1)

    def place_ground(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Of the ground."""
        (aside, columns), under = self.beside, self.ground_counts or self.counts[0]
        column = a * (2 * columns + under)
        share = np.clip((column - columns) / under, 0.0, 1.0)
        x = self.base * (share if self.ground_counts else share**self.grading)
        if columns:
            x = x + aside * (np.minimum(column / columns, 1.0) - 1.0)
            x = x + aside * np.maximum((column - columns - under) / columns, 0.0)
        return np.stack([x, b, self.depth[0] * (c - 1.0)], axis=-1)

    def deck(self, steps: str) -> str:
        """The deck; BED is the joint, UPSTREAM and DOWNSTREAM the faces of the dam."""
        nx, nz = self.counts
        columns, under = self.beside[1], self.ground_counts or nx
        mesh, (dam, ground) = joined(
            box_mesh((nx, 1, nz), self.place),
            box_mesh((2 * columns + under, 1, self.depth[1]), self.place_ground),
        )
        top = ground[columns : columns + under + 1, :, -1]
        bricks = np.arange(nx * nz).reshape(nx, 1, nz)
        below = nx * nz + np.arange((2 * columns + under) * self.depth[1])
        roof = below.reshape(2 * columns + under, 1, -1)[columns : columns + under, 0, -1]
        mesh.brick_sets = {"DAM": bricks.ravel(), "GROUND": below}
        skin = np.concatenate([ground[[0, -1]].ravel(), ground[:, :, 0].ravel()])
        if not columns:
            skin = ground.ravel()
        mesh.node_sets = {"SKIN": np.unique(skin), "ALL": np.arange(len(mesh.x))}
        mesh.surfaces = {
            "UPSTREAM": [(int(brick), 6) for brick in bricks[0].ravel()],
            "DOWNSTREAM": [(int(brick), 4) for brick in bricks[-1].ravel()],
            "SOLE": [(int(brick), 1) for brick in bricks[:, :, 0].ravel()],
            "ROOF": [(int(brick), 2) for brick in roof],
        }
        sides = [facets(top), facets(dam[:, :, 0])]
        if self.ground_is_slave:
            sides.reverse()
        pair = "ROOF, SOLE" if self.ground_is_slave else "SOLE, ROOF"
        faces = f"*JOINT, NAME=BED, LAW=LAW, INTEGRATION={self.integration}\n{pair}\n"
        if not self.ground_counts:
            mesh.joints = np.concatenate(sides, axis=1)
            mesh.joint_sets["BED"] = np.arange(len(mesh.joints))
            faces = f"*JOINT, NAME=BED, LAW=LAW, ELSET=BED, INTEGRATION={self.integration}\n"
        return (
            mesh_deck(mesh, {"DAM": "C3D8I", "GROUND": "C3D8I"}, "")
            + material("DAM", self.young, 0.0, self.density)
            + material("GROUND", self.young, 0.0, 0.0)
            + "*SOLID SECTION, ELSET=DAM, MATERIAL=DAM\n"
            + "*SOLID SECTION, ELSET=GROUND, MATERIAL=GROUND\n"
            + f"*JOINT LAW, NAME=LAW, {self.law}\n{faces}"
            + "*BOUNDARY\nSKIN, 1, 3\nALL, 2\n"
            + steps
        )

    @property
    def weight(self) -> tuple[float, float]:
        """Weight [N] and its distance from the heel [m]."""
        slope = self.base - self.crest
        area = self.crest * self.height, 0.5 * slope * self.height
        arm = 0.5 * self.crest, self.crest + slope / 3.0
        total = area[0] + area[1]
        return self.density * GRAVITY * total, (area[0] * arm[0] + area[1] * arm[1]) / total


def lake(level: float, more: str = "") -> str:
    """The reservoir."""
    return f"*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL={level!r}, BED=0.{more}\n"


def weight() -> str:
    """*DLOAD: gravity on the dam."""
    return f"*DLOAD\nDAM, GRAV, {GRAVITY!r}, 0., 0., -1.\n"
