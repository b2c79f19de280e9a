"""A case in Keyway."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from keyway_tools.deck_text import mesh_deck

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
    write_text,
)
from .timed_process import run_timed


def run_keyway(case: PeerCase, folder: Path, program: Path, threads: int, limit: float) -> PeerRun:
    """Writes the deck, runs it and reads the displacements of the control node."""
    deck = write_text(folder / "case.inp", deck_lines(case))
    np.savetxt(folder / "motion.txt", case.motion, fmt="%.12g")
    wall, memory, code = run_timed(
        [str(program), "-q", "-j", str(threads), str(deck)], folder, limit
    )
    if code:
        return PeerRun("Keyway", wall, memory, failure=f"exit code {code}")
    table = np.genfromtxt(folder / "case_node_CONTROL.csv", delimiter=",", names=True)
    columns = [name for name in table.dtype.names if name.startswith(("U1", "U2", "U3"))]
    rows = np.atleast_1d(table)[-max(case.num_increments, 1) :]
    return PeerRun("Keyway", wall, memory, np.array([rows[name] for name in columns]).T)


def deck_lines(case: PeerCase) -> list[str]:
    mesh = case.mesh
    lines = mesh_deck(mesh, dict.fromkeys(mesh.brick_sets, "C3D8"), "").splitlines()
    lines += ["*NSET, NSET=CONTROL", str(case.control_node + 1)]
    lines += ["*MATERIAL, NAME=CONCRETE", "*DENSITY", f"{CONCRETE[2]}"]
    lines += ["*ELASTIC", f"{CONCRETE[0]}, {CONCRETE[1]}"]
    lines += ["*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE"]
    if "ROCK" in mesh.brick_sets:
        lines += ["*MATERIAL, NAME=ROCK", "*ELASTIC", f"{ROCK[0]}, {ROCK[1]}"]
        lines += ["*SOLID SECTION, ELSET=ROCK, MATERIAL=ROCK"]
    if mesh.joint_sets:
        lines += [
            f"*JOINT LAW, NAME=LAW, KN={NORMAL_STIFFNESS}, KT={SHEAR_STIFFNESS}, "
            f"TENSILE STRENGTH=0, FRICTION={FRICTION}, COHESION=0"
        ]
        lines += [f"*JOINT, NAME={name}, LAW=LAW, ELSET={name}" for name in mesh.joint_sets]
    lines += ["*BOUNDARY", "FIXED, 1, 3"]
    if case.has_weight:
        lines += ["*STEP", "*STATIC", "1., 1.", "*DLOAD", f"DAM, GRAV, {GRAVITY}, 0., 0., -1."]
        lines += ["*NODE PRINT, NSET=CONTROL", "U", "*END STEP"]
    if case.num_increments:
        duration = case.num_increments * INCREMENT
        lines += [f"*AMPLITUDE, NAME=MOTION, INPUT=motion.txt, FORMAT=VALUES, DT={INCREMENT}"]
        lines += ["*STEP, INC=1000000", f"*DYNAMIC, DIRECT, ALPHA={ALPHA}"]
        lines += [f"{INCREMENT}, {duration}", "*BASE MOTION, DOF=1, AMPLITUDE=MOTION"]
        lines += ["*NODE PRINT, NSET=CONTROL", "U", "*END STEP"]
    return lines
