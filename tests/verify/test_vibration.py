"""Modes of bodies with closed forms: frequencies, their order in space, effective masses."""

import math

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, order_of
from keyway_tools.box_mesh import box_mesh, stretched

LENGTH, MODULUS, DENSITY = 10.0, 25.0e9, 2400.0
MASS = DENSITY * LENGTH  # of a section of 1 m2


def bar_modes(keyway, count: int, num_modes: int, element: str = "C3D8", mass: str = "CONSISTENT"):
    """Modes of a bar along z that is fixed at its foot and cannot bulge (nu = 0)."""
    mesh, number = box_mesh((1, 1, count), stretched((1.0, 1.0, LENGTH)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    law = elastic(MODULUS, 0.0, DENSITY).replace("MATERIAL=M", f"MATERIAL=M, MASS={mass}")
    cards = law + "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n"
    cards += f"*STEP\n*FREQUENCY\n{num_modes}\n*END STEP\n"
    modes = keyway(brick_deck(mesh, element, cards)).json["steps"][0]["frequencies"]
    hz = np.array([mode["hz"] for mode in modes])
    return hz, np.array([mode["effective_mass"] for mode in modes])


def exact_hz(k: int) -> float:
    """Mode k = 0, 1, ... of the continuous bar."""
    return (2 * k + 1) / (4.0 * LENGTH) * math.sqrt(MODULUS / DENSITY)


def discrete_hz(k: int, count: int) -> float:
    """Mode k of a bar of linear elements with consistent mass (Hughes 2000, sec. 7.3)."""
    phase = (2 * k + 1) * math.pi / (2 * count)
    h, speed = LENGTH / count, math.sqrt(MODULUS / DENSITY)
    share = 6.0 * (1.0 - math.cos(phase)) / (2.0 + math.cos(phase))
    return math.sqrt(share) * speed / h / (2.0 * math.pi)


def test_frequencies_of_the_discrete_bar(keyway):
    """1e-9: shift-invert Lanczos converges to round-off; json holds 13 digits. Modes that sway the
    four nodes of a section against each other are higher than the first six."""
    hz, _ = bar_modes(keyway, 20, 6)
    assert hz == pytest.approx([discrete_hz(k, 20) for k in range(6)], rel=1e-9)


@pytest.mark.parametrize("mass", ["CONSISTENT", "LUMPED"])
def test_second_order_and_side_of_the_error(keyway, documented, mass):
    """Consistent mass errs upwards, lumped mass downwards; 0.05: the next term of the error."""
    counts = np.array([8, 16, 32])
    found = np.array([bar_modes(keyway, count, 1, mass=mass)[0][0] for count in counts])
    errors = found / exact_hz(0) - 1.0
    assert np.all(errors > 0.0 if mass == "CONSISTENT" else errors < 0.0)
    order = order_of(1.0 / counts, np.abs(errors))
    assert order == pytest.approx(2.0, abs=0.05)
    side = "above" if mass == "CONSISTENT" else "below"
    what = ("frequency in space", f"{mass.lower()} mass (from {side})")
    documented("orders", what, "measured", order)


def test_effective_masses(keyway):
    """8 / (pi^2 (2k + 1)^2) of the mass: exact for linear elements up to (k h)^2 / 12, 0.3 % in the
    third of 40 elements. Across the bar nothing moves."""
    _, masses = bar_modes(keyway, 40, 3)
    expected = [8.0 * MASS / (math.pi * (2 * k + 1)) ** 2 for k in range(3)]
    assert masses[:, 2] == pytest.approx(expected, rel=3e-3)
    assert np.abs(masses[:, :2]).max() < 1e-9 * MASS


@pytest.mark.parametrize(("mass", "share"), [("CONSISTENT", 6.0 / 7.0), ("LUMPED", 3.0 / 4.0)])
def test_effective_masses_add_up(keyway, mass, share):
    """The effective masses of all modes of two bricks are the mass moved by the base, (M r)^T
    M_ff^-1 (M r) over the free nodes: with m = MASS / 2, M_ff = m/6 [4 1; 1 2] and M r = m (1, 1/2)
    that is 12/7 m; with lumped mass all but the half brick at the base, 3/2 m. 1e-12: round-off."""
    _, masses = bar_modes(keyway, 2, 7, mass=mass)
    assert masses.sum(axis=0)[2] == pytest.approx(share * MASS, rel=1e-12)


def test_many_modes_hold_the_total_mass(keyway):
    """The first n modes along the bar have all mass except 2 / (pi^2 n); modes with opposite
    motions of the edges are among them and have no effective mass. 0.3 %: the mesh of 60 bricks."""
    _, masses = bar_modes(keyway, 60, 30)
    along = masses[masses[:, 2] > 1e-9 * MASS, 2]
    expected = sum(8.0 / (math.pi * (2 * k + 1)) ** 2 for k in range(len(along)))
    assert expected > 0.98
    assert along.sum() == pytest.approx(expected * MASS, rel=3e-3)


@pytest.mark.parametrize(
    "size, counts", [((200.0, 1.0, 1.0), (100, 1, 1)), ((300.0, 30.0, 1.0), (60, 6, 1))]
)
def test_slender_bodies_have_modes(keyway, size, counts):
    """A beam 200:1 and a plate 300 x 30 x 1, fixed at one end: round-off of the forces of elements
    is 1e-6 of K phi and more. Euler-Bernoulli: 1.8751^2/(2 pi) sqrt(E t^2/(12 rho))/L^2. nu = 0;
    1e-3: squared element length over wave length."""
    mesh, number = box_mesh(counts, stretched(size))
    mesh.node_sets["BASE"] = number[0].ravel()
    cards = (
        elastic(MODULUS, 0.0, DENSITY) + "*BOUNDARY\nBASE, 1, 3\n*STEP\n*FREQUENCY\n2\n*END STEP\n"
    )
    modes = keyway(brick_deck(mesh, "C3D8I", cards)).json["steps"][0]["frequencies"]
    root = 1.875104068711961  # of cos x cosh x = -1
    exact = root**2 / (2 * math.pi) * size[2] * math.sqrt(MODULUS / 12 / DENSITY) / size[0] ** 2
    assert modes[0]["hz"] == pytest.approx(exact, rel=1e-3)
