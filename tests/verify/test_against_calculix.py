"""The same arch dam in CalculiX: static displacements, frequencies, a history in time.

No joints; bricks C3D8, some of them wedges with repeated nodes at the abutment. Both programs read
the same cards for mesh, material, supports; only where a keyword has no match is it written twice.
CalculiX prints seven digits.
"""

import numpy as np
import pytest
from brick_decks import last_state
from calculix import displacements, needs_calculix, run_calculix, table_below
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.deck_text import mesh_deck

pytestmark = [pytest.mark.full, needs_calculix]

DT, DURATION = 0.01, 2.0  # [s]
GRAVITY = 9.81
CONCRETE = """\
*MATERIAL, NAME=CONCRETE
*ELASTIC
22.e9, 0.167
*DENSITY
2400.
*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*BOUNDARY
FIXED, 1, 3
"""


@pytest.fixture(scope="module")
def body() -> str:
    """Mesh, material and supports: a dam of 135.5 m, 108 elements of which 24 are wedges."""
    options = DamOptions(
        num_arc=14, num_height=6, num_thick=2, num_bottom=2, num_joints=0, rock=None
    )
    mesh = build_arch_dam(ArchShape(), options)
    mesh.node_sets["ALL"] = np.arange(len(mesh.x))
    return mesh_deck(mesh, {"DAM": "C3D8"}, "") + CONCRETE


def test_weight(keyway, body, tmp_path):
    """1e-6 of the largest displacement; half of the seventh digit is up to 5e-7."""
    step = "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n"
    deck = body + step + "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    other = displacements(run_calculix(deck, tmp_path))[1.0]
    ours = last_state(keyway(deck), "ALL")
    apart = np.abs(ours - other).max() / np.abs(other).max()
    assert apart < 1e-6


def test_modes(keyway, body, tmp_path):
    """1e-5; half of the seventh digit is up to 5e-7. Effective masses cannot be compared: those of
    CalculiX leave out the mass at the supports, which the base moves too."""
    deck = body + "*STEP\n*FREQUENCY\n5\n*END STEP\n"
    lines = run_calculix(deck, tmp_path)
    modes = keyway(deck).json["steps"][0]["frequencies"]
    hz = np.array([mode["hz"] for mode in modes])
    other = table_below(lines, "E I G E N V A L U E")[:, 3]
    assert hz == pytest.approx(other, rel=1e-5)


def test_history(keyway, body, tmp_path):
    """HHT with alpha -0.05 in both: 1e-3 of the largest displacement leaves room for another start
    of the step. The motion of the base here is a body force there."""
    time = np.arange(0.0, DURATION + 0.5 * DT, DT)
    motion = 0.3 * GRAVITY * np.sin(2.0 * np.pi * 2.0 * time) * np.minimum(time, 1.0)
    pairs = zip(time.tolist(), motion.tolist(), strict=True)
    amplitude = "*AMPLITUDE, NAME=QUAKE\n" + "".join(f"{t:.2f}, {a:.12e}\n" for t, a in pairs)
    head, supports = body.split("*BOUNDARY\n")
    start = head + amplitude + "*BOUNDARY\n" + supports
    start += f"*STEP, INC=1000\n*DYNAMIC, DIRECT, ALPHA=-0.05\n{DT}, {DURATION}\n"
    prints = "*NODE PRINT, NSET=CROWN\nU\n*END STEP\n"
    force = "*DLOAD, AMPLITUDE=QUAKE\nDAM, GRAV, 1., 0., -1., 0.\n"
    other = displacements(run_calculix(start + force + prints, tmp_path))
    table = keyway(start + "*BASE MOTION, DOF=2, AMPLITUDE=QUAKE\n" + prints).csv("node_CROWN")
    expected = np.concatenate([other[t] for t in sorted(other)])
    ours = np.stack([table[f"U{i}"] for i in (1, 2, 3)], axis=1)[-len(expected) :]
    apart = np.abs(ours - expected).max() / np.abs(expected).max()
    assert len(other) == round(DURATION / DT)
    assert apart < 1e-3
