"""*GROUT: joints in contact until they are grouted (docs/theory.md, 15).

Two elastic blocks with a joint, as in SSNP143 of code_aster (sawing and grouting with the friction
law): a push of D over an opening of d gives s = -(D - d)/(1/k + L/E).
"""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import static
from stage_decks import GRAVITY, WEIGHT, YOUNG, add, remove, step
from stopped_runs import stops_that_go_on
from tied_blocks import Blocks, node_set

E, L, KN = 3e12, 10.0, 1e12  # of SSNP143 [Pa], [m], [Pa/m]
PUSH, SAWN = 3e-6, 1e-6  # D and d [m]
COMPLIANCE = 1.0 / KN + L / E
BEFORE, AFTER = -6.9230769e5, -4.6153846e5  # as SSNP143 gives them [Pa]
STRENGTH = 1e6
BONDED = f"FRICTION=0.6, TENSILE STRENGTH={STRENGTH!r}"
OPEN, STICK, INTACT = 0, 1, 3  # states of points
MESHES = pytest.mark.parametrize("facets", [1, 2], ids=["matching", "different"])


def bar(law: str, facets: int = 1) -> str:
    """Two blocks of L/2 along x; the left end is fixed, the right end moves along x."""
    blocks = Blocks()
    blocks.add("A", (2, 0, L / 2), (facets, 0, 1), (1, 0, 1))
    blocks.add("B", (2, L / 2, L), (1, 0, 1), (1, 0, 1))
    ends = node_set("LEFT", blocks.side("A", "X0")) + node_set("RIGHT", blocks.side("B", "X1"))
    return (
        blocks.deck({"": f"*ELASTIC\n{E!r}, 0.\n"}, ends)
        + f"*JOINT LAW, NAME=LAW, KN={KN!r}, KT={KN / 2!r}, {law}\n"
        + "*JOINT, NAME=J, LAW=LAW\nB_X0, A_X1\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 2, 3\n"
        + "*AMPLITUDE, NAME=UP\n0., 0., 1., 1.\n"
    )


def move(x: float, cards: str = "", name: str = "MOVE") -> str:
    """A step that moves the right end to x; the tables of the joint."""
    output = "*JOINT PRINT, JOINT=J\nOPENING, SLIP, TRACTION, STATE\n"
    return static(f"{cards}*BOUNDARY\nRIGHT, 1, 1, {x!r}\n{output}", name=name)


def ends_of_steps(run, column: str) -> np.ndarray:
    """Values of all points at the ends of the steps (steps, points)."""
    table = run.csv("joint_J")
    points = int(table["point"].max())
    last = [np.nonzero(table["step"] == s)[0][-points:] for s in np.unique(table["step"])]
    return np.array([table[column][rows] for rows in last])


@MESHES
def test_ssnp143(keyway, facets):
    """Contact before; opened by d, grouted there and pushed to d - D + d: both numbers."""
    run = keyway(
        bar(BONDED, facets)
        + move(-PUSH)
        + move(SAWN)
        + move(SAWN, "*GROUT, JOINT=J\n")
        + move(2 * SAWN - PUSH)
    )
    traction = ends_of_steps(run, "tn")
    assert traction[0] == pytest.approx(BEFORE, rel=1e-8)
    assert traction[0] == pytest.approx(-PUSH / COMPLIANCE, rel=1e-9)
    assert np.abs(traction[1:3]).max() < 1e-3
    assert traction[3] == pytest.approx(AFTER, rel=1e-8)
    opening = ends_of_steps(run, "opening")
    assert opening[1] == pytest.approx(SAWN, rel=1e-8)
    assert np.abs(opening[2]).max() < 1e-15
    assert (ends_of_steps(run, "state")[[0, 1, 2, 3]].T == [STICK, OPEN, INTACT, INTACT]).all()


