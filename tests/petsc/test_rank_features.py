"""What several processes work on, against one: joints, water, cracks, stages, heat, modes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import make_dam
import numpy as np
import pytest
from brick_decks import elastic
from heat_decks import brick, lines_of, model, warm
from joint_decks import Block, amplitude, dynamic, static, weight
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.deck_text import mesh_deck
from rank_decks import MOTION, OUTPUT, QUAKE, SPRINGS, WEIGHT, BlockOnRock
from test_grouting import BEFORE, BONDED, PUSH, SAWN, bar, ends_of_steps, move
from test_motion_errors import of_displacement, tower
from test_ranks import worst_difference
from test_stages_in_motion import column
from tied_blocks import Blocks, node_set
from uplift_decks import Section, lake
from uplift_decks import weight as weight_of_section

SHAKE = amplitude("SINE", np.arange(0.0, 0.2001, 0.005), 6.0 * np.sin(np.pi * np.arange(41) / 10.0))
# Tight tolerances: the program stops at these and not where the processes differ.
TIGHT = "*CONTROLS, RESIDUAL=1e-10, INCREMENT=1e-10, ITERATIONS=50"


def rocking(meshes=None, solver: str = "AUTO", damping: str = "") -> str:
    """A block that rocks and slides on its joint."""
    block = Block(
        (1.0, 1.0, 2.0),
        (2, 2, 4),
        young=1e8,
        law="KN=1e9, KT=1e9, FRICTION=0.4",
        meshes=meshes,
        cards=SHAKE,
    )
    controls = f"{TIGHT}, JOINT SOLVER={solver}\n"
    shaking = "*BASE MOTION, DOF=1, AMPLITUDE=SINE\n*NODE PRINT, NSET=TOP\nU\n"
    shaking += "*JOINT PRINT, JOINT=BED\n"
    return block.deck(
        static(controls + weight()) + dynamic(controls + damping + shaking, 0.005, 0.2)
    )


def shaken_water(ground_counts: int) -> str:
    """A section that rocks with water in its joint."""
    section = Section(
        counts=(12, 5),
        ground_counts=ground_counts,
        crest=1.5,
        young=2e10,
        law="KN=1e10, KT=1e10, FRICTION=0.8, UPLIFT=LAKE, PROFILE=OPEN",
    )
    print_joint = "*JOINT PRINT, JOINT=BED\n"
    steps = static(f"{TIGHT}\n" + weight_of_section() + lake(9.0) + print_joint, "0.25, 1.")
    steps += dynamic(f"{TIGHT}\n*BASE MOTION, DOF=1, AMPLITUDE=SINE\n" + print_joint, 0.005, 0.2)
    return section.deck(SHAKE + steps)


def joint_on_rock() -> str:
    """Blocks of different meshes with a joint between them, on springs of rock."""
    law = "*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, FRICTION=0.5\n*JOINT, NAME=SOLE, LAW=LAW\n"
    block = BlockOnRock(coupling=law + "SOLE, ROOF\n")
    push = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\nBLOCK, GRAV, 2., 1., 0., 0.\n"
    return block.deck(static(f"{TIGHT}\n{push}{OUTPUT}*JOINT PRINT, JOINT=SOLE\n", "0.5, 1."))


def tangents(kind: str) -> str:
    """The column that is built in lifts and cracks in motion."""
    controls = f"*CONTROLS, RESIDUAL=1e-8, INCREMENT=1e-8, ITERATIONS=50, TANGENT={kind}\n"
    return column().replace("*END STEP\n", f"{controls}*END STEP\n")


def modes() -> str:
    """Five modes of a block on springs."""
    return BlockOnRock(coupling=SPRINGS).deck("*STEP\n*FREQUENCY\n5\n*END STEP\n")


def modal_damping() -> str:
    """A block with modal damping."""
    damping = "*DAMPING, MODAL, RATIO=0.05, MODES=4\n"
    motion = f"*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n{OUTPUT}"
    return BlockOnRock().deck(QUAKE + dynamic(damping + motion, 0.01, 0.1))


def opened_dam(folder: Path, arc: int = 10) -> str:
    """A dam with two joints of 85 points, which are groups of their own: each has its rank. `arc`
    is the number of elements along the arch.
    """
    sizes = f"--joints 2 --arc {arc} --levels 4 --bottom 2 --thick 16 --no-rock"
    time = 0.01 * np.arange(40)
    motion = []
    for k, axis in enumerate("xyz"):
        motion.append(folder / f"motion_{axis}.txt")
        np.savetxt(motion[-1], 30.0 / (k + 1) * np.sin(10.0 * np.pi * time + k))
    files = [str(file) for file in motion]
    options = ["--motion-unit", "M/S2", "--duration", "0.3", "--motion", *files]
    assert make_dam.main(["-o", str(folder / "dam.inp"), *sizes.split(), *options]) == 0
    dam = (folder / "dam.inp").read_text()
    mesh = (folder / "dam_mesh.inp").read_text()
    deck = dam.replace("*INCLUDE, INPUT=dam_mesh.inp\n", mesh)
    for first in ("*DLOAD", "*DAMPING"):  # of both steps
        deck = deck.replace(first, f"{TIGHT}\n{first}")
    return deck.replace("INPUT=dam_motion", f"INPUT={folder}/dam_motion")


def lifts() -> str:
    """A tower of eight lifts of which the lowest two are there, under its weight and in motion.
    Ranks of the others have elements, but none that is present.
    """
    mesh, number = box_mesh((5, 4, 8), stretched((5.0, 4.0, 24.0)))
    bricks = np.arange(160).reshape(5, 4, 8)
    mesh.brick_sets = {"BODY": bricks.ravel()}
    mesh.element_sets = {"LATER": bricks[:, :, 2:].ravel()}
    mesh.node_sets = {"BED": number[:, :, 0].ravel(), "TOP": number[:, :, 2].ravel()}
    steps = (
        "*STEP\n*STATIC\n*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nLATER\n"
        f"*DLOAD\nBODY, GRAV, 9.81, 0., 0., -1.\n{OUTPUT}*END STEP\n"
        "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n"
        f"*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n{OUTPUT}*END STEP\n"
    )
    cards = elastic(3e10, 0.2, 2400.0) + "*BOUNDARY\nBED, 1, 3\n" + QUAKE
    return mesh_deck(mesh, {"BODY": "C3D8"}, "") + cards + steps


def warmed() -> str:
    """A held brick with a field of temperatures."""
    blocks = brick((4, 3, 3))
    held = "*BOUNDARY\n1, 1, 3\n2, 1, 3\n5, 1, 3\n9, 1, 3\n"
    return model(blocks, held) + warm(lines_of(blocks, lambda x: 10.0 + x[:, 0] * x[:, 1] * 9.0))


def held_joint(planes: int) -> str:
    """Two blocks whose faces at their joint are pressed together by 1 um; planes of nodes along x
    of a block: 2 at the joint and at the end, which are held, 3 with one between that is free.
    Strains are uniform, so that an estimated error would be round-off.
    """
    blocks = Blocks()
    blocks.add("A", (planes - 1, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("B", (planes - 1, 1, 2), (1, 0, 1), (1, 0, 1))
    faces = node_set("STILL", [*blocks.side("A", "X0"), *blocks.side("A", "X1")])
    faces += node_set("MOVED", [*blocks.side("B", "X0"), *blocks.side("B", "X1")])
    law = "*JOINT LAW, NAME=LAW, KN=1e12, KT=1e12, FRICTION=0.5\n*JOINT, NAME=J, LAW=LAW\n"
    loads = "*CONTROLS, ERROR ESTIMATE=OFF\n*BOUNDARY\nMOVED, 1, 1, -1e-6\n"
    steps = static(f"{loads}*JOINT PRINT, JOINT=J\nTRACTION\n", "1., 1.")
    cards = f"{law}B_X0, A_X1\n*BOUNDARY\nSTILL, 1, 3\nMOVED, 2, 3\n"
    return blocks.deck({"": "*ELASTIC\n3e10, 0.\n"}, faces) + cards + steps


FEATURES: dict[str, Callable[[], str]] = {
    "joint of one mesh": rocking,
    "joint of two meshes": lambda: rocking((3, 2)),
    "joint by full Newton": lambda: rocking(solver="FULL"),
    "joint with modal damping": lambda: rocking(damping="*DAMPING, MODAL, RATIO=0.1, MODES=4\n"),
    "joint on rock": joint_on_rock,
    "water in a joint of one mesh": lambda: shaken_water(0),
    "water in a joint of two meshes": lambda: shaken_water(8),
    "stages and cracks, elastic matrix": lambda: tangents("ELASTIC"),
    "stages and cracks, consistent tangent": lambda: tangents("CONSISTENT"),
    "modes": modes,
    "modal damping": modal_damping,
    "temperature": warmed,
    "lifts that are absent in motion": lifts,
}


@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("feature", FEATURES)
def test_feature(keyway, on_ranks, feature, ranks):
    """1e-8 of the largest value of each array, as with elastic solids (test_ranks): the iterations
    stop at 1e-10, with cracks at 1e-8. What the latter bounds is the residual, not the difference
    of two runs: such runs differ less as long as both take the same iterations (3e-11 measured on 2
    ranks). One rank with --solver DIRECT has the divided matrix in one part.
    """
    deck = FEATURES[feature]()
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")
    size, place = worst_difference(plain, divided)
    assert size <= 1e-8, place


@pytest.mark.parametrize("ranks", [2, 4])
def test_modes_with_ranks_without_elements(keyway, on_ranks, ranks):
    """Frequencies of the tower: PARPACK has ranks without unknowns. They agree to 1e-12, as the
    program asks of ARPACK; 1e-10 leaves room for other processors.
    """
    deck = lifts() + "*STEP\n*FREQUENCY\n3\n*END STEP\n"
    runs = [keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")]
    expected, found = ([mode["hz"] for mode in run.json["steps"][2]["frequencies"]] for run in runs)
    assert found == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("ranks", [2, 4])
def test_each_joint_on_its_rank(keyway, on_ranks, tmp_path, ranks):
    """A joint opens by 0.1 m. Two joints on two ranks, and on four, of which two have none; as in
    `test_feature`.
    """
    deck = opened_dam(tmp_path)
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")
    assert plain.csv("joint_JOINT1")["opening"].max() > 0.05
    size, place = worst_difference(plain, divided)
    assert size <= 1e-8, place


@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_joints_by_conjugate_gradients(keyway, on_ranks, tmp_path, ranks):
    """The compliance of a joint is that of the dam within 3 and then 6 elements, a half of the
    blocks; solves of the whole dam make up for the rest. 1e-6 of the largest value, as with
    elastic solids (test_ranks). Solves by iteration leave 1e-12 of forces that nearly cancel, so
    that increments of motion end at 1e-8. One of three ranks and two of four have no joint.
    """
    deck = opened_dam(tmp_path, arc=36).replace("=1e-10", "=1e-8")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "ITERATIVE")
    assert plain.csv("joint_JOINT1")["opening"].max() > 0.05
    size, place = worst_difference(plain, divided)
    assert size <= 1e-6, place


@pytest.mark.parametrize(("ranks", "solver"), [(1, "DIRECT"), (2, "ITERATIVE"), (4, "DIRECT")])
def test_reduced_model(keyway, on_ranks, tmp_path, ranks, solver):
    """Modes and shapes of the dam from the solves of all ranks; the increments are those of each
    rank. The motion of the nodes is expanded where the results of rank 0 need it. 1e-6 as between
    numbers of threads (test_reduced_model): shapes amplify round-off.
    """
    deck = opened_dam(tmp_path).replace("*DYNAMIC,", "*DYNAMIC, REDUCED, MODES=60,")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", solver)
    expected, found = plain.csv("joint_JOINT1"), divided.csv("joint_JOINT1")
    assert expected["opening"].max() > 0.05
    for name in ("opening", "slip1", "slip2"):
        assert found[name] == pytest.approx(expected[name], abs=1e-6 * abs(expected[name]).max())
    (old,), (new,) = (run.json["accuracy"]["reduced"].values() for run in (plain, divided))
    assert new["modes"] == old["modes"]
    assert new["estimated_error"] == pytest.approx(old["estimated_error"], rel=1e-3)


def test_modes_of_a_reduced_model(keyway, on_ranks):
    """As many modes as ACCURACY asks for, most of all that this block has: each shape comes from
    the one before, so that conjugate gradients would lose them. A reduced step takes the factor.
    """
    deck = rocking().replace("*DYNAMIC,", "*DYNAMIC, REDUCED,")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(2)(deck, "--solver", "ITERATIVE")
    (old,), (new,) = (run.json["accuracy"]["reduced"].values() for run in (plain, divided))
    assert new["modes"] == old["modes"] > 100
    # Of the last mode: round-off of all shapes before it.
    assert new["highest_hz"] == pytest.approx(old["highest_hz"], rel=1e-3)
    assert "factors by MUMPS" in (divided.folder / f"{divided.job}.log").read_text()


@pytest.mark.parametrize("feature", FEATURES)
def test_feature_by_conjugate_gradients(keyway, on_ranks, feature):
    """As `test_feature`, where increments end at 1e-8, to 1e-6 of the largest value."""
    deck = FEATURES[feature]().replace("=1e-10", "=1e-8")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(2)(deck, "--solver", "ITERATIVE")
    size, place = worst_difference(plain, divided)
    assert size <= 1e-6, place


def test_small_increment_by_conjugate_gradients(keyway, on_ranks):
    """A small static force on concrete that has cracked in a motion needs no cut-back, as with a
    factor: what solves leave is small beside its increment. 1e-4 of the largest displacement: ten
    15 increments of motion on cracks, each within RESIDUAL=1e-6.
    """
    deck = Path(__file__).with_name("small_force.inp")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(2)(deck, "--solver", "ITERATIVE")
    assert plain.json["steps"][-1]["cutbacks"] == divided.json["steps"][-1]["cutbacks"] == 0
    expected, found = plain.csv("node_CREST"), divided.csv("node_CREST")
    for name in ("U1", "U2", "U3"):
        assert found[name] == pytest.approx(expected[name], abs=1e-4 * abs(expected[name]).max())


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("residual", ["1e-6", "1e-9"])
def test_slender_blocks_by_conjugate_gradients(keyway, on_ranks, residual, ranks):
    """Forces of a stiff joint that are 1e4 times the load: the residual that remains is round-off
    of the forces, and each solve is one for a correction. 1e-5 of the largest value: the tolerance
    of *CONTROLS, INCREMENT, 1e-6, on each of two solutions.
    """
    deck = Path(__file__).with_name("slender_blocks.inp").read_text()
    deck = deck.replace("RESIDUAL=1e-6", f"RESIDUAL={residual}")
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "ITERATIVE")
    assert abs(plain.csv("joint_GAP")["slip2"]).max() > 0.05
    for name, key in (("node_LOADED", "U1"), ("node_LOADED", "U3"), ("joint_GAP", "slip2")):
        expected, found = plain.csv(name)[key], divided.csv(name)[key]
        assert found == pytest.approx(expected, abs=1e-5 * abs(expected).max())


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("top", [2, 3], ids=["all", "faces"])
def test_joint_between_held_faces(keyway, on_ranks, ranks, top):
    """Without free unknowns at a joint, or in all of the model, there is no part of the matrix near
    the joint. Its traction is that of its springs.
    """
    deck = held_joint(top)
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "ITERATIVE")
    assert divided.csv("joint_J")["tn"] == pytest.approx(-1e12 * 1e-6, rel=1e-9)
    size, place = worst_difference(plain, divided)
    assert size <= 1e-6, place


@pytest.mark.parametrize("ranks", [2, 4])
@pytest.mark.parametrize("facets", [1, 2], ids=["matching", "different"])
def test_grout(keyway, on_ranks, facets, ranks):
    """Two blocks with a joint, opened, grouted there and pushed together. All that the symmetry of
    the bar makes zero is round-off; compared are normal tractions and openings, to 1e-8 of the
    first push and of the opening.
    """
    steps = move(-PUSH) + move(SAWN) + move(SAWN, "*GROUT, JOINT=J\n")
    deck = bar(BONDED, facets) + steps + move(2 * SAWN - PUSH)
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")
    for name, size in (("tn", abs(BEFORE)), ("opening", SAWN)):
        gap = ends_of_steps(plain, name) - ends_of_steps(divided, name)
        assert np.abs(gap).max() <= 1e-8 * size, name


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_errors_in_motion(keyway, on_ranks, ranks):
    """Estimated errors of the mesh and of the time in the largest displacement: rank 0 knows the
    stresses of the modes, and all ranks go on with its answer. 1e-6 of each: the modes are found
    to 1e-10 by iteration, and the estimates are a difference of two motions, some 1e-2 of each.
    """
    deck = tower(2, "C3D8I", 0.45)
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")
    expected, found = of_displacement(plain), of_displacement(divided)
    assert {"value", "mesh", "time"} <= expected.keys()
    for name in ("value", "mesh", "time"):
        assert found[name] == pytest.approx(expected[name], rel=1e-6), name


@pytest.mark.parametrize(("first", "second"), [(2, 4), (2, 0), (0, 2)])
def test_any_number_of_ranks_goes_on(keyway, on_ranks, first, second):
    """A run of two steps equals the first step, and the second one with other ranks."""
    whole = rocking()
    end = whole.index("*STEP, NAME=DYNAMIC")
    part = whole[:end].replace("*END STEP\n", "*RESTART, WRITE\n*END STEP\n")
    full = part + whole[end:]
    plain = keyway(full, "-j", "1")
    on_ranks(first)(part)
    source = on_ranks(first).folder
    program = on_ranks(second)
    if program.folder != source:
        (source / "results_job").rename(program.folder / "results_job")
    size, place = worst_difference(plain, program(full, "--continue"))
    assert size <= 1e-8, place


@pytest.mark.parametrize(("first", "second"), [(2, 3), (3, 0), (0, 2), (4, 2)])
@pytest.mark.parametrize("deck", ["ties", "joints"])
def test_goes_on_in_the_middle_of_a_step(keyway, on_ranks, deck, first, second):
    """A run that ends after five increments of motion goes on after the third with other ranks:
    the checkpoint has the unknowns of all ranks in the order of one process.
    """
    full = rocking() if deck == "joints" else BlockOnRock().deck(QUAKE + WEIGHT + MOTION)
    full = full.replace(", INC=1000000", "")
    last = full.rindex("*END STEP")
    full = full[:last] + "*RESTART, WRITE, FREQUENCY=3\n" + full[last:]
    name = full.rindex("*STEP, NAME=") + len("*STEP, NAME=")
    end = full.index("\n", name)
    plain = keyway(full, "-j", "1")
    on_ranks(first)(full[:end] + ", INC=5" + full[end:], code=1)
    source, program = on_ranks(first).folder, on_ranks(second)
    if program.folder != source:
        (source / "results_job").rename(program.folder / "results_job")
    size, place = worst_difference(plain, program(full, "--continue"))
    assert size <= 1e-8, place


def test_all_ranks_take_the_checkpoint_of_rank_0(keyway, on_ranks):
    """The record of results in the last checkpoint is damaged, which rank 0 alone reads: all ranks
    go on from the checkpoint before, the end of the first step.
    """
    deck = rocking().replace("*END STEP\n", "*RESTART, WRITE\n*END STEP\n")
    plain, program = keyway(deck, "-j", "1"), on_ranks(2)
    first = program(deck, "--solver", "DIRECT")
    with h5py.File(first.folder / "job.ckpt.h5", "r+") as file:
        del file["record"]
    second = program(deck, "--continue", "--solver", "DIRECT")
    assert "the checkpoint before it is used" in second.stderr
    size, place = worst_difference(plain, second)
    assert size <= 1e-8, place
