"""Ties where they meet everything else: against meshes that share their nodes, which are other
equations with the same answers, and against what can be said without a mesh.

1e-9: round-off of two systems of equations that differ in their unknowns, and 9 digits of the CSV.
"""

import numpy as np
import pytest
from concrete_decks import Concrete
from tied_blocks import Blocks, node_set, state_of, ties

SAME = 1e-9
ELASTIC = "*ELASTIC\n1e9, 0.2\n*DENSITY\n2000.\n"
WEIGHT = "*DLOAD\nBODY, GRAV, 9.81, 0., 0., -1.\n"
PRINT = "*NODE PRINT, NSET=ALL\nU, V, A, RF\n"
STEPS = f"""\
*AMPLITUDE, NAME=PUSH
0., 0., 0.02, 1., 0.05, -1., 0.1, 0.
*STEP
*STATIC
{WEIGHT}{PRINT}*END STEP
*STEP
*FREQUENCY
6
*END STEP
*STEP
*DYNAMIC, DIRECT
0.005, 0.1
*DAMPING, RATIO=0.02, F1=5., F2=50.
*DSLOAD, AMPLITUDE=PUSH
B_Z1, P, 1e5
{PRINT}*END STEP
"""


def beam(n: int, m: int) -> Blocks:
    """A cantilever of two blocks along x, n and m bricks across."""
    blocks = Blocks()
    blocks.add("A", (4, 0, 4), (n, 0, 1), (n, 0, 1))
    blocks.add("B", (4, 4, 8), (m, 0, 1), (m, 0, 1))
    return blocks


def run_beam(keyway, blocks: Blocks, cards: str, *options: str, name="job"):
    held = node_set("BASE", blocks.side("A", "X0")) + "*BOUNDARY\nBASE, 1, 3\n"
    return keyway(blocks.deck({"": ELASTIC}, cards + held + STEPS), *options, name=name)


def frequencies(run) -> np.ndarray:
    return np.array([mode["hz"] for mode in run.json["steps"][1]["frequencies"]])


def test_tied_beam_of_equal_meshes_is_one_beam(keyway):
    """Statics, modes, motion and reactions; each node of one face follows one of the other."""
    tied, whole = beam(2, 2), beam(2, 2)
    whole.share("A", "B")
    runs = [
        run_beam(keyway, tied, ties(("B_X0", "A_X1")), name="tied"),
        run_beam(keyway, whole, "", name="whole"),
    ]
    used = np.unique(np.concatenate([n.ravel() for n in whole.nodes.values()]))
    np.testing.assert_allclose(frequencies(runs[0]), frequencies(runs[1]), rtol=SAME)
    for step in (1, 3):
        for field, tolerance in (("U", SAME), ("V", SAME), ("RF", SAME), ("A", 1e2 * SAME)):
            one, two = (state_of(run, "ALL", field, step)[used] for run in runs)
            # Round-off in the accelerations is that of the highest modes.
            assert np.abs(one - two).max() <= tolerance * max(np.abs(two).max(), 1e-30)
    # The nodes that follow move with those that they follow: to a unit of the last of the 13 digits
    # that are written, as weights of one and zero have round-off.
    slave, master = tied.side("B", "X0"), tied.side("A", "X1")
    u = state_of(runs[0], "ALL")
    assert np.abs(u[slave] - u[master]).max() <= 1e-12 * np.abs(u).max()
    assert runs[0].json["steps"][2]["energy"]["error"] < 1e-9


@pytest.mark.parametrize("meshes", [(2, 3), (3, 2), (4, 2), (2, 4)])
def test_modes_of_a_tied_beam(keyway, meshes):
    """Between those of one beam with the coarser and with the finer mesh, which are 5 % apart; a
    tie that fails or locks would leave this range.
    """
    slave, master = meshes
    blocks = beam(master, slave)
    found = frequencies(run_beam(keyway, blocks, ties(("B_X0", "A_X1"))))
    bounds = []
    for n in meshes:
        whole = beam(n, n)
        whole.share("A", "B")
        bounds.append(frequencies(run_beam(keyway, whole, "", name=f"whole{n}")))
    assert (found >= np.minimum(*bounds) * (1 - 1e-3)).all()
    assert (found <= np.maximum(*bounds) * (1 + 1e-3)).all()


