"""Decks with temperatures: bricks that are free, held, layered or joined."""

from __future__ import annotations

import numpy as np
from stage_decks import step
from tied_blocks import Blocks

YOUNG, ALPHA, DENSITY = 20e9, 1e-5, 2400.0  # [Pa], [1/K], [kg/m3]
OUTPUT = "*NODE PRINT, NSET=ALL\nU, RF, TEMP\n*EL PRINT, ELSET=BODY\nS, E, THE\n"


def law(nu: float = 0.2, alpha: float = ALPHA, young: float = YOUNG) -> str:
    """An elastic material that expands."""
    return f"*DENSITY\n{DENSITY!r}\n*ELASTIC\n{young!r}, {nu!r}\n*EXPANSION\n{alpha!r}\n"


def brick(counts=(2, 2, 2), size=(2.0, 1.0, 1.0)) -> Blocks:
    """One block A."""
    blocks = Blocks()
    blocks.add("A", *((n, 0.0, length) for n, length in zip(counts, size, strict=True)))
    return blocks


def model(blocks: Blocks, supports: str, material: str | dict = "", element: str = "C3D8") -> str:
    """The model; all nodes start at 10 degrees."""
    laws = material if isinstance(material, dict) else {"": material or law()}
    cards = f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 10.\n{supports}"
    return blocks.deck(laws, cards).replace("TYPE=C3D8", f"TYPE={element}")


def statically(blocks: Blocks, name: str = "A") -> str:
    """Supports of a block that hold it without force: three corners of its bottom."""
    nodes = blocks.nodes[name]
    a, b, c = nodes[0, 0, 0] + 1, nodes[-1, 0, 0] + 1, nodes[0, -1, 0] + 1
    return f"*BOUNDARY\n{a}, 1, 3\n{b}, 2, 3\n{c}, 3, 3\n"


def warm(value: float | str, data: str = "", output: str = OUTPUT) -> str:
    """A static step that warms all nodes to a temperature, or by data lines."""
    lines = value if isinstance(value, str) else f"ALL, {value!r}\n"
    return step(f"*TEMPERATURE\n{lines}{output}", data=data)


def lines_of(blocks: Blocks, field) -> str:
    """Data lines of a field over places (nodes, 3)."""
    values = field(blocks.x)
    return "".join(f"{i}, {v!r}\n" for i, v in enumerate(values.tolist(), 1))


def last_rows(run, table: str) -> dict[str, np.ndarray]:
    """The rows of the last increment."""
    rows = run.csv(table)
    end = rows["step"] == rows["step"][-1]
    end &= rows["increment"] == rows["increment"][end][-1]
    return {name: column[end] for name, column in rows.items()}


def components(rows: dict[str, np.ndarray], field: str) -> np.ndarray:
    """The six components of a tensor (rows, 6)."""
    names = ("11", "22", "33", "12", "13", "23")
    return np.stack([rows[f"{field}{name}"] for name in names], axis=-1)


def balances(run, tolerance: float = 1e-11) -> None:
    """The energies balance to round-off in every step."""
    assert max(s["energy"]["error"] for s in run.json["steps"]) < tolerance
