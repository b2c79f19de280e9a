"""NAFEMS LE10, a thick elliptic plate under pressure: bending through the thickness, stresses.

The standard NAFEMS benchmarks, TNSB, rev. 3 (1990), LE10: a quarter between the ellipses with half
axes 2, 1 and 3.25, 2.75 m, 0.6 m thick; E 210 GPa, nu 0.3; 1 MPa on the upper face; straight sides
held by symmetry, the outer side held in its plane and, along its middle line, across. Target:
sigma_yy = -5.38 MPa at the inner end of the x axis, on the upper face.
"""

import numpy as np
import pytest
import pyvista
from brick_decks import brick_deck, elastic
from keyway_tools.box_mesh import box_mesh

THICKNESS = 0.6
TARGET = -5.38e6


def stress_at_target(keyway, element: str, counts: tuple[int, int, int]) -> float:
    """sigma_yy there, with so many elements outwards, around and through."""

    def place(a, b, c):
        angle = 0.5 * np.pi * b
        x = (2.0 + 1.25 * a) * np.cos(angle)
        y = (1.0 + 1.75 * a) * np.sin(angle)
        return np.stack([x, y, THICKNESS * c], axis=-1)

    mesh, number = box_mesh(counts, place)
    mesh.node_sets["ON_X"] = number[:, 0].ravel()
    mesh.node_sets["ON_Y"] = number[:, -1].ravel()
    mesh.node_sets["OUTSIDE"] = number[-1].ravel()
    mesh.node_sets["MIDDLE"] = number[-1, :, counts[2] // 2].ravel()
    top = set(number[:, :, -1].ravel().tolist())
    mesh.surfaces["TOP"] = [p[0] for nodes, p in mesh.exterior_faces().items() if nodes <= top]
    cards = elastic(210.0e9, 0.3) + "*BOUNDARY\nON_X, 2\nON_Y, 1\nOUTSIDE, 1, 2\nMIDDLE, 3\n"
    cards += "*STEP\n*STATIC\n*DSLOAD\nTOP, P, 1.e6\n*EL FILE\nS\n*END STEP\n"
    run = keyway(brick_deck(mesh, element, cards))
    grid = pyvista.read(sorted(run.folder.glob("job_vtk/*.vtu"))[-1])
    node = np.argmin(np.abs(grid.points - [2.0, 0.0, THICKNESS]).sum(axis=1))
    return float(grid.point_data["S"][node][1])


def test_bending_stress(keyway):
    """3 %: a stress at a corner is extrapolated from Gauss points, which is of first order; the
    excess over the target is 2.6, 2.1, 1.7 % with 8, 12, 16 layers."""
    assert stress_at_target(keyway, "C3D8I", (16, 24, 8)) == pytest.approx(TARGET, rel=0.03)
