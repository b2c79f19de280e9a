"""Common parts of the checks of cracking structures: cards of concrete, bars in tension, curves."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from brick_decks import brick_deck
from harness import Run
from joint_decks import static
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.mesh_data import BrickMesh

# Table 1 of the paper: tensile strength [Pa], inelastic strain, damage
TABLE_1 = np.array(
    [
        (2.480e6, 0.000e-3, 0.000),
        (0.858e6, 0.175e-3, 0.359),
        (0.545e6, 0.324e-3, 0.620),
        (0.415e6, 0.469e-3, 0.756),
        (0.294e6, 0.757e-3, 0.876),
        (0.234e6, 1.044e-3, 0.924),
        (0.198e6, 1.330e-3, 0.949),
        (0.169e6, 1.664e-3, 0.964),
    ]
)
Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Concrete:
    """The constants of *CONCRETE DAMAGED PLASTICITY, by default those of the paper."""

    young: float = 25e9  # [Pa]
    poisson: float = 0.167
    density: float = 0.0  # [kg/m3]
    flow: tuple[float, ...] = (32.5, 0.01, 1.125, 2.0 / 3.0, 0.0)
    recovery: str = "LEE-FENVES"
    tension_type: str = "STRAIN"
    tension: Rows = tuple((row[0], row[1]) for row in TABLE_1.tolist())
    damage: Rows = ()  # of tension, against the same abscissa
    compression: Rows = ((30e6, 0.0),)  # constant, as paper_notes.md, 12
    crushing: Rows = ()  # damage in compression
    w_t: float = 0.0
    w_c: float = 1.0
    long_elements: str = ""

    def cards(self, name: str) -> str:
        """*MATERIAL and all that belongs to it."""
        mass = f"*DENSITY\n{self.density!r}\n" if self.density else ""
        kind = "STRAIN" if self.tension_type == "STRAIN" else "DISPLACEMENT"
        long = f", LONG ELEMENTS={self.long_elements}" if self.long_elements else ""
        text = f"*MATERIAL, NAME={name}\n{mass}*ELASTIC\n{self.young!r}, {self.poisson!r}\n"
        text += f"*CONCRETE DAMAGED PLASTICITY, RECOVERY={self.recovery}\n" + rows([self.flow])
        text += "*CONCRETE COMPRESSION HARDENING\n" + rows(self.compression)
        text += f"*CONCRETE TENSION STIFFENING, TYPE={self.tension_type}{long}\n"
        text += rows(self.tension)
        if self.crushing:
            text += f"*CONCRETE COMPRESSION DAMAGE, TENSION RECOVERY={self.w_t!r}\n"
            text += rows(self.crushing)
        if self.damage:
            recovery = f"COMPRESSION RECOVERY={self.w_c!r}"
            text += f"*CONCRETE TENSION DAMAGE, TYPE={kind}, {recovery}\n" + rows(self.damage)
        return text


def rows(table) -> str:
    """Data lines of a table."""
    return "".join(", ".join(repr(float(value)) for value in row) + "\n" for row in table)


def paper_concrete(**other) -> Concrete:
    """Concrete of Table 1 with its damage."""
    return replace(Concrete(damage=tuple((row[2], row[1]) for row in TABLE_1.tolist())), **other)


@dataclass
class Bar:
    """A straight bar along x, one of whose elements is weaker; its sides are free to move.

    Sets LEFT, RIGHT (nodes of the ends), WEAK, REST (elements).
    """

    weak: Concrete
    rest: Concrete | None = None  # None: all elements are of the weak concrete
    length: float = 0.5  # [m]
    side: float = 0.1  # of the square section [m]
    num_rest: int = 0
    weak_at: int = 0  # position of the weak element
    element: str = "C3D8"
    sets: dict[str, np.ndarray] = field(default_factory=dict)

    def deck(self, steps: str) -> str:
        """The deck; the end at x = 0 is held along x, planes of symmetry hold the rest."""
        size = (self.length, self.side, self.side)
        mesh, number = box_mesh((1 + self.num_rest, 1, 1), stretched(size))
        name_held_faces(mesh, number)
        mesh.node_sets |= self.sets
        text = brick_deck(mesh, self.element, "")
        others = [e + 1 for e in range(1 + self.num_rest) if e != self.weak_at]
        text += f"*ELSET, ELSET=WEAK\n{self.weak_at + 1}\n"
        if others:
            text += "*ELSET, ELSET=REST\n" + "".join(f"{e}\n" for e in others)
        text += self.weak.cards("WEAK") + "*SOLID SECTION, ELSET=WEAK, MATERIAL=WEAK\n"
        if others:
            text += (self.rest or self.weak).cards("REST")
            text += "*SOLID SECTION, ELSET=REST, MATERIAL=REST\n"
        return text + "*BOUNDARY\nLEFT, 1\nFRONT, 2\nBELOW, 3\n" + steps


def name_held_faces(mesh: BrickMesh, number: np.ndarray) -> None:
    """Sets LEFT and RIGHT (ends in x), FRONT (y = 0) and BELOW (z = 0)."""
    mesh.node_sets |= {
        "LEFT": number[0].ravel(),
        "RIGHT": number[-1].ravel(),
        "FRONT": number[:, 0, :].ravel(),
        "BELOW": number[:, :, 0].ravel(),
    }


def pull(
    path, dt: float | None = None, cards: str = "", controls: str = "", largest: float = 0.05
) -> str:
    """A static step that moves RIGHT along x through the displacements of `path` [m].

    One second from each to the next; `dt` is the size of fixed increments [s], None lets them grow
    to `largest`.
    """
    times = np.arange(len(path) + 1)
    pairs = zip(times, [0.0, *path], strict=True)
    ramp = "".join(f"{float(t)!r}, {float(u)!r}\n" for t, u in pairs)
    step = static(
        controls
        + "*BOUNDARY, AMPLITUDE=PULL\nRIGHT, 1, 1, 1.\n"
        + "*NODE PRINT, NSET=RIGHT\nU, RF\n*EL PRINT, ELSET=WEAK\nS, E, DAMAGET, DAMAGEC\n"
        + cards,
        f"{dt or 0.01!r}, {float(times[-1])!r}" + ("" if dt else f", 1e-6, {largest!r}"),
    )
    if dt:
        step = step.replace("*STATIC\n", "*STATIC, DIRECT\n")
    return f"*AMPLITUDE, NAME=PULL\n{ramp}" + step


def force_of(run: Run, nodes: str = "RIGHT", dof: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [m] of a set's first node and the sum of its reactions [N], by increment."""
    table = run.csv(f"node_{nodes}")
    time, place = np.unique(table["time"], return_inverse=True)
    force = np.zeros(len(time))
    np.add.at(force, place, table[f"RF{dof}"])
    first = table["node"] == table["node"][0]
    return table[f"U{dof}"][first], force


def work_of(displacement: np.ndarray, force: np.ndarray) -> float:
    """Work [J] of a force along a curve from rest."""
    u = np.concatenate(([0.0], displacement))
    f = np.concatenate(([0.0], force))
    return float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(u)))
