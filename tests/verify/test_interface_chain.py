"""The paper's chain on blocks whose meshes differ: fine block, springs of *INTERFACE (Eq. 8), quads
with nodes of their own, JOINT8, coarse block."""

from __future__ import annotations

import numpy as np
import pytest
from exact_fields import uniform
from joint_decks import amplitude, dynamic, static
from loaded_pairs import Loaded
from mesh_pairs import Pair, Side, graded, scattered, skewed

SPRINGS, KN, KT = 22e9, 1.1e12, 4e11  # [Pa/m]
GIVE = np.array([1 / SPRINGS + 1 / KT, 1 / SPRINGS + 1 / KT, 1 / SPRINGS + 1 / KN])  # [m/Pa]
STRESS = 1e6 * np.array([[1.0, 0.4, -0.3], [0.4, -2.0, 0.5], [-0.3, 0.5, 1.5]])  # [Pa]
MESHES = {
    "3:2": (Side((6, 3, 1)), Side((4, 2, 1))),
    "graded 1:10 against even": (Side((7, 7, 1), graded(10.0)), Side((3, 2, 1))),
    "skewed against lots": (Side((5, 6, 1), skewed(0.1)), Side((3, 4, 1), scattered(0.25, 3))),
}


def chain(pair: Pair, coarse: str, more: str = "") -> str:
    """The cards of the chain."""
    quads = pair.add_chain(coarse)
    fine = "LOWER" if coarse == "UPPER" else "UPPER"
    return (
        f"{quads}*INTERFACE, NAME=I, ELSET=QUADS, SURFACE={fine}, STIFFNESS={SPRINGS!r}\n"
        f"*JOINT LAW, NAME=L, KN={KN!r}, KT={KT!r}{more}\n"
        "*JOINT, NAME=J, LAW=L, ELSET=JOINTS\n"
    )


@pytest.mark.parametrize("coarse", ["UPPER", "LOWER"])
@pytest.mark.parametrize("meshes", MESHES)
def test_opening_is_traction_over_stiffness(keyway, meshes, coarse):
    """Uniform stress crosses any two flat meshes, tension and compression; the faces part by
    t / k across the springs and t / k_n, t / k_t across the joint: 1e-10, round-off."""
    pair = Pair(*(MESHES[meshes] if coarse == "UPPER" else MESHES[meshes][::-1]))
    cards = chain(pair, coarse, ", TENSILE STRENGTH=1e12")
    loaded = Loaded(
        pair, {"PULL": uniform(STRESS, pair, GIVE), "PUSH": uniform(-STRESS, pair, GIVE)}
    )
    run = keyway(loaded.deck(cards))
    assert not any("belongs to joint elements alone" in w for w in run.json["warnings"])
    assert max(loaded.errors_of_uniform_stress(run)) < 1e-10
    (cover,) = run.json["interfaces"]
    assert abs(cover["covered_area"] / cover["slave_area"] - 1.0) < 1e-12


@pytest.mark.parametrize("forces", ["HHT", "IMPLICIT"])
def test_massless_quads_pass_on_every_traction_in_time(keyway, forces):
    """A bar along c, pulled at its end at once: all quantities are uniform over its section, so at
    every time the springs part by the joint's traction over k. The quads have no mass. With the
    impulses of IMPLICIT it is the mean over an increment that does."""
    pair = Pair(Side((6, 3, 3)), Side((4, 2, 2)), poisson=0.0, heights=(2.0, 3.0))
    cards = chain(pair, "UPPER", ", TENSILE STRENGTH=1e12")
    prints = "*NODE PRINT, NSET=ALL\nU\n*JOINT PRINT, JOINT=J\n"
    step = (
        f"*CONTROLS, JOINT FORCES={forces}\n*BOUNDARY\nFAR, 1, 3\n*DSLOAD\nTOP, P, -1e6\n{prints}"
    )
    quads = np.arange(pair.mesh.bricks.max() + 1, len(pair.x))
    pair.mesh.node_sets["ALL"] = np.arange(len(pair.x))
    run = keyway(pair.deck(cards + dynamic(step, 2e-5, 8e-3, alpha=0.0)))
    table, joint = run.csv("node_ALL"), run.csv("joint_J")
    u = np.stack([table[f"U{i}"] for i in (1, 2, 3)], axis=1) @ pair.turn[:, 2]
    u = u.reshape(-1, len(pair.x))
    traction = joint["tn"].reshape(len(u), -1).mean(axis=1)
    assert len(u) == 401 and traction.max() > 1.5e6 and traction.min() < -1e5
    parted = u[:, quads, None] - u[:, None, pair.low[:, :, -1].ravel()]
    carried = traction[1:] if forces == "IMPLICIT" else traction
    found = 0.5 * (parted[1:] + parted[:-1]) if forces == "IMPLICIT" else parted
    wrong = found - carried[:, None, None] / SPRINGS
    assert np.abs(wrong).max() < 1e-9 * np.abs(parted).max()
    assert run.json["accuracy"]["largest_energy_error"] < 1e-9


