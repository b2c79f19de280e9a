"""A case in CalculiX: joints are contact pairs with a linear pressure and friction."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from keyway_tools.deck_text import id_lines, node_lines
from keyway_tools.mesh_data import BrickMesh

from .peer_case import (
    ALPHA,
    CONCRETE,
    FRICTION,
    GRAVITY,
    INCREMENT,
    NORMAL_STIFFNESS,
    ROCK,
    SHEAR_STIFFNESS,
    PeerCase,
    PeerRun,
    brick_lines,
    stopped_after,
    write_text,
)
from .timed_process import run_timed


def run_calculix(case: PeerCase, folder: Path, program: str, threads: int, limit: float) -> PeerRun:
    """Writes the deck, runs it and reads the displacements of the control node."""
    write_text(folder / "case.inp", deck_lines(case))
    wall, memory, code = run_timed(
        [program, "-i", "case"], folder, limit, OMP_NUM_THREADS=str(threads)
    )
    rows = read_displacements(folder / "case.dat")[-max(case.num_increments, 1) :]
    if code == -9:
        # Rows of the weight cannot be told from those of the history after it.
        known = rows[:0] if case.has_weight and case.num_increments else rows
        return PeerRun("CalculiX", wall, memory, known, stopped_after(limit, known))
    if code or len(rows) < max(case.num_increments, 1):
        return PeerRun("CalculiX", wall, memory, rows, f"exit code {code}, {len(rows)} increments")
    return PeerRun("CalculiX", wall, memory, rows)


def read_displacements(path: Path) -> np.ndarray:
    """Rows of three displacements after each header of the .dat file."""
    number = r"[-+]?\d\.\d+E[-+]\d+"
    text = path.read_text() if path.exists() else ""
    rows = re.findall(rf"^\s+\d+\s+({number})\s+({number})\s+({number})\s*$", text, re.M)
    return np.array(rows, dtype=float).reshape(-1, 3)


def deck_lines(case: PeerCase) -> list[str]:
    mesh = case.mesh
    lines = ["*NODE, NSET=ALL", *node_lines(mesh.x)]
    for name, members in mesh.brick_sets.items():
        lines += brick_lines(mesh, members, name, "C3D8")
    lines += ["*NSET, NSET=FIXED", *id_lines(mesh.node_sets["FIXED"])]
    lines += ["*NSET, NSET=CONTROL", str(case.control_node + 1)]
    lines += ["*MATERIAL, NAME=CONCRETE", "*DENSITY", f"{CONCRETE[2]}"]
    lines += ["*ELASTIC", f"{CONCRETE[0]}, {CONCRETE[1]}"]
    lines += ["*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE"]
    if "ROCK" in mesh.brick_sets:
        lines += ["*MATERIAL, NAME=ROCK", "*DENSITY", "1.e-6"]  # a density is demanded
        lines += ["*ELASTIC", f"{ROCK[0]}, {ROCK[1]}"]
        lines += ["*SOLID SECTION, ELSET=ROCK, MATERIAL=ROCK"]
    if mesh.joint_sets:
        lines += contact_lines(mesh)
    lines += ["*BOUNDARY", "FIXED, 1, 3"]
    weight = ["*DLOAD", f"DAM, GRAV, {GRAVITY}, 0., 0., -1."]
    if case.has_weight:
        lines += ["*STEP, INC=1000", "*STATIC", "1., 1.", *weight, *request_lines()]
    if case.num_increments:
        duration = case.num_increments * INCREMENT
        lines += ["*AMPLITUDE, NAME=MOTION"]
        lines += [f"{k * INCREMENT:.10g}, {a:.12g}" for k, a in enumerate(case.motion)]
        lines += ["*STEP, INC=1000000", f"*DYNAMIC, DIRECT, ALPHA={ALPHA}"]
        lines += [f"{INCREMENT}, {duration}"]
        lines += ["*DLOAD, AMPLITUDE=MOTION", "DAM, GRAV, 1., -1., 0., 0."]
        lines += (weight if case.has_weight else []) + request_lines()
    return lines


def request_lines() -> list[str]:
    return ["*NODE PRINT, NSET=CONTROL", "U", "*END STEP"]


def contact_lines(mesh: BrickMesh) -> list[str]:
    """Both faces of each joint as surfaces, and the pair of them."""
    owner = {nodes: pairs[0] for nodes, pairs in mesh.exterior_faces().items()}
    lines = []
    for name, members in mesh.joint_sets.items():
        for side, corners in (("MASTER", slice(0, 4)), ("SLAVE", slice(4, 8))):
            lines += [f"*SURFACE, NAME={side}_{name}, TYPE=ELEMENT"]
            for element in mesh.joints[members]:
                brick, face = owner[frozenset(element[corners].tolist())]
                lines += [f"{brick + 1}, S{face}"]
        lines += [f"*SURFACE INTERACTION, NAME=LAW_{name}"]
        lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{NORMAL_STIFFNESS}, 0."]
        lines += ["*FRICTION", f"{FRICTION}, {SHEAR_STIFFNESS}"]
        lines += [f"*CONTACT PAIR, INTERACTION=LAW_{name}, TYPE=SURFACE TO SURFACE"]
        lines += [f"SLAVE_{name}, MASTER_{name}"]
    return lines
