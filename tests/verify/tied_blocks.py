"""Tied blocks with meshes of their own: decks and motions of nodes."""

from __future__ import annotations

import numpy as np
from harness import Run

FACES = {"Z0": "S1", "Z1": "S2", "Y0": "S3", "X1": "S4", "Y1": "S5", "X0": "S6"}
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


class Blocks:
    """Bricks between planes, block by block; sides of blocks are surfaces like A_X1.

    Each block has nodes of its own, until `share` is called.
    """

    def __init__(self):
        self.x = np.zeros((0, 3))
        self.nodes: dict[str, np.ndarray] = {}  # positions, by i, j, k

    def add(self, name: str, x, y, z) -> None:
        """A block with planes of nodes at x, y and z; (n, a, b) are n bricks from a to b."""
        lines = (
            np.linspace(v[1], v[2], v[0] + 1) if isinstance(v, tuple) else np.asarray(v, float)
            for v in (x, y, z)
        )
        grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        self.nodes[name] = len(self.x) + np.arange(grid[..., 0].size).reshape(grid.shape[:3])
        self.x = np.concatenate([self.x, grid.reshape(-1, 3)])

    def share(self, a: str, b: str, where=None) -> None:
        """Block b takes the nodes of block a that lie where its own do (and `where` holds)."""
        own = self.nodes[b].ravel()
        for k, node in enumerate(own):
            near = np.nonzero(np.isclose(self.x[self.nodes[a]], self.x[node]).all(axis=-1))
            if len(near[0]) and (where is None or where(self.x[node])):
                own[k] = self.nodes[a][near][0]
        self.nodes[b] = own.reshape(self.nodes[b].shape)

    def side(self, name: str, side: str) -> np.ndarray:
        """Nodes of a side of a block (positions)."""
        pick = {"0": 0, "1": -1}[side[1]]
        return np.take(self.nodes[name], pick, axis="XYZ".index(side[0])).ravel()

    def on_box(self, low, high) -> np.ndarray:
        """Nodes in use on the six planes of a box (positions)."""
        used = np.unique(np.concatenate([n.ravel() for n in self.nodes.values()]))
        planes = (np.isclose(self.x, low) | np.isclose(self.x, high)).any(axis=1)
        return used[planes[used]]

    def deck(self, materials: dict[str, str], cards: str) -> str:
        """The model with a material for each block (all have that of '' if there is one), sets ALL
        and BODY; then the rest.
        """
        text = "*NODE, NSET=ALL\n" + "".join(
            f"{i}, {x!r}, {y!r}, {z!r}\n" for i, (x, y, z) in enumerate(self.x.tolist(), 1)
        )
        count = 0
        for name, nodes in self.nodes.items():
            shape = tuple(n - 1 for n in nodes.shape)
            numbers = count + 1 + np.arange(np.prod(shape)).reshape(shape)
            count += numbers.size
            text += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n"
            for i, j, k in np.ndindex(shape):
                of = [nodes[i + a, j + b, k + c] + 1 for a, b, c in CORNERS]
                text += ", ".join(map(str, [numbers[i, j, k], *of])) + "\n"
            for side, face in FACES.items():
                behind = np.take(numbers, {"0": 0, "1": -1}[side[1]], axis="XYZ".index(side[0]))
                text += f"*SURFACE, NAME={name}_{side}, TYPE=ELEMENT\n"
                text += "".join(f"{e}, {face}\n" for e in behind.ravel())
        for name, law in materials.items():
            text += f"*MATERIAL, NAME=M{name}\n{law}"
        for name in self.nodes:
            material = name if name in materials else ""
            text += f"*SOLID SECTION, ELSET={name}, MATERIAL=M{material}\n"
        return text + "*ELSET, ELSET=BODY\n" + ", ".join(self.nodes) + "\n" + cards


def ties(*pairs: tuple[str, str]) -> str:
    """*TIE of pairs of surfaces, slave first."""
    return "".join(f"*TIE, NAME=T{i}\n{s}, {m}\n" for i, (s, m) in enumerate(pairs))


def node_set(name: str, nodes) -> str:
    """*NSET of positions."""
    return f"*NSET, NSET={name}\n" + "".join(f"{n + 1}\n" for n in nodes)


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
