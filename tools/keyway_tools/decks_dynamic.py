"""Small decks in motion: a sliding block, the modes of a monolith."""

from __future__ import annotations

import numpy as np

from .box_mesh import add_base_joint, box_mesh, stretched
from .deck_text import small_deck

SLIDING_DT = 0.01  # [s]
SLIDING_DURATION = 6.0  # [s]
SLIDING_PEAK = 1.5  # [m/s2]


def sliding_base() -> str:
    """Base acceleration of the sliding block: six periods of a sine of 1 Hz."""
    t = SLIDING_DT * np.arange(round(SLIDING_DURATION / SLIDING_DT) + 1)
    wave = SLIDING_PEAK * np.sin(2.0 * np.pi * t)
    return "".join(f"{time:.2f}, {value:.12e}\n" for time, value in zip(t, wave, strict=True))


def sliding_block() -> str:
    """Coulomb friction on a shaken base."""
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.brick_sets["BLOCK"] = np.arange(1)
    base = add_base_joint(mesh, number[:, :, 0])
    mesh.joint_sets["BED"] = np.arange(1)
    mesh.node_sets["BASE"] = base.ravel()
    mesh.node_sets["TOP"] = number[:, :, 1].ravel()
    return small_deck(SLIDING_HEAD, mesh, "C3D8", SLIDING_CARDS)


SLIDING_HEAD = """\
Block of 1 m3 and 1 kg on a base that moves with 1.5 sin(2 pi t) m/s2; friction 0.1.

Shows: *BASE MOTION, an amplitude from a file, Coulomb friction, the energy balance.
Assumes: g 10 m/s2; block and bed stiff against the motion (elastic slip 1e-6 m); motion relative to
  the base.
Expect in the steady state: slip from peak to peak 0.0204531 m, so that friction takes
  2 * 0.0204531 m * 1 N = 0.0409062 J in each period. Below 1 m/s2 it never slides. The time step
  leaves 0.2 %. Source: closed form; the same numbers in code_aster's test SDND104.
"""
SLIDING_CARDS = """
*MATERIAL, NAME=LIGHT
*DENSITY
1.
*ELASTIC
1.e7, 0.
*SOLID SECTION, ELSET=BLOCK, MATERIAL=LIGHT
*JOINT LAW, NAME=SLIDE, KN=1.e6, KT=1.e6, FRICTION=0.1
*JOINT, NAME=BED, LAW=SLIDE, ELSET=BED
*AMPLITUDE, NAME=SINE, INPUT=sliding_block_base.txt, FORMAT=PAIRS
*BOUNDARY
BASE, 1, 3
*STEP, NAME=WEIGHT
*STATIC
*DLOAD
BLOCK, GRAV, 10., 0., 0., -1.
*END STEP
*STEP, NAME=SHAKING, INC=10000
*DYNAMIC, DIRECT
0.005, 6.
*BASE MOTION, DOF=1, AMPLITUDE=SINE, TYPE=ACCELERATION
*NODE PRINT, NSET=TOP
U, V
*JOINT PRINT, JOINT=BED
*NODE FILE, FREQUENCY=20
U
*ENVELOPE
OPENING, U
*END STEP
"""


def monolith_frequencies() -> str:
    """Natural frequencies of the Koyna monolith, plane stress."""
    levels = np.array([0.0, 66.5, 103.0])
    downstream = np.array([70.0, 19.25, 14.8])
    below, above = 30, 18

    def place(a, b, c):
        z = np.interp(c * (below + above), [0, below, below + above], levels)
        return np.stack([a * np.interp(z, levels, downstream), b * 1.0, z], axis=-1)

    mesh, number = box_mesh((16, 1, below + above), place)
    mesh.brick_sets["MONOLITH"] = np.arange(len(mesh.bricks))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["SLICE"] = number[:, 0, :].ravel()
    return small_deck(MONOLITH_HEAD, mesh, "C3D8I", MONOLITH_CARDS)


MONOLITH_HEAD = """\
Koyna monolith, empty, on a rigid base: natural frequencies.

Shows: *FREQUENCY, effective masses, incompatible modes.
Assumes: 103 m high, 70 m wide at the base, 14.8 m at the crest, 19.25 m where the downstream face
  changes slope (66.5 m); upstream face vertical; E 31.027 GPa, nu 0.2, rho 2643 kg/m3.
  Plane stress: a slice of 1 m whose one face is held along y (a plane of symmetry) and whose other
  face is free; the one element between them may change its thickness, so that its stress along y
  vanishes. The base is held along x and z.
Expect: 18.86, 49.97, 68.16, 98.27 rad/s = 3.002, 7.953, 10.848, 15.640 Hz within 1 %.
  Source: Koyna dam in the literature (Chopra and Chakrabarti 1973: 19.27, 51.50, 67.56, 99.73),
  where nu is 0.15 or 0.2. A fine plane mesh gives 18.91, 50.21, 68.19, 98.98 with 0.2 and 18.92,
  50.49, 68.20, 99.85 with 0.15: only 0.2 brings all four back.
"""
MONOLITH_CARDS = """
*MATERIAL, NAME=CONCRETE
*DENSITY
2643.
*ELASTIC
31.027e9, 0.2
*SOLID SECTION, ELSET=MONOLITH, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 1
BASE, 3, 3
SLICE, 2, 2
*STEP, NAME=MODES
*FREQUENCY
5
*END STEP
"""