def test_threads_do_not_change_a_tied_beam(keyway):
    runs = [
        run_beam(keyway, beam(2, 5), ties(("B_X0", "A_X1")), "-j", str(n), name=f"threads{n}")
        for n in (1, 2)
    ]
    np.testing.assert_allclose(frequencies(runs[0]), frequencies(runs[1]), rtol=1e-10)
    for field in ("U", "V", "RF"):
        one, two = (state_of(run, "ALL", field) for run in runs)
        assert np.abs(one - two).max() <= 1e-10 * np.abs(two).max()  # as in test_threads


@pytest.mark.parametrize("slave_above", [True, False])
def test_reactions_of_a_block_on_held_rock(keyway, slave_above):
    """All nodes of the rock are held, so its block carries nothing itself: what the dam weighs and
    how it leans arrives at the held nodes of the face, through the tie. Held nodes follow nothing,
    so with the rock as slave the dam has nothing that holds it: an error of the deck.
    """
    blocks = Blocks()
    blocks.add("DAM", (3, 0.3, 1.3), (3, 0.2, 1.2), (2, 1, 2))
    blocks.add("ROCK", (4, 0, 2), (5, 0, 2), (1, 0, 1))
    pair = ("DAM_Z0", "ROCK_Z1")
    cards = ties(pair if slave_above else pair[::-1])
    cards += node_set("ROCK", blocks.nodes["ROCK"].ravel()) + "*BOUNDARY\nROCK, 1, 3\n"
    cards += "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n*DSLOAD\nDAM_X0, P, 3e3\n"
    deck = blocks.deck({"": ELASTIC}, cards + PRINT + "*END STEP\n")
    if not slave_above:
        assert "the tie constrains no node" in keyway(deck, code=2).stderr
        return
    force = state_of(keyway(deck), "ALL", "RF")
    total = np.array([-3e3, 0.0, 9.81 * 2000.0])
    assert np.abs(force.sum(axis=0) - total).max() < SAME * total.max()
    moment = np.cross(blocks.x, force).sum(axis=0)
    exact = np.cross([0.8, 0.7, 1.5], total)
    assert np.abs(moment - exact).max() < SAME * np.abs(exact).max()
    face = np.isin(np.arange(len(force)), blocks.side("ROCK", "Z1"))
    assert np.abs(force[~face]).max() < SAME * total.max()


def test_tied_blocks_follow_a_moving_support(keyway):
    """Both ends of the face have supports, one end on the slave. With equal motions of the supports
    the model moves rigidly.
    """
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (2, 0, 1), (3, 0, 1))
    blocks.add("B", (2, 1, 2), (3, 0, 1), (2, 0, 1))
    held = np.unique(np.concatenate([blocks.side("A", "Z0"), blocks.side("B", "Z0")]))
    cards = ties(("A_X1", "B_X0")) + node_set("BASE", held) + "*BOUNDARY\nBASE, 1, 3\n"
    for move in ((1e-3, 0.0, 0.0), (1e-3, -2e-3, 0.0), (0.0, 0.0, 3e-3)):
        cards += "*STEP\n*STATIC\n0.5, 1.\n*BOUNDARY\n"
        cards += "".join(f"BASE, {i}, {i}, {u}\n" for i, u in enumerate(move, 1))
        cards += PRINT + "*END STEP\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards))
    for step, move in ((1, (1e-3, 0.0, 0.0)), (2, (1e-3, -2e-3, 0.0)), (3, (0.0, 0.0, 3e-3))):
        assert np.abs(state_of(run, "ALL", "U", step) - move).max() < 1e-12
        assert np.abs(state_of(run, "ALL", "RF", step)).max() < 1e-9 * 1e9 * 3e-3


