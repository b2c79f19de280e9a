"""The worked example of a time integrator: Bathe's method against closed forms, and beside HHT."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

DECK = (Path(__file__).resolve().parent / "bathe" / "deck.inp").read_text(encoding="utf-8")
MODEL = DECK[: DECK.index("*STEP")]
DAMPING = "*DAMPING, ALPHA=0.6283185307179586\n"
INCREMENTS = "0.01, 1.25\n"
OMEGA = 2.0 * math.pi  # of the brick [1/s]
RATIO = 0.05
START = -0.5 * 3.0 / OMEGA**2  # half of the weight over the stiffness [m]
SPLIT = 2.0 - math.sqrt(2.0)  # gamma


def edited(deck: str, *edits: tuple[str, str]) -> str:
    """The deck with replaced texts; each text must occur in the deck."""
    for old, new in edits:
        assert old in deck, f"the deck has no '{old}'"
        deck = deck.replace(old, new)
    return deck


def with_increments(dt: float, duration: float = 1.25) -> tuple[str, str]:
    return INCREMENTS, f"{dt!r}, {duration!r}\n"


def motion(run) -> np.ndarray:
    """Displacement, velocity and acceleration of the top in the last step, a column each."""
    table = run.csv("node_TOP")
    last = table["step"] == table["step"][-1]
    return np.stack([table[f"{name}3"][last] for name in "UVA"], axis=1)


def exact(t: float) -> np.ndarray:
    """Displacement, velocity and acceleration of the brick."""
    root = complex(-RATIO * OMEGA, OMEGA * math.sqrt(1.0 - RATIO**2))
    amplitude = START * complex(1.0, root.real / root.imag)
    return np.array([(amplitude * root**n * np.exp(root * t)).real for n in range(3)])


def one_increment(dt: float, state: np.ndarray) -> np.ndarray:
    """u, v, a after one increment of Bathe's method, from its equations (Bathe 2007, eq. 3-8)."""
    balance = [OMEGA**2, 2.0 * RATIO * OMEGA, 1.0]
    h = SPLIT * dt
    u, v, a = state
    matrix = [balance, [1.0, -h / 2, 0.0], [0.0, 1.0, -h / 2]]
    middle = np.linalg.solve(matrix, [0.0, u + h / 2 * v, v + h / 2 * a])
    c1 = (1.0 - SPLIT) / (SPLIT * dt)
    c2 = -1.0 / ((1.0 - SPLIT) * SPLIT * dt)
    c3 = (2.0 - SPLIT) / ((1.0 - SPLIT) * dt)
    matrix = [balance, [c3, -1.0, 0.0], [0.0, c3, -1.0]]
    return np.linalg.solve(matrix, [0.0, *(-c1 * state[:2] - c2 * middle[:2])])


@pytest.mark.parametrize("dt", [0.05, 0.3, 20.0])
def test_increments_are_those_of_the_method(example, dt):
    """The damped oscillator, increment by increment: round-off of 13 printed digits."""
    run = example("bathe")(edited(DECK, with_increments(dt, 5.0 * dt)))
    states = [exact(0.0)]
    for _ in range(5):
        states.append(one_increment(dt, states[-1]))
    scale = np.abs(states).max(axis=0)
    assert np.abs(motion(run) - states[1:]).max(axis=0) / scale == pytest.approx(0.0, abs=1e-11)


def test_second_order(example):
    """0.1: at 100 and 200 increments a period the next term is some percent of the first."""
    program = example("bathe")
    scale = abs(START) * OMEGA ** np.arange(3)
    errors = {}
    for scheme in ("BATHE", "HHT"):
        found = []
        for dt in (0.01, 0.005):
            deck = edited(DECK, with_increments(dt), ("SCHEME=BATHE", f"SCHEME={scheme}"))
            found.append(np.abs(motion(program(deck))[-1] - exact(1.25)) / scale)
        errors[scheme] = np.array(found)
    orders = np.log2(errors["BATHE"][0] / errors["BATHE"][1])
    assert orders == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors["HHT"][0, :2] / errors["HHT"][1, :2]) == pytest.approx(2.0, abs=0.1)
    # An increment of Bathe's method has two parts, so its error is smaller.
    assert np.all(errors["BATHE"][:, :2] < 0.5 * errors["HHT"][:, :2])


