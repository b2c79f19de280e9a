"""Petersson's notched beam in three-point bending: a crack that runs up its ligament."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .box_mesh import box_mesh
from .deck_text import small_deck
from .mesh_data import BrickMesh

SPAN, DEPTH, NOTCH, THICKNESS = 2.0, 0.2, 0.1, 0.05  # [m]
YOUNG, POISSON, STRENGTH, FRACTURE = 30e9, 0.18, 3.33e6, 137.0  # [Pa], -, [Pa], [N/m]
COMPRESSION = 33e6  # [Pa], as in code_aster's test SSNP166
DEFLECTION = 0.8e-3  # largest, of the load [m]
# Openings of the rows of the exponential curve, in G_f / f_t
OPENINGS = np.array([0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0])


@dataclass(frozen=True)
class BeamMesh:
    """Sizes of the bricks: the column above the notch, its bricks up the ligament, the arms."""

    column: float = 0.02  # width of notch and column [m]
    ligament: int = 10  # bricks up the ligament
    below: int = 5  # bricks beside the notch
    arm: int = 12  # bricks along each arm, growing outwards
    growth: float = 1.25


def exponential_curve() -> np.ndarray:
    """Rows of stress [Pa], opening [m], damage: f_t exp(-f_t w / G_f), made to enclose G_f.

    The damage 1 - sigma / f_t keeps the effective strength at f_t. The chords of the curve lie
    above it, so the openings are reduced by the ratio of the areas.
    """
    stress = np.exp(-OPENINGS)
    area = np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(OPENINGS))
    opening = OPENINGS / area * FRACTURE / STRENGTH
    return np.stack([STRENGTH * stress, opening, 1.0 - stress], axis=1)


def bilinear_curve() -> np.ndarray:
    """Petersson's own law: to f_t / 3 at 0.8 G_f / f_t, to zero at 3.6 G_f / f_t; no damage."""
    opening = np.array([0.0, 0.8, 3.6]) * FRACTURE / STRENGTH
    stress = STRENGTH * np.array([1.0, 1.0 / 3.0, 0.0])
    return np.stack([stress, opening, np.zeros(3)], axis=1)


def concrete_cards(
    curve: np.ndarray, dilation: float = 32.5, compression: float = COMPRESSION
) -> str:
    """*MATERIAL of the beam; `compression` is its strength in compression [Pa]."""
    stiffening = "".join(f"{stress:.6e}, {opening:.6e}\n" for stress, opening, _ in curve)
    text = f"*MATERIAL, NAME=CONCRETE\n*ELASTIC\n{YOUNG!r}, {POISSON!r}\n"
    text += f"*CONCRETE DAMAGED PLASTICITY\n{dilation!r}, 0.1, 1.16, 0.6667, 0.\n"
    text += f"*CONCRETE COMPRESSION HARDENING\n{compression!r}, 0.\n"
    text += "*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT\n" + stiffening
    if curve[:, 2].any():
        damage = "".join(f"{d:.6f}, {opening:.6e}\n" for _, opening, d in curve)
        text += "*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT\n" + damage
    return text + "*SOLID SECTION, ELSET=BEAM, MATERIAL=CONCRETE\n"


def beam_mesh(cells: BeamMesh) -> BrickMesh:
    """The slab; sets of nodes LEFT, RIGHT (supports), LOADED, TIP (of the notch), SLICE."""
    arm = np.cumsum(cells.growth ** np.arange(cells.arm))
    arm = 0.5 * cells.column + (0.5 * (SPAN - cells.column)) * np.concatenate(
        ([0.0], arm / arm[-1])
    )
    along = np.concatenate((-arm[::-1], arm))
    lower = np.linspace(0.0, NOTCH, cells.below + 1)
    up = np.concatenate((lower, np.linspace(NOTCH, DEPTH, cells.ligament + 1)[1:]))
    counts = (len(along) - 1, 1, len(up) - 1)

    def place(a, b, c):
        x = np.interp(a * counts[0], np.arange(counts[0] + 1), along)
        z = np.interp(c * counts[2], np.arange(counts[2] + 1), up)
        return np.stack([x, b * THICKNESS, z], axis=-1)

    mesh, number = box_mesh(counts, place)
    middle = mesh.x[mesh.bricks].mean(axis=1)
    is_notch = (np.abs(middle[:, 0]) < 0.5 * cells.column) & (middle[:, 2] < NOTCH)
    mesh.bricks = mesh.bricks[~is_notch]
    mesh.brick_sets["BEAM"] = np.arange(len(mesh.bricks))
    sides = [cells.arm, cells.arm + 1]
    mesh.node_sets = {
        "LEFT": number[0, :, 0].ravel(),
        "RIGHT": number[-1, :, 0].ravel(),
        "LOADED": number[sides, :, -1].ravel(),
        "TIP": number[sides, :, cells.below].ravel(),
        "SLICE": number[:, 0, :].ravel(),
    }
    return mesh


def petersson_deck(cells: BeamMesh, concrete: str, element: str = "C3D8I") -> str:
    """The deck on a mesh; `concrete` are the cards of the material."""
    return small_deck(BEAM_HEAD, beam_mesh(cells), element, concrete + STEP_CARDS)


def petersson_beam() -> str:
    """The deck of input/."""
    return petersson_deck(BeamMesh(), concrete_cards(bilinear_curve()))


BEAM_HEAD = """\
Petersson's beam: span 2.0 m, depth 0.2 m, notched to half its depth, 50 mm thick, bent by a load
  at mid-span that is moved down until the crack has run up most of the ligament.

Shows: a crack whose curve is given against its opening (TYPE=DISPLACEMENT), so that the width of
  the elements does not matter; the softening branch, by moving the load; plastic strain.
Assumes: E 30 GPa, nu 0.18, f_t 3.33 MPa, G_f 137 N/m, f_c 33 MPa, Petersson's bilinear softening
  (to f_t / 3 at 0.8 G_f / f_t, to zero at 3.6 G_f / f_t); no weight. The notch is a gap of one row
  of bricks. One face of the slab is held across, the other is free.
Expect: 774 N at a deflection of 0.365 mm (TIP), 598 N at 0.607 mm, each within 5 %. Source:
  code_aster's test SSNP166 (cohesive elements, the data above) after Petersson (1981).
"""
STEP_CARDS = f"""\
*BOUNDARY
LEFT, 3
RIGHT, 3
LEFT, 1
SLICE, 2
*STEP, NAME=BENDING, INC=1000
*STATIC
0.01, 1., 1.e-6, 0.02
*BOUNDARY
LOADED, 3, 3, {-DEFLECTION!r}
*NODE PRINT, NSET=LOADED
U, RF
*NODE PRINT, NSET=TIP
U
*NODE FILE, FREQUENCY=10
U
*EL FILE, FREQUENCY=10
S, SP, PE
*ENVELOPE
S1, U
*END STEP
"""
