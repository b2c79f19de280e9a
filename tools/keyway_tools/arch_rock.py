"""Rock under and around an arch dam: a box in which the dam's abutment is a strip of the surface.

The mesh is a logical box: along the abutment (left crest end, valley bottom, right crest end),
along the valley (downstream end, toe .. heel, upstream end) and into the rock.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arch_shape import ArchShape
from .mesh_data import BrickMesh


@dataclass(frozen=True)
class RockOptions:
    """Extent and layers of the rock."""

    extent: float = 1.0  # to the sides, below, upstream and downstream, in dam heights
    num_upstream: int = 4
    num_downstream: int = 4
    num_deep: int = 5
    growth: float = 1.4  # thickness of a layer over that of the one nearer to the dam
    fanning: float = 0.35  # 0: layers extend across the valley; 1: along the crest's tangent

    def __post_init__(self) -> None:
        for name in ("num_upstream", "num_downstream", "num_deep"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, found {getattr(self, name)}")
        if self.extent <= 0.0 or self.growth <= 0.0:
            raise ValueError("the rock's extent and the growth of its layers must be > 0")


def grade(count: int, growth: float) -> np.ndarray:
    """Shares 0..1 of `count` layers, each `growth` times as thick as the one before."""
    steps = growth ** np.arange(count)
    shares = np.concatenate(([0.0], np.cumsum(steps) / steps.sum()))
    shares[-1] = 1.0
    return shares


def build_rock(
    mesh: BrickMesh, abutment: np.ndarray, shape: ArchShape, options: RockOptions
) -> None:
    """Append the rock to the mesh; `abutment` holds its nodes, shape (stations, thickness)."""
    count = (len(abutment) - 1) // 2
    surface = _ground_surface(mesh.x[abutment[count:]], shape, options)
    half = _extrude(surface, shape, options)
    mirrored = half[:0:-1] * np.array([-1.0, 1.0, 1.0])
    x = np.concatenate((mirrored, half))
    number = np.full(x.shape[:3], -1)
    toe = options.num_downstream
    number[:, toe : toe + abutment.shape[1], 0] = abutment
    is_new = number < 0
    number[is_new] = len(mesh.x) + np.arange(is_new.sum())
    mesh.x = np.concatenate((mesh.x, x[is_new]))
    first = len(mesh.bricks)
    mesh.bricks = np.concatenate((mesh.bricks, _box_bricks(number)))
    mesh.brick_sets["ROCK"] = np.arange(first, len(mesh.bricks))
    ends = (number[:, 0, :], number[:, -1, :], number[:, :, -1])
    mesh.node_sets["FIXED"] = np.unique(np.concatenate([end.ravel() for end in ends]))


def _ground_surface(foot: np.ndarray, shape: ArchShape, options: RockOptions) -> np.ndarray:
    """Surface of the valley for the right half: foot of the dam, valley up- and downstream of it.

    Away from the dam the valley runs along y: level lines continue straight from the dam's edge.
    """
    extent = options.extent * shape.height
    y_up = foot[:, -1, 1].min() - extent
    y_down = foot[:, 0, 1].max() + extent
    up, down = foot[:, -1:], foot[:, :1]
    shares_up = grade(options.num_upstream, options.growth)[1:]
    shares_down = grade(options.num_downstream, options.growth)[:0:-1]
    upstream = np.repeat(up, len(shares_up), axis=1)
    downstream = np.repeat(down, len(shares_down), axis=1)
    upstream[:, :, 1] += shares_up * (y_up - up[:, :, 1])
    downstream[:, :, 1] += shares_down * (y_down - down[:, :, 1])
    upstream[:, -1, 1], downstream[:, 0, 1] = y_up, y_down
    return np.concatenate((downstream, foot, upstream), axis=1)


def _extrude(surface: np.ndarray, shape: ArchShape, options: RockOptions) -> np.ndarray:
    """Layers from the ground surface to the box: shape (stations, along the valley, layers, 3)."""
    outer = surface.copy()
    outline = _box_outline(len(surface), shape, options)
    outer[:, :, 0], outer[:, :, 2] = outline[:, None, 0], outline[:, None, 1]
    # the outer box is rotated with the arch, as far as its ends allow
    y = surface[:, :, 1]
    room = np.minimum(1.0, (y[:, -1:] - y) * (y - y[:, :1]) / (0.5 * (y[:, -1:] - y[:, :1])) ** 2)
    run = np.abs(outer[:, :, 0] - surface[:, :, 0]) * surface[:, :, 0] / shape.axis
    outer[:, :, 1] += options.fanning * room * run
    shares = grade(options.num_deep, options.growth)
    layers = surface[:, :, None] + shares[None, None, :, None] * (outer - surface)[:, :, None]
    layers[:, :, -1] = outer
    return layers


def _box_outline(num_stations: int, shape: ArchShape, options: RockOptions) -> np.ndarray:
    """x and z of the box's boundary for each station, from below the crown to the crest's end."""
    extent = options.extent * shape.height
    width, depth = shape.crest_half_width + extent, extent
    share_of_bottom = width / (width + depth + shape.height)
    corner = int(np.clip(round(share_of_bottom * (num_stations - 1)), 1, num_stations - 2))
    outline = np.empty((num_stations, 2))
    outline[: corner + 1, 0] = np.linspace(0.0, width, corner + 1)
    outline[: corner + 1, 1] = -depth
    outline[corner:, 0] = width
    outline[corner:, 1] = np.linspace(-depth, shape.height, num_stations - corner)
    return outline


def _box_bricks(number: np.ndarray) -> np.ndarray:
    """Bricks of a logical box of nodes (along the abutment, to upstream, into the rock)."""
    a, b = number[:-1], number[1:]
    corners = []
    for part in (slice(None, -1), slice(1, None)):  # towards upstream
        corners += [a[:, part, 1:], b[:, part, 1:], b[:, part, :-1], a[:, part, :-1]]
    return np.stack(corners, axis=-1).reshape(-1, 8)
