"""Results of a run with joints: checked energies, and points of the joint."""

from __future__ import annotations

import numpy as np
from harness import Run


def sound_energy(run: Run) -> dict[str, np.ndarray]:
    """Checked table of the energies: the balance closes, and the scheme adds no energy.

    The balance is an identity but for the tolerance of the iteration (1e-6 of the forces); 0.1 % is
    allowed. The numerical dissipation of HHT may decrease temporarily by 1e-3.
    """
    table = run.csv("energy")
    largest = max(np.max(np.abs(table[name])) for name in ("kinetic", "strain", "external"))
    assert table["error"].max() < 1e-3
    taken = table["numerical"]
    assert np.min(taken - np.maximum.accumulate(taken)) > -1e-3 * largest
    assert taken.min() > -1e-4 * largest
    return table


def history(run: Run, x: float, name: str = "opening") -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and values of the joint's point at (x, 0, 0)."""
    table = run.csv("joint_BED")
    here = (np.abs(table["x"] - x) < 1e-9) & (np.abs(table["y"]) < 1e-9)
    return table["time"][here], table[name][here]
