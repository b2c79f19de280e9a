"""Joints that meet: blocks around a common edge (loops and chains of pairs), triangular faces."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from joint_decks import BOTH_MESHES, Block, amplitude, dynamic, material, node_sets, static
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


# Elements of a unit cube of each body in x, y, z where their meshes differ.
CUTS = {"A": (2, 2, 2), "B": (3, 2, 3), "C": (2, 1, 1), "D": (1, 3, 2)}


def blocks_of_own_meshes(layout: str) -> str:
    """The same blocks, each body with a mesh of its own; the joints lie between surfaces."""
    bodies = LAYOUTS[layout]
    mesh = BrickMesh(np.zeros((0, 3)), np.zeros((0, 8), dtype=int), np.zeros((0, 8), dtype=int))
    mesh.surfaces = {name: [] for name in ("X", "Y", "EAST", "WEST", "NORTH", "SOUTH")}
    for body in sorted(set(bodies.values())):
        places = np.array([p for p, b in bodies.items() if b == body])
        corner = np.append(places.min(axis=0), 0)
        size = np.append(np.ptp(places, axis=0), 0) + 1
        cut = size * CUTS[body]
        box, _ = box_mesh(tuple(cut), stretched(tuple(size.astype(float))))
        bricks = len(mesh.bricks) + np.arange(len(box.bricks)).reshape(cut)
        mesh.bricks = np.concatenate((mesh.bricks, box.bricks + len(mesh.x)))
        mesh.x = np.concatenate((mesh.x, box.x + corner))
        far = corner + size
        for name, face, layer, at_edge in (
            ("X" if far[0] == 2 else "EAST", 4, bricks[-1], True),
            ("Y" if far[1] == 2 else "NORTH", 5, bricks[:, -1], True),
            ("WEST", 6, bricks[0], corner[0] > 0),
            ("SOUTH", 3, bricks[:, 0], corner[1] > 0),
        ):
            if at_edge:
                mesh.surfaces[name] += [(int(k), face) for k in layer.ravel()]
    mesh.brick_sets["BLOCK"] = np.arange(len(mesh.bricks))
    mesh.node_sets = {f"LOW{k}": np.nonzero(mesh.x[:, i] == 0.0)[0] for i, k in enumerate("XYZ")}
    joints = "*JOINT, NAME=JX, LAW=LAW\nWEST, EAST\n*JOINT, NAME=JY, LAW=LAW\nSOUTH, NORTH\n"
    return blocks_deck(mesh, joints)


def blocks_around_an_edge(layout: str, integration: str = "NODES", meshes=None) -> str:
    """Unit cubes in two rows, a joint wherever two bodies touch; held on x = 0, y = 0, z = 0."""
    if meshes:
        return blocks_of_own_meshes(layout)
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
    joints = (
        f"*JOINT, NAME=J{k}, LAW=LAW, ELSET=J{k}, INTEGRATION={integration}\n" for k in PRESSURE
    )
    return blocks_deck(mesh, "".join(joints))


def blocks_deck(mesh: BrickMesh, joints: str) -> str:
    """The model of the blocks."""
    law = f"KN={STIFFNESS!r}, KT={STIFFNESS!r}, FRICTION={FRICTION}"
    return (
        mesh_deck(mesh, {"BLOCK": "C3D8"}, "")
        + node_sets({"FAR": np.array([np.argmax(mesh.x.sum(axis=1))])})
        + material("STUFF", MODULUS, 0.0, 2400.0)
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + f"*JOINT LAW, NAME=LAW, {law}\n"
        + joints
    )


HELD = "*BOUNDARY\nLOWX, 1\nLOWY, 2\nLOWZ, 3\n"
PRINT = "*JOINT PRINT, JOINT=JX\n*JOINT PRINT, JOINT=JY\n*NODE PRINT, NSET=FAR\nU\n"


@pytest.mark.parametrize(
    ("integration", "meshes"), [("NODES", None), ("GAUSS", None), ("NODES", CUTS)]
)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_blocks_around_an_edge_pass_on_pressure(keyway, layout, integration, meshes):
    """Pressed along x and y: every point carries this pressure; displacements by springs in series.

    Exact for these elements: no Poisson, uniform stress. The T has no joint across x in its lower
    row, whose upper face then shears against the blocks above: only Y is uniform there.
    """
    pressed = "*DSLOAD\n" + "".join(f"{k}, P, {p!r}\n" for k, p in PRESSURE.items() if p)
    deck = blocks_around_an_edge(layout, integration, meshes)
    run = keyway(deck + static(HELD + pressed + PRINT))
    if layout.startswith("four"):
        for k, pressure in PRESSURE.items():
            table = run.csv(f"joint_J{k}")
            assert table["tn"] == pytest.approx(-pressure, rel=1e-8)
            assert np.max(np.abs([table["t1"], table["t2"]])) < 1e-8 * pressure
            moved = run.csv("node_FAR")["U1" if k == "X" else "U2"][-1]
            assert moved == pytest.approx(-pressure * (2 / MODULUS + 1 / STIFFNESS), rel=1e-8)
    table = run.csv("joint_JY")
    if meshes is None:
        assert len(table["tn"]) == 8
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        area = np.asarray(file["joints/JY/area"])
    assert np.sum(area) == pytest.approx(2.0, rel=1e-9)
    assert area @ table["tn"] == pytest.approx(-2.0 * PRESSURE["Y"], rel=1e-8)


@BOTH_MESHES
@pytest.mark.parametrize("layout", LAYOUTS)
def test_condensed_and_full_newton_agree(keyway, layout, meshes):
    """Pressed and shaken so that joints open, close with impact and, in the T, slide: openings to
    1e-8.

    Both iterate to 1e-10 here. An impact multiplies the difference of two runs by 3 to 30; 0.25 s
    have few impacts (measured: 3e-12 of the largest opening in the loop).
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
        deck = blocks_around_an_edge(layout, meshes=meshes) + amplitude("SHAKE", time, shake)
        steps = static(HELD + controls + pressed) + dynamic(controls + motion + PRINT, 1e-3, 0.25)
        run = keyway(deck + steps, name=solver)
        assert run.json["steps"][1]["cutbacks"] == 0
        assert run.json["steps"][1]["energy"]["error"] < 1e-3
        tables[solver] = [run.csv(f"joint_J{k}") for k in "XY"]
    states = {state for table in tables["FULL"] for state in table["state"]}
    # Matching faces of the loop never shear; on different meshes they bend a little apart.
    slides = meshes is not None or not layout.startswith("four")
    assert states == ({0.0, 1.0, 2.0} if slides else {0.0, 1.0})
    for first, second in zip(tables["CONDENSED"], tables["FULL"], strict=True):
        for column in ("opening", "tn"):
            scale = np.max(np.abs(first[column]))
            assert second[column] == pytest.approx(first[column], abs=1e-8 * scale)
        apart = np.max(np.abs(first["slip1"] - second["slip1"]))
        assert apart <= 1e-8 * max(np.max(np.abs(first["slip1"])), 1e-8)


