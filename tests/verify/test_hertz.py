"""Hertz: two equal elastic spheres of 50 mm pressed together by 4 mm, without friction.

E = 20 GPa, nu = 0.3: with E* = E / (2 (1 - nu^2)) and R* = 25 mm the contact has the radius
a = sqrt(R* d) = 10 mm and the pressure p0 = 2 E* a / (pi R*) = 2798.3 MPa at its middle (K.L.
Johnson, Contact Mechanics, 1985, eqs 4.22-4.24; the two spheres of code_aster's SSNV104).

Hertz's d is the approach of points far from a contact that is small. Whole spheres held at their
equators are not far: by Y. Tatara (J. Eng. Mater. Technol. 113 (1991) 285-291) the same 4 mm give
them 7 % less room. So a quarter of each body is cut out around the contact, 40 mm wide and deep,
and its outer faces move as Hertz's pressure moves them in a half-space (Boussinesq, Johnson eq.
3.19), plus 2 mm. The computed result is the contact: its radius and pressure.

By symmetry one sphere on a rigid plane, moved by 2 mm, is the same problem; its normal is that of
the plane, as it is between the two spheres once they touch. Between spheres as meshed the normals
lean by r / R, which is no more small where a / R is 0.2.
"""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import static
from mesh_pairs import Pair, Side

YOUNG, POISSON, RADIUS, APPROACH = 20e9, 0.3, 0.05, 0.004  # [Pa], -, [m], [m]
WIDE = 0.04  # of the part cut out [m]
CONTACT = np.sqrt(0.5 * RADIUS * APPROACH)  # 0.010 [m]
PRESSURE = YOUNG / (1.0 - POISSON**2) * CONTACT / (np.pi * 0.5 * RADIUS)  # 2.7983e9 [Pa]


def knots(fine: int, coarse: int, edge: float) -> np.ndarray:
    """Shares of a line: `fine` equal parts up to `edge`, then `coarse` that grow evenly."""
    step = edge / fine
    growth = np.arange(1, coarse + 1)
    more = (1.0 - edge - coarse * step) / growth.sum()
    return np.concatenate(
        (np.linspace(0.0, edge, fine + 1), edge + np.cumsum(step + more * growth))
    )


