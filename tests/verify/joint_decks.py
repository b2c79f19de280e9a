"""Decks with joints for the verification: blocks, bars and columns on a rigid base."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from keyway_tools.box_mesh import add_base_joint, box_mesh, stretched
from keyway_tools.deck_text import id_lines, mesh_deck
from keyway_tools.mesh_data import BrickMesh

GRAVITY = 9.81  # [m/s2]
# Tests that run with a base whose mesh matches and with one that does not, to the same tolerances.
BOTH_MESHES = pytest.mark.parametrize("meshes", [None, (3, 2)], ids=["matching", "different"])


@dataclass
class Block:
    """A straight box with one corner at the origin, its bottom on a joint with a rigid base."""

    size: tuple[float, float, float]  # [m]
    counts: tuple[int, int, int] = (1, 1, 1)
    young: float = 1e13  # [Pa]
    poisson: float = 0.0
    density: float = 2400.0  # [kg/m3]
    law: str = "KN=1e10, KT=1e10"  # parameters of *JOINT LAW
    joint: str = ""  # more parameters of *JOINT, each behind a comma
    element: str = "C3D8"
    base_is_slave: bool = False
    meshes: tuple[int, int] | None = None  # facets of a base of other mesh, None: it matches
    sets: dict[str, np.ndarray] = field(default_factory=dict)  # more node sets
    cards: str = ""  # more cards of the model

    def deck(self, steps: str) -> str:
        """The deck; sets BLOCK (elements and nodes), BASE, BOTTOM and TOP are in it."""
        mesh, number = box_mesh(self.counts, stretched(self.size))
        mesh.brick_sets["BLOCK"] = np.arange(len(mesh.bricks))
        if self.meshes:
            base = add_base(mesh, self.size[:2], (0.0, 0.0), self.meshes)
            mesh.surfaces["BOTTOM_FACE"] = lowest(number, mesh.brick_sets["BLOCK"])
        else:
            base = add_base_joint(mesh, number[:, :, 0])
            if self.base_is_slave:
                mesh.joints = np.roll(mesh.joints, 4, axis=1)
            mesh.joint_sets["BED"] = np.arange(len(mesh.joints))
        mesh.node_sets |= {
            "BASE": base.ravel(),
            "BODY": number.ravel(),
            "BOTTOM": number[:, :, 0].ravel(),
            "TOP": number[:, :, -1].ravel(),
            "LEFT": number[0, :, :].ravel(),
            "RIGHT": number[-1, :, :].ravel(),
            "LEFT_EDGE": number[0, :, 0].ravel(),
            "RIGHT_EDGE": number[-1, :, 0].ravel(),
        }
        return (
            mesh_deck(mesh, {"BLOCK": self.element, "BASE": "C3D8"}, "")
            + node_sets(self.sets)
            + material("STUFF", self.young, self.poisson, self.density)
            + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
            + f"*JOINT LAW, NAME=LAW, {self.law}\n"
            + self.bed()
            + "*BOUNDARY\nBASE, 1, 3\n"
            + self.cards
            + steps
        )

    def bed(self) -> str:
        """The joint, and the base that it needs."""
        if not self.meshes:
            return f"*JOINT, NAME=BED, LAW=LAW, ELSET=BED{self.joint}\n"
        faces = ("BASE_FACE", "BOTTOM_FACE") if self.base_is_slave else ("BOTTOM_FACE", "BASE_FACE")
        return BASE_CARDS + f"*JOINT, NAME=BED, LAW=LAW{self.joint}\n{', '.join(faces)}\n"

    @property
    def x(self) -> np.ndarray:
        """Nodes of the body, as the deck numbers them from 1 [m]."""
        return box_mesh(self.counts, stretched(self.size))[0].x


BASE_CARDS = "*MATERIAL, NAME=ROCK\n*ELASTIC\n1e10, 0.\n*SOLID SECTION, ELSET=BASE, MATERIAL=ROCK\n"


def add_base(mesh: BrickMesh, size, corner, facets: tuple[int, int]) -> np.ndarray:
    """Put a layer of bricks below z = 0: elements BASE, surface BASE_FACE. Returns its nodes.

    It is as long and wide as `size` from `corner` on and has `facets` elements in x and y.
    """
    size, corner = np.append(size, 0.1), np.append(corner, -0.1)
    base, number = box_mesh((*facets, 1), lambda *s: corner + np.stack(s, axis=-1) * size)
    bricks = len(mesh.bricks) + np.arange(len(base.bricks))
    mesh.brick_sets["BASE"] = bricks
    mesh.surfaces["BASE_FACE"] = [(int(k), 2) for k in bricks]
    mesh.bricks = np.concatenate((mesh.bricks, base.bricks + len(mesh.x)))
    number = number + len(mesh.x)
    mesh.x = np.concatenate((mesh.x, base.x))
    return number


def lowest(number: np.ndarray, bricks: np.ndarray) -> list[tuple[int, int]]:
    """The lower faces of the lowest bricks of a box, numbered as box_mesh does."""
    counts = np.array(number.shape) - 1
    return [(int(k), 1) for k in bricks.reshape(counts)[:, :, 0].ravel()]


def material(name: str, young: float, poisson: float, density: float) -> str:
    """*MATERIAL; a density of 0 is left out."""
    mass = f"*DENSITY\n{density!r}\n" if density > 0.0 else ""
    return f"*MATERIAL, NAME={name}\n{mass}*ELASTIC\n{young!r}, {poisson!r}\n"


def node_sets(sets: dict[str, np.ndarray]) -> str:
    """*NSET cards; positions count from 0."""
    lines = []
    for name, members in sets.items():
        lines += [f"*NSET, NSET={name}", *id_lines(members)]
    return "".join(f"{line}\n" for line in lines)


def amplitude(name: str, time: np.ndarray, value: np.ndarray) -> str:
    """*AMPLITUDE of pairs."""
    pairs = "".join(f"{t!r}, {v!r}\n" for t, v in zip(time.tolist(), value.tolist(), strict=True))
    return f"*AMPLITUDE, NAME={name}\n{pairs}"


def static(content: str, data: str = "", name: str = "STATIC") -> str:
    """A static step; `data` is the data line of *STATIC."""
    line = f"{data}\n" if data else ""
    return f"*STEP, NAME={name}, INC=100000\n*STATIC\n{line}{content}*END STEP\n"


def dynamic(content: str, dt: float, duration: float, alpha: float | None = None) -> str:
    """A dynamic step of fixed increments."""
    damped = "" if alpha is None else f", ALPHA={alpha!r}"
    head = f"*STEP, NAME=DYNAMIC, INC=1000000\n*DYNAMIC, DIRECT{damped}\n"
    return head + f"{float(dt)!r}, {float(duration)!r}\n{content}*END STEP\n"


def weight(gravity: float = GRAVITY) -> str:
    """*DLOAD: gravity on the block."""
    return f"*DLOAD\nBLOCK, GRAV, {float(gravity)!r}, 0., 0., -1.\n"


def initial(kind: str, values: list[tuple[int, int, float]]) -> str:
    """*INITIAL CONDITIONS for nodes (positions from 0)."""
    lines = "".join(f"{node + 1}, {dof}, {float(value)!r}\n" for node, dof, value in values)
    return f"*INITIAL CONDITIONS, TYPE={kind}\n{lines}"


def spring_and_mass(
    elements: int, stretch: float, release: str, meshes: tuple[int, int] | None = None
) -> str:
    """1 kg on a bed with friction 0.1, tied to a wall by a spring of 1e4 N/m: a massless brick.

    Held at `stretch` [m] while its weight comes on; `release` is the step that follows. Sets FAR
    (end of the spring), MOVING (the mass), BODY, BASE.
    """
    mesh, number = box_mesh((2 * elements, 1, 1), stretched((2.0, 1.0, 0.1)))
    mesh.brick_sets = {"SPRING": np.arange(elements), "BLOCK": np.arange(elements, 2 * elements)}
    if meshes:
        base = add_base(mesh, (1.0, 1.0), (1.0, 0.0), meshes)
        mesh.surfaces["BOTTOM_FACE"] = [(k, 1) for k in range(elements, 2 * elements)]
        bed = BASE_CARDS + "*JOINT, NAME=BED, LAW=LAW\nBOTTOM_FACE, BASE_FACE\n"
    else:
        base = add_base_joint(mesh, number[elements:, :, 0])
        mesh.joint_sets = {"BED": np.arange(elements)}
        bed = "*JOINT, NAME=BED, LAW=LAW, ELSET=BED\n"
    mesh.node_sets = {
        "BASE": base.ravel(),
        "FAR": number[0].ravel(),
        "MOVING": number[elements:].ravel(),
        "BODY": number[elements:].ravel(),
        "SOLID": number.ravel(),
    }
    held = f"*BOUNDARY\nMOVING, 1, 1, {stretch!r}\n"
    return (
        mesh_deck(mesh, dict.fromkeys(mesh.brick_sets, "C3D8"), "")
        + material("SPRING", 1e5, 0.0, 0.0)
        + material("STUFF", 1e9, 0.0, 10.0)
        + "*SOLID SECTION, ELSET=SPRING, MATERIAL=SPRING\n"
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + "*JOINT LAW, NAME=LAW, KN=1e9, KT=1e9, FRICTION=0.1\n"
        + bed
        + "*BOUNDARY\nBASE, 1, 3\nFAR, 1, 3\nSOLID, 2\n"
        + f"*INITIAL CONDITIONS, TYPE=DISPLACEMENT\nMOVING, 1, {stretch!r}\n"
        + static(held + weight(10.0))
        + release
    )