def test_unresolved_motion_is_damped(example):
    """Spectral radius at 100 periods an increment: near 0; of HHT (1 + alpha)/(1 - alpha), 0.90."""
    program = example("bathe")
    left = {}
    for scheme in ("BATHE", "HHT"):
        change = ("SCHEME=BATHE", f"SCHEME={scheme}")
        run = program(edited(DECK, with_increments(100.0, 500.0), change, (DAMPING, "")))
        left[scheme] = np.abs(motion(run)[:, 0] / START)
    assert left["BATHE"][0] < 1e-2
    assert left["BATHE"][4] < 1e-9
    assert left["HHT"][4] > 0.1


def test_energies(example):
    """Without damping only the scheme dissipates energy, of third order in the increment."""
    taken = []
    for dt in (0.02, 0.01):
        run = example("bathe")(edited(DECK, with_increments(dt), (DAMPING, "")))
        table = run.csv("energy")
        assert table["error"].max() < 1e-11
        largest = table["strain"][table["step"] == 1][-1]
        assert np.diff(table["numerical"]).min() > -1e-12 * largest
        left = table["strain"][-1] + table["kinetic"][-1]
        taken.append(table["numerical"][-1] / largest)
        assert taken[-1] == pytest.approx((largest - left) / largest, rel=1e-9)
    assert math.log2(taken[0] / taken[1]) == pytest.approx(3.0, abs=0.1)


def test_energies_with_damping(example):
    """Damping dissipates the loss of the closed form; 1e-3: its work is that of mean forces."""
    table = example("bathe")(edited(DECK, with_increments(0.005))).csv("energy")
    assert table["error"].max() < 1e-11
    u, v, _ = exact(1.25)
    left = 0.5 * (v**2 + OMEGA**2 * u**2)
    start = 0.5 * OMEGA**2 * START**2
    assert table["damping"][-1] == pytest.approx(start - left, rel=1e-3)


def wave(name: str, values) -> str:
    """*AMPLITUDE of a function of time over 1.3 s."""
    time = np.linspace(0.0, 1.3, 6501)
    pairs = zip(time.tolist(), values(time).tolist(), strict=True)
    return f"*AMPLITUDE, NAME={name}\n" + "".join(f"{t!r}, {v!r}\n" for t, v in pairs)


@pytest.mark.parametrize("motion_of_base", ["base motion", "moved supports"])
def test_shaken_base(example, motion_of_base):
    """The base moves by 1 - cos(3 t): u'' + w^2 u = -1.5 * 9 cos(3 t), from rest, without damping.

    Half of the brick's mass moves with the base, which is 1.5 times the mass of its top.
    """
    speed, end = 3.0, 1.25
    if motion_of_base == "base motion":
        cards = wave("PATH", lambda t: speed**2 * np.cos(speed * t))
        moving = "*BASE MOTION, DOF=3, AMPLITUDE=PATH, TYPE=ACCELERATION\n"
        base = 0.0
    else:
        cards = wave("PATH", lambda t: 1.0 - np.cos(speed * t))
        moving = "*BOUNDARY, AMPLITUDE=PATH\nBASE, 3, 3, 1.\n"
        base = 1.0 - math.cos(speed * end)
    relative = (
        -1.5 * speed**2 / (OMEGA**2 - speed**2) * (math.cos(speed * end) - math.cos(OMEGA * end))
    )
    errors = []
    for dt in (0.02, 0.01):
        head = f"*STEP\n*DYNAMIC, SCHEME=BATHE, DIRECT\n{dt!r}, {end!r}\n"
        prints = "*NODE PRINT, NSET=TOP\nU, V, A\n*END STEP\n"
        run = example("bathe")(edited(MODEL, (DAMPING, "")) + cards + head + moving + prints)
        errors.append(abs(motion(run)[-1, 0] - base - relative) / abs(relative))
        assert run.csv("energy")["error"].max() < 1e-9
    assert errors[1] < 2e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


