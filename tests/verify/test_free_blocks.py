"""Blocks that only joints hold: in equilibrium where statics allows, else named in the message."""

import re

import numpy as np
import pytest
from block_decks import MESHES, Pair, joint_state
from joint_decks import material, static
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck
from uplift_decks import facets, joined

OUTPUT = "*NODE FILE\nU, OPENING\n"
WEIGHT = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n"
meshes = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())


def message(run) -> str:
    """Message of a stopped run."""
    return run.json["message"]


@meshes
@pytest.mark.parametrize("slope", [0.0, 20.0])
def test_a_block_stands_on_a_slope(keyway, mesh, slope) -> None:
    """tan 20 = 0.36 < 0.6: the joint carries both parts of the weight."""
    pair = Pair(slope=slope, law="KN=1e10, KT=1e10, FRICTION=0.6", **mesh)
    run = keyway(pair.deck(static(WEIGHT + OUTPUT)))
    found = joint_state(run)
    a = np.radians(slope)
    assert found["force"][0] == pytest.approx(-pair.weight * np.cos(a), rel=1e-6)
    shear = np.hypot(*found["force"][1:])
    assert shear == pytest.approx(pair.weight * np.sin(a), rel=1e-6, abs=1e-6 * pair.weight)
    assert run.json["warnings"] == []


@meshes
def test_a_block_slides_off_a_slope(keyway, mesh) -> None:
    """tan 35 = 0.70 > 0.6: down the slope."""
    pair = Pair(slope=35.0, law="KN=1e10, KT=1e10, FRICTION=0.6", **mesh)
    run = keyway(pair.deck(static(WEIGHT)), code=1)
    found = re.search(r"cannot hold (.*) under .*: the block can move along \((.*)\)", message(run))
    assert found[1] == "the block with element 1 of set BLOCK"
    assert [float(word) for word in found[2].split(",")] == pytest.approx(
        pair.turned([1.0, 0.0, 0.0]), abs=0.002
    )


@meshes
def test_cohesion_resists_up_to_its_strength(keyway, mesh) -> None:
    """On 35 degrees friction lacks 0.08 of the weight: cohesion of 1.2 times that is enough."""
    pair = Pair(slope=35.0, **mesh)
    a = np.radians(35.0)
    lacking = float(pair.weight * (np.sin(a) - 0.6 * np.cos(a)) / pair.area)
    for share, code in ((1.2, 0), (0.5, 1)):
        pair.law = f"KN=1e10, KT=1e10, FRICTION=0.6, COHESION={share * lacking!r}"
        run = keyway(pair.deck(static(WEIGHT + OUTPUT)), code=code, name=f"share_{code}")
    assert "cannot hold the block with element 1" in message(run)


def test_a_push_beyond_friction(keyway) -> None:
    """The weight first, then a push that grows past mu W: the message gives its direction."""
    pair = Pair(law="KN=1e10, KT=1e10, FRICTION=0.6")
    push = "*CLOAD\nTOP, 1, -4000.\n"  # nine nodes: 36 kN beside mu W = 28 kN
    run = keyway(pair.deck(static(WEIGHT, "0.5, 1.") + static(push, "0.1, 1.")), code=1)
    assert re.search("element 1 of set BLOCK under .*: the block can move along -x", message(run))
    assert run.json["steps"][1]["time"] == pytest.approx(28251.0 / 36000.0, abs=0.02)


def test_a_block_topples(keyway) -> None:
    """A tower pushed at its top rotates about its edge."""
    pair = Pair(size=(1.0, 1.0, 5.0), law="KN=1e10, KT=1e10, FRICTION=2.")
    push = "*CLOAD\nTOP, 1, 1600.\n"  # nine nodes, 5 m: 72 kNm beside W/2 = 59 kNm
    run = keyway(pair.deck(static(WEIGHT) + static(push, "0.1, 1.")), code=1)
    reported = re.search(r"can rotate about the axis y through \((.*), 0.5, (.*)\)", message(run))
    assert [float(reported[1]), float(reported[2])] == pytest.approx([1.0, 0.0], abs=0.01)


def test_a_block_is_lifted(keyway) -> None:
    """Pulled up by more than its weight: all open."""
    pair = Pair(law="KN=1e10, KT=1e10, FRICTION=0.6")
    pull = "*CLOAD\nTOP, 3, 6000.\n"
    run = keyway(pair.deck(static(WEIGHT) + static(pull, "0.1, 1.")), code=1)
    assert re.search("element 1 of set BLOCK under .*: the block can move along z", message(run))


