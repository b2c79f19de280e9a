"""Common parts of the checks of solids: decks of mapped boxes, last state of a set of nodes."""

from __future__ import annotations

import numpy as np
from harness import Run
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh


def brick_deck(mesh: BrickMesh, element_type: str, cards: str) -> str:
    """Deck of a mesh whose bricks make the set BODY."""
    mesh.brick_sets["BODY"] = np.arange(len(mesh.bricks))
    return mesh_deck(mesh, {"BODY": element_type}, "") + cards


def elastic(modulus: float, poisson: float, density: float | None = None) -> str:
    """Cards of the material of BODY."""
    mass = "" if density is None else f"*DENSITY\n{density!r}\n"
    law = f"*MATERIAL, NAME=M\n{mass}*ELASTIC\n{modulus!r}, {poisson!r}\n"
    return law + "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n"


def nodal_forces(forces: dict[int, tuple[float, ...]]) -> str:
    """Data lines of *CLOAD: forces by position of the node; components of zero are left out."""
    return "".join(
        f"{node + 1}, {dof}, {float(value)!r}\n"
        for node, force in forces.items()
        for dof, value in enumerate(force, start=1)
        if value
    )


def last_state(run: Run, name: str, field: str = "U") -> np.ndarray:
    """Vectors (nodes, 3) of a set at the end of the run, in the order of the node ids."""
    table = run.csv(f"node_{name}")
    last = (table["step"] == table["step"][-1]) & (table["increment"] == table["increment"][-1])
    order = np.argsort(table["node"][last])
    return np.stack([table[f"{field}{i}"][last][order] for i in (1, 2, 3)], axis=1)


def order_of(sizes, errors) -> float:
    """Order of convergence: slope of log error over log size, of the finest pair."""
    return float(np.log(errors[-2] / errors[-1]) / np.log(sizes[-2] / sizes[-1]))