def test_a_sawn_joint_under_pressure_keeps_it_when_grouted(keyway):
    """A gap of d as sawn, pushed by D: -(D - d)/(1/k + L/E), the same after the grouting."""
    law = f"FRICTION=0.6, GAP={SAWN!r}"
    run = keyway(bar(law) + move(-PUSH) + move(-PUSH, "*GROUT, JOINT=J\n") + move(-2 * PUSH))
    traction = ends_of_steps(run, "tn")
    assert traction[0] == pytest.approx(AFTER, rel=1e-8)
    assert traction[1] == pytest.approx(traction[0], rel=1e-12)
    assert traction[2] == pytest.approx(-(2 * PUSH - SAWN) / COMPLIANCE, rel=1e-9)


@MESHES
def test_tension_up_to_the_strength_and_no_earlier(keyway, facets):
    """Without grout no tension; with grout 99 % of the strength is carried, 101 % breaks it."""
    rise = STRENGTH * COMPLIANCE
    run = keyway(
        bar(BONDED, facets)
        + move(0.5 * rise)
        + move(0.5 * rise, "*GROUT, JOINT=J\n")
        + move(1.49 * rise)
        + move(1.51 * rise)
        + move(0.5 * rise - PUSH)
        + move(0.5 * rise)
        + move(0.6 * rise, "*GROUT, JOINT=J\n")
        + move(1.51 * rise)
    )
    traction = ends_of_steps(run, "tn")
    assert np.abs(traction[[0, 1, 3, 5]]).max() < 1e-2
    assert traction[2] == pytest.approx(0.99 * STRENGTH, rel=1e-8)
    assert traction[4] == pytest.approx(-PUSH / COMPLIANCE, rel=1e-8)
    # The second *GROUT acts at the start of its step, before the end moves by a tenth of the rise.
    assert traction[6] == pytest.approx(0.1 * STRENGTH, rel=1e-6)
    assert np.abs(traction[7]).max() < 1e-2


@MESHES
def test_pressure_of_the_grout_stays_when_it_hardens(keyway, facets):
    """The grout opens the joint by p L/E and keeps its pressure; the strength starts."""
    p = 2e5
    run = keyway(
        bar(BONDED, facets)
        + move(SAWN)
        + move(SAWN, f"*GROUT, JOINT=J, PRESSURE={p!r}\n")
        + move(SAWN)
        + move(SAWN + (0.9 * STRENGTH + p) * COMPLIANCE)
    )
    opening, traction = ends_of_steps(run, "opening"), ends_of_steps(run, "tn")
    assert opening[1] == pytest.approx(SAWN + p * L / E, rel=1e-9)
    assert traction[2] == pytest.approx(-p, rel=1e-9)
    assert traction[3] == pytest.approx(0.9 * STRENGTH, rel=1e-9)
    energy = [s["energy"] for s in run.json["steps"]]
    assert energy[2]["stages"] == pytest.approx(p**2 / (2 * KN), rel=1e-9)
    assert max(e["error"] for e in energy[1:3]) < 1e-10


def test_grout_is_not_where_the_joint_breaks_later_in_its_step(keyway):
    """The intact joint breaks while the grout is under pressure: it stays open, nothing moves."""
    rise = STRENGTH * COMPLIANCE
    run = keyway(
        bar(BONDED)
        + move(0.0, "*GROUT, JOINT=J\n")
        + move(2.0 * rise, "*GROUT, JOINT=J, PRESSURE=1e5\n")
        + move(2.0 * rise)
        + move(2.0 * rise, "*GROUT, JOINT=J\n")
    )
    assert (ends_of_steps(run, "state").T == [INTACT, OPEN, OPEN, INTACT]).all()
    # Round-off of the forces that the pull has had: 1e-9 of the strength.
    assert np.abs(ends_of_steps(run, "tn")).max() < 1e-9 * STRENGTH
    opening = ends_of_steps(run, "opening")
    assert opening[1:3] == pytest.approx(2.0 * rise, rel=1e-9)
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-10