def test_support_of_one_direction_keeps_the_others_tied(keyway):
    """A plane state: every node is held along y. A rod in tension is as long as one without a tie,
    sigma (1 - nu^2) / E.
    """
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (1, 0, 1), (2, 0, 1))
    blocks.add("B", (2, 1, 2), (1, 0, 1), (3, 0, 1))
    cards = ties(("B_X0", "A_X1")) + node_set("WALL", blocks.side("A", "X0"))
    cards += "*BOUNDARY\nWALL, 1\nALL, 2\n1, 3\n*STEP\n*STATIC\n*DSLOAD\nB_X1, P, -1e6\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards + PRINT + "*END STEP\n"))
    u = state_of(run, "ALL")
    exact = 1e6 / 1e9 * (1 - 0.2**2) * blocks.x[:, 0]
    assert np.abs(u[:, 0] - exact).max() < SAME * exact.max()


def test_free_fall_and_flight(keyway):
    """Velocities are given to the master and to the free nodes of the slave: what follows starts
    with what it follows. Under gravity nothing but the acceleration g appears anywhere.
    """
    blocks = Blocks()
    blocks.add("A", (2, 0, 1), (2, 0, 1), (2, 0, 1))
    blocks.add("B", (1, 1, 2), (3, 0, 1), (4, 0, 1))
    given = np.setdiff1d(np.arange(len(blocks.x)), blocks.side("A", "X1"))
    cards = ties(("A_X1", "B_X0")) + node_set("GIVEN", given)
    cards += "*INITIAL CONDITIONS, TYPE=VELOCITY\nGIVEN, 1, 3.\nGIVEN, 2, -1.\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n" + WEIGHT + PRINT + "*END STEP\n"
    run = keyway(blocks.deck({"": ELASTIC}, cards))
    assert run.stderr.count("warning") == 0
    table = run.csv("node_ALL")
    time = table["time"]
    for i, speed in ((1, 3.0), (2, -1.0), (3, 0.0)):
        fall = -9.81 if i == 3 else 0.0
        assert np.abs(table[f"A{i}"] - fall).max() < 1e-8 * 9.81
        assert np.abs(table[f"V{i}"] - speed - fall * time).max() < SAME
        assert np.abs(table[f"U{i}"] - speed * time - fall * time**2 / 2).max() < SAME


def test_joint_between_tied_blocks(keyway):
    """Two blocks that stand on rock, tied to it or with its nodes, and a joint between them that
    opens and slides: its lowest pairs are tied at both ends, where it cannot.
    """

    def deck(is_tied: bool) -> str:
        blocks = Blocks()
        blocks.add("ROCK", (4, 0, 4), (2, 0, 1), (1, 0, 1))
        blocks.add("L", (2, 0, 2), (2, 0, 1), (2, 1, 3))
        blocks.add("R", (2, 2, 4), (2, 0, 1), (2, 1, 3))
        for name in () if is_tied else ("L", "R"):
            blocks.share("ROCK", name)
        cards = ties(("L_Z0", "ROCK_Z1"), ("R_Z0", "ROCK_Z1")) if is_tied else ""
        pairs = zip(blocks.nodes["L"][-1], blocks.nodes["R"][0], strict=True)
        left, right = (np.array(side) for side in zip(*pairs, strict=True))
        cards += "*ELEMENT, TYPE=JOINT8, ELSET=SEAM\n"
        for k, (j, i) in enumerate(np.ndindex(2, 2), start=1001):
            # the normal points from master (left) to slave (right)
            corner = [(j, i), (j + 1, i), (j + 1, i + 1), (j, i + 1)]
            ids = [side[c] + 1 for side in (left, right) for c in corner]
            cards += ", ".join(map(str, [k, *ids])) + "\n"
        cards += "*JOINT LAW, NAME=LAW, FRICTION=0.3\n*JOINT, NAME=SEAM, LAW=LAW, ELSET=SEAM\n"
        cards += node_set("BASE", blocks.side("ROCK", "Z0")) + "*BOUNDARY\nBASE, 1, 3\n"
        cards += node_set("TOP", np.concatenate([blocks.side(b, "Z1") for b in "LR"]))
        cards += "*STEP\n*STATIC\n0.25, 1.\n*DSLOAD\nL_X0, P, 2e5\nR_Y0, P, 1e5\n"
        cards += "*NODE PRINT, NSET=TOP\nU\n*JOINT PRINT, JOINT=SEAM\n*END STEP\n"
        cards += "*STEP\n*STATIC\n0.25, 1.\n*DSLOAD\nL_X0, P, -1e5\n*END STEP\n"
        cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.2\n*DSLOAD\nL_X0, P, 0.\n*END STEP\n"
        return blocks.deck({"": ELASTIC}, cards)

    tied, whole = (keyway(deck(is_tied), name=f"tied{is_tied}") for is_tied in (True, False))
    for step in (1, 2, 3):
        one, two = (state_of(run, "TOP", "U", step) for run in (tied, whole))
        assert np.abs(one - two).max() < 1e-7 * np.abs(two).max()  # of a friction iteration
    opening = whole.csv("joint_SEAM")["opening"].max()
    assert opening > 1e-5
    assert tied.csv("joint_SEAM")["opening"].max() == pytest.approx(opening, rel=1e-6)


