"""The water on Koyna's monolith: resultant of the pressure, mass that moves with the dam.

The base moves with a(t) so slowly that the dam follows rigidly: the reaction is the mass of all
moving parts times a. Taking the run without water away leaves the water's mass. Westergaard
(paper_notes.md, 17): 7/8 rho sqrt(H y) per area, so 7/12 rho H^2 per metre of width: 4.9105e6 kg at
H = 91.75 m, and 7/8 rho H = 8.028e4 kg/m2 at the bed.
"""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, last_state
from keyway_tools.box_mesh import box_mesh

DEPTH = 91.75
HEIGHT, BASE, CREST = 103.0, 70.0, 14.8
WATER, GRAVITY = 1000.0, 9.81


def monolith(levels: np.ndarray, slope: float = 0.0):
    """A slice of 1 m with nodes at these heights; the upstream face leans back by `slope`."""
    shares = np.arange(len(levels)) / (len(levels) - 1)

    def place(a, b, c):
        z = np.interp(c, shares, levels)
        front = slope * z
        back = np.interp(z, [0.0, HEIGHT], [BASE, max(CREST, slope * HEIGHT + CREST)])
        return np.stack([front + a * (back - front), b, z], axis=-1)

    mesh, number = box_mesh((4, 1, len(levels) - 1), place)
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["ALL"] = number.ravel()
    upstream = set(number[0].ravel().tolist())
    mesh.surfaces["UPSTREAM"] = [
        pairs[0] for nodes, pairs in mesh.exterior_faces().items() if nodes <= upstream
    ]
    return mesh


def reservoir(**options: str) -> str:
    words = "".join(f", {name.replace('_', ' ')}={value}" for name, value in options.items())
    return f"*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL={DEPTH}, BED=0.{words}\n"


def base_reaction(keyway, mesh, water: str, dof: int = 1) -> np.ndarray:
    """Of a base acceleration of 1 m/s2, reached in 180 periods of the dam, scheme damped."""
    cards = elastic(31.027e9, 0.2, 2643.0) + "*BOUNDARY\nALL, 2, 2\nBASE, 1, 3\n"
    cards += "*AMPLITUDE, NAME=SLOW\n0., 0., 60., 1., 90., 1.\n"
    cards += f"*STEP, INC=100000\n*DYNAMIC, DIRECT, ALPHA=-0.3\n0.5, 90.\n{water}"
    cards += (
        f"*BASE MOTION, DOF={dof}, AMPLITUDE=SLOW\n*NODE PRINT, NSET=BASE, FREQUENCY=1000\nRF\n"
    )
    run = keyway(brick_deck(mesh, "C3D8", cards + "*END STEP\n"))
    return last_state(run, "BASE", "RF").sum(axis=0)


def added_mass(keyway, mesh, **options: str) -> np.ndarray:
    """Force along x, y, z per acceleration along x."""
    words = {"HYDROSTATIC": "NO", "ADDED_MASS": "WESTERGAARD"} | options
    return base_reaction(keyway, mesh, reservoir(**words)) - base_reaction(keyway, mesh, "")


LEVELS = np.linspace(0.0, HEIGHT, 33)  # the water ends within an element
SLOPE = 0.5
TOTAL = 7.0 / 12.0 * WATER * DEPTH**2  # per metre of height [kg/m]


@pytest.mark.parametrize("direction", ["DIAGONAL", "NORMAL"])
def test_total_added_mass_in_base_motion(keyway, direction):
    """1e-6: residual oscillation of the slow motion."""
    found = added_mass(keyway, monolith(LEVELS), DIRECTION=direction)
    assert found[0] == pytest.approx(TOTAL, rel=1e-6)
    assert pytest.approx(4.9105e6, rel=1e-5) == TOTAL  # five printed digits
    assert np.abs(found[1:]).max() < 1e-9 * TOTAL


