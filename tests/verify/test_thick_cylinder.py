"""A thick-walled cylinder under pressure: nearly incompressible, and the order in space.

R.H. MacNeal & R.L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20: radii 3 and 9,
rings at 3, 3.5, 4.2, 5.2, 6.75, 9, E = 1000, pressure 1, plane strain; elements of 10 degrees.
A quarter stands for it, held by symmetry. Exact (Lame): with A = (1 + nu) p a^2 / (E (b^2 - a^2)),
u(r) = A ((1 - 2 nu) r + b^2 / r); at the bore 5.0399e-3, 5.0602e-3, 5.0623e-3 for nu = 0.49,
0.499, 0.4999.
"""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, last_state, order_of
from keyway_tools.box_mesh import box_mesh

BORE, OUTSIDE, MODULUS = 3.0, 9.0, 1000.0
RINGS = np.array([3.0, 3.5, 4.2, 5.2, 6.75, 9.0])


def lame(r, poisson: float):
    """Radial displacement for a unit pressure in the bore."""
    factor = (1.0 + poisson) * BORE**2 / (MODULUS * (OUTSIDE**2 - BORE**2))
    return factor * ((1.0 - 2.0 * poisson) * r + OUTSIDE**2 / r)


def radial_displacements(keyway, element: str, poisson: float, rings: np.ndarray, num_around: int):
    """Radii and radial displacements of all nodes; the slice is as thick as 1."""
    shares = np.arange(len(rings)) / (len(rings) - 1)

    def place(a, b, c):
        r, angle = np.interp(a, shares, rings), 0.5 * np.pi * b
        return np.stack([r * np.cos(angle), r * np.sin(angle), c], axis=-1)

    mesh, number = box_mesh((len(rings) - 1, num_around, 1), place)
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["ON_X"] = number[:, 0].ravel()
    mesh.node_sets["ON_Y"] = number[:, -1].ravel()
    mesh.surfaces["BORE"] = [(brick, 6) for brick in range(num_around)]
    cards = elastic(MODULUS, poisson) + "*BOUNDARY\nALL, 3, 3\nON_X, 2, 2\nON_Y, 1, 1\n"
    cards += "*STEP\n*STATIC\n*DSLOAD\nBORE, P, 1.\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    u = last_state(keyway(brick_deck(mesh, element, cards)), "ALL")
    r = np.hypot(mesh.x[:, 0], mesh.x[:, 1])
    return r, (u[:, 0] * mesh.x[:, 0] + u[:, 1] * mesh.x[:, 1]) / r


def share_at_the_bore(keyway, element: str, poisson: float) -> float:
    r, u = radial_displacements(keyway, element, poisson, RINGS, 9)
    return float(u[r < BORE + 1e-6].mean() / lame(BORE, poisson))


@pytest.mark.parametrize("element", ["C3D8B", "C3D8I", "C3D8R"])
@pytest.mark.parametrize("poisson", [0.49, 0.499, 0.4999])
def test_nearly_incompressible_does_not_lock(keyway, documented, element, poisson):
    """2 %: grade A of the paper. The mesh of straight sides alone leaves 1 %."""
    found = share_at_the_bore(keyway, element, poisson)
    assert found == pytest.approx(1.0, abs=0.02)
    documented("cylinder", str(poisson), element, found)


@pytest.mark.parametrize(("poisson", "expected"), [(0.49, 0.846), (0.499, 0.359), (0.4999, 0.053)])
def test_plain_bricks_lock_as_published(keyway, documented, poisson, expected):
    """The paper's plain quadrilateral with 2 x 2 points in plane strain (QUAD4): three digits,
    0.002 because it loads the nodes of an arc and not of its chord."""
    found = share_at_the_bore(keyway, "C3D8", poisson)
    assert found == pytest.approx(expected, abs=0.002)
    documented("cylinder", str(poisson), "C3D8", found)
    documented("cylinder", str(poisson), "published, plain", expected)


@pytest.mark.parametrize(
    ("element", "poisson"),
    [("C3D8", 0.3), ("C3D8I", 0.3), ("C3D8R", 0.3), ("C3D8B", 0.3), ("C3D8B", 0.4999)],
)
def test_second_order_in_space(keyway, documented, element, poisson):
    """Root mean square error at the nodes; 0.1: from the second to the third halving the next
    term of the error is a few percent of the first (C3D8R: a quarter, from above)."""
    counts, errors = np.array([8, 16, 32]), []
    for count in counts:
        rings = np.linspace(BORE, OUTSIDE, count + 1)
        r, u = radial_displacements(keyway, element, poisson, rings, count)
        exact = lame(r, poisson)
        errors.append(np.sqrt(np.mean((u - exact) ** 2) / np.mean(exact**2)))
    order = order_of(1.0 / counts, errors)
    assert order == pytest.approx(2.0, abs=0.1)
    what = ("displacement in space, r.m.s.", f"{element}, nu {poisson}")
    documented("orders", what, "measured", order)
