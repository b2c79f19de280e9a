"""Joints that meet: blocks around a common edge (loops and chains of pairs), triangular faces."""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import Block, amplitude, dynamic, material, node_sets, static
from keyway_tools.box_mesh import add_base_joint, box_mesh, stretched
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh

MODULUS, STIFFNESS = 2e10, 1e10  # [Pa], [Pa/m]
PRESSURE = {"X": 1e6, "Y": 3e6}  # on the outer faces [Pa]
FRICTION = 0.2
# Blocks by place (x, y); two that share a letter are one body.
LAYOUTS = {
    "four blocks, a loop": {(0, 0): "A", (1, 0): "B", (0, 1): "C", (1, 1): "D"},
    "three blocks, a T": {(0, 0): "A", (1, 0): "A", (0, 1): "C", (1, 1): "D"},
}


def blocks_around_an_edge(layout: str, integration: str) -> str:
    """Unit cubes in two rows, a joint wherever two bodies touch; held on x = 0, y = 0, z = 0."""
    bodies = LAYOUTS[layout]
    nodes: dict[tuple, int] = {}

    def corner(place, shift):
        x = (place[0] + shift[0], place[1] + shift[1], shift[2])
        return nodes.setdefault((bodies[place], x), len(nodes))

    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    bricks = [[corner(p, (*r, z)) for z in (0, 1) for r in ring] for p in bodies]
    joints = {"X": [], "Y": []}
    for (i, j), body in bodies.items():
        for name, other, face in (
            ("X", (i + 1, j), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))),
            ("Y", (i, j + 1), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
        ):
            if bodies.get(other, body) == body:
                continue
            step = np.subtract(other, (i, j))
            slave = [corner(other, (*(np.array(f[:2]) - step), f[2])) for f in face]
            joints[name].append([corner((i, j), f) for f in face] + slave)
    x = np.array([key[1] for key in nodes], dtype=float)
    mesh = BrickMesh(x, np.array(bricks), np.array(joints["X"] + joints["Y"]))
    mesh.brick_sets["BLOCK"] = np.arange(4)
    split = len(joints["X"])
    mesh.joint_sets = {"JX": np.arange(split), "JY": split + np.arange(len(joints["Y"]))}
    mesh.node_sets = {f"LOW{k}": np.nonzero(x[:, i] == 0.0)[0] for i, k in enumerate("XYZ")}
    mesh.surfaces = {
        "X": [(k, 4) for k, p in enumerate(bodies) if p[0] == 1],
        "Y": [(k, 5) for k, p in enumerate(bodies) if p[1] == 1],
    }
    law = f"KN={STIFFNESS!r}, KT={STIFFNESS!r}, FRICTION={FRICTION}"
    return (
        mesh_deck(mesh, {"BLOCK": "C3D8"}, "")
        + node_sets({"FAR": np.array([np.argmax(x.sum(axis=1))])})
        + material("STUFF", MODULUS, 0.0, 2400.0)
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + f"*JOINT LAW, NAME=LAW, {law}\n"
        + f"*JOINT, NAME=JX, LAW=LAW, ELSET=JX, INTEGRATION={integration}\n"
        + f"*JOINT, NAME=JY, LAW=LAW, ELSET=JY, INTEGRATION={integration}\n"
    )


HELD = "*BOUNDARY\nLOWX, 1\nLOWY, 2\nLOWZ, 3\n"
PRINT = "*JOINT PRINT, JOINT=JX\n*JOINT PRINT, JOINT=JY\n*NODE PRINT, NSET=FAR\nU\n"


