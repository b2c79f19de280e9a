"""Areas of joint points whose faces come and go with their lifts (docs/theory.md, 15.1).

Two columns of lifts of 1 m stand side by side with a joint between them. The left one is held, the
right one is pressed against it; without Poisson's ratio and held across, each lift is in one state.
"""

from __future__ import annotations

import numpy as np
import pytest
from stage_decks import YOUNG, add, remove, step
from stopped_runs import stops_that_go_on
from tied_blocks import CORNERS, Blocks, node_set

KN, FIRST, SECOND = 1e10, 4e5, 1e6  # [Pa/m]; pressures [Pa]
JOINTS = pytest.mark.parametrize("joint", ["elements", "matching", "different"])
OUTPUT = "*NODE PRINT, NSET=FREE\nU\n*JOINT PRINT, JOINT=J\nTRACTION, STATE\n"


def columns(joint: str, law: str = "FRICTION=0.6", lifts: int = 2) -> str:
    """The model: blocks A1, A2 on the left, B1, B2 on the right."""
    blocks = Blocks()
    n = 2 if joint == "different" else 1
    for i in range(1, lifts + 1):
        blocks.add(f"A{i}", (1, -1, 0), (1, 0, 1), (1, i - 1, i))
        blocks.add(f"B{i}", (1, 0, 1), (n, 0, 1), (n, i - 1, i))
        if i > 1:
            blocks.share(f"A{i - 1}", f"A{i}")
            blocks.share(f"B{i - 1}", f"B{i}")
    left, right = (
        np.unique([blocks.nodes[f"{side}{i}"].ravel() for i in range(1, lifts + 1)])
        for side in "AB"
    )
    cards = node_set("HELD", left) + node_set("FREE", right)
    if joint == "elements":
        cards += "*ELEMENT, TYPE=JOINT8, ELSET=J\n"
        for i in range(1, lifts + 1):
            a, b = blocks.nodes[f"A{i}"][1], blocks.nodes[f"B{i}"][0]
            ring = [c[1:] for c in CORNERS if c[0] == 0]
            pick = [ring[0], ring[1], ring[3], ring[2]]
            numbers = [x[at] + 1 for x in (a, b) for at in pick]
            cards += ", ".join(map(str, [900 + i, *numbers])) + "\n"
        named = "ELSET=J\n"
    else:
        for side, name in (("X0", "B"), ("X1", "A")):
            cards += f"*SURFACE, NAME={name}_FACE, TYPE=ELEMENT\n"
            cards += "".join(
                line for i in range(1, lifts + 1) for line in facets(blocks, f"{name}{i}", side)
            )
        named = "\nB_FACE, A_FACE\n"
    cards += f"*JOINT LAW, NAME=LAW, KN={KN!r}, KT={KN!r}, {law}\n*JOINT, NAME=J, LAW=LAW"
    cards += (", " if joint == "elements" else "") + named
    cards += "*BOUNDARY\nHELD, 1, 3\nFREE, 2, 3\n"
    return blocks.deck({"": f"*ELASTIC\n{YOUNG!r}, 0.\n"}, cards)


def facets(blocks: Blocks, name: str, side: str) -> list[str]:
    """Data lines of *SURFACE: the side of a block."""
    text = blocks.deck({"": ""}, "")
    start = text.index(f"*SURFACE, NAME={name}_{side}")
    return [f"{line}\n" for line in text[start:].split("*")[1].splitlines()[1:]]


def press(**pressures: float) -> str:
    """Pressures on the right sides of blocks."""
    return "".join(f"*DLOAD\n{name}, P4, {p!r}\n" for name, p in pressures.items())


def at_end(run, number: int, table: str, column: str) -> np.ndarray:
    """Values of a table at the end of a step."""
    rows = run.csv(table)
    here = rows["step"] == number
    here &= rows["increment"] == rows["increment"][here].max()
    return rows[column][here]


def levels(run, number: int) -> dict[float, np.ndarray]:
    """Normal tractions of the points at each level."""
    traction, level = (at_end(run, number, "joint_J", name) for name in ("tn", "z"))
    return {float(h): traction[np.isclose(level, h)] for h in np.unique(np.round(level, 6))}


def low_points(run, number: int) -> np.ndarray:
    """Normal tractions up to the top of the first lift."""
    return np.concatenate([t for h, t in levels(run, number).items() if h <= 1.0])


def assert_pressures(run, rel: float) -> None:
    """The second lift comes under load (2), the load grows (3), the lift leaves again (4)."""
    for number, (low, middle, high) in {
        2: (FIRST, FIRST / 2, 0.0),
        3: (FIRST + SECOND, FIRST / 2 + SECOND, SECOND),
    }.items():
        found = levels(run, number)
        assert found[0.0] == pytest.approx(-low, rel=rel)
        assert found[1.0] == pytest.approx(-middle, rel=rel)
        assert found[2.0] == pytest.approx(-high, rel=rel, abs=rel * FIRST)
    assert low_points(run, 4) == pytest.approx(-FIRST - SECOND, rel=rel)


