"""*TEMPERATURE and *EXPANSION against closed forms (docs/theory.md, 16)."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista
from heat_decks import (
    ALPHA,
    OUTPUT,
    YOUNG,
    balances,
    brick,
    components,
    last_rows,
    law,
    lines_of,
    model,
    statically,
    warm,
)
from stage_decks import add, remove, step
from tied_blocks import Blocks, node_set, ties

FORMULATIONS = pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
WARMER = 20.0  # from 10 to 30 degrees
STRAIN = ALPHA * WARMER
ALL_HELD = "*BOUNDARY\nALL, 1, 3\n"


@FORMULATIONS
def test_a_free_body_has_no_stress(keyway, element):
    """Distorted elements: u = alpha dT x and no stress, 1e-12 of E alpha dT."""
    blocks = brick((3, 3, 3))
    inner = ~((blocks.x == 0.0) | (blocks.x == blocks.x.max(axis=0))).any(axis=1)
    blocks.x[inner] += np.random.default_rng(7).uniform(-0.06, 0.06, (inner.sum(), 3))
    run = keyway(model(blocks, statically(blocks), element=element) + warm(30.0, "0.25, 1.\n"))
    rows, nodes = last_rows(run, "el_BODY"), last_rows(run, "node_ALL")
    assert np.abs(components(rows, "S")).max() < 1e-12 * YOUNG * STRAIN  # theory.md, 16.3
    balances(run)
    moved = np.stack([nodes[f"U{i}"] for i in (1, 2, 3)], axis=-1)
    assert np.abs(moved - STRAIN * blocks.x).max() < 1e-12 * STRAIN * 2.0
    assert np.allclose(components(rows, "E")[:, :3], STRAIN, rtol=1e-10)
    assert np.allclose(components(rows, "THE")[:, :3], STRAIN, rtol=1e-12)
    assert np.abs(components(rows, "THE")[:, 3:]).max() == 0.0
    assert (nodes["TEMP"] == 30.0).all()


def test_expansion_on_the_nodes(keyway):
    """A free C3D8I element bends without stress where the temperature is linear: strain and thermal
    strain are alpha (T - T0) at its nodes. Of the next points THE would be 0.58 of that."""
    blocks = brick((1, 1, 1), (1.0, 1.0, 1.0))
    warmth = 10.0 * (2.0 * blocks.x[:, 2] - 1.0)
    lines = lines_of(blocks, lambda x: 10.0 + 10.0 * (2.0 * x[:, 2] - 1.0))
    cards = step("*TEMPERATURE\n" + lines + "*EL FILE\nS, E, THE\n")
    run = keyway(model(blocks, statically(blocks), element="C3D8I") + cards)
    on_nodes = pyvista.read(max(run.folder.glob("job_vtk/*.vtu"))).point_data
    assert np.abs(on_nodes["S"]).max() < 1e-10 * YOUNG * ALPHA * 10.0
    for name in ("E", "THE"):
        for axis in range(3):
            assert on_nodes[name][:, axis] == pytest.approx(ALPHA * warmth, rel=1e-9)


@pytest.mark.parametrize("holds_planes", [True, False], ids=["planes", "corners"])
def test_a_large_free_body_has_no_stress(keyway, holds_planes):
    """20 elements a side: 1e-12 of E alpha dT, but for two elements next to single supports.

    The supports at three corners carry the round-off of the forces of all nodes (theory.md, 16.3).
    """
    n = 20
    blocks = brick((n, n, n), (2.0, 2.0, 2.0))
    inner = ~((blocks.x == 0.0) | (blocks.x == blocks.x.max(axis=0))).any(axis=1)
    blocks.x[inner] += np.random.default_rng(7).uniform(-0.01, 0.01, (inner.sum(), 3))
    held = statically(blocks)
    if holds_planes:
        held = "".join(node_set(f"{a}0", blocks.side("A", f"{a}0")) for a in "XYZ")
        held += "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
    run = keyway(model(blocks, held) + warm(30.0))
    stress = np.abs(components(last_rows(run, "el_BODY"), "S")).reshape(n, n, n, -1).max(axis=-1)
    if not holds_planes:
        low, high = slice(None, 2), slice(-2, None)
        corners = [(low, low, low), (high, low, low), (low, high, low)]
        assert max(stress[c].max() for c in corners) < 1e-11 * YOUNG * STRAIN
        for c in corners:
            stress[c] = 0.0
    assert stress.max() < 1e-12 * YOUNG * STRAIN


@FORMULATIONS
def test_a_body_that_is_held(keyway, element):
    """-E alpha dT/(1 - 2 nu) in all directions; its energy is the work of the temperature."""
    run = keyway(model(brick(), ALL_HELD, element=element) + warm(30.0, "0.25, 1.\n"))
    stress = components(last_rows(run, "el_BODY"), "S")
    expected = -YOUNG * STRAIN / (1.0 - 2.0 * 0.2)
    assert stress[:, :3] == pytest.approx(expected, rel=1e-12)
    assert np.abs(stress[:, 3:]).max() < 1e-12 * abs(expected)
    energy = run.json["steps"][0]["energy"]
    stored = -0.5 * expected * 3.0 * STRAIN * 2.0  # volume 2 m3
    assert energy["strain"] == pytest.approx(stored, rel=1e-12)
    assert energy["temperature"] == pytest.approx(stored, rel=1e-12)
    assert energy["external"] == 0.0
    balances(run)
    reaction = last_rows(run, "node_ALL")
    right = brick().side("A", "X1")
    assert reaction["RF1"][right].sum() == pytest.approx(expected, rel=1e-12)  # 1 m2


@FORMULATIONS
def test_a_bar_between_walls(keyway, element):
    """-E alpha dT along the bar, nothing across; ramps halfway at half of the step."""
    blocks = brick((3, 1, 1), (3.0, 1.0, 1.0))
    walls = node_set("WALLS", [*blocks.side("A", "X0"), *blocks.side("A", "X1")])
    supports = statically(blocks) + walls + "*BOUNDARY\nWALLS, 1\n"
    run = keyway(model(blocks, supports, element=element) + warm(30.0, "0.5, 1., 0.5, 0.5\n"))
    rows = run.csv("el_BODY")
    for increment, part in ((1, 0.5), (2, 1.0)):
        stress = components({k: v[rows["increment"] == increment] for k, v in rows.items()}, "S")
        assert stress[:, 0] == pytest.approx(-part * YOUNG * STRAIN, rel=1e-11)
        assert np.abs(stress[:, 1:]).max() < 1e-11 * YOUNG * STRAIN
    balances(run)


def test_a_plate_with_a_gradient(keyway):
    """C3D8I alone: a temperature linear through one element bends a free plate without stress."""
    blocks = brick((2, 2, 1))
    field = lines_of(blocks, lambda x: 10.0 + 40.0 * x[:, 2])
    run = keyway(model(blocks, statically(blocks), element="C3D8I") + warm(field))
    assert np.abs(components(last_rows(run, "el_BODY"), "S")).max() < 1e-10 * YOUNG * 40 * ALPHA
    nodes = last_rows(run, "node_ALL")
    x, y, z = blocks.x.T
    g = 40.0 * ALPHA
    exact = np.stack([g * x * z, g * y * z, 0.5 * g * (z**2 - x**2 - y**2)], axis=-1)
    exact += np.stack([0 * x, 0 * x, 0.5 * g * (2.0 * x + y)], axis=-1)  # supports: rotations
    exact -= np.stack([0.5 * g * 2.0 * z, 0.5 * g * z, 0 * x], axis=-1)
    moved = np.stack([nodes[f"U{i}"] for i in (1, 2, 3)], axis=-1)
    assert np.abs(moved - exact).max() < 1e-10 * g


def test_a_wall_with_a_gradient(keyway):
    """C3D8I alone: -E alpha T/(1 - nu) at each point where only the thickness is free."""
    blocks = brick((2, 2, 1))
    field = lines_of(blocks, lambda x: 10.0 + 40.0 * (x[:, 2] - 0.5))
    held = statically(blocks) + "*BOUNDARY\nALL, 1, 2\n"
    run = keyway(model(blocks, held, element="C3D8I") + warm(field))
    rows = last_rows(run, "el_BODY")
    expected = -YOUNG * components(rows, "THE")[:, 0] / (1.0 - 0.2)
    assert np.abs(expected).max() > 0.5 * YOUNG * ALPHA * 20.0
    for i in (0, 1):
        assert components(rows, "S")[:, i] == pytest.approx(expected, rel=1e-9)
    assert np.abs(components(rows, "S")[:, 2:]).max() < 1e-9 * np.abs(expected).max()


def test_a_bimetal_strip(keyway):
    """Curvature of Timoshenko (1925) between two layers of C3D8I, one element each.

    kappa = 6 (a2 - a1) dT (1 + m)^2/(h (3 (1 + m)^2 + (1 + m n)(m^2 + 1/(m n)))), thicknesses
    t1/t2 = m, moduli E1/E2 = n; nu = 0: the strip is in plane stress.
    """
    blocks = Blocks()
    blocks.add("A", (40, 0, 10), (1, 0, 0.5), (1, 0.0, 0.2))
    blocks.add("B", (40, 0, 10), (1, 0, 0.5), (1, 0.2, 0.5))
    blocks.share("A", "B")
    laws = {"A": law(0.0, 2e-5, 2 * YOUNG), "B": law(0.0, 1e-5, YOUNG)}
    run = keyway(model(blocks, statically(blocks), laws, "C3D8I") + warm(30.0))
    nodes = last_rows(run, "node_ALL")
    line = blocks.nodes["A"][:, 0, 0]
    lift = nodes["U3"][line]
    m, n, h = 0.2 / 0.3, 2.0, 0.5
    bracket = 3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))
    kappa = 6 * (2e-5 - 1e-5) * WARMER * (1 + m) ** 2 / (h * bracket)
    # Between the quarter points the ends are five thicknesses away; the layer below is the warmer
    # one: the strip is lower in the middle. u'' from three nodes 2.5 m apart.
    bend = (lift[10] - 2 * lift[20] + lift[30]) / 2.5**2
    assert abs(bend) == pytest.approx(kappa, rel=2e-6)  # what is left of the free ends there


def cylinder(n: int) -> tuple[Blocks, str]:
    """A quarter of a cylinder of radii 1 and 2 m in plane strain, n x n elements."""
    blocks = Blocks()
    blocks.add("A", (n, 1, 2), (n, 0, np.pi / 2), (1, 0, 1.0 / n))
    sides = {name: blocks.side("A", name) for name in ("Y0", "Y1")}
    r, angle, z = blocks.x.T.copy()
    blocks.x = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)
    blocks.x[np.abs(blocks.x) < 1e-12] = 0.0
    cards = node_set("Y0", sides["Y0"]) + node_set("Y1", sides["Y1"])
    return blocks, cards + "*BOUNDARY\nY0, 2\nY1, 1\nALL, 3\n"


def radial(r: np.ndarray, nu: float) -> tuple[np.ndarray, np.ndarray]:
    """Radial displacement and hoop stress of Timoshenko and Goodier, Theory of Elasticity (1970),
    article 151, in plane strain, for the temperature WARMER ln(b/r)/ln(b/a) of radii 1 and 2.
    """
    a, b = 1.0, 2.0

    def moment(s):  # of T r from a to s
        part = lambda q: q**2 / 2 * np.log(b / q) + q**2 / 4  # noqa: E731
        return WARMER * (part(s) - part(a)) / np.log(b / a)

    t = WARMER * np.log(b / r) / np.log(b / a)
    whole = moment(b) / (b**2 - a**2)
    u = (1 + nu) / (1 - nu) * ALPHA / r * (moment(r) + ((1 - 2 * nu) * r**2 + a**2) * whole)
    hoop = ALPHA * YOUNG / (1 - nu) / r**2 * ((r**2 + a**2) * whole + moment(r) - t * r**2)
    return u, hoop


@FORMULATIONS
def test_a_cylinder_with_a_radial_field(keyway, element):
    """Second order for the displacements of the nodes and the hoop stress of the elements."""
    errors = []
    for n in (4, 8, 16):
        blocks, supports = cylinder(n)
        field = lines_of(
            blocks,
            lambda x: 10.0 + WARMER * np.log(2.0 / np.hypot(x[:, 0], x[:, 1])) / np.log(2.0),
        )
        run = keyway(model(blocks, supports, element=element) + warm(field), name=f"n{n}")
        nodes, rows = last_rows(run, "node_ALL"), last_rows(run, "el_BODY")
        r = np.hypot(*blocks.x.T[:2])
        moved = (nodes["U1"] * blocks.x[:, 0] + nodes["U2"] * blocks.x[:, 1]) / r
        exact = radial(r, 0.2)[0]
        error = [np.abs(moved - exact).max() / exact.max()]
        # The mean of the points of an element against the hoop stress at its middle radius.
        stress = components(rows, "S").reshape(n * n, -1, 6).mean(axis=1)
        i, k = np.divmod(np.arange(n * n), n)
        middle, angle = 1.0 + (i + 0.5) / n, (k + 0.5) * np.pi / 2 / n
        s, c = np.sin(angle), np.cos(angle)
        hoop = stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2.0 * stress[:, 3] * s * c
        exact = radial(middle, 0.2)[1]
        errors.append([*error, np.abs(hoop - exact).max() / np.abs(exact).max()])
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (orders[-1] > 1.8).all()
    assert errors[-1][0] < 1e-2


CRACKING = f"""*DENSITY
2400.
*ELASTIC
{YOUNG!r}, 0.
*EXPANSION
{ALPHA!r}
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
20e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
2e6, 200.
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, 1.8e-4
"""


def test_a_cooled_bar_cracks_at_its_strength(keyway):
    """E alpha dT up to f_t, at a cooling of f_t/(E alpha) = 10 K, and less afterwards.

    The work of the temperature is the area below the stress over the thermal strain.
    """
    blocks = brick((1, 1, 1), (1.0, 1.0, 1.0))
    walls = node_set("WALLS", [*blocks.side("A", "X0"), *blocks.side("A", "X1")])
    supports = statically(blocks) + walls + "*BOUNDARY\nWALLS, 1\n"
    cards = "*STEP\n*STATIC, DIRECT\n0.025, 1.\n*TEMPERATURE\nALL, -6.\n" + OUTPUT + "*END STEP\n"
    run = keyway(model(blocks, supports, CRACKING) + cards)
    rows = run.csv("el_BODY")
    first = rows["point"] == 1
    cooling, stress = 16.0 * rows["time"][first], rows["S11"][first]
    before = cooling < 10.0 - 1e-9
    assert stress[before] == pytest.approx(YOUNG * ALPHA * cooling[before], rel=1e-9)
    assert stress.max() == pytest.approx(2e6, rel=1e-6)
    assert (np.diff(stress[~before]) < 0.0).all()
    energy = run.json["steps"][0]["energy"]
    area = np.trapezoid(np.concatenate([[0.0], stress]), np.concatenate([[0.0], cooling])) * ALPHA
    assert energy["temperature"] == pytest.approx(area, rel=1e-7)  # of equilibria within 1e-6
    assert energy["fracture"] > 0.3 * energy["strain"]
    assert energy["strain"] + energy["fracture"] == pytest.approx(area, rel=1e-7)
    balances(run, 1e-7)


@pytest.mark.parametrize("facets", [1, 2], ids=["matching", "different"])
def test_a_joint_between_cooled_blocks_opens(keyway, facets):
    """Intact: alpha dT 2 L/(1/k + 2 L/E); without strength it opens by alpha dT 2 L."""
    k, length, cooling = 1e11, 5.0, 20.0
    blocks = Blocks()
    blocks.add("A", (2, 0, length), (facets, 0, 1), (1, 0, 1))
    blocks.add("B", (2, length, 2 * length), (1, 0, 1), (1, 0, 1))
    ends = node_set("ENDS", [*blocks.side("A", "X0"), *blocks.side("B", "X1")])
    shrinks = ALPHA * cooling * 2 * length
    for strength, name in ((1e7, "intact"), (0.0, "open")):
        joint = (
            f"*JOINT LAW, NAME=LAW, KN={k!r}, KT={k!r}, FRICTION=0.6, "
            f"TENSILE STRENGTH={strength!r}\n*JOINT, NAME=J, LAW=LAW\nB_X0, A_X1\n"
            "*BOUNDARY\nENDS, 1\nALL, 2, 3\n"
        )
        # Only along the bar: nu = 0, so that the blocks that are held across stay in one state.
        deck = model(blocks, ends + joint, law(0.0))
        run = keyway(
            deck + warm(-10.0, output="*JOINT PRINT, JOINT=J\nOPENING, TRACTION, STATE\n"),
            name=name,
        )
        last = last_rows(run, "joint_J")
        if strength > 0.0:
            traction = shrinks / (1.0 / k + 2 * length / YOUNG)
            assert last["tn"] == pytest.approx(traction, rel=1e-9)
        else:
            assert last["opening"] == pytest.approx(shrinks, rel=1e-9)
            assert np.abs(last["tn"]).max() < 1e-3
        balances(run)


@FORMULATIONS
def test_lifts_with_their_own_placing_temperatures(keyway, element):
    """Each lift counts from the temperature of its nodes when it is placed.

    All nodes are held: -K 3 alpha (T - T0), T0 of the second lift the mean of the warm joint of the
    lifts, 30, and of its fresh top, 20 degrees.
    """
    blocks = Blocks()
    blocks.add("L1", (1, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("L2", (1, 0, 1), (1, 0, 1), (1, 1, 2))
    blocks.share("L1", "L2")
    sets = node_set("LOW", blocks.nodes["L1"].ravel()) + node_set("TOP", blocks.side("L2", "Z1"))
    run = keyway(
        model(blocks, sets + ALL_HELD, element=element)
        + step(remove("L2") + "*TEMPERATURE\nLOW, 30.\nTOP, 20.\n" + OUTPUT)
        + step(add("L2"))
        + warm(5.0, output="")
    )
    rows = last_rows(run, "el_BODY")
    stress = components(rows, "S")[:, :3].reshape(2, -1)
    bulk = YOUNG / (1.0 - 2.0 * 0.2) * ALPHA
    assert stress[0] == pytest.approx(-bulk * (5.0 - 10.0), rel=1e-10)
    assert stress[1].mean() == pytest.approx(-bulk * (5.0 - 25.0), rel=1e-10)
    tables = run.csv("el_BODY")
    placed = (tables["step"] == 2) & (tables["element"] == 2)
    assert np.abs(tables["S11"][placed]).max() < 1e-9 * bulk
    balances(run)


def test_tied_blocks_of_different_meshes_are_free(keyway):
    """Warm tied blocks have no stress; the tied faces go with each other."""
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (3, 0, 1), (2, 0, 1))
    blocks.add("B", (2, 1, 2), (2, 0, 1), (3, 0, 1))
    supports = ties(("A_X1", "B_X0")) + statically(blocks)
    run = keyway(model(blocks, supports) + warm(30.0))
    assert np.abs(components(last_rows(run, "el_BODY"), "S")).max() < 1e-10 * YOUNG * STRAIN


def test_a_table_over_temperature(keyway):
    """Mean coefficients from ZERO on: alpha(T)(T - Z) - alpha(T0)(T0 - Z)."""
    table = f"*ELASTIC\n{YOUNG!r}, 0.2\n*EXPANSION, ZERO=-10.\n8e-6, 0.\n1.2e-5, 40.\n"
    run = keyway(model(brick(), statically(brick()), table) + warm(30.0) + warm(60.0))
    strain = run.csv("el_BODY")
    start = 9e-6 * 20.0  # at 10 degrees alpha is 9e-6
    for number, expected in ((1, 1.1e-5 * 40.0 - start), (2, 1.2e-5 * 70.0 - start)):
        rows = strain["step"] == number
        assert strain["THE22"][rows] == pytest.approx(expected, rel=1e-12)
        assert strain["E22"][rows] == pytest.approx(expected, rel=1e-9)