@BOTH_MESHES
@pytest.mark.parametrize("threads", [1, 2])
def test_threads_change_no_digit_of_a_small_deck(keyway, threads, meshes):
    """One and two threads, and the same once more: the tables are the same to the last byte.

    With meshes of their own the joints have so many points that LAPACK shares their work between
    threads; sums then differ in the last digits (measured 1e-10 of the largest value).
    """
    time = np.linspace(0.0, 0.3, 301)
    wave = amplitude("SHAKE", time, 40.0 * np.sin(2.0 * np.pi * 10.0 * time))
    deck = blocks_around_an_edge("three blocks, a T", meshes=meshes) + wave
    pressed = "*DSLOAD\nX, P, 2e4\nY, P, 6e4\n"
    motion = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n"
    deck += static(HELD + pressed) + dynamic(motion + PRINT, 0.002, 0.3)
    runs = [keyway(deck, "-j", str(j), name=f"threads_{j}_{i}") for i, j in ((0, 1), (1, threads))]
    for table in ("joint_JX", "joint_JY", "node_FAR", "energy"):
        first, second = (run.results.path(f"_{table}.csv").read_bytes() for run in runs)
        if meshes is None or threads == 1:
            assert first == second
            continue
        one, two = (run.csv(table) for run in runs)
        for name in {"opening", "slip1", "tn", "U1", "U2", "kinetic", "strain"} & set(one):
            size = np.max(np.abs(one[name]))
            assert two[name] == pytest.approx(one[name], abs=1e-8 * size)


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