def test_sliding_mass(example):
    """1 kg on a bed with friction 0.1 under 1.5 sin(2 pi t) m/s2: 20.4531 mm of slip (SDND104).

    Tolerance: that of tests/verify/test_joint_motion.py for the same mass and increment.
    """
    bed = "*NODE\n" + "".join(
        f"{100 + node}, {x}, {y}, 0.\n"
        for node, x, y in ((1, 0, 0), (2, 1, 0), (3, 0, 1), (4, 1, 1))
    )
    bed += "*NSET, NSET=BED\n101, 102, 103, 104\n*ELEMENT, TYPE=JOINT8, ELSET=JJ\n"
    bed += "1001, 101, 102, 104, 103, 1, 2, 4, 3\n*MATERIAL"
    law = "*JOINT LAW, NAME=L, KN=1e8, KT=1e8, FRICTION=0.1\n*JOINT, NAME=J, LAW=L, ELSET=JJ\n"
    model = edited(
        MODEL,
        (DAMPING, ""),
        ("*MATERIAL", bed),
        ("39.47841760435743, 0.", "1e9, 0."),
        ("\n3.\n", "\n1.\n"),
        ("*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n", law + "*BOUNDARY\nBED, 1, 3\n"),
    )
    time = np.linspace(0.0, 4.0, 4001)
    pairs = zip(time.tolist(), (1.5 * np.sin(2.0 * np.pi * time)).tolist(), strict=True)
    model += "*AMPLITUDE, NAME=SINE\n" + "".join(f"{t!r}, {v!r}\n" for t, v in pairs)
    steps = "*STEP\n*STATIC\n*DLOAD\nBODY, GRAV, 10., 0., 0., -1.\n*END STEP\n"
    steps += "*STEP, INC=1000\n*DYNAMIC, SCHEME=BATHE, DIRECT\n0.005, 4.\n"
    steps += "*BASE MOTION, DOF=1, AMPLITUDE=SINE, TYPE=ACCELERATION\n"
    steps += "*NODE PRINT, NSET=TOP\nU, V, A\n*END STEP\n"
    run = example("bathe")(model + steps)
    slip = 0.0204531
    moved = run.csv("node_TOP")["U1"][400:]
    assert np.ptp(moved) == pytest.approx(slip, rel=3e-3)
    table = run.csv("energy")
    friction = np.interp([2.0, 5.0], table["time"], table["friction"])
    assert np.diff(friction)[0] / 3.0 == pytest.approx(2.0 * slip, rel=3e-3)
    assert table["error"].max() < 1e-3


CONCRETE = """25e9, 0.
*CONCRETE DAMAGED PLASTICITY
32.5, 0.01, 1.125, 0.6666666666666666, 0.
*CONCRETE COMPRESSION HARDENING
30e6, 0.
*CONCRETE TENSION STIFFENING
2.48e6, 0.
0.858e6, 0.175e-3
0.294e6, 0.757e-3
*CONCRETE TENSION DAMAGE
0., 0.
0.359, 0.175e-3
0.876, 0.757e-3
"""


@pytest.mark.parametrize("damping", ["", "*DAMPING, BETA=1e-5, BASE=CURRENT\n"])
def test_concrete_that_cracks(example, damping):
    """Concrete thrown upwards at its top, beyond its strength: it cracks once, in a quarter of its
    period, and oscillates on. 1 %: both schemes resolve the crack with 60 increments or more.
    """
    model = edited(
        MODEL, (DAMPING, damping), ("39.47841760435743, 0.\n", CONCRETE), ("\n3.\n", "\n2400.\n")
    )
    model += "*INITIAL CONDITIONS, TYPE=VELOCITY\n"
    model += "".join(f"{node}, 3, 0.8\n" for node in (5, 6, 7, 8))
    broken = {}
    for scheme in ("BATHE", "HHT"):
        steps = f"*STEP, INC=1000\n*DYNAMIC, SCHEME={scheme}, DIRECT\n5e-6, 1e-3\n"
        steps += "*NODE PRINT, NSET=TOP\nU, V, A\n*END STEP\n"
        table = example("bathe")(model + steps, name=scheme.lower()).csv("energy")
        assert table["error"].max() < 1e-6
        assert np.diff(table["fracture"]).min() >= -1e-12 * table["fracture"][-1]
        broken[scheme] = table["fracture"][-1] / table["kinetic"][0]
    assert broken["BATHE"] > 0.1
    assert broken["BATHE"] == pytest.approx(broken["HHT"], rel=1e-2)


def test_help_and_messages_name_the_new_scheme(example):
    """The reader, the help and the messages are made from the catalogue."""
    program = example("bathe")
    text = program.call("--keywords", "DYNAMIC").stdout
    assert "method of time integration; one of HHT, REDUCED, BATHE; default HHT" in text
    run = program(edited(DECK, ("SCHEME=BATHE", "SCHEME=BATH")), code=2)
    assert "expected one of HHT, REDUCED, BATHE" in run.stderr
    run = program(edited(DECK, ("SCHEME=BATHE", "SCHEME=BATHE, ALPHA=-0.1")), code=2)
    assert "has no effect with SCHEME=BATHE; expected ALPHA with SCHEME=HHT only" in run.stderr
    run = program(edited(DECK, ("0.01, 1.25\n", "0.01, 1.25\n*CONTROLS, JOINT FORCES=END\n")))
    assert "JOINT FORCES has no effect with SCHEME=BATHE" in run.stderr
    assert "SCHEME BATHE" in program.call("--check", str(program.folder / "job.inp")).stdout