@meshes
def test_a_block_is_lifted_by_its_top(keyway, mesh) -> None:
    """Moved up by its supports until all joints are open: nothing holds the block sideways. Hints
    for the iteration would be wrong."""
    pair = Pair(young=2e10, law="KN=1e10, KT=5e9, FRICTION=0.5", **mesh)
    lift = static("*BOUNDARY\nTOP, 3, 3, 1e-3\n", "0.1, 1.")
    run = keyway(pair.deck(static(WEIGHT) + lift), code=1)
    assert message(run).startswith("the block with element 1 of set BLOCK has come free: all its")
    assert "supports let it move along x, y and rotate about the axis z" in message(run)
    assert "CONTROLS" not in message(run)
    assert "prestress" not in message(run)
    assert run.stderr.rstrip().endswith("[free-block]")


def test_without_friction_there_is_a_warning(keyway) -> None:
    """Without a push the block is in equilibrium, with a push it is not."""
    pair = Pair()
    words = (
        "the block with element 1 of set BLOCK can move along x, y and rotate about the "
        "axis z through (1, 0.5, 0.5): only joints hold the block"
    )
    run = keyway(pair.deck(static(WEIGHT)))
    assert words in run.stderr
    run = keyway(pair.deck(static(WEIGHT + "*CLOAD\nTOP, 1, 1.\n")), code=1, name="pushed")
    assert "the block can move along x" in message(run)
    held = "BODY, 2\n1, 1\n"  # one node along x, all along y
    run = keyway(pair.deck(static(WEIGHT), held), name="held")
    assert "only joints hold" not in run.stderr


def arch_stone(
    taper: float, friction: float, steps: str, different: bool, supports: str = ""
) -> str:
    """A stone between two abutments whose faces lean by `taper` degrees; joints LEFT and RIGHT."""
    lean = np.tan(np.radians(taper))

    def stone(a, b, c):
        half = 0.5 + lean * c
        return np.stack([(2.0 * a - 1.0) * half, b, c], axis=-1)

    def abutment(side):
        def place(a, b, c):
            inner = 0.5 + lean * c
            return np.stack([side * (inner + 0.5 * a), side * b + 0.5 * (1.0 - side), c], axis=-1)

        return place

    fine = (2, 3, 3) if different else (2, 2, 2)
    mesh, (middle, right, left) = joined(
        box_mesh((2, 2, 2), stone), box_mesh(fine, abutment(1.0)), box_mesh(fine, abutment(-1.0))
    )
    bricks = np.arange(8).reshape(2, 2, 2)
    count = int(np.prod(fine))
    beyond = [8 + i * count + np.arange(count).reshape(fine) for i in range(2)]
    mesh.brick_sets = {"STONE": bricks.ravel(), "WALLS": np.arange(8, 8 + 2 * count)}
    mesh.node_sets = {
        "STONE": middle.ravel(),
        "WALLS": np.concatenate([right.ravel(), left.ravel()]),
    }
    mesh.surfaces = {
        "STONE_R": [(int(brick), 4) for brick in bricks[-1].ravel()],
        "STONE_L": [(int(brick), 6) for brick in bricks[0].ravel()],
        "WALL_R": [(int(brick), 6) for brick in beyond[0][0].ravel()],
        "WALL_L": [(int(brick), 6) for brick in beyond[1][0].ravel()],
    }
    joints = "*JOINT, NAME=RIGHT, LAW=LAW\nSTONE_R, WALL_R\n"
    joints += "*JOINT, NAME=LEFT, LAW=LAW\nSTONE_L, WALL_L\n"
    if not different:
        walls = [facets(right[0]), facets(left[0][::-1])]
        stones = [facets(middle[-1]), facets(middle[0])]
        mesh.joints = np.concatenate([np.concatenate(walls), np.concatenate(stones)], axis=1)
        mesh.joint_sets = {"RIGHT": np.arange(4), "LEFT": np.arange(4, 8)}
        joints = "".join(f"*JOINT, NAME={n}, LAW=LAW, ELSET={n}\n" for n in ("RIGHT", "LEFT"))
    return (
        mesh_deck(mesh, {"STONE": "C3D8", "WALLS": "C3D8"}, "")
        + material("STUFF", 1e13, 0.0, 2400.0)
        + "*SOLID SECTION, ELSET=STONE, MATERIAL=STUFF\n"
        + "*SOLID SECTION, ELSET=WALLS, MATERIAL=STUFF\n"
        + f"*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, FRICTION={friction!r}\n{joints}"
        + f"*BOUNDARY\nWALLS, 1, 3\n{supports}"
        + steps
    )