@pytest.mark.parametrize("integration", ["NODES", "GAUSS"])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_blocks_around_an_edge_pass_on_pressure(keyway, layout, integration):
    """Pressed along x and y: every point carries just that; displacements by springs in series.

    Exact for these elements: no Poisson, uniform stress. The T has no joint across x in its lower
    row, whose upper face then shears against the blocks above: only Y is uniform there.
    """
    pressed = "*DSLOAD\n" + "".join(f"{k}, P, {p!r}\n" for k, p in PRESSURE.items() if p)
    deck = blocks_around_an_edge(layout, integration)
    run = keyway(deck + static(HELD + pressed + PRINT))
    if layout.startswith("four"):
        for k, pressure in PRESSURE.items():
            table = run.csv(f"joint_J{k}")
            assert table["tn"] == pytest.approx(-pressure, rel=1e-8)
            assert np.max(np.abs([table["t1"], table["t2"]])) < 1e-8 * pressure
            moved = run.csv("node_FAR")["U1" if k == "X" else "U2"][-1]
            assert moved == pytest.approx(-pressure * (2 / MODULUS + 1 / STIFFNESS), rel=1e-8)
    table = run.csv("joint_JY")
    count = len(table["tn"])
    assert count == 8
    assert np.mean(table["tn"]) == pytest.approx(-PRESSURE["Y"], rel=1e-8)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_condensed_and_full_newton_agree(keyway, layout):
    """Pressed and shaken so that joints open, hit and, in the T, slide: openings to 1e-8.

    Both iterate to 1e-10 here. A hit takes the difference of two runs times 3 to 30, as bouncing
    bodies do; 0.25 s hold few enough (measured: 3e-12 of the largest opening in the loop).
    """
    time = np.linspace(0.0, 0.5, 501)
    shake = 30.0 * np.sin(2.0 * np.pi * 12.0 * time) * np.minimum(time / 0.1, 1.0)
    tables = {}
    for solver in ("CONDENSED", "FULL"):
        controls = "*CONTROLS, RESIDUAL=1e-10, INCREMENT=1e-10, ITERATIONS=40, "
        controls += f"JOINT SOLVER={solver}\n"
        pressed = "*DSLOAD\nX, P, 4e4\nY, P, 1e5\n"
        motion = "*DAMPING, RATIO=0.05, F1=10., F2=200.\n"
        motion += "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n"
        deck = blocks_around_an_edge(layout, "NODES") + amplitude("SHAKE", time, shake)
        steps = static(HELD + controls + pressed) + dynamic(controls + motion + PRINT, 1e-3, 0.25)
        run = keyway(deck + steps, name=solver)
        assert run.json["steps"][1]["cutbacks"] == 0
        assert run.json["steps"][1]["energy"]["error"] < 1e-3
        tables[solver] = [run.csv(f"joint_J{k}") for k in "XY"]
    states = {state for table in tables["FULL"] for state in table["state"]}
    assert states == ({0.0, 1.0} if layout.startswith("four") else {0.0, 1.0, 2.0})
    for first, second in zip(tables["CONDENSED"], tables["FULL"], strict=True):
        for column in ("opening", "tn"):
            scale = np.max(np.abs(first[column]))
            assert second[column] == pytest.approx(first[column], abs=1e-8 * scale)
        apart = np.max(np.abs(first["slip1"] - second["slip1"]))
        assert apart <= 1e-8 * max(np.max(np.abs(first["slip1"])), 1e-8)


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_change_no_digit_of_a_small_deck(keyway, threads):
    """One and two threads, and the same once more: the tables are the same to the last byte."""
    time = np.linspace(0.0, 0.3, 301)
    wave = amplitude("SHAKE", time, 40.0 * np.sin(2.0 * np.pi * 10.0 * time))
    deck = blocks_around_an_edge("three blocks, a T", "NODES") + wave
    pressed = "*DSLOAD\nX, P, 2e4\nY, P, 6e4\n"
    motion = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n"
    deck += static(HELD + pressed) + dynamic(motion + PRINT, 0.002, 0.3)
    runs = [keyway(deck, "-j", str(j), name=f"threads_{j}_{i}") for i, j in ((0, 1), (1, threads))]
    for table in ("joint_JX", "joint_JY", "node_FAR", "energy"):
        first, second = (run.results.path(f"_{table}.csv").read_bytes() for run in runs)
        assert first == second


@pytest.mark.parametrize("integration", ["NODES", "GAUSS"])
def test_triangular_faces(keyway, integration):
    """A cube cut into two wedges, each on a triangular facet; pressed down uniformly.

    Uniform stress: every point carries k v, on areas that add up to 1 m2. The joint elements repeat
    their third node as the wedges do.
    """
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    base = add_base_joint(mesh, number[:, :, 0])
    a, b, c, d = (number[i, j] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    low = {int(n[0]): int(g) for n, g in zip((a, b, c, d), base.ravel()[[0, 2, 3, 1]], strict=True)}
    wedges = [[p[k] for k in (0, 1) for p in t] for t in ((a, b, c, c), (a, c, d, d))]
    mesh.bricks = np.array(wedges)
    mesh.joints = np.array([[low[int(n)] for n in w[:4]] + w[:4] for w in wedges])
    mesh.brick_sets["BLOCK"], mesh.joint_sets["BED"] = np.arange(2), np.arange(2)
    mesh.node_sets = {"BASE": base.ravel(), "TOP": number[:, :, 1].ravel()}
    down = 1e-4
    deck = (
        mesh_deck(mesh, {"BLOCK": "C3D8"}, "")
        + material("STUFF", MODULUS, 0.0, 2400.0)
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + f"*JOINT LAW, NAME=LAW, KN={STIFFNESS!r}, KT={STIFFNESS!r}, FRICTION=0.6\n"
        + f"*JOINT, NAME=BED, LAW=LAW, ELSET=BED, INTEGRATION={integration}\n"
        + static(
            f"*BOUNDARY\nBASE, 1, 3\nTOP, 1, 2\nTOP, 3, 3, {-down!r}\n"
            "*JOINT PRINT, JOINT=BED\n*NODE PRINT, NSET=TOP\nU, RF\n"
        )
    )
    run = keyway(deck)
    table = run.csv("joint_BED")
    pressure = down / (1.0 / MODULUS + 1.0 / STIFFNESS)
    assert len(table["tn"]) == (4 if integration == "NODES" else 8)
    assert table["tn"] == pytest.approx(-pressure, rel=1e-9)
    assert np.sum(run.csv("node_TOP")["RF3"]) == pytest.approx(-pressure * 1.0, rel=1e-9)


def test_fixed_base_as_master_or_slave(keyway):
    """A leaning block whose fixed base is the master, then the slave of the joint: one answer."""
    answers = []
    for base_is_slave in (False, True):
        block = Block((1.0, 1.0, 2.0), (2, 2, 4), young=MODULUS, base_is_slave=base_is_slave)
        block.law = "KN=1e10, KT=5e9, FRICTION=0.5"
        lean = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\nBLOCK, GRAV, 3., 1., 0.2, 0.\n"
        run = keyway(
            block.deck(static(lean + "*NODE PRINT, NSET=BODY\nU\n*JOINT PRINT, JOINT=BED\n")),
            name=f"slave_{base_is_slave}",
        )
        nodes = run.csv("node_BODY")
        answers.append((np.stack([nodes[f"U{i}"] for i in (1, 2, 3)]), run.csv("joint_BED")))
    (u, first), (w, second) = answers
    assert w == pytest.approx(u, abs=1e-7 * np.max(np.abs(u)))
    assert first["opening"] == pytest.approx(second["opening"], abs=1e-12)
    assert {0.0, 1.0} <= set(first["state"]) | set(second["state"])