def test_frequencies_of_a_block_on_the_chain(keyway):
    """A stiff cube on springs in series: the six frequencies of a rigid body on them. Its own give,
    h / E times k, is 2e-6. Gauss points make the joint's stiffness against turning exact."""
    pair = Pair(Side((6, 3, 1)), Side((4, 2, 1)), young=1e16, poisson=0.0, heights=(0.5, 1.0))
    springs, kn, kt = 4e10, 4e10, 1e10
    run = keyway(
        pair.deck(
            f"{pair.add_chain('UPPER')}*INTERFACE, NAME=I, ELSET=QUADS, SURFACE=LOWER, "
            f"STIFFNESS={springs!r}\n*JOINT LAW, NAME=L, KN={kn!r}, KT={kt!r}\n"
            "*JOINT, NAME=J, LAW=L, ELSET=JOINTS, INTEGRATION=GAUSS\n"
            "*BOUNDARY\nFAR, 1, 3\n*STEP\n*FREQUENCY\n6\n*END STEP\n"
        )
    )
    found = [mode["hz"] for mode in run.json["steps"][0]["frequencies"]]
    mass, inertia = 2400.0, 2400.0 / 6.0
    axial, shear = (1.0 / (1.0 / springs + 1.0 / k) for k in (kn, kt))
    # sway and turn about the middle of the cube, half a metre above the joint
    sway = np.array([[shear, 0.5 * shear], [0.5 * shear, axial / 12.0 + 0.25 * shear]])
    both = np.linalg.eigvalsh(sway / np.sqrt(np.outer(*2 * [[mass, inertia]])))
    squares = [*both, *both, axial / mass, shear / 6.0 / inertia]
    exact = np.sort(np.sqrt(squares)) / (2.0 * np.pi)
    assert np.abs(np.array(found) / exact - 1.0).max() < 1e-5


def test_energy_balance_of_a_block_thrown_up_from_the_chain(keyway):
    """The base shakes with 2.5 g; the upper block leaves the joint and falls back. Only the time
    stepping dissipates, which is reported; the rest is round-off and iteration."""
    pair = Pair(Side((6, 3, 2)), Side((4, 2, 2)), heights=(2.0, 4.0), turn=np.eye(3))
    quads = pair.add_chain("UPPER")
    pair.mesh.node_sets |= {"SIDEWAYS": pair.high.ravel(), "MIDDLE": pair.high[2, 1, -1:]}
    time = np.arange(0.0, 1.001, 0.005)
    motion = amplitude("A", time, 25.0 * np.sin(8.0 * np.pi * time) * (time < 0.5))
    gravity = "*DLOAD\nLOWER, GRAV, 9.81, 0., 0., -1.\nUPPER, GRAV, 9.81, 0., 0., -1.\n"
    cards = (
        f"{quads}*INTERFACE, NAME=I, ELSET=QUADS, SURFACE=LOWER\n*JOINT LAW, NAME=L\n"
        f"*JOINT, NAME=J, LAW=L, ELSET=JOINTS\n*BOUNDARY\nFAR, 1, 3\nSIDEWAYS, 1, 2\n{motion}"
    )
    moving = "*BASE MOTION, DOF=3, AMPLITUDE=A\n*ENVELOPE\nOPENING\n"
    run = keyway(pair.deck(cards + static(gravity) + dynamic(moving, 2e-3, 1.0)))
    assert run.json["joints"]["J"]["opening"]["anywhere"]["value"] > 0.3
    assert run.json["steps"][1]["energy"]["error"] < 1e-6
    assert run.json["steps"][1]["cutbacks"] == 0


def test_nodes_without_a_partner_are_reported(keyway):
    """The coarse block projects 1 m over the edge of the fine one, 2 cm above it."""
    pair = Pair(Side((4, 2, 1)), Side((4, 1, 1)), (4.0, 1.0), shift=(1.0, 0.0), apart=0.02)
    cards = chain(pair, "UPPER", ", TENSILE STRENGTH=1e12")
    step = static("*BOUNDARY\nFAR, 1, 3\n*DSLOAD\nTOP, P, 1e5\n")
    run = keyway(pair.deck(cards + step))
    (cover,) = run.json["interfaces"]
    assert abs(cover["slave_area"] - 4.0) < 1e-12 and abs(cover["master_area"] - 4.0) < 1e-12
    assert abs(cover["covered_area"] - 3.0) < 1e-12
    assert cover["elements_without_partner"] == [len(pair.mesh.bricks) + 8]
    assert abs(cover["largest_gap"] - 0.02) < 1e-12 and cover["largest_overlap"] == 0.0
    bare, gap = (w for w in run.json["warnings"] if "*INTERFACE" in w)
    assert "1 of the area 4 of the slave face has no master facet opposite" in bare
    assert "the faces lie up to 0.02 apart" in gap
