"""The arch dams that are measured: meshes of a wanted size or refinement, and their decks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck
from keyway_tools.arch_rock import RockOptions
from keyway_tools.arch_shape import ArchShape
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh

INCREMENT = 0.01  # [s]
ENVELOPES = "*ENVELOPE\n"  # and the line after it

# Concrete so strong and tough that no motion of the bench causes cracks.
STRONG = """*CONCRETE DAMAGED PLASTICITY
36.31, 0.1, 1.16, 0.6667, 0.
*CONCRETE COMPRESSION HARDENING
1.e9, 0.
1.2e9, 0.01
*CONCRETE TENSION STIFFENING, TYPE=GFI
1.e8, 1.e7
"""


def unknowns_of(mesh: BrickMesh) -> int:
    return 3 * (len(mesh.x) - len(mesh.node_sets["FIXED"]))


def dam_of_size(unknowns: int, num_joints: int = 0) -> BrickMesh:
    """The arch dam whose number of unknowns is nearest to the given one."""
    meshes: list[BrickMesh] = []
    smallest = int(0.8 * (unknowns / 3.4) ** (1.0 / 3.0))  # 2.5 to 3.4 levels**3 unknowns
    for levels in range(max(6, smallest), 80):
        meshes += [scaled_dam(levels, more, num_joints) for more in (0, 2, 4)]
        if unknowns_of(meshes[-3]) > unknowns:
            break
    return min(meshes, key=lambda mesh: abs(unknowns_of(mesh) - unknowns))


def scaled_dam(levels: int, more: int, num_joints: int) -> BrickMesh:
    """An arch dam with rock: numbers of elements proportional to `levels`, `more` along the arc."""
    layers = max(2, round(levels / 3))
    rock = RockOptions(num_upstream=layers, num_downstream=layers, num_deep=layers)
    bottom = 2 * max(1, levels // 6)
    options = DamOptions(
        num_arc=2 * levels + bottom + more,
        num_height=levels,
        num_thick=max(2, levels // 4),
        num_bottom=bottom,
        num_joints=num_joints,
        rock=rock,
    )
    return build_arch_dam(ArchShape(), options)


def refined_dam(factor: int, num_joints: int = 0) -> BrickMesh:
    """A small arch dam with every element divided by `factor` in each direction."""
    layers = 2 * factor
    rock = RockOptions(
        num_upstream=layers, num_downstream=layers, num_deep=layers, growth=1.6 ** (1.0 / factor)
    )
    options = DamOptions(
        num_arc=16 * factor,
        num_height=6 * factor,
        num_thick=2 * factor,
        num_bottom=4 * factor,
        num_joints=num_joints,
        rock=rock,
    )
    return build_arch_dam(ArchShape(), options)


def shaking(duration: float) -> np.ndarray:
    """A smooth base acceleration at every millisecond [m/s2]: a sum of sines."""
    t = np.arange(0.0, duration + 1.0e-9, 1.0e-3)
    sines = [(1.2, 1.7), (1.6, 2.9), (0.8, 5.3), (0.4, 8.1)]  # [m/s2], [Hz]
    build_up = np.minimum(1.0, t / 0.4) ** 2
    return build_up * sum(size * np.sin(2.0 * np.pi * hertz * t) for size, hertz in sines)


def write_deck(
    folder: Path,
    name: str,
    mesh: BrickMesh,
    duration: float = 0.0,
    increment: float = INCREMENT,
    element_type: str = "C3D8",
    num_modes: int = 0,
    has_envelopes: bool = True,
) -> Path:
    """Gravity and water, then optionally modes and a motion along the valley; no VTK output."""
    motions: tuple[str, ...] = ()
    if duration > 0.0:
        np.savetxt(folder / "motion.txt", shaking(duration), fmt="%.9g")
        motions = ("motion.txt",)
    options = DeckOptions(
        motions=motions,
        motion_dt=1.0e-3,
        duration=duration,
        increment=increment,
        num_modes=num_modes,
        picture_frequency=10**6,
    )
    types = dict.fromkeys(mesh.brick_sets, element_type)
    (folder / f"{name}_mesh.inp").write_text(mesh_deck(mesh, types, "Mesh of bench"))
    lines = arch_dam_deck(mesh, "bench", f"{name}_mesh.inp", options).splitlines(keepends=True)
    if not has_envelopes:
        lines = [
            line
            for line, before in zip(lines, ["", *lines[:-1]], strict=True)
            if ENVELOPES not in (line, before)
        ]
    deck = folder / f"{name}.inp"
    deck.write_text("".join(lines))
    return deck


def make_concrete(deck: Path) -> Path:
    """The same dam with a concrete that could crack."""
    lines = deck.read_text().splitlines(keepends=True)
    first = lines.index("*MATERIAL, NAME=CONCRETE\n")
    constants = first + lines[first:].index("*ELASTIC\n") + 1
    lines.insert(constants + 1, STRONG)
    deck.write_text("".join(lines))
    return deck
