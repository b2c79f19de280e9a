"""Pairs of blocks whose meshes differ where they meet, for the checks of ties and joints.

In axes of its own a pair fills 0..a, 0..b and -c0..c1; the lower and the upper block meet on a
surface c = shape(a, b), mostly c = 0. `turn` then puts the pair into space at an angle, so that no
axis of the model lies in the interface. Each block has its own divisions and its own places of
nodes on the interface; away from the interface the places become regular.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from joint_decks import material
from keyway_tools.box_mesh import box_mesh, quads
from keyway_tools.deck_text import element_lines, mesh_deck
from keyway_tools.mesh_data import BrickMesh

Shares = tuple[np.ndarray, np.ndarray]


def straight(s: np.ndarray, t: np.ndarray) -> Shares:
    """Nodes at equal distances."""
    return s, t


def graded(ratio: float) -> Callable[..., Shares]:
    """Facets that grow along both sides, the last about `ratio` times the first."""

    def place(s, t):
        return (ratio**s - 1.0) / (ratio - 1.0), (ratio**t - 1.0) / (ratio - 1.0)

    return place


def swirled(angle: float) -> Callable[..., Shares]:
    """The grid turned in its plane about its middle, by `angle` [rad] there, not at its outline."""

    def place(s, t):
        x, y = 2.0 * s - 1.0, 2.0 * t - 1.0
        turn = angle * (1.0 - x**2) * (1.0 - y**2)
        c, d = np.cos(turn), np.sin(turn)
        return 0.5 * (1.0 + c * x - d * y), 0.5 * (1.0 + d * x + c * y)

    return place


def skewed(size: float) -> Callable[..., Shares]:
    """Lines of the grid lean over, those of the outline stay: nodes move along it."""

    def place(s, t):
        return (
            s + size * np.sin(np.pi * s) * (2.0 * t - 1.0),
            t - size * np.sin(np.pi * t) * (2.0 * s - 1.0),
        )

    return place


def scattered(size: float, seed: int) -> Callable[..., Shares]:
    """Each node moved at random, by up to `size` of a facet; those of the outline along it."""

    def place(s, t):
        lot = np.random.default_rng(seed)
        facets = np.array(s.shape) - 1
        moved = [s + size / facets[0] * lot.uniform(-1.0, 1.0, s.shape) * is_inside(s),
                 t + size / facets[1] * lot.uniform(-1.0, 1.0, t.shape) * is_inside(t)]  # fmt: skip
        return moved[0], moved[1]

    return place


def is_inside(share: np.ndarray) -> np.ndarray:
    """Where a share is neither 0 nor 1."""
    return (share > 1e-9) & (share < 1.0 - 1e-9)


def rotation(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """Rotation by `angle` [rad] about an axis (Rodrigues)."""
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


AT_AN_ANGLE = rotation((1.0, -2.0, 0.7), 0.9)


def flat(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A plane interface."""
    return np.zeros_like(a + b)


def even(share: float) -> float:
    """Layers of one height."""
    return share


@dataclass
class Side:
    """One block of a pair."""

    counts: tuple[int, int, int]  # along a, b and c
    place: Callable[..., Shares] = straight  # of nodes on the interface, in shares of a and b
    wedges: bool = False  # each brick cut into two along c
    shape: Callable[[np.ndarray, np.ndarray], np.ndarray] = flat  # of the interface, c over (a, b)
    layers: Callable[[np.ndarray], np.ndarray] = even  # shares of the height, from the interface


