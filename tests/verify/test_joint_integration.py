"""Where a joint is integrated: at the nodes its traction is smooth, at Gauss points it oscillates.

A strip of 16 cubes on a stiff bonded joint (k_n = k_t = 1e13 Pa/m, 400 times E/L of a cube) is
pulled up at one end; the traction should decay from there (docs/studies/joint_integration.md).
"""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import Block, static

PULL = 1e6  # at each of two nodes [N]


def strip_traction(keyway, integration: str) -> dict[str, np.ndarray]:
    """Points of the joint along the strip's side, in the order of x."""
    strip = Block(
        (16.0, 1.0, 1.0),
        (16, 1, 1),
        young=25e9,
        poisson=0.2,
        law="KN=1e13, KT=1e13, TENSILE STRENGTH=1e12",
        joint=f", INTEGRATION={integration}",
    )
    end = [i for i, x in enumerate(strip.x) if x[0] == 0.0 and x[2] == 1.0]
    strip.sets["END"] = np.array(end)
    run = keyway(
        strip.deck(static(f"*CLOAD\nEND, 3, {PULL!r}\n*JOINT PRINT, JOINT=BED\n")),
        name=integration,
    )
    table = run.csv("joint_BED")
    assert set(table["state"]) == {3.0}
    side = table["y"] < 0.4
    order = np.argsort(table["x"][side], kind="stable")
    points = {name: column[side][order] for name, column in table.items()}
    points["all"] = table["tn"]
    return points


def ripple(traction: np.ndarray) -> float:
    """Sum of the increases in the decay of the traction, over its largest value."""
    size = np.abs(traction)
    return np.sum(np.maximum(np.diff(size), 0.0)) / size.max()


def test_traction_is_smooth_at_nodes_and_oscillates_at_gauss_points(keyway):
    """Measured 1e-9 and 0.060; the unit test finds the same with a matrix of its own."""
    nodes = strip_traction(keyway, "NODES")
    gauss = strip_traction(keyway, "GAUSS")
    assert len(nodes["x"]) == 17 and len(gauss["x"]) == 32
    assert ripple(nodes["tn"]) < 1e-3
    assert ripple(gauss["tn"]) > 0.05


def test_both_rules_carry_the_load(keyway):
    """Equilibrium: area times traction adds up to the pull (round-off)."""
    nodes = strip_traction(keyway, "NODES")
    ends = np.isin(nodes["x"], (0.0, 16.0))
    area = np.where(ends, 0.25, 0.5)
    assert 2.0 * np.sum(area * nodes["tn"]) == pytest.approx(2.0 * PULL, rel=1e-6)
    gauss = strip_traction(keyway, "GAUSS")
    assert np.sum(0.25 * gauss["all"]) == pytest.approx(2.0 * PULL, rel=1e-6)
