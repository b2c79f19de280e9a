"""A case in OpenSees, by openseespy in a Python of its own; joints are contacts of two nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

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
    stopped_after,
)
from .timed_process import run_timed


def run_opensees(case: PeerCase, folder: Path, python: str, threads: int, limit: float) -> PeerRun:
    """Writes the model as arrays, lets `opensees_model.py` run it and reads the displacements."""
    mesh, pairs = case.mesh, case.pairs
    rock = mesh.brick_sets.get("ROCK", np.zeros(0, dtype=int))
    np.savez(
        folder / "case.npz",
        x=mesh.x,
        dam=mesh.bricks[mesh.brick_sets["DAM"]],
        rock=mesh.bricks[rock].reshape(-1, 8),
        fixed=mesh.node_sets["FIXED"],
        master=pairs.master,
        slave=pairs.slave,
        area=pairs.area,
        normal=pairs.normal,
        motion=case.motion,
        concrete=CONCRETE,
        ground=ROCK,
        joint=(NORMAL_STIFFNESS, SHEAR_STIFFNESS, FRICTION),
        control=case.control_node,
        gravity=GRAVITY if case.has_weight else 0.0,
        increment=INCREMENT,
        alpha=ALPHA,
    )
    script = Path(__file__).with_name("opensees_model.py")
    wall, memory, code = run_timed(
        [python, str(script), "case.npz", "answer.npy"],
        folder,
        limit,
        OMP_NUM_THREADS=str(threads),
    )
    answer = folder / "answer.npy"
    rows = np.load(answer) if answer.exists() else np.zeros((0, 3))
    if code == -9:
        return PeerRun("OpenSees", wall, memory, rows, stopped_after(limit, rows))
    if code:
        return PeerRun("OpenSees", wall, memory, rows, f"exit code {code}, {len(rows)} increments")
    return PeerRun("OpenSees", wall, memory, rows)