def test_grout_hardens_before_a_step_of_modes(keyway):
    """Its energy stands in the step after the modes: p^2 A / (2 k_n), as without them."""
    p = 2e5
    modes = "*STEP\n*FREQUENCY\n1\n*END STEP\n"
    deck = bar(BONDED) + move(SAWN) + move(SAWN, f"*GROUT, JOINT=J, PRESSURE={p!r}\n")
    deck = (deck + modes + move(SAWN)).replace("*ELASTIC", "*DENSITY\n2400.\n*ELASTIC")
    energy = keyway(deck).json["steps"][-1]["energy"]
    assert energy["stages"] == pytest.approx(p**2 / (2 * KN), rel=1e-9)
    assert energy["error"] < 1e-10


@MESHES
def test_grout_in_contact_without_penetration(keyway, facets):
    """-(D E/L) before and after; under pressure p of the grout as well, which then hardens."""
    p = 1e5
    run = keyway(
        bar("FRICTION=0.6, PENETRATION=1e-12", facets)
        + move(-PUSH)
        + move(-PUSH, "*GROUT, JOINT=J\n")
        + move(-PUSH, f"*GROUT, JOINT=J, PRESSURE={p!r}\n")
        + move(-PUSH)
        + move(SAWN)
        + move(SAWN, f"*GROUT, JOINT=J, PRESSURE={p!r}\n")
        + move(SAWN)
    )
    traction, opening = ends_of_steps(run, "tn"), ends_of_steps(run, "opening")
    pressed = -PUSH * E / L
    for number, expected in enumerate((pressed, pressed, pressed + p, pressed, 0.0, 0.0, -p)):
        assert traction[number] == pytest.approx(expected, rel=1e-6, abs=1e-6 * p)
    assert np.abs(opening[:4]).max() < 2e-12
    assert opening[4] == pytest.approx(SAWN, rel=1e-6)
    assert opening[5] == pytest.approx(SAWN + p * L / E, rel=1e-6)
    assert np.abs(opening[6]).max() < 2e-12
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-6


def test_cohesion_starts_with_the_grout(keyway):
    """Pressed by p and moved along the joint: mu p before, mu p + c after."""
    cohesion, friction = 3e5, 0.5
    run = keyway(
        bar(f"FRICTION={friction!r}, COHESION={cohesion!r}")
        + move(-PUSH)
        + move(-PUSH, "*BOUNDARY\nRIGHT, 2, 2, 1e-4\n")
        + move(-PUSH, "*GROUT, JOINT=J\n")
        + move(-PUSH, "*BOUNDARY\nRIGHT, 2, 2, 2e-4\n")
    )
    shear = np.hypot(ends_of_steps(run, "t1"), ends_of_steps(run, "t2"))
    pressure = -ends_of_steps(run, "tn")
    for i, c in ((1, 0.0), (2, 0.0), (3, cohesion)):
        area_mean = np.mean(shear[i]) / np.mean(friction * pressure[i] + c)
        assert area_mean == pytest.approx(1.0, rel=1e-6)


def arch(joint: str) -> str:
    """Two blocks of different height on steps of rock: their settlements differ."""
    blocks = Blocks()
    blocks.add("A", (3, 0, 6), (1, 0, 2), (5, 0, 10))
    blocks.add("B", (3, 6, 12), (1, 0, 2), (3, 4, 10))
    base = np.concatenate((blocks.side("A", "Z0"), blocks.side("B", "Z0")))
    sets = node_set("EVERY", range(len(blocks.x))) + node_set("BASE", base)
    sets += node_set("END", blocks.side("B", "X1"))
    return (
        blocks.deck({"": f"*DENSITY\n2400.\n*ELASTIC\n{YOUNG!r}, 0.\n"}, sets)
        + f"*JOINT LAW, NAME=LAW, KN=1e12, KT=5e11, FRICTION=0.7, TENSILE STRENGTH={joint}\n"
        + "*JOINT, NAME=J, LAW=LAW\nB_X0, A_X1\n*BOUNDARY\nBASE, 1, 3\n"
    )


