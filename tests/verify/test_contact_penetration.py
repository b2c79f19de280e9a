"""Contact without penetration (*JOINT LAW, PENETRATION), and the joints in job.json."""

from __future__ import annotations

import re

import numpy as np
import pytest
from joint_decks import BOTH_MESHES, GRAVITY, Block, amplitude, dynamic, static, weight
from joint_histories import history, sound_energy

PRINT = "*JOINT PRINT, JOINT=BED\n"
HEIGHT, DENSITY = 4.0, 2400.0
PRESSURE = DENSITY * GRAVITY * HEIGHT  # below a column [Pa]


def column(law: str, **changes) -> Block:
    """A column of 4 m on its bed; two elements wide, six high."""
    values = {"young": 3e10, "density": DENSITY, "law": law} | changes
    return Block((1.0, 1.0, HEIGHT), (2, 2, 6), **values)


@pytest.mark.parametrize("solver", ["CONDENSED", "FULL"])
@pytest.mark.parametrize("allowed", [1e-6, 1e-9])
def test_a_column_does_not_sink(keyway, solver, allowed):
    """A soft bed, 1e8 Pa/m: 0.94 mm by its stiffness, at most the limit with PENETRATION.

    The pressure is that of the weight in both, to the tolerance of the iteration.
    """
    runs = {}
    for name, more in (("soft", ""), ("exact", f", PENETRATION={allowed!r}")):
        deck = column("KN=1e8, KT=1e10, FRICTION=0.6" + more).deck(
            static(f"*CONTROLS, JOINT SOLVER={solver}\n" + weight() + PRINT)
        )
        runs[name] = keyway(deck, name=name)
        table = runs[name].csv("joint_BED")
        assert np.mean(table["tn"]) == pytest.approx(-PRESSURE, rel=1e-2)  # by points, not areas
        assert runs[name].csv("energy")["error"].max() < 1e-6
    reported = {name: run.json["accuracy"] for name, run in runs.items()}
    sunk = reported["soft"]["joints"]["BED"]["largest_penetration"]
    assert sunk == pytest.approx(PRESSURE / 1e8, rel=0.05)
    assert reported["soft"]["augmentations"] == 0
    assert reported["exact"]["joints"]["BED"]["largest_penetration"] <= allowed
    assert np.max(np.abs(runs["exact"].csv("joint_BED")["opening"])) <= allowed
    assert 1 <= reported["exact"]["most_augmentations"] <= 6


@BOTH_MESHES
def test_stiffness_by_default_is_that_of_a_penalty(keyway, meshes):
    """PENETRATION alone: KN = 50 E/h, h = 4/6 m the depth of the elements. With a limit of 1 m
    there is no augmentation, and the bed sinks by p h/(50 E) (Poisson 0: uniform to 1e-6). The
    base of other mesh has 1e10 Pa and 0.1 m: it is the stiffer side."""
    run = keyway(column("PENETRATION=1.", meshes=meshes).deck(static(weight() + PRINT)))
    assert run.json["accuracy"]["augmentations"] == 0
    opening = run.csv("joint_BED")["opening"]
    assert opening == pytest.approx(-PRESSURE * (HEIGHT / 6.0) / (50.0 * 3e10), rel=1e-6)


@pytest.mark.parametrize("law", ["PENETRATION=1e-9", "KN=1e8, PENETRATION=1e-9"])
def test_frequencies_are_those_of_rigid_contact(keyway, law):
    """KN controls the iteration alone; rigid contact is that of a stiff spring, 1e15 Pa/m."""
    cards = static(weight()) + "*STEP\n*FREQUENCY\n3\n*END STEP\n"
    found, expected = (
        [
            mode["hz"]
            for mode in keyway(column(text).deck(cards), name=name).json["steps"][1]["frequencies"]
        ]
        for name, text in (("contact", f"{law}, FRICTION=0.6"), ("spring", "KN=1e15, KT=6e11"))
    )
    # KT is E/THICKNESS/(2(1 + nu)), with a Poisson ratio of 0 and 0.02 m: 7.5e11.
    assert found == pytest.approx(expected, rel=2e-3)


def test_a_bonded_joint_keeps_its_stiffness(keyway):
    """With a tensile strength KN stays E/THICKNESS, and bonded points sink by it."""
    law = "PENETRATION=1e-9, TENSILE STRENGTH=1e6, THICKNESS=0.5"
    run = keyway(column(law).deck(static(weight() + PRINT)))
    table = run.csv("joint_BED")
    assert set(table["state"]) == {3.0}
    assert table["opening"] == pytest.approx(-PRESSURE * 0.5 / 3e10, rel=1e-6)


