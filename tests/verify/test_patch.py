"""The patch test through decks: MacNeal & Harder's seven bricks with an inner skew one.

Coordinates of the inner nodes and the displacements of the outer ones are those of R.H. MacNeal &
R.L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20; exact: strains of 1e-3, direct
stresses of 2000 and shear stresses of 400 everywhere.
"""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from keyway_tools.mesh_data import BrickMesh

INNER = [
    (0.249, 0.342, 0.192),
    (0.826, 0.288, 0.288),
    (0.850, 0.649, 0.263),
    (0.273, 0.750, 0.230),
    (0.320, 0.186, 0.643),
    (0.677, 0.305, 0.683),
    (0.788, 0.693, 0.644),
    (0.165, 0.745, 0.702),
]
OUTER = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
# The inner brick and one on each of its faces; inner nodes are 0-7, outer ones 8-15.
BRICKS = [
    (0, 1, 2, 3, 4, 5, 6, 7),
    (8, 9, 10, 11, 0, 1, 2, 3),
    (4, 5, 6, 7, 12, 13, 14, 15),
    (8, 9, 1, 0, 12, 13, 5, 4),
    (9, 10, 2, 1, 13, 14, 6, 5),
    (10, 11, 3, 2, 14, 15, 7, 6),
    (11, 8, 0, 3, 15, 12, 4, 7),
]
# u = 1e-3 (2x + y + z) / 2 and cyclically: all six strains are 1e-3
GRADIENT = 1.0e-3 * np.array([[1.0, 0.5, 0.5], [0.5, 1.0, 0.5], [0.5, 0.5, 1.0]])
STRESS = np.array([2000.0, 2000.0, 2000.0, 400.0, 400.0, 400.0])


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_constant_strain_is_exact(keyway, element):
    """1e-10: round-off of a solve with a well-conditioned matrix, and 9 digits of the CSV."""
    mesh = BrickMesh(np.array(INNER + OUTER, dtype=float), np.array(BRICKS), np.zeros((0, 8)))
    mesh.node_sets["INSIDE"] = np.arange(8)
    exact = mesh.x @ GRADIENT.T
    cards = elastic(1.0e6, 0.25) + "*STEP\n*STATIC\n*BOUNDARY\n"
    for node in range(8, 16):
        cards += "".join(f"{node + 1}, {i + 1}, {i + 1}, {exact[node, i]}\n" for i in range(3))
    cards += "*NODE PRINT, NSET=INSIDE\nU\n*EL PRINT, ELSET=BODY\nS\n*END STEP\n"
    run = keyway(brick_deck(mesh, element, cards))
    table = run.csv("node_INSIDE")
    u = np.stack([table[f"U{i}"] for i in (1, 2, 3)], axis=1)
    assert np.abs(u - exact[:8]).max() < 1e-10 * np.abs(exact).max()
    stress = run.csv("el_BODY")
    names = ("S11", "S22", "S33", "S12", "S13", "S23")
    s = np.stack([stress[name] for name in names], axis=1)
    assert len(s) == 7 * (1 if element == "C3D8R" else 8)
    assert np.abs(s - STRESS).max() < 1e-10 * STRESS.max()