def test_added_mass_per_area_at_the_bed(keyway):
    """Of a strip of 0.1 m at the bed, whose mean depth is 0.05 m less: 0.03 % of 0.1 %."""
    mesh = monolith(np.concatenate(([0.0, 0.1], np.linspace(5.0, HEIGHT, 10))))
    mesh.surfaces["UPSTREAM"] = mesh.surfaces["UPSTREAM"][:1]
    found = added_mass(keyway, mesh, DIRECTION="NORMAL")
    assert found[0] / 0.1 == pytest.approx(8.028e4, rel=1e-3)


@pytest.mark.parametrize("direction", ["DIAGONAL", "NORMAL"])
@pytest.mark.parametrize("dof", [1, 3])
def test_added_mass_of_a_sloping_face(keyway, direction, dof):
    """m n n^T along x and z, or its diagonal; the face is longer by the root of 1 + slope^2."""
    mesh = monolith(LEVELS, SLOPE)
    words = {"HYDROSTATIC": "NO", "ADDED_MASS": "WESTERGAARD", "DIRECTION": direction}
    found = base_reaction(keyway, mesh, reservoir(**words), dof) - base_reaction(
        keyway, mesh, "", dof
    )
    normal = np.array([-1.0, 0.0, SLOPE]) / np.hypot(1.0, SLOPE)
    block = TOTAL * np.hypot(1.0, SLOPE) * np.outer(normal, normal)
    expected = (np.diag(np.diag(block)) if direction == "DIAGONAL" else block)[:, dof - 1]
    assert found == pytest.approx(expected, abs=1e-6 * TOTAL)


@pytest.mark.parametrize("slope", [0.0, SLOPE])
def test_hydrostatic_resultant_and_moment(keyway, slope):
    """rho g H^2 / 2 against the dam at a third of the depth, and the weight of the water above a
    sloping face; 1e-9: the pressure is integrated exactly, also where the water ends."""
    mesh = monolith(LEVELS, slope)
    cards = elastic(31.027e9, 0.2) + "*BOUNDARY\nALL, 2, 2\nBASE, 1, 3\n*STEP\n*STATIC\n"
    cards += reservoir() + "*NODE PRINT, NSET=BASE\nRF\n*END STEP\n"
    reaction = last_state(keyway(brick_deck(mesh, "C3D8", cards)), "BASE", "RF")
    push = 0.5 * WATER * GRAVITY * DEPTH**2
    assert reaction.sum(axis=0) == pytest.approx([-push, 0.0, slope * push], abs=1e-9 * push)
    arm = mesh.x[np.sort(mesh.node_sets["BASE"]), 0]
    moment = push * DEPTH / 3.0 * (1.0 + slope**2)
    assert arm @ reaction[:, 2] == pytest.approx(moment, rel=1e-9)


def test_modes_have_the_added_mass(keyway):
    """A dam of next to no mass: the effective masses are that of the water except at the fixed
    base. There are as many as wet nodes above it. 1e-9: round-off; 5 Gauss points integrate to
    1e-12."""
    mesh = monolith(np.linspace(0.0, HEIGHT, 9))
    wet = mesh.surface_nodes("UPSTREAM")
    num_wet = np.count_nonzero(mesh.x[wet, 2] > 0.0)
    cards = elastic(31.027e9, 0.2, 1.0e-9) + "*BOUNDARY\nALL, 2, 2\nBASE, 1, 3\n"
    cards += f"*STEP\n*FREQUENCY\n{num_wet}\n"
    cards += reservoir(ADDED_MASS="WESTERGAARD", DIRECTION="NORMAL") + "*END STEP\n"
    modes = keyway(brick_deck(mesh, "C3D8", cards)).json["steps"][0]["frequencies"]
    point, weight = np.polynomial.legendre.leggauss(5)
    share, rise = 0.5 * (1.0 - point), HEIGHT / 8.0
    depth = DEPTH - (1.0 - share) * rise
    at_base = 0.875 * WATER * rise * np.sum(0.5 * weight * share * np.sqrt(DEPTH * depth))
    held = sum(mode["effective_mass"][0] for mode in modes)
    assert held == pytest.approx(TOTAL - at_base, rel=1e-9)
