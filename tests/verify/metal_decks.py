"""Decks of metal plasticity and their closed forms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Steel:
    """*ELASTIC and the table of *PLASTIC: rows of yield stress [Pa] and plastic strain."""

    young: float
    poisson: float
    table: tuple[tuple[float, float], ...]

    @property
    def cards(self) -> str:
        rows = "\n".join(f"{stress!r}, {strain!r}" for stress, strain in self.table)
        return f"*ELASTIC\n{self.young}, {self.poisson}\n*PLASTIC\n{rows}\n"

    def yield_stress(self, strain):
        """Linear between the rows, constant past the last one."""
        stress, plastic = np.array(self.table).T
        return np.interp(strain, plastic, stress)

    def work(self, strain: float) -> float:
        """Area below the table [J/m3]; the trapezoids of its rows are exact."""
        rows = [row[1] for row in self.table if row[1] < strain]
        at = np.array([*rows, strain])
        return float(np.trapezoid(self.yield_stress(at), at)) if len(at) > 1 else 0.0

    def tension_test(self, strain) -> np.ndarray:
        """Columns stress, plastic strain, its sum without sign, along a path of axial strains.

        One spring, and one slider whose resistance is the table: the slip solves a piecewise linear
        equation, found by bisection to the last digit.
        """
        plastic, total, rows = 0.0, 0.0, []
        for e in strain:
            trial = self.young * (e - plastic)
            low, high = 0.0, abs(trial) / self.young
            if abs(trial) <= self.yield_stress(total):
                high = 0.0
            for _ in range(100):
                mid = 0.5 * (low + high)
                over = abs(trial) - self.young * mid - self.yield_stress(total + mid)
                low, high = (mid, high) if over > 0.0 else (low, mid)
            slip = 0.5 * (low + high)
            plastic += np.sign(trial) * slip
            total += slip
            rows.append((self.young * (e - plastic), plastic, total))
        return np.array(rows)


@dataclass(frozen=True)
class Octant:
    """An eighth of a hollow sphere: three patches of n x n columns, `layers` along the radius."""

    n: int
    layers: int
    inside: float = 1.0
    outside: float = 2.0

    def mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (n, 3) and elements (n, 8) from 1; each patch numbers the layers first."""
        radii = np.geomspace(self.inside, self.outside, self.layers + 1)
        numbers: dict[tuple, int] = {}
        nodes: list[np.ndarray] = []

        def node(direction: np.ndarray, layer: int) -> int:
            key = (*np.round(direction, 9), layer)
            if key not in numbers:
                nodes.append(radii[layer] * direction)
                numbers[key] = len(nodes)
            return numbers[key]

        solids = []
        for axis in range(3):
            way = self._directions(axis)
            for p, q, r in np.ndindex(self.n, self.n, self.layers):
                ring = [way[p, q], way[p + 1, q], way[p + 1, q + 1], way[p, q + 1]]
                solids.append([node(w, r) for w in ring] + [node(w, r + 1) for w in ring])
        return np.array(nodes), np.array(solids)

    def _directions(self, axis: int) -> np.ndarray:
        """Unit vectors (n + 1, n + 1, 3) of the patch around an axis."""
        e = np.eye(3)
        corners = [
            e[axis],
            e[axis] + e[(axis + 1) % 3],
            e.sum(axis=0),
            e[axis] + e[(axis + 2) % 3],
        ]
        a, b, c, d = (v / np.linalg.norm(v) for v in corners)
        s, t = (
            g[..., None] for g in np.meshgrid(*2 * [np.linspace(0, 1, self.n + 1)], indexing="ij")
        )
        way = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
        way[np.abs(way) < 1e-12] = 0.0
        return way / np.linalg.norm(way, axis=2, keepdims=True)

    def cards(self, element: str) -> str:
        """Nodes, elements, the sets IN (innermost elements), OUT (nodes), and symmetry planes."""
        x, solids = self.mesh()
        text = "*NODE\n"
        text += "".join(
            f"{k + 1}, {p[0]:.16g}, {p[1]:.16g}, {p[2]:.16g}\n" for k, p in enumerate(x)
        )
        text += f"*ELEMENT, TYPE={element}, ELSET=ALL\n"
        text += "".join(f"{k + 1}, {', '.join(map(str, row))}\n" for k, row in enumerate(solids))
        inner = range(1, len(solids) + 1, self.layers)
        text += "*ELSET, ELSET=IN\n" + "".join(f"{k},\n" for k in inner)
        outer = np.flatnonzero(np.isclose(np.linalg.norm(x, axis=1), self.outside))
        text += "*NSET, NSET=OUT\n" + "".join(f"{k + 1},\n" for k in outer)
        for axis, name in enumerate("XYZ"):
            plane = np.flatnonzero(x[:, axis] == 0.0)
            text += f"*NSET, NSET=PLANE{name}\n" + "".join(f"{k + 1},\n" for k in plane)
        return text + "*BOUNDARY\nPLANEX, 1\nPLANEY, 2\nPLANEZ, 3\n"


def sphere_pressure(octant: Octant, strength: float, front: float) -> float:
    """Inner pressure of a sphere of an ideally plastic metal that yields out to the radius `front`.

    Hill 1950, The Mathematical Theory of Plasticity, V.2: by symmetry two principal stresses are
    equal, and the yield surface of von Mises is that of Tresca.
    """
    a, b = octant.inside, octant.outside
    return 2 * strength * np.log(front / a) + 2 / 3 * strength * (1 - (front / b) ** 3)


def sphere_growth(octant: Octant, steel: Steel, front: float) -> float:
    """Radial displacement of the outer face: outside of the front the sphere is elastic, with
    the hoop stress Y front^3/outside^3 at the outer face."""
    strength = steel.table[0][0]
    return (1 - steel.poisson) * strength * front**3 / (steel.young * octant.outside**2)