def test_the_thickness_of_the_tangential_stiffness(keyway):
    """KT is E/THICKNESS/(2(1 + nu)) where PENETRATION is given, also beside KN: no warning says
    that THICKNESS has no effect."""
    moved, crest = {}, "*NODE PRINT, NSET=TOP\nU\n"
    tilted = f"*DLOAD\nBLOCK, GRAV, {GRAVITY!r}, 0.02, 0., -1.\n"
    for thickness in (0.5, 2.0):
        law = f"KN=1e11, PENETRATION=1e-9, FRICTION=0.6, THICKNESS={thickness!r}"
        run = keyway(column(law).deck(static(tilted + crest)), name=f"t{thickness:.0f}")
        assert not any("THICKNESS" in text for text in run.json["warnings"])
        moved[thickness] = run.csv("node_TOP")["U1"][-1]
    # The shear stress of the sole is 0.02 of the pressure (2e-4 less: the direction is taken as a
    # unit vector); the shear modulus is E/2 with a Poisson ratio of 0. The column bends alike.
    expected = 0.02 * PRESSURE * (2.0 - 0.5) / (0.5 * 3e10)
    assert moved[2.0] - moved[0.5] == pytest.approx(expected, rel=1e-3)


def test_a_bar_bounces_off_a_rigid_wall(keyway):
    """The bar of test_joint_motion on a joint of KN = 50 E/h without penetration (closed form).

    Tolerances as there: contact time three elements, pressure 0.1 %, energy by the dissipation of
    HHT. Without a spring between them the last element rings against the wall: 0.3 % of ripple
    (0.00 % there).
    """
    length, young, speed, elements = 10.0, 25e9, 1.0, 50
    wave = np.sqrt(young / DENSITY)
    dt = 0.5 * length / elements / wave
    steps = round(1.6 * 2.0 * length / wave / dt)
    bar = Block(
        (1.0, 1.0, length),
        (1, 1, elements),
        young=young,
        density=DENSITY,
        law="KT=1e10, GAP=1e-5, PENETRATION=1e-7",
        cards="*BOUNDARY\nBODY, 1, 2\n*INITIAL CONDITIONS, TYPE=VELOCITY\nBODY, 3, -1.\n",
    )
    run = keyway(bar.deck(dynamic(PRINT, dt, steps * dt)))
    balance = sound_energy(run)
    time, pressure = history(run, 0.0, "tn")
    touching = np.nonzero(pressure < 0.0)[0]
    middle = pressure[touching[len(touching) // 4] : touching[3 * len(touching) // 4]]
    contact = time[touching[-1]] - time[touching[0]] + dt
    assert contact == pytest.approx(2.0 * length / wave, rel=1.5 / elements)
    assert -middle.mean() == pytest.approx(DENSITY * wave * speed, rel=1e-3)
    assert middle.std() < 5e-3 * DENSITY * wave * speed
    assert history(run, 0.0)[1].min() >= -1e-7
    start = balance["kinetic"][0]
    left = (balance["kinetic"][-1] + balance["strain"][-1]) / start
    assert left > 0.97
    assert left + balance["numerical"][-1] / start == pytest.approx(1.0, abs=1e-6)


def test_an_unattainable_penetration_is_reported(keyway):
    """A penetration below the last digits of the displacements is an error that gives its size."""
    run = keyway(
        column("KN=1e9, KT=1e10, FRICTION=0.6, PENETRATION=1e-24").deck(static(weight())),
        name="lost",
        code=1,
    )
    assert "times the limit of *JOINT LAW, PENETRATION after" in run.json["message"]
    assert "a larger KN needs fewer" in run.json["message"]
    assert "largest in joint BED at (" in run.json["message"]


# --- small sliding ------------------------------------------------------------------------------


@pytest.mark.parametrize("is_open", [False, True])
def test_a_slip_beyond_a_facet_ends_the_run(keyway, is_open):
    """A mass on a base of other mesh that moves off with 4 m/s2, friction 0.1 (or none, and open).

    Slip from rest is (4 - mu g) t^2 / 2; the run ends in the increment that exceeds the admissible
    slip of the message, the size of a facet (1 m or a third of it), and keeps its results.
    """
    dt, mu = 0.005, 0.0 if is_open else 0.1
    steady = amplitude("STEADY", np.array([0.0, 10.0]), np.array([4.0, 4.0]))
    law = "KN=1e8, KT=1e8, " + ("GAP=0.01" if is_open else "FRICTION=0.1")
    block = Block((1.0, 1.0, 0.1), young=1e7, density=10.0, law=law, meshes=(3, 2), cards=steady)
    motion = "*BASE MOTION, DOF=1, AMPLITUDE=STEADY\n" + PRINT
    steps = ("" if is_open else static(weight(10.0))) + dynamic(motion, dt, 2.0)
    run = keyway(block.deck(steps), code=1)
    reported = re.fullmatch(
        r"joint BED has slipped (\S+) at \((\S+), (\S+), 0\) at time (\S+); joints between "
        r"different meshes allow small sliding only, (\S+) at this point \(size of a facet\)",
        run.json["message"],
    )
    assert reported
    slipped, x, y, time, allowed = (float(text) for text in reported.groups())
    start = 0.0 if is_open else 1.0
    assert {x, y} <= {0.0, 1.0}
    assert 0.3 < allowed < 1.5
    rate = 4.0 - 10.0 * mu
    assert allowed < slipped < allowed + 2.0 * rate * dt * np.sqrt(2.0 * allowed / rate)
    assert time - start == pytest.approx(np.sqrt(2.0 * slipped / rate), abs=2.0 * dt)
    table = run.csv("joint_BED")
    assert table["time"].max() == pytest.approx(time, rel=1e-5)
    assert run.json["status"] == "stopped"
    assert run.json["joints"]["BED"]["slip"]["anywhere"]["value"] == pytest.approx(
        slipped, rel=1e-3
    )


# --- the condition of the equations ------------------------------------------------------------


def brick_stiffness(x: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Stiffness of the trilinear brick, 2 x 2 x 2 points."""
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = young / (2.0 * (1.0 + poisson))
    d = np.diag([2.0 * shear] * 3 + [shear] * 3)
    d[:3, :3] += lame
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    corner = np.array([(*c, z) for z in (-1, 1) for c in corner], dtype=float)
    k = np.zeros((24, 24))
    for point in corner / np.sqrt(3.0):
        terms = 1.0 + corner * point
        dn = np.stack([corner[:, i] * np.prod(np.delete(terms, i, 1), 1) / 8.0 for i in range(3)])
        jacobian = dn @ x
        g = np.linalg.solve(jacobian, dn)
        b = np.zeros((6, 24))
        for row, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
            b[row, i::3] += g[j]
            if i != j:
                b[row, j::3] += g[i]
        k += b.T @ d @ b * np.linalg.det(jacobian)
    return k


@pytest.mark.parametrize("stiffness", [1e8, 1e12, 1e15])
@pytest.mark.parametrize("solver", ["CONDENSED", "FULL"])
def test_condition_of_the_equations_against_numpy(keyway, solver, stiffness):
    """The estimate bounds the 1-norm condition of the scaled matrix from below, and is exact here.

    Two bricks on a joint with a rigid base: the jumps are the displacements of the bottom nodes in
    another order, so that numpy needs no more than K with the springs at these nodes. Hager's
    estimate is a lower bound, as a rule exact (Higham 1988); a factor of 3 is allowed.
    """
    young, poisson = 2e10, 0.2
    block = Block((2.0, 1.0, 1.0), (2, 1, 1), young=young, poisson=poisson)
    block.law = f"KN={stiffness!r}, KT={0.4 * stiffness!r}, FRICTION=0.6"
    run = keyway(block.deck(static(f"*CONTROLS, JOINT SOLVER={solver}\n" + weight())))
    x = block.x
    k = np.zeros((36, 36))
    number = np.arange(12).reshape(3, 2, 2)
    for i in range(2):
        ring = [(i, 0), (i + 1, 0), (i + 1, 1), (i, 1)]
        nodes = [number[a, b, c] for c in (0, 1) for a, b in ring]
        rows = (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()
        k[np.ix_(rows, rows)] += brick_stiffness(x[nodes], young, poisson)
    for i, area in enumerate((0.25, 0.5, 0.25)):
        for node in number[i, :, 0]:
            k[range(3 * node, 3 * node + 3), range(3 * node, 3 * node + 3)] += (
                stiffness * area * np.array([0.4, 0.4, 1.0])
            )
    root = np.sqrt(np.diag(k))
    exact = np.linalg.cond(k / np.outer(root, root), 1)
    reported = run.json["accuracy"]["joint_condition"]
    assert exact / 3.0 <= reported <= exact * (1.0 + 1e-6)