@dataclass
class Pair:
    """Two blocks; in the mesh the nodes and elements of the lower one come first.

    Sets: LOWER and UPPER (elements, and the faces that meet), ALL, FAR (far end of the lower
    block), TOP (that of the upper one).
    """

    lower: Side
    upper: Side
    size: tuple[float, float] = (1.0, 1.0)  # [m]
    heights: tuple[float, float] = (0.5, 0.5)  # of the lower and the upper block [m]
    shift: tuple[float, float] = (0.0, 0.0)  # of the upper block along a and b [m]
    apart: float = 0.0  # the upper block lifted by this [m]
    turn: np.ndarray = field(default_factory=lambda: AT_AN_ANGLE)
    element: str = "C3D8"
    young: float = 25e9  # of both blocks [Pa]
    poisson: float = 0.2

    def __post_init__(self):
        lower, low = self.block(self.lower, is_upper=False)
        upper, high = self.block(self.upper, is_upper=True)
        self.low, self.high = low, high + len(lower.x)  # numbers of nodes, (a, b, c)
        bricks = np.concatenate((lower.bricks, upper.bricks + len(lower.x)))
        self.mesh = BrickMesh(
            np.concatenate((lower.x, upper.x)), bricks, np.zeros((0, 8), dtype=int)
        )
        split = len(lower.bricks)
        self.mesh.brick_sets = {
            "LOWER": np.arange(split),
            "UPPER": np.arange(split, len(bricks)),
        }
        self.mesh.node_sets = {
            "ALL": np.arange(len(self.mesh.x)),
            "FAR": self.low[:, :, 0].ravel(),
            "TOP": self.high[:, :, -1].ravel(),
        }
        self.mesh.surfaces = {
            "LOWER": self.faces_among(self.low[:, :, -1], 2),
            "UPPER": self.faces_among(self.high[:, :, 0], 1),
            "TOP": self.faces_among(self.high[:, :, -1], 2),
        }

    def block(self, side: Side, is_upper: bool) -> tuple[BrickMesh, np.ndarray]:
        """Mesh of one block, not rounded: plane faces are exact to the last digit."""
        mesh, number = box_mesh(side.counts, lambda *shares: np.stack(shares, axis=-1))
        na, nb, nc = (count + 1 for count in side.counts)
        s, t = np.meshgrid(np.linspace(0, 1, na), np.linspace(0, 1, nb), indexing="ij")
        laid = side.place(s, t)
        height = self.heights[int(is_upper)]
        x = np.empty((na, nb, nc, 3))
        for k, share in enumerate(np.linspace(0.0, 1.0, nc)):
            away = side.layers(share if is_upper else 1.0 - share)
            for i, plain in enumerate((s, t)):
                x[:, :, k, i] = (laid[i] * (1.0 - away) + plain * away) * self.size[i]
                x[:, :, k, i] += self.shift[i] * is_upper
            rise = side.shape(x[:, :, k, 0], x[:, :, k, 1]) * (1.0 - away)
            x[:, :, k, 2] = rise + (height * away + self.apart if is_upper else -height * away)
        mesh.x = x.reshape(-1, 3) @ self.turn.T
        if side.wedges:
            mesh.bricks = np.array([w for brick in mesh.bricks for w in two_wedges(brick)])
        return mesh, number

    def faces_among(self, nodes: np.ndarray, face: int) -> list[tuple[int, int]]:
        """Faces 1..6 of bricks that have all their nodes in a set."""
        inside = np.isin(self.mesh.bricks, nodes)
        return [(i, face) for i in range(len(inside))
                if inside[i, [(0, 1, 2, 3), (4, 5, 6, 7)][face - 1]].all()]  # fmt: skip

    @property
    def x(self) -> np.ndarray:
        """Nodes [m]."""
        return self.mesh.x

    @property
    def local(self) -> np.ndarray:
        """Nodes in the axes of the pair [m]."""
        return self.mesh.x @ self.turn

    def outer_faces(self) -> list[np.ndarray]:
        """Nodes (4) of the facets that are not on the interface, right-hand rule outwards."""
        meet = {*self.mesh.surfaces["LOWER"], *self.mesh.surfaces["UPPER"]}
        pairs = [p for found in self.mesh.exterior_faces().values() for p in found]
        return [self.outward(*pair) for pair in pairs if pair not in meet]

    def outward(self, brick: int, face: int) -> np.ndarray:
        """Nodes of a face, right-hand rule out of its brick."""
        nodes = self.mesh.face_nodes(brick, face)
        x = self.x[nodes]
        normal = np.cross(x[2] - x[0], x[3] - x[1])
        middle = self.x[self.mesh.bricks[brick]].mean(axis=0)
        return nodes if normal @ (x.mean(axis=0) - middle) > 0.0 else nodes[::-1]

    def weld(self) -> None:
        """Joins blocks of the same mesh node by node: the mesh without an interface."""
        ours, theirs = self.low[:, :, -1].ravel(), self.high[:, :, 0].ravel()
        assert np.allclose(self.x[ours], self.x[theirs], rtol=0.0, atol=1e-12)
        new = np.arange(len(self.x))
        new[theirs] = ours
        self.mesh.bricks = new[self.mesh.bricks]
        self.mesh.node_sets["ALL"] = np.setdiff1d(self.mesh.node_sets["ALL"], theirs)

    def hold_end(self) -> None:
        """Makes FAR the end a = 0 of both blocks, for beams along a."""
        end = np.nonzero(self.local[:, 0] < 1e-12)[0]
        self.mesh.node_sets["FAR"] = np.intersect1d(end, self.mesh.node_sets["ALL"])

    def add_chain(self, coarse: str) -> str:
        """The paper's chain: quads with nodes of their own on the face of the coarse block, joint
        elements between the two. Returns the cards of the quads (set QUADS); joints are JOINTS.
        """
        nodes = self.low[:, :, -1] if coarse == "LOWER" else self.high[:, :, 0]
        first = len(self.mesh.x)
        own = np.arange(first, first + nodes.size).reshape(nodes.shape)
        self.mesh.x = np.concatenate((self.mesh.x, self.mesh.x[nodes.ravel()]))
        # the right-hand rule of the quads, which are the master, points into the coarse block
        around = slice(None, None, -1 if coarse == "LOWER" else 1)
        face = np.array(quads(nodes))[:, around]
        iface = np.array(quads(own))[:, around]
        self.mesh.joints = np.concatenate((iface, face), axis=1)
        self.mesh.joint_sets["JOINTS"] = np.arange(len(face))
        first = len(self.mesh.bricks) + len(face) + 1
        lines = "".join(f"{line}\n" for line in element_lines(first, iface))
        return f"*ELEMENT, TYPE=IFACE4, ELSET=QUADS\n{lines}"

    def deck(self, cards: str) -> str:
        """Mesh, one material for both blocks, then other cards."""
        types = dict.fromkeys(self.mesh.brick_sets, self.element)
        sections = "".join(
            f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n" for name in self.mesh.brick_sets
        )
        return (
            mesh_deck(self.mesh, types, "")
            + material("M", self.young, self.poisson, 2400.0)
            + sections
            + cards
        )


def two_wedges(brick: np.ndarray) -> list[list[int]]:
    """A brick cut along its nodes 1 and 3; corners 3-4 and 7-8 repeat."""
    low, high = brick[:4].tolist(), brick[4:].tolist()
    return [
        [ring[i] for ring in (low, high) for i in (*cut, cut[-1])] for cut in ((0, 1, 2), (0, 2, 3))
    ]
