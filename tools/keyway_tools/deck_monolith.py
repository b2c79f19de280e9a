"""The monolith of the README: a mesh to include, and a deck of a few lines that uses it."""

from __future__ import annotations

import numpy as np

from .box_mesh import box_mesh
from .deck_text import comment, mesh_deck

LEVELS = np.array([0.0, 66.5, 103.0])  # [m] base, change of slope, crest
DOWNSTREAM = np.array([70.0, 19.25, 14.8])  # [m] of the downstream face at these levels
CELLS_ACROSS, CELLS_BELOW, CELLS_ABOVE = 8, 12, 8

MESH_HEAD = """\
Mesh and supports of monolith_water.inp: Koyna's section, 1 m thick, x downstream, z up.

Plane stress: one face is held along y, the other is free. The base is held along x and z.
"""
SUPPORTS = """*BOUNDARY
BASE, 1, 1
BASE, 3, 3
SLICE, 2, 2
"""
WATER_DECK = """\
** Koyna's section under 91.75 m of water, without weight: the deck of the README.
**
** Shows: *INCLUDE, *RESERVOIR, reactions, envelopes on the two faces.
** Assumes: plane stress (one face of the slice is held, the other free), a rigid base, no weight.
** Expect: horizontal reaction rho g H^2 / 2 = 4.129060e7 N on the slice of 1 m.
**   Source: hydrostatics.
*INCLUDE, INPUT=meshes/monolith_mesh.inp
*MATERIAL, NAME=CONCRETE
*ELASTIC
31.027e9, 0.2
*SOLID SECTION, ELSET=MONOLITH, MATERIAL=CONCRETE
*STEP, NAME=WATER
*STATIC
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=91.75, BED=0
*NODE PRINT, NSET=BASE
RF
*NODE FILE
U
*EL FILE
S, SP
*ENVELOPE
S1, S3, U
*END STEP
"""


def monolith_water() -> str:
    """The deck."""
    return WATER_DECK


def monolith_mesh() -> str:
    """The mesh file that the deck includes."""
    high = CELLS_BELOW + CELLS_ABOVE

    def place(a, b, c):
        z = np.interp(c * high, [0, CELLS_BELOW, high], LEVELS)
        return np.stack([a * np.interp(z, LEVELS, DOWNSTREAM), b * 1.0, z], axis=-1)

    mesh, number = box_mesh((CELLS_ACROSS, 1, high), place)
    mesh.brick_sets["MONOLITH"] = np.arange(len(mesh.bricks))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["SLICE"] = number[:, 0, :].ravel()
    mesh.surfaces["UPSTREAM"] = upstream_faces(mesh, number)
    return comment(MESH_HEAD) + "\n" + mesh_deck(mesh, {"MONOLITH": "C3D8I"}, "") + SUPPORTS


def upstream_faces(mesh, number: np.ndarray) -> list[tuple[int, int]]:
    """Elements and face numbers (S1..S6) whose four nodes lie at the heel's column of nodes."""
    corners = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))
    on_face = np.isin(mesh.bricks, number[0])
    return [
        (brick, face)
        for brick in range(len(mesh.bricks))
        for face, nodes in enumerate(corners, start=1)
        if on_face[brick, list(nodes)].all()
    ]