@pytest.mark.parametrize("meshes", ["equal", "finer concrete", "coarser concrete"])
def test_concrete_cracks_beside_a_tie(keyway, meshes):
    """A bar of two materials along x, pulled until the weak brick of concrete has softened to a
    third of its strength: the same curve as of a bar in one piece. nu = 0 and a dilation with which
    cracks open straight keep the state uniaxial, so that the meshes across do not matter; that
    dilation is rounded to three digits.
    """
    concrete = Concrete(
        poisson=0.0,
        tension_type="GFI",
        tension=((2.5e6, 150.0),),
        flow=(56.2, 0.0001, 1.125, 2.0 / 3.0, 0.0),
    )
    sound = "*ELASTIC\n25e9, 0.\n"

    def curve(across: tuple[int, int], is_tied: bool, name: str) -> tuple[np.ndarray, ...]:
        blocks = Blocks()
        for block, x, n in (("WEAK", (1, 0, 0.1), across[0]), ("REST", (2, 0.1, 0.3), across[1])):
            blocks.add(block, x, (n, 0, 0.1), (n, 0, 0.1))
        finer = across[0] >= across[1]
        pair = ("WEAK_X1", "REST_X0") if finer else ("REST_X0", "WEAK_X1")
        if not is_tied:
            blocks.share("WEAK", "REST")
        cards = ties(pair) if is_tied else ""
        cards += node_set("LEFT", blocks.side("WEAK", "X0"))
        cards += node_set("RIGHT", blocks.side("REST", "X1"))
        cards += "*BOUNDARY\nLEFT, 1\n1, 2, 3\n" + f"{blocks.side('WEAK', 'X0')[-1] + 1}, 2\n"
        cards += "*STEP, INC=200\n*STATIC\n0.02, 1., 1e-4, 0.02\n*BOUNDARY\nRIGHT, 1, 1, 1.1e-4\n"
        cards += "*NODE PRINT, NSET=RIGHT\nU, RF\n*END STEP\n"
        law = concrete.cards("MWEAK").removeprefix("*MATERIAL, NAME=MWEAK\n")
        run = keyway(blocks.deck({"WEAK": law, "REST": sound}, cards), name=name)
        table = run.csv("node_RIGHT")
        times = np.unique(table["time"])
        force = np.array([table["RF1"][table["time"] == t].sum() for t in times])
        return times, force

    across = {"equal": (2, 2), "finer concrete": (3, 2), "coarser concrete": (2, 3)}[meshes]
    times, force = curve(across, True, "tied")
    whole_times, whole = curve((2, 2), False, "whole")
    # An increment may pass over the peak, by 2 % of the elongation at most.
    assert force.max() == pytest.approx(2.5e6 * 0.01, rel=0.02)
    assert force[-1] < 0.4 * force.max()
    expected = np.interp(times, whole_times, whole)
    tolerance = SAME if meshes == "equal" else 1e-4
    assert np.abs(force - expected).max() < tolerance * whole.max()
