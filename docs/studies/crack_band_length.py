"""Which width has the band of a crack? Energy that a crack takes in long bricks, by three rules.

    python docs/studies/crack_band_length.py [--program build/release/keyway] [--output TEXT]

A slab is torn in two along y. What the concrete dissipates by cracking over G_f times the area
of the crack should be 1, whatever the bricks are. The rules for the width l, with which the
opening of a crack becomes a strain:
  edges       l = sqrt(sum (g_i . n)^2), as in the program (theory.md, (11.11))
  cube root   l = cube root of the volume
  projection  l = sum |g_i . n|, the height of the element over the crack
g_i are the edges of the brick, n is the normal of the crack, here y. The program knows the first
alone; for the two others the table is divided by l beforehand and given against strain.

Meshes: bricks of side b and of length k b along y (crack across the long side), of length k b
along x (crack along the long side), and both turned by 45 degrees in the plane. The elements that
the line y = 0 cuts may crack, the others are elastic: the path is given, its energy is asked.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

YOUNG, POISSON, STRENGTH, ENERGY = 25e9, 0.2, 2.0e6, 2000.0
SIDE = 0.2
OPENING = 2.0 * ENERGY / STRENGTH  # w_u of linear softening
RESIDUAL = 1e-3  # share of the strength that stays (theory.md, 11.4)
RULES = ("edges", "cube root", "projection")


@dataclass
class Slab:
    """One layer of bricks in the plane z = 0, with the line y = 0 as the crack."""

    name: str
    plane: np.ndarray  # (nodes, 2)
    quads: np.ndarray  # (elements, 4)
    edges: np.ndarray  # (2, 2) rows are the edges of a brick in the plane
    half_height: float

    @property
    def cut(self) -> np.ndarray:
        """Elements that the crack goes through."""
        y = self.plane[self.quads, 1]
        return (y.min(axis=1) < -1e-9) & (y.max(axis=1) > 1e-9)

    @property
    def ligament(self) -> float:
        """Length of the crack inside the elements."""
        return sum(chord(self.plane[quad]) for quad in self.quads[self.cut])

    def width(self, rule: str) -> float:
        """l for a crack with the normal y."""
        reach = np.abs(self.edges[:, 1])
        if rule == "projection":
            return float(reach.sum())
        if rule == "cube root":
            return abs(float(np.linalg.det(self.edges)) * SIDE) ** (1 / 3)
        return float(np.hypot(*reach))


def chord(corners: np.ndarray) -> float:
    """Length of the line y = 0 inside a convex polygon."""
    crossings = []
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 * y1 < 0.0:
            crossings.append(x0 - y0 * (x1 - x0) / (y1 - y0))
    return max(crossings) - min(crossings)


def make_slab(name: str, first: np.ndarray, second: np.ndarray, half: float, width: float) -> Slab:
    """The bricks of a lattice whose centres lie in a rectangle around the crack."""
    reach = range(-60, 61)
    shift = -0.5 * first - 0.5 * second if abs(first[0] * first[1]) < 1e-12 else np.zeros(2)
    if np.any(shift == 0.0):  # turned: the line passes between two rows of nodes
        shift = np.array([0.0, 0.5 * min(abs(first[1]), abs(second[1]))])
    nodes: dict[tuple[int, int], int] = {}
    quads, plane = [], []
    for i in reach:
        for j in reach:
            centre = shift + (i + 0.5) * first + (j + 0.5) * second
            if abs(centre[0]) > width / 2 or abs(centre[1]) > half:
                continue
            quad = []
            for corner in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                if corner not in nodes:
                    nodes[corner] = len(plane)
                    plane.append(shift + corner[0] * first + corner[1] * second)
                quad.append(nodes[corner])
            quads.append(quad)
    return Slab(name, np.array(plane), np.array(quads), np.array([first, second]), half)


def slabs() -> list[Slab]:
    """All meshes of the study."""
    made = []
    turn = np.array([[1.0, 1.0], [-1.0, 1.0]]) / math.sqrt(2.0)
    for k in (1, 3, 5):
        long, short = np.array([0.0, k * SIDE]), np.array([SIDE, 0.0])
        made.append(make_slab(f"across the long side, {k}", short, long, 1.6 * k * SIDE, 0.8))
        if k > 1:
            long, short = np.array([k * SIDE, 0.0]), np.array([0.0, SIDE])
            made.append(
                make_slab(f"along the long side, {k}", long, short, 1.6 * SIDE, 2.1 * k * SIDE)
            )
    for k in (1, 3, 5):
        first, second = k * SIDE * turn[0], SIDE * turn[1]
        height = (k + 1) * SIDE / math.sqrt(2.0)
        made.append(
            make_slab(f"turned by 45 degrees, {k}", first, second, 2.6 * height, 1.2 * (k + 1))
        )
    return made


def deck_of(slab: Slab, rule: str) -> str:
    """The deck: grips above and below, pulled apart until the crack is open everywhere."""
    lines = ["*NODE"]
    count = len(slab.plane)
    for z in (0, 1):
        lines += [
            f"{n + 1 + z * count}, {x:.9g}, {y:.9g}, {z * SIDE}"
            for n, (x, y) in enumerate(slab.plane)
        ]
    for name, chosen in (("CRACK", slab.cut), ("REST", ~slab.cut)):
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for e in np.flatnonzero(chosen):
            below = slab.quads[e] + 1
            lines.append(", ".join(map(str, [e + 1, *below, *(below + count)])))
    grip = slab.half_height
    y = slab.plane[:, 1]
    # nodes of the elements farthest out are held
    reach = np.abs(slab.edges[:, 1]).sum()
    sets = {
        "LOWER": np.flatnonzero(y < -grip + 0.6 * reach),
        "UPPER": np.flatnonzero(y > grip - 0.6 * reach),
    }
    for name, nodes in sets.items():
        both = [*(nodes + 1), *(nodes + 1 + count)]
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in both)]
    lines += ["*NSET, NSET=BACK, GENERATE", f"1, {count}, 1"]
    for name in ("CRACK", "REST"):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{YOUNG}, {POISSON}"]
        if name == "CRACK":
            lines += ["*CONCRETE DAMAGED PLASTICITY", "45., 0.01"]
            lines += ["*CONCRETE COMPRESSION HARDENING", "30e6, 0."]
            lines += stiffening(rule, slab.width(rule))
        lines.append(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")
    lines += ["*BOUNDARY", "BACK, 3, 3", "LOWER, 1, 2", "UPPER, 1, 1"]
    lines += ["*STEP, INC=2000", "*STATIC", "0.01, 1., 1e-7, 0.02"]
    lines += ["*BOUNDARY", f"UPPER, 2, 2, {3.0 * OPENING}", "*END STEP", ""]
    return "\n".join(lines)


def stiffening(rule: str, width: float) -> list[str]:
    """Linear softening: by G_f, or for a given width against strain."""
    if rule == "edges":
        return ["*CONCRETE TENSION STIFFENING, TYPE=GFI", f"{STRENGTH}, {ENERGY}"]
    last = OPENING * (1.0 - RESIDUAL) / width
    return ["*CONCRETE TENSION STIFFENING", f"{STRENGTH}, 0.", f"{RESIDUAL * STRENGTH}, {last}"]


def energy_ratio(slab: Slab, rule: str, program: Path, folder: Path) -> float:
    """Energy of the crack over G_f times its area."""
    deck = folder / "slab.inp"
    deck.write_text(deck_of(slab, rule), encoding="utf-8")
    done = subprocess.run(
        [str(program.resolve()), "-q", "-o", str(folder), str(deck)], capture_output=True, text=True
    )
    if done.returncode != 0:
        return math.nan
    summary = json.loads((folder / "slab.json").read_text(encoding="utf-8"))
    fracture = summary["steps"][-1]["energy"]["fracture"]
    return fracture / (ENERGY * slab.ligament * SIDE)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=Path("build/release/keyway"))
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    lines = [f"{'mesh, aspect':28}" + "".join(f"{rule:>22}" for rule in RULES)]
    print(lines[0])
    with tempfile.TemporaryDirectory() as folder:
        for slab in slabs():
            row = f"{slab.name:28}"
            for rule in RULES:
                ratio = energy_ratio(slab, rule, given.program, Path(folder))
                row += f"{slab.width(rule):10.3f} m {ratio:9.3f}"
            lines.append(row)
            print(lines[-1], flush=True)
    if given.output:
        given.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
