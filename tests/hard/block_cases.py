"""Hard cases of stiff blocks on joints: contact, friction, impact, rocking, meshes 1:10."""

from __future__ import annotations

import numpy as np
from block_decks import Pair, joint_state
from hard_case import Chapter, energies, fed, off, supplied, unbalance
from joint_decks import GRAVITY, Block, amplitude, dynamic, initial, static, weight
from test_massless_start import OF_TOP, column_deck, sudden_weight

BLOCKS = Chapter("Blocks, contact and friction")
SHAKEN = 0.4  # [s]
WEIGHT = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n"
OUTPUT = "*NODE FILE\nU, OPENING\n"


def chatter(keyway, stiffness: float):
    """An elastic block on its bed, shaken by 2 g up and down and by 0.5 g along for 0.4 s, then
    free."""
    time = np.linspace(0.0, SHAKEN, 161)
    waves = amplitude("UP", time, 2.0 * GRAVITY * np.sin(30.0 * np.pi * time))
    waves += amplitude("ALONG", time, 0.5 * GRAVITY * np.sin(10.0 * np.pi * time))
    law = f"KN={stiffness!r}, KT={stiffness!r}, FRICTION=0.6"
    block = Block((2.0, 1.0, 1.0), (4, 2, 2), young=3e10, poisson=0.2, law=law, cards=waves)
    shake = "*BASE MOTION, DOF=3, AMPLITUDE=UP, TYPE=ACCELERATION\n"
    shake += "*BASE MOTION, DOF=1, AMPLITUDE=ALONG, TYPE=ACCELERATION\n"
    return keyway(block.deck(static(weight()) + dynamic(shake, 0.0025, 0.8)))


def add_chatter(exponent: int) -> None:
    @BLOCKS.case(
        f"chatter, k_n 1e{exponent}",
        "a block that lifts off and lands at every point of its bed, undamped",
        "error of the energy balance; energy that the time stepping has supplied by the end",
        1e-6,
    )
    def judge(keyway):
        run = chatter(keyway, 10.0**exponent)
        return max(unbalance(run), supplied(run)), [run]


for k in (8, 10, 12):
    add_chatter(k)
# With kernels for HASWELL one landing ends in a cycle of Newton's iteration.
add_chatter(14)


@BLOCKS.case(
    "penalty over eight decades",
    "k_n 1e8 to 1e16 Pa/m below a block of 3e10 Pa, pushed by half of what friction carries",
    "error of the resultant of the joint",
    1e-6,
)
def penalty(keyway):
    runs, worst = [], 0.0
    for exponent in (8, 10, 12, 14, 16):
        law = f"KN=1e{exponent}, KT=1e{exponent}, FRICTION=0.6"
        pair = Pair(young=3e10, law=law, counts=(2, 2, 1), base_counts=(3, 3, 1))
        push = 0.3 * pair.weight / 9.0  # on each node of the top
        steps = static(f"{WEIGHT}*CLOAD\nTOP, 1, {push!r}\n{OUTPUT}")
        runs.append(keyway(pair.deck(steps), name=f"k{exponent}"))
        exact = pair.weight * np.array([-1.0, 0.3])
        force = joint_state(runs[-1])["force"]
        worst = max(worst, off([force[0], np.hypot(*force[1:])], np.abs(exact) * [-1, 1]))
    return worst, runs


def facets(keyway, counts, base_counts):
    law = "KN=1e10, KT=1e10, FRICTION=0.6"
    pair = Pair(young=3e10, law=law, counts=counts, base_counts=base_counts)
    push = 0.3 * pair.weight / ((counts[0] + 1) * (counts[1] + 1))
    run = keyway(pair.deck(static(f"{WEIGHT}*CLOAD\nTOP, 1, {push!r}\n{OUTPUT}")))
    force = joint_state(run)["force"]
    exact = pair.weight * np.array([1.0, 0.3])
    return off([-force[0], np.hypot(*force[1:])], exact), [run]


@BLOCKS.case(
    "10 facets on 1",
    "the slave has ten facets along each side, its master one; friction 0.6, pushed to half of it",
    "error of the resultant of the joint",
    1e-6,
)
def ten_on_one(keyway):
    return facets(keyway, (10, 10, 2), (1, 1, 1))