def drop(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Depth of the sphere below its pole; plane beyond 1.6 a."""
    r = np.minimum(np.hypot(a, b), 1.6 * CONTACT)
    return RADIUS - np.sqrt(RADIUS**2 - r**2)


def body(fine: int, coarse: int, layers: int, sign: float) -> Side:
    """A quarter of one body."""
    line = knots(fine, coarse, 0.32)
    rise = knots(layers // 2, layers - layers // 2, 0.25)

    def place(s, t):
        even = np.linspace(0.0, 1.0, len(line))
        return np.interp(s, even, line), np.interp(t, even, line)

    def layer(share):
        return np.interp(share, np.linspace(0.0, 1.0, len(rise)), rise)

    def shape(a, b):
        return sign * drop(a, b)

    count = fine + coarse
    return Side((count, count, layers), place, shape=shape, layers=layer)


def half_space(x: np.ndarray) -> np.ndarray:
    """Displacements (n, 3) under Hertz's pressure at places x, x[:, 2] the depth (Boussinesq)."""
    rings, weight = np.polynomial.legendre.leggauss(24)
    radius, weight = 0.5 * CONTACT * (1.0 + rings), 0.5 * CONTACT * weight
    turns = 2.0 * np.pi * (np.arange(48) + 0.5) / 48
    r, angle = np.meshgrid(radius, turns, indexing="ij")
    load = PRESSURE * np.sqrt(1.0 - (r / CONTACT) ** 2) * r * weight[:, None] * (2.0 * np.pi / 48)
    dx = x[:, 0, None] - (r * np.cos(angle)).ravel()
    dy = x[:, 1, None] - (r * np.sin(angle)).ravel()
    z = x[:, 2, None]
    far = np.sqrt(dx**2 + dy**2 + z**2)
    along = z / far**3 - (1.0 - 2.0 * POISSON) / (far * (far + z))
    down = z**2 / far**3 + 2.0 * (1.0 - POISSON) / far
    shear = YOUNG / (2.0 * (1.0 + POISSON))
    scaled = load.ravel() / (4.0 * np.pi * shear)
    return np.stack([(dx * along) @ scaled, (dy * along) @ scaled, down @ scaled], axis=1)


def far_motion(pair: Pair, body: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on the outer faces of one body and how they move; it lies on the side `sign` of 0."""
    x = pair.x[body]
    is_outer = (x[:, :2].max(axis=1) > WIDE - 1e-9) | (sign * x[:, 2] > WIDE - 1e-9)
    x = x[is_outer]
    u = half_space(x * np.array([1.0, 1.0, sign]))
    u[:, 2] = sign * (u[:, 2] - 0.5 * APPROACH)
    for i in (0, 1):
        u[x[:, i] < 1e-12, i] = 0.0
    return body[is_outer], u


def hertz_deck(pair: Pair, slave: str, mirrored: bool) -> str:
    """The two bodies, or the upper one and the rigid plane that mirrors it."""
    lower, upper = pair.low.ravel(), pair.high.ravel()
    nodes, u = far_motion(pair, upper, 1.0)
    if mirrored:
        nodes, u = np.concatenate((nodes, lower)), np.concatenate((u, np.zeros((len(lower), 3))))
    else:
        more, v = far_motion(pair, lower, -1.0)
        nodes, u = np.concatenate((nodes, more)), np.concatenate((u, v))
    moved = "".join(
        f"{n + 1}, {i + 1}, {i + 1}, {u[k, i]}\n" for k, n in enumerate(nodes) for i in range(3)
    )
    free = np.setdiff1d(np.arange(len(pair.x)), nodes)
    pair.mesh.node_sets |= {f"MIDDLE{i + 1}": free[pair.x[free, i] < 1e-12] for i in (0, 1)}
    master = "LOWER" if slave == "UPPER" else "UPPER"
    output = "*JOINT PRINT, JOINT=J\n*NODE PRINT, NSET=ALL\nRF\n"
    return pair.deck(
        "*JOINT LAW, NAME=L, KN=1e15, KT=1e13\n*JOINT, NAME=J, LAW=L, CLEARANCE=MEASURED\n"
        f"{slave}, {master}\n*BOUNDARY\nMIDDLE1, 1\nMIDDLE2, 2\n"
        + static(f"*BOUNDARY\n{moved}{output}", "0.25, 1.")
    )


def bodies(fine: tuple[int, int], mirrored: bool) -> Pair:
    """Quarters with so many facets over the inner 12.8 mm of the lower and the upper face."""
    lower, upper = (body(n, n // 2, n, sign) for n, sign in zip(fine, (-1.0, 1.0), strict=True))
    if mirrored:
        lower = Side((*lower.counts[:2], 1), lower.place)
    return Pair(
        lower,
        upper,
        size=(WIDE, WIDE),
        heights=(0.2 * WIDE if mirrored else WIDE, WIDE),
        turn=np.eye(3),
        element="C3D8I",
        young=YOUNG,
        poisson=POISSON,
    )


def contact(keyway, fine: tuple[int, int], slave: str, mirrored: bool) -> dict[str, np.ndarray]:
    """Places r and pressures p of the joint's points at the end; the force of the whole contact."""
    pair = bodies(fine, mirrored)
    run = keyway(hertz_deck(pair, slave, mirrored), name=f"hertz_{fine[0]}_{fine[1]}_{slave}")
    points, nodes = run.csv("joint_J"), run.csv("node_ALL")
    last = points["increment"] == points["increment"].max()
    now = (nodes["increment"] == nodes["increment"].max()) & (nodes["node"] > len(pair.low.ravel()))
    r = np.hypot(points["x"][last], points["y"][last])
    order = np.argsort(r)
    return {
        "r": r[order],
        "p": -points["tn"][last][order],
        "force": -4.0 * nodes["RF3"][now].sum(),
    }


def size_and_pressure(found: dict[str, np.ndarray]) -> tuple[float, float]:
    """Radius and largest pressure over Hertz's: p^2 is a line over r^2, fitted within 0.9 a."""
    near = (found["r"] < 0.9 * CONTACT) & (found["p"] > 0.0)
    slope, start = np.polyfit(found["r"][near] ** 2, (found["p"][near] / PRESSURE) ** 2, 1)
    return float(np.sqrt(-start / slope) / CONTACT), float(np.sqrt(start))


@pytest.mark.parametrize("fine", [(9, 11), (11, 9)])
def test_pressure_and_radius(keyway, fine):
    """Facets of 1.42 against 1.16 mm, both ways round; a rigid plane is the slave.

    Measured: radius 0.999 and 0.995, largest pressure 0.991 and 0.997 of Hertz's. Bounds of 2 %: a
    facet is 12 to 14 % of a, and the force, 0.987, has errors of both, and of the sphere that is no
    parabola.
    """
    found = contact(keyway, fine, "LOWER", mirrored=True)
    radius, pressure = size_and_pressure(found)
    assert radius == pytest.approx(1.0, abs=0.02)
    assert pressure == pytest.approx(1.0, abs=0.02)
    assert found["p"][0] == pytest.approx(PRESSURE, rel=0.02)
    assert found["p"].max() < 1.02 * PRESSURE
    force = 2.0 / 3.0 * np.pi * CONTACT**2 * PRESSURE
    assert found["force"] == pytest.approx(force, rel=0.02)
    facet = 0.32 * WIDE / min(fine)
    assert found["r"][found["p"] > 0.0].max() < CONTACT + facet
    assert found["r"][found["p"] <= 0.0].min() > CONTACT - facet


def test_two_spheres_as_meshed(keyway):
    """Both bodies: pressure within 2 %, radius 3.2 % too small (bound 4 %).

    With small displacements the normals are those of the mesh. With a / R = 0.1, 0.05, 0.0125 on
    the same meshes the radius is 0.993, 0.996, 0.997, the pressure 1.001, 0.999, 1.000 of Hertz's.
    """
    found = contact(keyway, (9, 11), "LOWER", mirrored=False)
    radius, _ = size_and_pressure(found)
    assert found["p"][0] == pytest.approx(PRESSURE, rel=0.02)
    assert radius == pytest.approx(1.0, abs=0.04)