PRINT = "*EL PRINT, ELSET=BODY\nS\n*JOINT PRINT, JOINT=J\nOPENING, TRACTION, STATE\n"
ARCH_LOAD = f"*DLOAD\nBODY, GRAV, {GRAVITY!r}, 0, 0, -1\n"


def cross_stress(run, step_number: int) -> float:
    """Largest stress across and along the joint, over the largest vertical stress."""
    rows = run.csv("el_BODY")
    here = rows["step"] == step_number
    across = max(np.abs(rows[f"S{i}"][here]).max() for i in ("11", "12", "13"))
    return across / np.abs(rows["S33"][here]).max()


def test_cantilevers_have_no_arch_stress(keyway):
    """Weight before the grouting: none to 1e-10 of the vertical stress; on the grouted arch 3 %."""
    by_cantilevers = keyway(
        arch("2e6")
        + step(remove("B") + ARCH_LOAD + PRINT)
        + step(add("B"))
        + step("*GROUT, JOINT=J\n")
        + step("*CLOAD\nEND, 1, -1e5\n"),
        name="cantilevers",
    )
    for number in (1, 2, 3):
        assert cross_stress(by_cantilevers, number) < 1e-10
    assert cross_stress(by_cantilevers, 4) > 1e-2
    whole = keyway(arch("2e6") + step(ARCH_LOAD + PRINT), name="whole")
    assert cross_stress(whole, 1) > 1e-2


def test_a_joint_waits_for_the_elements_behind_it(keyway):
    """The points of the joint are absent without B, in contact with it, then grouted."""
    run = keyway(
        arch("2e6")
        + step(remove("B") + ARCH_LOAD + PRINT + "*NODE FILE\nU, OPENING\n")
        + step(add("B"))
        + step("*GROUT, JOINT=J\n")
    )
    state = ends_of_steps(run, "state")
    assert (state[0] == OPEN).all() and (state[2] == INTACT).all()
    assert np.abs(ends_of_steps(run, "tn")).max() < 1e-6 * WEIGHT
    assert np.abs(ends_of_steps(run, "opening")).max() < 1e-15


def test_a_shaken_dam_after_its_stages(keyway):
    """The grouted joint works in a dynamic step; energies balance."""
    shake = (
        "*STEP\n*DYNAMIC, DIRECT, ALPHA=0\n0.002, 0.1\n"
        "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n*END STEP\n"
    )
    run = keyway(
        arch("1e4")
        + "*AMPLITUDE, NAME=SHAKE\n0., 0., 0.02, 300., 0.05, -300., 0.08, 200., 0.1, 0.\n"
        + step(remove("B") + ARCH_LOAD + PRINT)
        + step(add("B"))
        + step("*GROUT, JOINT=J, PRESSURE=1e4\n")
        + shake
    )
    assert ends_of_steps(run, "opening")[-1].max() > 1e-9
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-5


def test_a_run_goes_on_between_and_within_stages(program_path, tmp_path):
    """A run that is stopped in any step and continued ends with the same tables."""
    deck = tmp_path / "job.inp"
    quarter = "0.25, 1., 0.25, 0.25\n"
    deck.write_text(
        arch("2e6")
        + step(remove("B") + ARCH_LOAD + PRINT + "*RESTART, WRITE\n", data=quarter)
        + step(add("B"), data=quarter)
        + step("*GROUT, JOINT=J, PRESSURE=1e5\n", data=quarter)
        + step("*CLOAD\nEND, 1, -1e5\n", data=quarter)
        + step(remove("B"), data=quarter)
    )

    assert stops_that_go_on(program_path, tmp_path, deck, (2, 4, 6, 8, 10, 12, 14, 18)) >= 4
