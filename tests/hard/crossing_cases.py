"""Hard cases of many joints: crossings, arches of blocks, monoliths on a joint along their base."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hard_case import Chapter, off, over_limits, unbalance
from joint_decks import GRAVITY, amplitude, static
from tied_blocks import Blocks, node_set

CROSSINGS = Chapter("Crossings and many joints")
CONCRETE = "*DENSITY\n2400.\n*ELASTIC\n25e9, 0.167\n"
ROCK = "*ELASTIC\n20e9, 0.2\n"
Model = tuple[Blocks, list[tuple[str, str]], list[str]]  # blocks, joints, names of moving blocks


def joints(friction: float, pairs: list[tuple[str, str]], law: str = "J") -> str:
    """Joints J0, J1, .. without strength between pairs of surfaces, slave first."""
    text = f"*JOINT LAW, NAME={law}, FRICTION={friction!r}\n"
    faces = (f"*JOINT, NAME={law}{k}, LAW={law}\n{', '.join(p)}\n" for k, p in enumerate(pairs))
    return text + "".join(faces)


def gravity(names) -> str:
    return "*DLOAD\n" + "".join(f"{name}, GRAV, {GRAVITY!r}, 0., 0., -1.\n" for name in names)


def foot(blocks: Blocks, name: str) -> str:
    """Holds the lower side of a block."""
    return node_set("FOOT", blocks.side(name, "Z0")) + "*BOUNDARY\nFOOT, 1, 3\n"


def four_blocks(meshes: tuple[int, int]) -> Model:
    """Four blocks of 5 m round an edge on a ground: meshes in turn of so many bricks a side."""
    a, b = meshes
    blocks = Blocks()
    blocks.add("GROUND", (4, -2.0, 12.0), (1, 0.0, 5.0), (2, -4.0, 0.0))
    blocks.add("A", (a, 0.0, 5.0), (1, 0.0, 5.0), (a, 0.0, 5.0))
    blocks.add("B", (b, 5.0, 10.0), (1, 0.0, 5.0), (b, 0.0, 5.0))
    blocks.add("C", (b, 0.0, 5.0), (1, 0.0, 5.0), (b, 5.0, 10.0))
    blocks.add("D", (a, 5.0, 10.0), (1, 0.0, 5.0), (a, 5.0, 10.0))
    pairs = [("A_Z0", "GROUND_Z1"), ("B_Z0", "GROUND_Z1"), ("C_Z0", "A_Z1"), ("D_Z0", "B_Z1")]
    pairs += [("B_X0", "A_X1"), ("D_X0", "C_X1")]
    return blocks, pairs, ["A", "B", "C", "D"]


def stand(keyway, blocks, pairs, names, friction: float, push="", more=""):
    """Static balance under weight; the number is that of the cut-backs."""
    cards = joints(friction, pairs) + foot(blocks, "GROUND") + more
    deck = blocks.deck({"": CONCRETE, "GROUND": ROCK}, cards + static(gravity(names) + push))
    run = keyway(deck)
    return sum(step["cutbacks"] for step in run.json["steps"]), [run]


def add_crossing(friction: float, meshes: tuple[int, int]) -> None:
    @CROSSINGS.case(
        f"X crossing, friction {friction}, meshes {meshes[0]}:{meshes[1]}",
        "four blocks without strength round an edge, under weight and a push of a tenth of it",
        "cut-backs until static balance",
        0,
    )
    def judge(keyway):
        blocks, pairs, names = four_blocks(meshes)
        side = blocks.side("C", "X0")
        weight = 4 * 125.0 * 2400.0 * GRAVITY
        push = f"*CLOAD\nSIDE, 1, {0.1 * weight / len(side)!r}\n"
        return stand(keyway, blocks, pairs, names, friction, push, node_set("SIDE", side))


for value in (0.4, 0.6, 0.8):
    add_crossing(value, (2, 3))
add_crossing(0.6, (1, 10))


def shake_crossing(keyway, friction: float, size: float, meshes: tuple[int, int]):
    """Four blocks round an edge, shaken by `size` [g] up and along."""
    blocks, pairs, names = four_blocks(meshes)
    time = np.linspace(0.0, 0.5, 101)
    cards = joints(friction, pairs) + foot(blocks, "GROUND")
    shake = ""
    for dof, hz in ((1, 3.0), (3, 5.0)):
        wave = size * GRAVITY * np.sin(2.0 * np.pi * hz * time)
        cards += amplitude(f"WAVE{dof}", time, wave)
        shake += f"*BASE MOTION, DOF={dof}, AMPLITUDE=WAVE{dof}, TYPE=ACCELERATION\n"
    step = f"*STEP, INC=100000\n*DYNAMIC\n0.005, 0.5\n{shake}*END STEP\n"
    deck = blocks.deck({"": CONCRETE, "GROUND": ROCK}, cards + static(gravity(names)) + step)
    return keyway(deck)


def add_shaken_crossing(friction: float) -> None:
    @CROSSINGS.case(
        f"X crossing, shaken, friction {friction}",
        "four blocks without strength round an edge, meshes 2:3, shaken by 0.5 g up and along",
        "error of the energy balance over 1e-6; 1 + cut-backs, if any",
        1.0,
    )
    def judge(keyway):
        run = shake_crossing(keyway, friction, 0.5, (2, 3))
        cuts = sum(step["cutbacks"] for step in run.json["steps"])
        return over_limits(unbalance(run), cuts), [run]


add_shaken_crossing(0.4)
add_shaken_crossing(0.8)


@CROSSINGS.case(
    "T crossing",
    "a block bridges the joint between two others, meshes 2:3, no strength, friction 0.6",
    "cut-backs until static balance",
    0,
)
def t_crossing(keyway):
    blocks = Blocks()
    blocks.add("GROUND", (4, -2.0, 12.0), (1, 0.0, 5.0), (2, -4.0, 0.0))
    blocks.add("A", (2, 0.0, 5.0), (1, 0.0, 5.0), (2, 0.0, 5.0))
    blocks.add("B", (3, 5.0, 10.0), (1, 0.0, 5.0), (3, 0.0, 5.0))
    blocks.add("C", (4, 1.0, 9.0), (1, 0.0, 5.0), (2, 5.0, 10.0))
    pairs = [("A_Z0", "GROUND_Z1"), ("B_Z0", "GROUND_Z1"), ("B_X0", "A_X1")]
    pairs += [("A_Z1", "C_Z0"), ("B_Z1", "C_Z0")]
    return stand(keyway, blocks, pairs, ["A", "B", "C"], 0.6)


def arch(count: int, along: int, through: int, thick: float) -> Model:
    """A half circle of blocks, 10 m inside, between two abutments."""
    blocks, names = Blocks(), [f"V{k}" for k in range(count)]
    angle = np.pi / count
    for k, name in enumerate(names):
        blocks.add(
            name, (along, k * angle, (k + 1) * angle), (1, 0.0, 2.0), (through, 10.0, 10.0 + thick)
        )
    for name, start in (("LEFT", -angle), ("RIGHT", np.pi)):
        blocks.add(name, (1, start, start + angle), (1, 0.0, 2.0), (through, 10.0, 10.0 + thick))
    turn, radius = blocks.x[:, 0].copy(), blocks.x[:, 2].copy()
    blocks.x[:, 0], blocks.x[:, 2] = -radius * np.cos(turn), radius * np.sin(turn)
    chain = ["LEFT", *names, "RIGHT"]
    pairs = [(f"{b}_X0", f"{a}_X1") for a, b in pairwise(chain)]
    return blocks, pairs, names


def stand_arch(keyway, count: int, meshes: tuple[int, int], thick: float, friction: float):
    """An arch without strength under its weight."""
    blocks, pairs, names = arch(count, *meshes, thick)
    held = np.concatenate([blocks.nodes["LEFT"].ravel(), blocks.nodes["RIGHT"].ravel()])
    cards = joints(friction, pairs) + node_set("HELD", held) + "*BOUNDARY\nHELD, 1, 3\n"
    return keyway(blocks.deck({"": CONCRETE}, cards + static(gravity(names))))


def add_arch(name: str, count: int, meshes: tuple[int, int], thick: float, **more) -> None:
    @CROSSINGS.case(
        f"{name} of {count} blocks",
        f"an arch {thick} m thick without strength under its weight in one increment, friction 0.6",
        "cut-backs until static balance",
        0,
        **more,
    )
    def judge(keyway):
        run = stand_arch(keyway, count, meshes, thick, 0.6)
        return sum(step["cutbacks"] for step in run.json["steps"]), [run]


add_arch("arch", 12, (2, 4), 1.5)
add_arch("thin arch", 12, (4, 8), 1.3)
add_arch("arch in fine meshes", 10, (8, 8), 2.0, full=True)


def monoliths(facets: int) -> Model:
    """Three monoliths 15 m high on massless rock; their bricks of 5 m meet facets of the rock."""
    blocks = Blocks()
    blocks.add("ROCK", (facets, -10.0, 40.0), (facets, -15.0, 30.0), (3, -15.0, 0.0))
    names = ["M0", "M1", "M2"]
    for k, name in enumerate(names):
        blocks.add(name, (2, 10.0 * k, 10.0 * (k + 1)), (3, 0.0, 15.0), (3, 0.0, 15.0))
    pairs = [(f"{name}_Z0", "ROCK_Z1") for name in names]
    return blocks, [*pairs, ("M1_X0", "M0_X1"), ("M2_X0", "M1_X1")], names


def shaken_monoliths(keyway, facets: int, friction: float, size: float, duration: float):
    """Weight and water, then a motion in three directions; the rock has no mass."""
    blocks, pairs, names = monoliths(facets)
    cards = joints(friction, pairs)
    skin = np.concatenate([blocks.side("ROCK", side) for side in ("X0", "X1", "Y0", "Y1", "Z0")])
    cards += node_set("SKIN", np.unique(skin)) + "*BOUNDARY\nSKIN, 1, 3\n"
    time = np.linspace(0.0, 2.0, 401)
    hull = size * GRAVITY * np.sin(np.pi * time / 2.0)
    for name, hz in (("X", 3.1), ("Y", 4.3), ("Z", 6.7)):
        cards += amplitude(name, time, hull * np.sin(2.0 * np.pi * hz * time))
    upstream = f"*SURFACE, NAME=UP, TYPE=ELEMENT\n{upstream_faces(blocks, names)}"
    water = "*RESERVOIR, NAME=LAKE, SURFACE=UP, LEVEL=14., BED=0., ADDED MASS=WESTERGAARD\n"
    shake = "*DAMPING, RATIO=0.05, F1=4, F2=20\n" + "".join(
        f"*BASE MOTION, DOF={k + 1}, AMPLITUDE={name}, TYPE=ACCELERATION\n"
        for k, name in enumerate("XYZ")
    )
    step = f"*STEP, INC=100000\n*DYNAMIC\n0.01, {duration!r}\n{shake}*END STEP\n"
    deck = blocks.deck(
        {"": CONCRETE, "ROCK": ROCK}, cards + upstream + static(gravity(names) + water) + step
    )
    return keyway(deck)


def upstream_faces(blocks: Blocks, names) -> str:
    """Data lines of the faces Y0 of some blocks: elements count in the order of the blocks."""
    lines, count = "", 0
    for name, nodes in blocks.nodes.items():
        shape = tuple(n - 1 for n in nodes.shape)
        numbers = count + 1 + np.arange(np.prod(shape)).reshape(shape)
        count += numbers.size
        if name in names:
            lines += "".join(f"{e}, S3\n" for e in numbers[:, 0, :].ravel())
    return lines


def add_monoliths(facets: int, friction: float, size: float) -> None:
    @CROSSINGS.case(
        f"monoliths, base {facets} facets, friction {friction}, {size} g",
        "joints along base and between three monoliths on massless rock with added mass, different "
        "meshes",
        "error of the energy balance over 1e-6; 1 + cut-backs, if any",
        1.0,
    )
    def judge(keyway):
        run = shaken_monoliths(keyway, facets, friction, size, 0.8)
        cuts = sum(step["cutbacks"] for step in run.json["steps"])
        return over_limits(unbalance(run), cuts), [run]


add_monoliths(6, 0.7, 0.3)
add_monoliths(15, 1.5, 0.8)
add_monoliths(3, 0.7, 0.3)


@CROSSINGS.case(
    "lift joint across contraction joints",
    "three monoliths 30 m high on joints, a lift joint at 14 m, meshes 2:3, no strength, water",
    "cut-backs until static balance",
    0,
)
def lift_joint(keyway):
    blocks = Blocks()
    blocks.add("ROCK", (10, -10.0, 40.0), (8, -15.0, 25.0), (3, -15.0, 0.0))
    names, pairs = [], []
    for k, n in enumerate((2, 3, 2)):
        x, y = (n, 10.0 * k, 10.0 * (k + 1)), (n, 0.0, 10.0)
        blocks.add(f"L{k}", x, y, (n + 1, 0.0, 14.0))
        blocks.add(f"U{k}", x, y, (n + 1, 14.0, 30.0))
        pairs += [(f"L{k}_Z0", "ROCK_Z1"), (f"U{k}_Z0", f"L{k}_Z1")]
        names += [f"L{k}", f"U{k}"]
    upright = [(f"{part}{k}_X1", f"{part}{k + 1}_X0") for k in range(2) for part in "LU"]
    cards = joints(0.8, pairs) + joints(0.6, upright, "C") + foot(blocks, "ROCK")
    for name, sides, dof in (("ALONG", ("X0", "X1"), 1), ("ACROSS", ("Y0", "Y1"), 2)):
        held = np.concatenate([blocks.side("ROCK", side) for side in sides])
        cards += node_set(name, np.unique(held)) + f"*BOUNDARY\n{name}, {dof}\n"
    cards += f"*SURFACE, NAME=UP, TYPE=ELEMENT\n{upstream_faces(blocks, names)}"
    water = "*RESERVOIR, NAME=LAKE, SURFACE=UP, LEVEL=15., BED=0.\n"
    deck = blocks.deck({"": CONCRETE, "ROCK": ROCK}, cards + static(gravity(names) + water))
    run = keyway(deck)
    return sum(step["cutbacks"] for step in run.json["steps"]), [run]


@CROSSINGS.case(
    "stack of ten blocks",
    "ten blocks one on the other, meshes 2 and 3 in turn, without strength, leaning 1:10",
    "error of the resultant on the lowest joint; cut-backs",
    1e-6,
)
def stack(keyway):
    blocks, names = Blocks(), [f"S{k}" for k in range(10)]
    blocks.add("GROUND", (2, -2.0, 6.0), (2, -2.0, 4.0), (1, -2.0, 0.0))
    for k, name in enumerate(names):
        n = 2 + k % 2
        blocks.add(name, (n, 0.1 * k, 4.0 + 0.1 * k), (n, 0.0, 2.0), (1, 1.0 * k, 1.0 + k))
    chain = ["GROUND", *names]
    pairs = [(f"{b}_Z0", f"{a}_Z1") for a, b in pairwise(chain)]
    cards = joints(0.6, pairs) + foot(blocks, "GROUND")
    output = "*NODE PRINT, NSET=FOOT\nRF\n"
    run = keyway(
        blocks.deck({"": CONCRETE, "GROUND": ROCK}, cards + static(gravity(names) + output))
    )
    weight = 10 * 8.0 * 2400.0 * GRAVITY
    error = off([run.csv("node_FOOT")["RF3"].sum()], [weight])
    return max(error, float(run.json["steps"][0]["cutbacks"])), [run]
