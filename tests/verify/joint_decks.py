"""Decks with joints that the verification runs: blocks, bars and columns on a rigid base."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from keyway_tools.box_mesh import add_base_joint, box_mesh, stretched
from keyway_tools.deck_text import id_lines, mesh_deck

GRAVITY = 9.81  # [m/s2]


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
    sets: dict[str, np.ndarray] = field(default_factory=dict)  # more node sets
    cards: str = ""  # more cards of the model

    def deck(self, steps: str) -> str:
        """The deck; sets BLOCK (elements and nodes), BASE, BOTTOM and TOP are in it."""
        mesh, number = box_mesh(self.counts, stretched(self.size))
        base = add_base_joint(mesh, number[:, :, 0])
        if self.base_is_slave:
            mesh.joints = np.roll(mesh.joints, 4, axis=1)
        mesh.brick_sets["BLOCK"] = np.arange(len(mesh.bricks))
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
            mesh_deck(mesh, {"BLOCK": self.element}, "")
            + node_sets(self.sets)
            + material("STUFF", self.young, self.poisson, self.density)
            + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
            + f"*JOINT LAW, NAME=LAW, {self.law}\n"
            + f"*JOINT, NAME=BED, LAW=LAW, ELSET=BED{self.joint}\n"
            + "*BOUNDARY\nBASE, 1, 3\n"
            + self.cards
            + steps
        )

    @property
    def x(self) -> np.ndarray:
        """Nodes of the body, as the deck numbers them from 1 [m]."""
        return box_mesh(self.counts, stretched(self.size))[0].x


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


def spring_and_mass(elements: int, stretch: float, release: str) -> str:
    """1 kg on a bed with friction 0.1, tied to a wall by a spring of 1e4 N/m: a massless brick.

    Held at `stretch` [m] while its weight comes on; `release` is the step that follows. Sets FAR
    (end of the spring), MOVING (the mass), BODY, BASE.
    """
    mesh, number = box_mesh((2 * elements, 1, 1), stretched((2.0, 1.0, 0.1)))
    base = add_base_joint(mesh, number[elements:, :, 0])
    mesh.brick_sets = {"SPRING": np.arange(elements), "BLOCK": np.arange(elements, 2 * elements)}
    mesh.joint_sets = {"BED": np.arange(elements)}
    mesh.node_sets = {
        "BASE": base.ravel(),
        "FAR": number[0].ravel(),
        "MOVING": number[elements:].ravel(),
        "BODY": number[elements:].ravel(),
        "SOLID": number.ravel(),
    }
    held = f"*BOUNDARY\nMOVING, 1, 1, {stretch!r}\n"
    return (
        mesh_deck(mesh, {"SPRING": "C3D8", "BLOCK": "C3D8"}, "")
        + material("SPRING", 1e5, 0.0, 0.0)
        + material("STUFF", 1e9, 0.0, 10.0)
        + "*SOLID SECTION, ELSET=SPRING, MATERIAL=SPRING\n"
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + "*JOINT LAW, NAME=LAW, KN=1e9, KT=1e9, FRICTION=0.1\n"
        + "*JOINT, NAME=BED, LAW=LAW, ELSET=BED\n"
        + "*BOUNDARY\nBASE, 1, 3\nFAR, 1, 3\nSOLID, 2\n"
        + f"*INITIAL CONDITIONS, TYPE=DISPLACEMENT\nMOVING, 1, {stretch!r}\n"
        + static(held + weight(10.0))
        + release
    )
