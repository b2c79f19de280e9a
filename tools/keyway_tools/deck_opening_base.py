"""A monolith that is shaken until its base joint opens: a small dynamic deck with a joint."""

from __future__ import annotations

import numpy as np

from .box_mesh import add_base_joint, box_mesh, stretched
from .deck_text import small_deck

WIDTH, HEIGHT = 8.0, 16.0  # [m]
PEAK, FREQUENCY, DURATION = 3.5, 2.0, 1.0  # [m/s2], [Hz], [s]
STEP = 0.02  # [s] of the motion


def opening_base() -> str:
    """A slice of a monolith on a joint with its rock."""
    mesh, number = box_mesh((4, 1, 8), stretched((WIDTH, 1.0, HEIGHT)))
    mesh.brick_sets["MONOLITH"] = np.arange(len(mesh.bricks))
    base = add_base_joint(mesh, number[:, :, 0])
    mesh.joint_sets["BED"] = np.arange(len(mesh.joints))
    mesh.node_sets["BASE"] = base.ravel()
    mesh.node_sets["SLICE"] = number.ravel()
    mesh.node_sets["TOP"] = number[:, :, -1].ravel()
    return small_deck(HEAD, mesh, "C3D8I", CARDS.replace("MOTION\n", motion()))


def motion() -> str:
    """Pairs of time and acceleration: a sine of 2 Hz that rises and falls again within a second."""
    t = STEP * np.arange(round(DURATION / STEP) + 1)
    a = PEAK * np.sin(2.0 * np.pi * FREQUENCY * t) * np.sin(np.pi * t / DURATION) ** 2
    pairs = [f"{time:.2f}, {value:.5f}" for time, value in zip(t, a, strict=True)]
    return "".join(", ".join(pairs[k : k + 4]) + "\n" for k in range(0, len(pairs), 4))


HEAD = """\
Slice of a monolith, 8 m by 16 m, on a joint with rigid rock; a motion opens both its edges.

Shows: a joint that opens and closes in motion; a deck for tools/accuracy DECK --verify.
Assumes: g 9.81 m/s2; plane strain; no tensile strength; motion relative to the base.
Expect: under the weight -2400*9.81*16 = -376.7 kPa on all points of the joint, from the statics.
  Without inertia of its own the joint begins to open at g b/(3 h) = 1.64 m/s2, and the monolith
  would turn over at g b/h = 4.9 m/s2; the motion has 3.5 m/s2: it opens, and closes again.
"""
CARDS = f"""
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
20.e9, 0.2
*SOLID SECTION, ELSET=MONOLITH, MATERIAL=CONCRETE
*JOINT LAW, NAME=BASE_JOINT, KN=5.e10, KT=2.e10, FRICTION=1.0
*JOINT, NAME=BED, LAW=BASE_JOINT, ELSET=BED
*AMPLITUDE, NAME=SHAKE
MOTION
*BOUNDARY
BASE, 1, 3
SLICE, 2, 2
*STEP, NAME=WEIGHT
*STATIC
*DLOAD
MONOLITH, GRAV, 9.81, 0., 0., -1.
*JOINT PRINT, JOINT=BED
OPENING, TRACTION
*END STEP
*STEP, NAME=SHAKING, INC=100000
*DYNAMIC, DIRECT
0.01, {DURATION:g}
*DAMPING, RATIO=0.05, F1=5., F2=50.
*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, TYPE=ACCELERATION
*NODE PRINT, NSET=TOP
U
*ENVELOPE
S1, S3, OPENING, U
*END STEP
"""
