"""Blocks with meshes of their own, to be tied: their decks, and what their nodes do."""

from __future__ import annotations

import numpy as np
from harness import Run

FACES = {"Z0": "S1", "Z1": "S2", "Y0": "S3", "X1": "S4", "Y1": "S5", "X0": "S6"}


class Blocks:
    """Bricks between lines, block by block; sides of blocks are surfaces like A_X1.

    A node is made anew for each block: blocks share nothing but ties, unless `merge` is called.
    """

    def __init__(self):
        self.x: list[np.ndarray] = []
        self.cards = ""
        self.blocks: dict[str, np.ndarray] = {}
        self.num_elements = 0
        self.lines: dict[str, tuple[np.ndarray, ...]] = {}

    def add(self, name: str, x, y, z) -> None:
        """A block with planes of nodes at x, y and z; (n, a, b) are n bricks from a to b."""
        lines = tuple(
            np.linspace(v[1], v[2], v[0] + 1) if isinstance(v, tuple) else np.asarray(v, float)
            for v in (x, y, z)
        )
        self.lines[name] = lines
        first = len(self.x)
        grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        nodes = first + np.arange(grid[..., 0].size).reshape(grid.shape[:3])
        self.x.extend(grid.reshape(-1, 3))
        self.blocks[name] = nodes
        n, m, o = (np.array(nodes.shape) - 1).tolist()
        numbers = self.num_elements + 1 + np.arange(n * m * o).reshape(n, m, o)
        self.num_elements += n * m * o
        self.cards += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n"
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        corners += [(i, j, 1) for i, j, _ in corners]
        for i, j, k in np.ndindex(n, m, o):
            of = [nodes[i + a, j + b, k + c] + 1 for a, b, c in corners]
            self.cards += ", ".join(map(str, [numbers[i, j, k], *of])) + "\n"
        sides = {
            "X0": numbers[0], "X1": numbers[-1], "Y0": numbers[:, 0], "Y1": numbers[:, -1],
            "Z0": numbers[:, :, 0], "Z1": numbers[:, :, -1],
        }  # fmt: skip
        for side, elements in sides.items():
            self.cards += f"*SURFACE, NAME={name}_{side}, TYPE=ELEMENT\n"
            self.cards += "".join(f"{e}, {FACES[side]}\n" for e in elements.ravel())

    @property
    def positions(self) -> np.ndarray:
        return np.array(self.x)

    def on_box(self, low, high) -> np.ndarray:
        """Nodes on the six planes of a box (positions)."""
        x = self.positions
        return np.nonzero((np.isclose(x, low) | np.isclose(x, high)).any(axis=1))[0]

    def side(self, name: str, side: str) -> np.ndarray:
        """Nodes of a side of a block (positions)."""
        pick = {"0": 0, "1": -1}[side[1]]
        return np.take(self.blocks[name], pick, axis="XYZ".index(side[0])).ravel()

    def deck(self, material: str, steps: str) -> str:
        """Nodes, elements, surfaces, one material for all blocks, sets ALL; then the rest."""
        text = "*NODE, NSET=ALL\n"
        text += "".join(f"{i}, {p[0]!r}, {p[1]!r}, {p[2]!r}\n" for i, p in
                        enumerate(self.positions.tolist(), 1))  # fmt: skip
        text += self.cards + f"*MATERIAL, NAME=M\n{material}"
        for name in self.blocks:
            text += f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n"
        return text + "*ELSET, ELSET=BODY\n" + ", ".join(self.blocks) + "\n" + steps


def prescribe(nodes: np.ndarray, u: np.ndarray) -> str:
    """Data lines of *BOUNDARY: displacements (nodes of the model, 3) of some nodes."""
    return "".join(
        f"{n + 1}, {i + 1}, {i + 1}, {float(u[n, i])!r}\n" for n in nodes for i in range(3)
    )


def state_of(run: Run, name: str, field: str = "U", step: int | None = None) -> np.ndarray:
    """Vectors (nodes, 3) of a set at the end of the run or of a step, in the order of the ids."""
    table = run.csv(f"node_{name}")
    last = table["step"] == (table["step"][-1] if step is None else step)
    last &= table["increment"] == table["increment"][last][-1]
    order = np.argsort(table["node"][last])
    return np.stack([table[f"{field}{i}"][last][order] for i in (1, 2, 3)], axis=1)
