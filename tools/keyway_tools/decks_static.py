"""Small decks at rest: a cantilever, a column, a block on a joint."""

from __future__ import annotations

import numpy as np

from .box_mesh import add_base_joint, box_mesh, quads, stretched
from .deck_text import small_deck


def cantilever() -> str:
    """Bending: incompatible modes find the beam's deflection with two elements over the depth."""
    mesh, number = box_mesh((20, 2, 2), stretched((10.0, 1.0, 1.0)))
    mesh.brick_sets["BEAM"] = np.arange(len(mesh.bricks))
    mesh.node_sets["ROOT"] = number[0].ravel()
    mesh.node_sets["TIP_CORNERS"] = number[-1, ::2, ::2].ravel()
    mesh.node_sets["TIP_EDGES"] = np.array(
        [number[-1, 0, 1], number[-1, 1, 0], number[-1, 1, 2], number[-1, 2, 1]]
    )
    mesh.node_sets["TIP"] = number[-1, 1:2, 1]
    return small_deck(CANTILEVER_HEAD, mesh, "C3D8I", CANTILEVER_CARDS)


CANTILEVER_HEAD = """\
Cantilever, 10 x 1 x 1 m, clamped at x = 0, 1 MN down at its tip.

Shows: *CLOAD on sets, incompatible modes (C3D8I) in bending, *NODE PRINT.
Assumes: linear concrete, E 30 GPa, nu 0.2; the tip load is spread over the end as a constant shear
  (1 : 2 : 4 for corner, edge, centre); no weight.
Expect: tip deflection U3 = -(P L^3 / (3 E I) + P L / (5/6 G A)) = -(0.133333 + 0.000960) m
  = -0.134293 m. Source: Timoshenko's beam; the clamped end and the mesh leave 0.7 %.
"""
CANTILEVER_CARDS = """
*MATERIAL, NAME=CONCRETE
*ELASTIC
30.e9, 0.2
*SOLID SECTION, ELSET=BEAM, MATERIAL=CONCRETE
*BOUNDARY
ROOT, 1, 3
*STEP, NAME=LOAD
*STATIC
*CLOAD
TIP_CORNERS, 3, -62500.
TIP_EDGES, 3, -125000.
TIP, 3, -250000.
*NODE PRINT, NSET=TIP
U
*NODE FILE
U
*EL FILE
S, SP
*ENVELOPE
S1, S3, U
*END STEP
"""


def gravity_column() -> str:
    """Own weight in a confined column: exact at the nodes with linear elements."""
    mesh, number = box_mesh((1, 1, 10), stretched((1.0, 1.0, 10.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:, :, -1].ravel()
    mesh.node_sets["ALL"] = number.ravel()
    return small_deck(COLUMN_HEAD, mesh, "C3D8", COLUMN_CARDS)


COLUMN_HEAD = """\
Column of concrete, 1 x 1 x 10 m, under its own weight, sides kept from moving out.

Shows: *DLOAD, GRAV, reactions, stresses at integration points.
Assumes: E 25 GPa, nu 0.2, rho 2400 kg/m3, g 9.81 m/s2; uniaxial strain.
Expect: settlement of the top rho g H^2 / (2 M) with M = E (1 - nu) / ((1 + nu) (1 - 2 nu))
  = 27.7778 GPa: U3 = -4.237920e-5 m, to round-off (linear elements are exact at a bar's nodes).
  Sum of the vertical reactions of BASE: rho g V = 235 440 N. Source: closed form.
"""
COLUMN_CARDS = """
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
25.e9, 0.2
*SOLID SECTION, ELSET=COLUMN, MATERIAL=CONCRETE
*BOUNDARY
ALL, 1, 2
BASE, 3, 3
*STEP, NAME=WEIGHT
*STATIC
*DLOAD
COLUMN, GRAV, 9.81, 0., 0., -1.
*NODE PRINT, NSET=TOP
U
*NODE PRINT, NSET=BASE
RF
*EL PRINT, ELSET=COLUMN
S
*NODE FILE
U, RF
*EL FILE
S
*END STEP
"""


def block_on_joint() -> str:
    """A gravity block that lifts its heel off a joint under water."""
    mesh, number = box_mesh((50, 1, 20), stretched((5.0, 1.0, 10.0)))
    mesh.brick_sets["BLOCK"] = np.arange(len(mesh.bricks))
    base = add_base_joint(mesh, number[:, :, 0])
    mesh.joint_sets["BED"] = np.arange(len(mesh.joints))
    mesh.node_sets["BASE"] = base.ravel()
    mesh.node_sets["HEEL"] = number[0, :, 0].ravel()
    mesh.node_sets["TOE"] = number[-1, :, 0].ravel()
    upstream = {frozenset(n) for n in quads(number[0])}
    mesh.surfaces["UPSTREAM"] = [
        pairs[0] for nodes, pairs in mesh.exterior_faces().items() if nodes in upstream
    ]
    return small_deck(BLOCK_HEAD, mesh, "C3D8", BLOCK_CARDS)


BLOCK_HEAD = """\
Gravity block, 5 m wide and 10 m high (a slice of 1 m), on a joint; water on its left side to 9 m.

Shows: *JOINT without strength, *RESERVOIR, a heel that opens, *JOINT PRINT, *ENVELOPE.
Assumes: block stiff against its bed (E 25 000 GPa, k_n 1e10 Pa/m), rho 2400 kg/m3, g 9.81 m/s2, no
  uplift in the joint, friction 0.6 (397 kN of water against 706 kN: it does not slide).
Expect, from the statics of a rigid block on a bed without tension: weight 1 177 200 N, moment of
  the water 1 191 915 Nm, so an eccentricity of 1.0125 m; the bed is pressed over 4.4625 m, the toe
  with 527 597 Pa: U3 of TOE = -5.27597e-5 m, opening at the heel 6.3547e-6 m. Areas lumped at the
  nodes of 50 elements and the block's own strain leave under 0.1 % at the toe, 0.5 % at the heel.
"""
BLOCK_CARDS = """
*MATERIAL, NAME=STIFF
*DENSITY
2400.
*ELASTIC
25.e12, 0.2
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STIFF
*JOINT LAW, NAME=CONTACT, KN=1.e10, KT=1.e10, FRICTION=0.6
*JOINT, NAME=BED, LAW=CONTACT, ELSET=BED
*BOUNDARY
BASE, 1, 3
*STEP, NAME=WEIGHT
*STATIC
*DLOAD
BLOCK, GRAV, 9.81, 0., 0., -1.
*END STEP
*STEP, NAME=WATER
*STATIC
0.2, 1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=9., BED=0.
*NODE PRINT, NSET=TOE
U
*NODE PRINT, NSET=HEEL
U
*JOINT PRINT, JOINT=BED
*NODE FILE
U
*EL FILE
S, OPENING
*ENVELOPE
OPENING, U
*END STEP
"""