@BLOCKS.case(
    "1 facet on 10",
    "the slave has one facet, its master ten along each side",
    "error of the resultant of the joint",
    1e-6,
)
def one_on_ten(keyway):
    return facets(keyway, (1, 1, 1), (10, 10, 1))


def slide(keyway, dt: float, duration: float, name: str):
    """A stiff block on a base that accelerates by 0.8 g from the start, friction 0.4."""
    block = Block((1.0, 1.0, 0.5), law="KN=1e10, KT=1e10, FRICTION=0.4")
    block.cards = amplitude("PUSH", np.array([0.0, 1.0]), np.full(2, -0.8 * GRAVITY))
    push = "*BASE MOTION, DOF=1, AMPLITUDE=PUSH, TYPE=ACCELERATION\n*NODE PRINT, NSET=TOP\nV\n"
    steps = static(weight()) + dynamic(push, dt, duration, alpha=0.0)
    return keyway(block.deck(steps), name=name)


def slide_error(run, duration: float) -> float:
    """At the end, by the mean of the top."""
    table = run.csv("node_TOP")
    last = table["time"] == table["time"][-1]
    return off([table["V1"][last].mean()], [0.4 * GRAVITY * duration])


@BLOCKS.case(
    "2000 increments of sliding",
    "a stiff block slides for 2000 increments of HHT with alpha 0, DIRECT",
    "error of its speed against (0.8 - 0.4) g t",
    1e-3,
)
def long_slide(keyway):
    run = slide(keyway, 1e-3, 2.0, "slide")
    return slide_error(run, 2.0), [run]


@BLOCKS.case(
    "increments times ten",
    "the same slide over 0.2 s with increments of 1e-4, 1e-3 and 1e-2 s",
    "error of the speed against the closed form",
    1e-2,
)
def times_ten(keyway):
    runs = [slide(keyway, dt, 0.2, f"dt{dt}") for dt in (1e-4, 1e-3, 1e-2)]
    return max(slide_error(run, 0.2) for run in runs), runs


def newmark_block(time: np.ndarray, base: np.ndarray, friction: float) -> float:
    """Slip of a rigid block on a base that accelerates by `base` (Newmark 1965), by small steps."""
    speed = slip = 0.0
    dt = time[1] - time[0]
    most = friction * GRAVITY
    for acceleration in base[1:]:
        trial = speed - acceleration * dt
        speed = trial - np.clip(trial, -most * dt, most * dt)
        slip += speed * dt
    return float(slip)


@BLOCKS.case(
    "stick-slip ratchet",
    "a base that jerks one way and returns slowly, twenty times: the block slides on each time",
    "difference of the slip from that of a rigid block, over the latter",
    2e-2,
)
def ratchet(keyway):
    time = np.linspace(0.0, 2.0, 401)
    phase = (10.0 * time) % 1.0
    base = np.where(phase < 0.25, 9.0, -3.0)  # [m/s2], mean zero; friction 0.4 g = 3.92
    base[0] = 0.0
    jerk = amplitude("JERK", time, base)
    block = Block((1.0, 1.0, 0.5), law="KN=1e10, KT=1e10, FRICTION=0.4", cards=jerk)
    shake = "*BASE MOTION, DOF=1, AMPLITUDE=JERK, TYPE=ACCELERATION\n*NODE PRINT, NSET=TOP\nU\n"
    run = keyway(block.deck(static(weight()) + dynamic(shake, 0.001, 2.0)))
    fine = np.linspace(0.0, 2.0, 200001)
    exact = newmark_block(fine, np.interp(fine, time, base), 0.4)
    return off([run.csv("node_TOP")["U1"][-1]], [exact]), [run]


