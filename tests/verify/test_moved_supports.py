"""Bodies that their supports strain or move: blocks by hand."""

from __future__ import annotations

import numpy as np
import pytest
from brick_decks import brick_deck, elastic, last_state
from joint_decks import Block
from keyway_tools.box_mesh import box_mesh, stretched
from tied_blocks import Blocks, node_set


def test_a_strained_block_is_at_rest_in_statics_and_dynamics(keyway):
    """A cube between a fixed and a lowered face, sides held: linear; 1e-12 of it is round-off. The
    reference force is that of the reactions."""
    mesh, number = box_mesh((2, 2, 2), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BOTTOM"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:, :, -1].ravel()
    cards = elastic(25.0e9, 0.2, 2400.0) + "*BOUNDARY\nALL, 1, 2\nBOTTOM, 3, 3\n"
    cards += "*STEP\n*STATIC\n*BOUNDARY\nTOP, 3, 3, -1.e-3\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*END STEP\n"
    run = keyway(brick_deck(mesh, "C3D8", cards))
    u = last_state(run, "ALL")
    assert np.abs(u[:, 2] + 1.0e-3 * mesh.x[:, 2]).max() < 1e-15
    assert [step["increments"] for step in run.json["steps"]] == [1, 10]


WEIGHT = "*STEP\n*STATIC\n*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n"
RF = "*NODE PRINT, NSET=BASE\nU, RF\n*END STEP\n"


@pytest.mark.parametrize("base_is_slave", [False, True])
def test_a_base_that_belongs_to_joints_alone(keyway, base_is_slave):
    """It has the reactions of the joint, and moves where it is moved: the block goes with it."""
    law = "KN=1e10, KT=1e10, FRICTION=0.8"
    block = Block(size=(2.0, 1.0, 1.5), density=2000.0, law=law, base_is_slave=base_is_slave)
    steps = WEIGHT + "*NODE PRINT, NSET=TOP\nU\n" + RF
    steps += "*STEP\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY\nBASE, 3, 3, 0.01\nBASE, 1, 1, -0.002\n"
    run = keyway(block.deck(steps + "*END STEP\n"))
    base, top = run.csv("node_BASE"), run.csv("node_TOP")
    weight = 2000.0 * 9.81 * 3.0
    for step, increment in ((1, 1), (2, 1), (2, 4)):
        now = (base["step"] == step) & (base["increment"] == increment)
        assert base["RF3"][now].sum() == pytest.approx(weight, rel=1e-9)
        assert np.abs(base["RF1"][now].sum()) < 1e-6 * weight
    last = top["step"] == 2
    share = top["increment"][last] / 4.0
    start = top["U3"][top["step"] == 1].mean()
    assert top["U3"][last] == pytest.approx(start + 0.01 * share, abs=1e-9)
    assert top["U1"][last] == pytest.approx(-0.002 * share, abs=1e-9)


@pytest.mark.parametrize("alpha", [0.0, -0.05])
@pytest.mark.parametrize("increment", [0.01, 0.0025])
def test_a_history_of_displacements(keyway, alpha, increment):
    """u = (1 - cos(w t))^2 in steps of 0.01 s: rates are those of the history, and the reaction is
    the mass times the acceleration of a stiff block.

    By Newmark's formulas each corner of the table starts a swing of the support: with increments of
    a quarter of its steps the reaction was 20 to 300 times too large."""
    time = np.linspace(0.0, 0.5, 51)
    omega, size = 2.0 * np.pi / 0.5, 0.001
    path = size * (1.0 - np.cos(omega * time)) ** 2
    table = "".join(f"{t:.4f}, {u:.12g}\n" for t, u in zip(time, path, strict=True))
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    damped = elastic(3e10, 0.0, 2400.0).replace("*DENSITY", "*DAMPING, BETA=1e-3\n*DENSITY")
    cards = f"{damped}*AMPLITUDE, NAME=PATH\n{table}*BOUNDARY\nBASE, 2, 3\n"
    cards += f"*STEP, INC=1000\n*DYNAMIC, DIRECT, ALPHA={alpha}\n{increment}, 0.5\n"
    cards += "*BOUNDARY, AMPLITUDE=PATH\nBASE, 1, 1, 1.\n*NODE PRINT, NSET=BASE\nU, V, A, RF\n"
    run = keyway(brick_deck(mesh, "C3D8", cards + "*END STEP\n"))
    found = run.csv("node_BASE")
    one = found["node"] == found["node"][0]
    t = found["time"][one]
    s, c = np.sin(omega * t), np.cos(omega * t)
    speed = 2.0 * size * omega * (1.0 - c) * s
    rate = 2.0 * size * omega**2 * (s**2 + (1.0 - c) * c)
    # The table has corners: between them the speed is that of a chord. Where increments are finer
    # than the table, the acceleration of a corner stands in one increment, and the block answers
    # to it: means over a step of the table are compared, of forces in the mean square.
    assert found["V1"][one] == pytest.approx(speed, abs=0.08 * np.abs(speed).max())
    force = found["RF1"].reshape(len(t), -1).sum(axis=1)
    width = round(0.01 / increment)
    mean, right, pushed = (
        np.convolve(values, np.ones(width) / width, "valid")
        for values in (found["A1"][one], rate, force)
    )
    assert mean == pytest.approx(right, abs=0.12 * np.abs(rate).max())
    assert np.linalg.norm(pushed - 2400.0 * right) <= 0.2 * np.linalg.norm(2400.0 * right)
    assert np.abs(found["A1"][one]).max() <= 1.2 * width * np.abs(rate).max()
    assert run.json["steps"][0]["energy"]["error"] < 1e-9


def test_a_support_that_goes_fades(keyway):
    """A bar is pushed by 1 mm and let go in four increments: the reaction falls in equal parts, as
    loads that are taken away do, and the bar with it. All energy is given back."""
    mesh, number = box_mesh((1, 1, 3), stretched((1.0, 1.0, 3.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    cards = elastic(20e9, 0.0) + "*BOUNDARY\nBASE, 1, 3\n"
    cards += "*STEP\n*STATIC, DIRECT\n0.5, 1.\n*BOUNDARY\nTOP, 3, 3, -1e-3\n"
    cards += "*NODE PRINT, NSET=TOP\nU, RF\n*END STEP\n"
    cards += "*STEP\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY, OP=NEW\nBASE, 1, 3\n*END STEP\n"
    run = keyway(brick_deck(mesh, "C3D8", cards))
    table = run.csv("node_TOP")
    now = table["step"] == 2
    share = table["increment"][now] / 4.0
    assert table["U3"][now] == pytest.approx(-1e-3 * (1.0 - share), abs=1e-15)
    assert np.all(table["RF3"][now] == 0.0)
    energy = run.csv("energy")
    assert energy["external"][-1] == pytest.approx(0.0, abs=1e-9 * energy["external"].max())
    assert energy["numerical"] == pytest.approx(0.0, abs=1e-9 * energy["external"].max())


# Forces on the top of a bar of 1000 N/m: in a motion, in the static step after it, and how far both
# move the top [m].
RELEASES = {
    "a force comes": ("", "*CLOAD, AMPLITUDE=ONE\nTOP, 3, 25.\n", 0.0, 0.1),
    "a force gets a history": (
        "*CLOAD\nTOP, 3, 25.\n",
        "*CLOAD, AMPLITUDE=ONE\nTOP, 3, 25.\n",
        0.1,
        0.1,
    ),
    "a pressure gets other heights": (
        "*DLOAD\nBODY, HP2, -100., 2., 1.\n",
        "*DLOAD, AMPLITUDE=ONE\nBODY, HP2, -100., 3., 2.\n",
        0.1,
        0.2,
    ),
}


@pytest.mark.parametrize("case", RELEASES)
def test_a_support_of_a_motion_goes_and_a_load_comes(keyway, case):
    """The top is moved to 10 mm in a dynamic step. In the static step after it the support goes,
    and its reaction fades, without inertia; a load with an amplitude acts from the start."""
    first, second, before, after = RELEASES[case]
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    cards = elastic(1000.0, 0.0, 1.0) + "*AMPLITUDE, NAME=ONE\n0., 1., 1., 1.\n"
    cards += "*BOUNDARY\nBASE, 1, 3\nTOP, 1, 3\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.03\n*BOUNDARY\nTOP, 3, 3, 0.01\n"
    cards += f"{first}*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    cards += "*STEP\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY, OP=NEW\nBASE, 1, 3\nTOP, 1, 2\n"
    table = keyway(brick_deck(mesh, "C3D8", f"{cards}{second}*END STEP\n")).csv("node_TOP")
    now = table["step"] == 2
    left = 1.0 - table["increment"][now] / 4.0
    # The support carries what the first force lacks, or has too much, for 10 mm. 1e-12: round-off.
    assert table["U3"][now] == pytest.approx(after + (0.01 - before) * left, rel=1e-12)


def shaken_bar(parts: list[float], base: str, more: str = "") -> str:
    """A bar of two bricks on a base with these cards in each step; the base is in direction 3."""
    mesh, number = box_mesh((1, 1, 2), stretched((1.0, 1.0, 4.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    history = "".join(f"{t:.3f}, {np.sin(17.0 * t) ** 2:.12g}\n" for t in np.arange(0, 1, 0.01))
    cards = elastic(2e10, 0.2, 2400.0) + "*BOUNDARY\nBASE, 1, 3\n"
    cards += f"*AMPLITUDE, NAME=PATH, TIME=TOTAL TIME\n{history}"
    for i, length in enumerate(parts):
        cards += f"*STEP\n*DYNAMIC, DIRECT\n0.005, {length}\n{base}{more if i == 1 else ''}"
        cards += "*NODE PRINT, NSET=TOP\nU, V, A\n*NODE PRINT, NSET=BASE\nU, V, A, RF\n*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


FOLLOWS = "*BOUNDARY, AMPLITUDE=PATH\nBASE, 3, 3, 0.01\n"


def test_a_history_over_several_steps(keyway):
    """Rates at the ends of steps are those of the history, which goes on: the same in one step."""
    whole = keyway(shaken_bar([0.4], FOLLOWS), name="whole")
    parts = keyway(shaken_bar([0.1, 0.005, 0.095, 0.2], FOLLOWS), name="parts")
    for name in ("node_TOP", "node_BASE"):
        expected, found = whole.csv(name), parts.csv(name)
        for column in set(expected) - {"step", "increment", "time", "node"}:
            one = expected[column][expected["increment"] > 0]
            other = found[column][found["increment"] > 0]
            assert other == pytest.approx(one, abs=1e-9 * max(np.abs(one).max(), 1e-9)), column


def drawn_bar(clock: str, end: float, first: float = 0.0) -> str:
    """A bar that its base accelerates by 1 m/s2 for 0.2 s; then nothing holds the base along the
    motion. A table from `first` to `end` [s]."""
    mesh, number = box_mesh((1, 1, 2), stretched((1.0, 1.0, 2.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "ALL": number.ravel()}
    times = np.arange(0.0, end + 0.005, 0.01)
    history = "".join(f"{first + t:.2f}, {0.5 * t**2:.12g}\n" for t in times)
    cards = elastic(2e10, 0.2, 2400.0) + f"*AMPLITUDE, NAME=A, TIME={clock}\n{history}"
    cards += "*BOUNDARY\nBASE, 1, 3\n" + ("*STEP\n*STATIC\n*END STEP\n" if first else "")
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.2\n*BOUNDARY, AMPLITUDE=A\nBASE, 1, 1, 1.\n"
    cards += "*NODE PRINT, NSET=ALL\nU, V, A, RF\n*NODE PRINT, NSET=BASE\nA\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.05\n*BOUNDARY, OP=NEW\nBASE, 2, 3\n*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


@pytest.mark.parametrize("first", [0.0, 1.0], ids=["analysis", "later step"])
def test_a_table_in_total_time_that_ends_with_its_step(keyway, first):
    """The same motion as by a table in the time of the step, also after the release. The support
    stopped in the last increment, with 20 times its acceleration, and took 6 % of the momentum."""
    clocks = {"STEP TIME": 0.0, "TOTAL TIME": first}
    tables = [
        keyway(drawn_bar(clock, 0.2, start), name=clock[:4]).csv("node_ALL")
        for clock, start in clocks.items()
    ]
    ends = [(t["step"] >= t["step"][-1] - 1) & (t["increment"] > 0) for t in tables]
    for column in ("U1", "V1", "A1", "A3", "RF1"):
        expected, found = (table[column][end] for table, end in zip(tables, ends, strict=True))
        assert found == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("end", [0.2, 0.3], ids=["ends", "goes on"])
def test_a_support_has_the_acceleration_of_its_table(keyway, end):
    """1 m/s2 in all increments, whether the table ends with the step or goes on."""
    table = keyway(drawn_bar("TOTAL TIME", end)).csv("node_BASE")
    moves = (table["step"] == 1) & (table["increment"] > 0)
    assert table["A1"][moves] == pytest.approx(1.0, rel=1e-6)  # digits of the table


@pytest.mark.parametrize(
    "change",
    [
        "*BOUNDARY, OP=NEW\nBASE, 1, 3\nTOP, 1, 1\n",
        "*BOUNDARY, OP=NEW\nBASE, 1, 2\n",
        "*BOUNDARY\nBASE, 3, 3, 0.002\n",
        "*CLOAD\nTOP, 3, 1e6\n",
        "*DAMPING, RATIO=0.1, F1=5., F2=50.\n",
    ],
)
@pytest.mark.parametrize("first", ["", FOLLOWS], ids=["at rest", "moves"])
def test_what_changes_between_two_steps(keyway, change, first):
    """Supports that go, come or jump, loads and damping: the energy balance closes."""
    push = "*CLOAD\nTOP, 1, 2e5\n"
    text = shaken_bar([0.1, 0.1], push, change)
    run = keyway(text.replace(push, first + push, 1))
    assert [step["increments"] for step in run.json["steps"]] == [20, 20]
    assert max(step["energy"]["error"] for step in run.json["steps"]) < 1e-9


PERIOD, SWAY = 0.3, 0.01  # of the base [s], [m]


def swayed_bar(keyway, num: int, damping: str, moves_supports: bool, alpha: float) -> np.ndarray:
    """Motion of the top of a soft bar relative to its base, which sways smoothly for two periods:
    by displacements of its supports, or by accelerations of the base."""
    mesh, number = box_mesh((1, 1, 2), stretched((1.0, 1.0, 2.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:1, 0, -1]}
    end, w = 2.0 * PERIOD, 2.0 * np.pi / PERIOD
    time = np.linspace(0.0, end, num + 1)
    c = np.cos(w * time)
    path = SWAY * (1.0 - c) ** 2
    history = path if moves_supports else 2.0 * SWAY * w**2 * (1.0 + c - 2.0 * c**2)
    table = "".join(f"{t!r}, {x!r}\n" for t, x in zip(time.tolist(), history.tolist(), strict=True))
    cards = elastic(2e6, 0.0, 2400.0) + f"*AMPLITUDE, NAME=PATH\n{table}*BOUNDARY\nBASE, 1, 3\n"
    cards += f"*STEP, INC=10000\n*DYNAMIC, DIRECT, ALPHA={alpha}\n{end / num!r}, {end}\n{damping}"
    if moves_supports:
        cards += "*BOUNDARY, AMPLITUDE=PATH\nBASE, 1, 1, 1.\n"
    else:
        cards += "*BASE MOTION, DOF=1, AMPLITUDE=PATH\n"
    run = keyway(brick_deck(mesh, "C3D8", f"{cards}*NODE PRINT, NSET=TOP\nU\n*END STEP\n"))
    assert run.json["steps"][0]["energy"]["error"] < 1e-9
    relative = run.csv("node_TOP")["U1"][-num:] - (path[1:] if moves_supports else 0.0)
    return np.append(run.csv("energy")["damping"][-1], relative)


@pytest.mark.parametrize("damping", ["", "*DAMPING, MODAL, RATIO=0.05, MODES=4\n"])
@pytest.mark.parametrize("alpha", [0.0, -0.3])
def test_supports_move_as_a_base_does(keyway, damping, alpha):
    """Both have the same equations but for the accelerations of the supports, which are central
    differences: an error of second order. Modes are damped relative to their supports: the
    absolute velocity made 8 % in the histories and a fifteenth of the energy (MODES=1)."""
    errors = []
    for num in (120, 240):
        one, other = (swayed_bar(keyway, num, damping, way, alpha) for way in (True, False))
        errors.append(np.abs(one - other)[1:].max() / np.abs(other[1:]).max())
        assert one[0] == pytest.approx(other[0], rel=0.02)  # energy of the damping
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] > 3.7


@pytest.mark.parametrize("held", ["BASE, 3, 3\nBOTTOM, 1, 2", "BOTTOM, 1, 3"])
def test_a_base_that_is_not_held_is_warned_of(keyway, held):
    """Without solids it has no unknowns then, and stands at its place."""
    block = Block(size=(1.0, 1.0, 1.0), law="KN=1e10, KT=1e10, FRICTION=0.8")
    deck = block.deck(WEIGHT + "*END STEP\n").replace("BASE, 1, 3", held)
    run = keyway(deck)
    assert "belongs to joint elements alone and is not held in all directions" in run.stderr


@pytest.mark.parametrize("change", ["*BOUNDARY, OP=NEW\nBASE, 1, 3\n", "*BOUNDARY\nBASE, 1, 1\n"])
def test_supports_end_an_acceleration(keyway, change):
    """As in Abaqus: OP=NEW takes accelerations of supports away, and displacements of the supports
    replace them, as a base motion of zero does."""
    mesh, number = box_mesh((1, 1, 2), stretched((1.0, 1.0, 2.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    cards = elastic(1e4, 0.2, 1.0) + "*BOUNDARY\nBASE, 1, 3\n"
    cards += "*AMPLITUDE, NAME=Q\n0., 0., 0.1, 1., 0.2, -0.5, 0.3, 0.7\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.02, 0.3\n{}*NODE PRINT, NSET=TOP\nU, A\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.02, 0.3\n{}*END STEP\n"
    still = "*BASE MOTION, DOF=1, AMPLITUDE=Q, SCALE="
    pairs = (
        (
            "*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=Q\nBASE, 1, 1, 3.\n",
            change,
        ),
        (f"{still}3.\n", f"{still}0.\n"),
    )
    ours, other = (
        keyway(brick_deck(mesh, "C3D8", cards.format(*pair)), name=f"run{i}").csv("node_TOP")
        for i, pair in enumerate(pairs)
    )
    assert np.abs(other["U1"][other["step"] == 2]).max() > 1e-4
    for column in ("U1", "A1", "U3"):
        assert ours[column] == pytest.approx(other[column], abs=1e-12)


def test_a_base_motion_replaces_an_acceleration(keyway):
    """Supports that are given again do not end a *BASE MOTION."""
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets |= {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    cards = elastic(1e4, 0.2, 1.0) + "*BOUNDARY\nBASE, 1, 3\n"
    cards += "*AMPLITUDE, NAME=Q\n0., 0., 0.1, 1., 0.2, -0.5, 0.3, 0.7\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.02, 0.3\n*NODE PRINT, NSET=TOP\nU\n"
    cards += "*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=Q\nBASE, 1, 1, 3.\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.02, 0.3\n*BASE MOTION, DOF=1, AMPLITUDE=Q, SCALE=3.\n"
    ours, other = (
        keyway(brick_deck(mesh, "C3D8", f"{cards}{more}*END STEP\n"), name=name).csv("node_TOP")
        for name, more in (("ours", "*BOUNDARY\nBASE, 1, 3\n"), ("other", ""))
    )
    assert ours["U1"] == pytest.approx(other["U1"], abs=1e-15)


@pytest.mark.parametrize("stiffness", [2.5e4, 2.5e5, 2.5e7])
def test_a_held_block_above_a_gap(keyway, stiffness):
    """A block in mm moves by 0.5 towards another one, 1 below. Nothing resists: the round-off of
    closed joints, which the factored matrix has, counts as none."""
    blocks = Blocks()
    blocks.add("A", (1, 0.0, 1e4), (1, 0.0, 1e4), (1, 0.0, 1e4))
    blocks.add("B", (1, 0.0, 1e4), (1, 0.0, 1e4), (1, 10001.0, 20001.0))
    cards = node_set("BASE", blocks.side("A", "Z0")) + node_set("TOP", blocks.side("B", "Z1"))
    cards += f"*JOINT LAW, NAME=LAW, KN={stiffness!r}, FRICTION=0.5, TENSILE STRENGTH=1.\n"
    cards += "*JOINT, NAME=J, LAW=LAW, CLEARANCE=MEASURED\nB_Z0, A_Z1\n"
    cards += "*BOUNDARY\nBASE, 1, 3\nTOP, 1, 3\n*STEP\n*STATIC\n*JOINT PRINT, JOINT=J\n"
    cards += "*BOUNDARY\nTOP, 3, 3, -0.5\n*END STEP\n"
    run = keyway(blocks.deck({"": "*DENSITY\n1.\n*ELASTIC\n25e3, 0.\n"}, cards))
    assert run.json["steps"][0]["increments"] == 1
    # Round-off times the stiffness of the joint over that of the block, 1e7.
    assert run.csv("joint_J")["opening"] == pytest.approx(0.5, abs=1e-8)
