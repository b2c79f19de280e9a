"""Ties between blocks of different meshes: patch tests with cross lines and cross points, chains,
joints at tied nodes, supports, motion, modes, cracks, threads.
"""

import itertools

import numpy as np
import pytest
from tied_blocks import Blocks, prescribe, state_of, ties

ELASTIC = "*ELASTIC\n1e6, 0.25\n"
# u = G x, with rotations, and its stresses; the same with all sides but those along x free
FULL = 1.0e-3 * np.array([[1.0, 0.5, 0.5], [0.3, 1.0, 0.4], [0.2, 0.7, 1.0]])
FULL_STRESS = np.array([2000.0, 2000.0, 2000.0, 320.0, 280.0, 440.0])
ALONG_X = 1.0e-3 * np.diag([1.0, -0.25, -0.25])
ALONG_X_STRESS = np.array([1000.0, 0.0, 0.0, 0.0, 0.0, 0.0])
NAMES = ("S11", "S22", "S33", "S12", "S13", "S23")
# round-off of a solve with a well-conditioned matrix, and of the segments
EXACT = 1e-10


def check_patch(keyway, blocks: Blocks, tied, held, is_full=True) -> None:
    """A constant strain, given at some nodes, is found in all displacements and stresses."""
    exact = blocks.x @ (FULL if is_full else ALONG_X).T
    expected = FULL_STRESS if is_full else ALONG_X_STRESS
    used = np.unique(np.concatenate([n.ravel() for n in blocks.nodes.values()]))
    cards = ties(*tied) + "*STEP\n*STATIC\n*BOUNDARY\n" + prescribe(held, exact)
    cards += "*NODE PRINT, NSET=ALL\nU\n*EL PRINT, ELSET=BODY\nS\n*END STEP\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards))
    u = state_of(run, "ALL")
    assert np.abs(u - exact)[used].max() < EXACT * np.abs(exact).max()
    table = run.csv("el_BODY")
    stress = np.stack([table[name] for name in NAMES], axis=1)
    assert np.abs(stress - expected).max() < EXACT * expected.max()


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("lines", ["1:1", "3:2", "1:10", "graded"])
def test_patch_of_two_blocks(keyway, lines, swapped):
    blocks = Blocks()
    if lines == "graded":
        blocks.add("A", (2, 0, 1), [0, 0.05, 0.2, 0.5, 1], [0, 0.6, 0.9, 1])
        blocks.add("B", (2, 1, 2), [0, 0.41, 0.77, 1], [0, 0.03, 0.11, 0.33, 1])
    else:
        n, m = {"1:1": (2, 2), "3:2": (3, 2), "1:10": (2, 20)}[lines]
        blocks.add("A", (2, 0, 1), (n, 0, 1), (n + 1, 0, 1))
        blocks.add("B", (2, 1, 2), (m, 0, 1), (m + 1, 0, 1))
    pair = ("A_X1", "B_X0")
    pair = pair[::-1] if swapped else pair
    check_patch(keyway, blocks, [pair], blocks.on_box([0, 0, 0], [2, 1, 1]))


# Slaves all the way round; both slaves at one block; two and two.
ROUNDS = [
    [("A_X1", "B_X0"), ("B_Y1", "C_Y0"), ("C_X0", "D_X1"), ("D_Y0", "A_Y1")],
    [("A_X1", "B_X0"), ("A_Y1", "D_Y0"), ("C_X0", "D_X1"), ("C_Y0", "B_Y1")],
    [("B_X0", "A_X1"), ("D_Y0", "A_Y1"), ("C_X0", "D_X1"), ("B_Y1", "C_Y0")],
]


@pytest.mark.parametrize("is_full", [True, False])
@pytest.mark.parametrize("tied", ROUNDS)
def test_patch_of_four_blocks_round_a_line(keyway, tied, is_full):
    """Not full, nothing but ties holds the free ends of the line where the blocks meet."""
    blocks = Blocks()
    blocks.add("A", (3, 0, 1), (3, 0, 1), (3, 0, 1))
    blocks.add("B", (4, 1, 2), (3, 0, 1), (4, 0, 1))
    blocks.add("C", (3, 1, 2), (4, 1, 2), (5, 0, 1))
    blocks.add("D", (2, 0, 1), (3, 1, 2), (3, 0, 1))
    held = blocks.on_box([0, 0, 0] if is_full else [0, 9, 9], [2, 2, 1] if is_full else [2, 9, 9])
    check_patch(keyway, blocks, tied, held, is_full)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_patch_of_eight_blocks_round_a_point(keyway, seed):
    """Twelve ties, slave and master by chance, as are the meshes."""
    chance = np.random.default_rng(seed)
    blocks = Blocks()
    tied = []
    for i, j, k in itertools.product((0, 1), repeat=3):
        nx, ny, nz = (int(n) for n in chance.integers(2, 5, 3))
        blocks.add(f"B{i}{j}{k}", (nx, i, i + 1), (ny, j, j + 1), (nz, k, k + 1))
    for corner in itertools.product((0, 1), repeat=3):
        for axis in range(3):
            if corner[axis] == 1:
                continue
            here = "B{}{}{}".format(*corner)
            there = "B{}{}{}".format(*(c or int(d == axis) for d, c in enumerate(corner)))
            pair = (f"{here}_{'XYZ'[axis]}1", f"{there}_{'XYZ'[axis]}0")
            tied.append(pair if chance.random() < 0.5 else pair[::-1])
    check_patch(keyway, blocks, tied, blocks.on_box([0, 0, 0], [2, 2, 2]))