STONE_WEIGHT = "*DLOAD\nSTONE, GRAV, 9.81, 0., 0., -1.\n"


@pytest.mark.parametrize("different", [False, True])
@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_an_arch_stone_stands(keyway, different, friction) -> None:
    """It widens upwards: the two abutments carry its weight, without friction by pressure alone."""
    taper = 20.0
    held = "" if friction else "STONE, 2, 2\n"
    run = keyway(arch_stone(taper, friction, static(STONE_WEIGHT + OUTPUT), different, held))
    load = 2400.0 * 9.81 * (1.0 + np.tan(np.radians(taper)))
    up = 0.0
    for name in ("LEFT", "RIGHT"):
        found = joint_state(run, name=name)
        forces = found["area"][:, None, None] * found["rotation"] * found["traction"][:, :, None]
        up -= forces.sum(axis=(0, 1))[2]
        if not friction:
            pressure = load / 2.0 / np.sin(np.radians(taper))
            assert -found["force"][0] == pytest.approx(pressure, rel=1e-3)
    assert up == pytest.approx(load, rel=1e-6)
    assert "only joints hold" not in run.stderr


@pytest.mark.parametrize("different", [False, True])
def test_a_stone_between_upright_abutments_falls(keyway, different) -> None:
    """Without friction and taper the stone has no support."""
    run = keyway(arch_stone(0.0, 0.0, static(STONE_WEIGHT), different), code=1)
    assert "of set STONE can move along y, z" in run.stderr
    assert re.search("element 1 of set STONE under .*: the block can move along -z", message(run))


def test_a_stone_without_driving_load(keyway) -> None:
    """Supported by its taper, free along y: a warning, and the stone is in equilibrium."""
    run = keyway(arch_stone(20.0, 0.0, static(STONE_WEIGHT), False))
    assert "the block with element 1 of set STONE can move along y" in run.stderr
    for joint in run.json["joints"].values():
        assert joint["pressure"]["anywhere"]["value"] > 0.0
    assert run.json["steps"][0]["energy"]["error"] < 1e-9  # round-off of the sums over the points


@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_a_row_of_stones(keyway, friction) -> None:
    """Three stones in a row between walls fall together; with friction they would need a thrust."""
    mesh, n = joined(
        *[
            box_mesh((1, 2, 2), lambda a, b, c, s=s: np.stack([s + a, b, c], axis=-1))
            for s in range(5)
        ]
    )
    pairs = [(facets(n[i][-1]), facets(n[i + 1][0])) for i in range(4)]
    mesh.joints = np.concatenate([np.concatenate(pair, axis=1) for pair in pairs])
    names = [f"B{i}" for i in range(5)]
    mesh.brick_sets = {name: np.arange(4 * i, 4 * i + 4) for i, name in enumerate(names)}
    mesh.joint_sets["ALL"] = np.arange(len(mesh.joints))
    mesh.node_sets = {"WALLS": np.concatenate([n[0].ravel(), n[4].ravel()])}
    deck = (
        mesh_deck(mesh, dict.fromkeys(names, "C3D8"), "")
        + material("STUFF", 1e11, 0.0, 2400.0)
        + "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=STUFF\n" for name in names)
        + f"*JOINT LAW, NAME=L, KN=1e10, KT=1e10, FRICTION={friction!r}\n"
        + "*JOINT, NAME=J, LAW=L, ELSET=ALL\n*BOUNDARY\nWALLS, 1, 3\n"
        + static("*DLOAD\n" + "".join(f"{b}, GRAV, 9.81, 0., 0., -1.\n" for b in names))
    )
    run = keyway(deck, code=1)
    if friction:
        assert "the same model of rigid blocks has an equilibrium" in message(run)
        assert "may need prestress" in message(run)
    else:
        assert run.stderr.count("can move along y, z and rotate about the axis x") == 3
        assert "the block can move along -z (2 more blocks move too)" in message(run)