@BLOCKS.case(
    "rocking",
    "a tower set down from a tilt of 0.01 that lands on its other edge",
    "error of the quarter period against Housner, sqrt(2 theta I/(W b))",
    1e-3,
)
def rocking(keyway):
    tilt = 0.01
    block = Block((1.0, 1.0, 4.0), young=1e12, law="KN=1e11, KT=1e11, FRICTION=2.")
    block.cards = "*BOUNDARY\nBODY, 2\n"
    placed = [(i, 1, -tilt * x[2]) for i, x in enumerate(block.x) if x[2]]
    placed += [(i, 3, tilt * x[0]) for i, x in enumerate(block.x) if x[0]]
    block.cards += initial("DISPLACEMENT", placed)
    hold = static(f"*BOUNDARY\nRIGHT_EDGE, 3, 3, {tilt}\n" + weight())
    free = "*BOUNDARY, OP=NEW\nBASE, 1, 3\nBODY, 2\n*NODE PRINT, NSET=RIGHT_EDGE\nU\n"
    run = keyway(block.deck(hold + dynamic(free, 5e-4, 0.4)))
    table = run.csv("node_RIGHT_EDGE")
    first = table["node"] == table["node"][0]
    time, lift = table["time"][first], table["U3"][first]
    down = np.nonzero(lift <= 0.0)[0][0]
    found = np.interp(0.0, lift[[down, down - 1]], time[[down, down - 1]]) - 1.0
    inertia = 4.0 / 3.0 * (0.5**2 + 2.0**2)
    return off([found], [np.sqrt(2.0 * tilt * inertia / (GRAVITY * 0.5))]), [run]


@BLOCKS.case(
    "floating block",
    "a block that only a gap of 5 mm separates from its bed falls, and bounces for 0.5 s",
    "created energy over the largest energy; error of the free fall",
    1e-6,
)
def floating(keyway):
    block = Block((1.0, 1.0, 1.0), (2, 2, 2), young=3e10, law="KN=1e11, KT=1e11, GAP=5e-3")
    steps = dynamic(weight() + "*NODE PRINT, NSET=TOP\nU, A\n", 1e-3, 0.5)
    run = keyway(block.deck(steps))
    table = run.csv("node_TOP")
    falls = table["time"] < np.sqrt(2.0 * 5e-3 / GRAVITY) - 1e-3
    return max(fed(run), off(table["A3"][falls], -GRAVITY)), [run]


@BLOCKS.case(
    "impulse in one increment",
    "all momentum comes in one increment: 4e5 N on 4800 kg for 0.001 s, free above a gap",
    "error of the speed against impulse over mass",
    1e-6,
)
def impulse(keyway):
    block = Block((2.0, 1.0, 1.0), young=3e10, law="KN=1e11, KT=1e11, GAP=1.")
    block.cards = amplitude("HIT", np.array([0.0, 0.001, 0.00100001]), np.array([1.0, 1.0, 0.0]))
    hit = "*CLOAD, AMPLITUDE=HIT\nTOP, 3, 1e5\n*NODE PRINT, NSET=BODY\nV\n"
    run = keyway(block.deck(dynamic(hit, 0.001, 0.1, alpha=0.0)))
    table = run.csv("node_BODY")
    last = table["time"] == table["time"][-1]
    # The trapezoidal rule sees the force fall to zero over the second increment.
    found = table["V3"][last].mean()  # of the corners of one brick: that of its centre
    return off([found], [4e5 * 0.001 * 1.5 / 4800.0]), [run]


@BLOCKS.case(
    "massless column under a joint",
    "the mass matrix is singular: a dam as slave of a joint on massless rock, meshes 3:2",
    "error of acceleration of the column against its static balance",
    1e-5,
)
def massless(keyway):
    run = keyway(column_deck((3, 2), sudden_weight(0.0)))
    top, bottom = run.csv("node_TOP")["A3"], run.csv("node_BOTTOM")["A3"]
    return off(top, OF_TOP * bottom), [run]


@BLOCKS.case(
    "first-opening cascade",
    "80 bonded points of 1 MPa that fail one after the other within an increment",
    "error of the energy balance",
    1e-6,
)
def cascade(keyway):
    law = "KN=1e11, KT=1e11, TENSILE STRENGTH=1e6, FRICTION=0.6, COHESION=1e6"
    block = Block((4.0, 1.0, 1.0), (19, 3, 1), young=3e10, law=law)
    block.cards = amplitude("JERK", np.array([0.0, 0.01, 0.05]), np.array([0.0, 1.0, 1.0]))
    pull = "*CLOAD, AMPLITUDE=JERK\nRIGHT_EDGE, 3, 2e6\n"
    run = keyway(block.deck(static(weight()) + dynamic(pull, 0.005, 0.05).replace(", DIRECT", "")))
    assert energies(run)["fracture"][-1] > 0.0
    return unbalance(run), [run]