@JOINTS
def test_the_top_row_of_an_unfinished_lift(keyway, joint):
    """One lift alone: -p at all its points; it moves by p/k_n, its right side by p L/E more."""
    run = keyway(columns(joint) + step(remove("A2", "B2") + press(B1=FIRST) + OUTPUT))
    assert low_points(run, 1) == pytest.approx(-FIRST, rel=1e-9)
    moved = at_end(run, 1, "node_FREE", "U1")
    assert moved.min() == pytest.approx(-FIRST / KN - FIRST / YOUNG, rel=1e-9)
    assert run.json["steps"][0]["energy"]["error"] < 1e-11


@JOINTS
def test_the_next_lift_brings_its_area_without_stress(keyway, joint):
    """The force of the row between the lifts stays; it spreads over twice the area.

    Then a pressure on both lifts adds itself to all points alike. Without the second lift the first
    one has both pressures, and nothing is left of what came between.
    """
    both = press(B1=FIRST + SECOND, B2=SECOND)
    run = keyway(
        columns(joint)
        + step(remove("A2", "B2") + press(B1=FIRST) + OUTPUT)
        + step(add("A2", "B2"))
        + step(both)
        + step(remove("A2", "B2"))
        + step(add("A2", "B2") + press(B1=FIRST, B2=0.0))
        + step(remove("A2", "B2"))
    )
    assert_pressures(run, 1e-9)
    assert low_points(run, 6) == pytest.approx(-FIRST, rel=1e-9)
    first, last = (at_end(run, k, "node_FREE", "U1").min() for k in (1, 6))
    assert last == pytest.approx(first, rel=1e-9)
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-9


@JOINTS
def test_a_weightless_lift_comes_and_goes(keyway, joint):
    """The tractions below are those of before, with the lift gone; nothing moves all the time."""
    run = keyway(
        columns(joint)
        + step(remove("A2", "B2") + press(B1=FIRST) + OUTPUT)
        + step(add("A2", "B2"))
        + step(remove("A2", "B2"))
        + step(add("A2", "B2"))
    )
    moved = [at_end(run, k, "node_FREE", "U1")[:4] for k in (1, 2, 3, 4)]
    for other in moved[1:]:
        assert other == pytest.approx(moved[0], rel=1e-9)
    assert low_points(run, 3) == pytest.approx(low_points(run, 1), rel=1e-9)
    assert run.json["steps"][-1]["energy"]["error"] < 1e-9


@JOINTS
def test_lifts_on_contact_without_penetration(keyway, joint):
    """The tractions are those of springs, and no face penetrates the other by 2 PENETRATION."""
    both = press(B1=FIRST + SECOND, B2=SECOND)
    run = keyway(
        columns(joint, "FRICTION=0.6, PENETRATION=1e-12")
        + step(
            remove("A2", "B2") + press(B1=FIRST) + OUTPUT.replace("TRACTION", "OPENING, TRACTION")
        )
        + step(add("A2", "B2"))
        + step(both)
        + step(remove("A2", "B2"))
    )
    assert_pressures(run, 1e-6)
    for number in (1, 2, 3, 4):
        assert np.abs(at_end(run, number, "joint_J", "opening")).max() < 2e-12
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-6


@pytest.mark.parametrize("joint", ["elements", "different"])
def test_grout_presses_on_the_faces_that_are_there(keyway, joint):
    """The pressure of grout on one lift moves it by p/k_n over its own area."""
    p = 2e5
    run = keyway(
        columns(joint, "FRICTION=0.6, TENSILE STRENGTH=1e7")
        + step(remove("A2", "B2") + press(B1=FIRST) + OUTPUT)
        + step(f"*GROUT, JOINT=J, PRESSURE={p!r}\n")
        + step(add("A2", "B2"))
    )
    # Pressed by more than the grout: the faces keep the rest until it hardens.
    assert low_points(run, 2) == pytest.approx(-FIRST + p, rel=1e-9)
    assert levels(run, 3)[1.0] == pytest.approx(-FIRST / 2, rel=1e-9)


@pytest.mark.parametrize("joint", ["elements", "different"])
def test_a_run_goes_on_between_lifts(program_path, tmp_path, joint):
    """A run that is stopped and continued ends with the same tables."""
    quarter = "0.25, 1., 0.25, 0.25\n"
    deck = tmp_path / "job.inp"
    deck.write_text(
        columns(joint)
        + step(remove("A2", "B2") + press(B1=FIRST) + OUTPUT + "*RESTART, WRITE\n", data=quarter)
        + step(add("A2", "B2"), data=quarter)
        + step(press(B1=FIRST + SECOND, B2=SECOND), data=quarter)
        + step(remove("A2", "B2"), data=quarter)
    )

    assert stops_that_go_on(program_path, tmp_path, deck, (3, 4, 6, 8, 10, 13)) >= 2