@pytest.mark.parametrize("swapped", [False, True])
def test_patch_of_faces_that_share_nodes(keyway, swapped):
    """Blocks that hang together along one edge, by nodes that both faces have."""
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (2, 0, 1), (2, 0, 1))
    blocks.add("B", (2, 1, 2), (3, 0, 1), (4, 0, 1))
    blocks.share("A", "B", where=lambda x: x[1] == 0.0)
    assert len(set(blocks.side("A", "X1")) & set(blocks.side("B", "X0"))) == 3
    pair = ("A_X1", "B_X0")
    pair = pair[::-1] if swapped else pair
    check_patch(keyway, blocks, [pair], blocks.on_box([0, 9, 9], [2, 9, 9]), is_full=False)


def test_patch_of_a_block_on_a_wider_one(keyway):
    """A face in the middle of a larger one, as a dam on its rock."""
    blocks = Blocks()
    blocks.add("DAM", (2, 1.15, 2.35), (3, 1.2, 1.9), (2, 1, 2))
    blocks.add("ROCK", (4, 0, 3), (3, 0, 3), (2, 0, 1))
    held = [blocks.side(block, side) for block in ("ROCK", "DAM") for side in ("X0", "X1")]
    tied = [("DAM_Z0", "ROCK_Z1")]
    check_patch(keyway, blocks, tied, np.concatenate(held), is_full=False)


@pytest.mark.parametrize("swapped", [False, True])
def test_nodes_that_a_later_step_holds(keyway, swapped):
    """Some nodes inside the slave face are held in the second step only, where they are: both
    steps are exact, for these nodes bear no multiplier in either.
    """
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (6, 0, 1), (5, 0, 1))
    blocks.add("B", (2, 1, 2), (5, 0, 1), (6, 0, 1))
    exact = blocks.x @ FULL.T
    pair = ("A_X1", "B_X0")
    middle = np.abs(blocks.x - [1, 0.5, 0.5]).max(axis=1) < 0.2
    inner = np.array(
        [n for n in blocks.side(*(("B", "X0") if swapped else ("A", "X1"))) if middle[n]]
    )
    assert len(inner) >= 2
    cards = ties(pair[::-1] if swapped else pair)
    cards += "*STEP\n*STATIC\n*BOUNDARY\n" + prescribe(blocks.on_box([0, 0, 0], [2, 1, 1]), exact)
    cards += "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    later = prescribe(inner[:2], exact).splitlines()
    cards += "*STEP\n*STATIC\n*BOUNDARY\n" + "\n".join([later[0], *later[3:]]) + "\n*END STEP\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards))
    for step in (1, 2):
        u = state_of(run, "ALL", "U", step)
        assert np.abs(u - exact).max() < EXACT * np.abs(exact).max()


def test_opening_of_springs_is_traction_over_stiffness(keyway):
    """*TIE with STIFFNESS on a bar in tension: its faces part by t / k, everywhere."""
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (3, 0, 1), (2, 0, 1))
    blocks.add("B", (2, 1, 2), (2, 0, 1), (5, 0, 1))
    traction, stiffness = 1000.0, 1e7
    cards = ties(("A_X1", "B_X0")).replace("T0", f"T0, STIFFNESS={stiffness}")
    held = np.concatenate([blocks.side("A", "X0"), blocks.side("B", "X1")])
    exact = blocks.x @ ALONG_X.T
    exact[blocks.nodes["B"].ravel(), 0] += traction / stiffness
    cards += "*STEP\n*STATIC\n*BOUNDARY\n" + prescribe(held, exact)
    cards += "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    u = state_of(keyway(blocks.deck({"": ELASTIC}, cards)), "ALL")
    assert np.abs(u - exact).max() < EXACT * np.abs(exact).max()


def test_a_curved_tie_can_rotate(keyway):
    """Two rings of facets that are chords of one cylinder: with ADJUST a rotation of the outside
    turns the inside without stress; without, stresses are of the order of the chords' gaps.
    """
    worst = []
    for adjust in ("NO", "YES"):
        blocks = Blocks()
        blocks.add("A", (2, 1, 2), (4, 0, 1), (3, 0, 1))
        blocks.add("B", (2, 2, 3), (6, 0, 1), (4, 0, 1))
        held = blocks.on_box([1, 0, 0], [3, 1, 1])
        r, angle, z = blocks.x.T
        blocks.x = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
        turned = 1e-3 * np.cross([0.3, -0.5, 1.0], blocks.x)
        cards = ties(("B_X0", "A_X1")).replace("T0", f"T0, ADJUST={adjust}")
        cards += "*STEP\n*STATIC\n*BOUNDARY\n" + prescribe(held, turned)
        cards += "*NODE PRINT, NSET=ALL\nU\n*EL PRINT, ELSET=BODY\nS\n*END STEP\n"
        table = keyway(blocks.deck({"": ELASTIC}, cards), name=adjust).csv("el_BODY")
        worst.append(max(np.abs(table[name]).max() for name in NAMES) / (1e6 * 1e-3))
    assert worst[0] > 1e-3
    assert worst[1] < 1e-10
