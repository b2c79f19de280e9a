"""Koyna's monolith under weight, water and a strong motion: it cracks."""

from __future__ import annotations

import numpy as np

from .box_mesh import box_mesh
from .deck_monolith import DOWNSTREAM, LEVELS, upstream_faces
from .deck_text import small_deck
from .mesh_data import BrickMesh

ACROSS, BELOW, ABOVE = 18, 26, 14  # bricks
MOTION_DT, MOTION_DURATION, MOTION_PEAK = 0.01, 5.0, 2.0  # [s], [s], [m/s2]
WAVES = ((2.1, 0.5, 0.0), (3.1, 1.0, 1.0), (5.3, 0.6, 2.0))  # frequency [Hz], share, phase


def monolith_motion() -> str:
    """Base acceleration [m/s2]: three sines that rise over 1 s and fade from 3 s on."""
    t = MOTION_DT * np.arange(round(MOTION_DURATION / MOTION_DT) + 1)
    wave = sum(share * np.sin(2.0 * np.pi * hz * t + phase) for hz, share, phase in WAVES)
    shape = np.minimum(1.0, t) * np.clip((MOTION_DURATION - t) / 2.0, 0.0, 1.0)
    wave = wave * shape
    return "".join(f"{a:.6f}\n" for a in wave * (MOTION_PEAK / np.abs(wave).max()))


def monolith_mesh(across: int = ACROSS, below: int = BELOW, above: int = ABOVE) -> BrickMesh:
    """The section, one brick thick; sets BASE, SLICE, CREST, surface UPSTREAM."""

    def place(a, b, c):
        z = np.interp(c * (below + above), [0, below, below + above], LEVELS)
        return np.stack([a * np.interp(z, LEVELS, DOWNSTREAM), b * 1.0, z], axis=-1)

    mesh, number = box_mesh((across, 1, below + above), place)
    mesh.brick_sets["MONOLITH"] = np.arange(len(mesh.bricks))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["SLICE"] = number[:, 0, :].ravel()
    mesh.node_sets["CREST"] = number[:1, 0, -1].ravel()
    mesh.surfaces["UPSTREAM"] = upstream_faces(mesh, number)
    return mesh


def cracking_monolith() -> str:
    """The deck of input/."""
    return small_deck(HEAD, monolith_mesh(), "C3D8I", CARDS)


HEAD = """\
Koyna's section under weight, 91.75 m of water and 5 s of a strong motion: it cracks at its heel and
  near the change of slope of its downstream face.

Shows: *CONCRETE DAMAGED PLASTICITY in an earthquake: cracks that open and close (w_c = 1), damage
  in the pictures and in job.json, what cracking dissipates in the energy balance.
Assumes: section of monolith_frequencies.inp, 1 m thick, plane stress; rigid base. Concrete: E
  31.027 GPa, nu 0.2, rho 2643 kg/m3, f_t 2.0 MPa, G_f 300 N/m with damage 0.9 at the end of the
  crack's curve, compression as for Koyna in the literature (13 MPa, 24.1 MPa). A smaller G_f would
  snap back in bricks of up to 4.5 m: 2 E G_f / f_t^2 = 4.65 m. Damping 3 %. Motion (made up): three
  sines of 2.1, 3.1 and 5.3 Hz, the second near the first mode of the full dam, peak 2 m/s2.
Expect: a crack from the heel along the base and cracks through the neck, one brick wide, intact
  concrete elsewhere; compression nowhere above 13 MPa, so that what job.json counts as crushing is
  shear over closed cracks; an energy error below 1e-3. Source: where Koyna cracked in 1967, and
  the balance of energy. The row of bricks that a crack takes is sensitive to *CONTROLS and mesh.
"""
CARDS = """
*MATERIAL, NAME=CONCRETE
*DENSITY
2643.
*ELASTIC
31.027e9, 0.2
*CONCRETE DAMAGED PLASTICITY, RECOVERY=LEE-FENVES
36.31, 0.1, 1.16, 0.6667, 0.
*CONCRETE COMPRESSION HARDENING
13.0e6, 0.
24.1e6, 1.e-3
*CONCRETE TENSION STIFFENING, TYPE=GFI
2.e6, 300.
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT, COMPRESSION RECOVERY=1.
0., 0.
0.9, 3.e-4
*SOLID SECTION, ELSET=MONOLITH, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 1
BASE, 3, 3
SLICE, 2, 2
*AMPLITUDE, NAME=MOTION, INPUT=cracking_monolith_motion.txt, FORMAT=VALUES, DT=0.01
*STEP, NAME=WEIGHT_AND_WATER
*STATIC
0.5, 1.
*DLOAD
MONOLITH, GRAV, 9.81, 0., 0., -1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=91.75, BED=0, ADDED MASS=WESTERGAARD
*END STEP
*STEP, NAME=MOTION, INC=100000
*DYNAMIC
0.01, 6., 1.e-5, 0.01
*DAMPING, RATIO=0.03, F1=2.5, F2=12.
*BASE MOTION, DOF=1, AMPLITUDE=MOTION
*NODE PRINT, NSET=CREST
U
*NODE FILE, FREQUENCY=20
U
*EL FILE, FREQUENCY=20
S, SP, PE, DAMAGET
*ENVELOPE
S1, S3, DAMAGET, U
*END STEP
"""
