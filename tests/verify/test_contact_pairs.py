"""*CONTACT PAIR and its laws: the joints that they become, and closed forms of blocks.

The block is 2 x 1 x 1 m, its Poisson's ratio is zero; all nodes of the base are held.
"""

from __future__ import annotations

import numpy as np
import pytest
from block_decks import THREE_TO_TWO, TWO_TO_THREE, joint_state
from brick_decks import last_state
from contact_decks import PAIR, Contact, law
from joint_decks import static

WEIGHT = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n"
PRINT = "*NODE PRINT, NSET=BODY\nU\n*NODE FILE\nOPENING\n"
LINES = "SOLE, ROOF\n"
JOINT = "*JOINT LAW, NAME=LAW, KN=2e10, KT=1e10, FRICTION=0.5{}\n*JOINT, NAME=CONTACT1, LAW=LAW{}\n"
YOUNG = 1e10


def steps(load: str = WEIGHT) -> str:
    return static(load + PRINT)


def pressed(down: float, along: float = 0.0) -> str:
    """The top moves down, then along the surface; it stays flat."""
    first = f"*BOUNDARY\nTOP, 3, 3, {-down!r}\nTOP, 1, 2, 0.\n"
    text = steps(first)
    return text + steps(f"*BOUNDARY\nTOP, 1, 1, {along!r}\n") if along else text


def contact(*cards: str, **changes) -> Contact:
    return Contact(young=YOUNG, contact=list(cards), **changes)


def moved(run) -> np.ndarray:
    return last_state(run, "BODY")


@pytest.mark.parametrize("meshes", [TWO_TO_THREE, THREE_TO_TWO], ids=["2:3", "3:2"])
@pytest.mark.parametrize("gap", ["none", "mesh", "clearance"])
def test_equals_the_joint(keyway, meshes, gap):
    """The same segments, points and law: 1e-12 of the largest displacement is round-off."""
    linear = law("LINEAR", "0.5, 1e10", "2e10")
    lift = 1e-3 if gap == "mesh" else 0.0
    more = "*CLEARANCE, SLAVE=SOLE, MASTER=ROOF, VALUE=1e-3\n" if gap == "clearance" else ""
    pair = contact(linear, PAIR + "\n", LINES, more, lift=lift, **meshes)
    options = {
        "none": ("", ""),
        "mesh": ("", ", CLEARANCE=MEASURED"),
        "clearance": (", GAP=1e-3", ""),
    }
    joint = contact(JOINT.format(*options[gap]), LINES, lift=lift, **meshes)
    load = pressed(2e-3, 1.5e-3)
    ours = moved(keyway(pair.deck(load), name="pair"))
    other = moved(keyway(joint.deck(load), name="joint"))
    assert np.abs(ours - other).max() <= 1e-12 * np.abs(other).max()


@pytest.mark.parametrize("rounding", [1e-9, -1e-9])
def test_rounding_of_a_mesh_is_no_gap(keyway, rounding):
    """Faces that a mesher left 1 nm apart touch: a joint with CLEARANCE=MEASURED keeps its tensile
    strength, as one without. The tolerance is that nanometre over the displacement."""
    strong = ", TENSILE STRENGTH=1e8"
    states = []
    for options, lift in ((", CLEARANCE=MEASURED", rounding), ("", 0.0)):
        joint = contact(JOINT.format(strong, options), LINES, lift=lift, **TWO_TO_THREE)
        run = keyway(joint.deck(pressed(-1e-5)), name=f"joint{len(states)}")
        states.append(joint_state(run, name="CONTACT1"))
    measured, touching = states
    assert touching["opening"].min() > 1e-8
    assert measured["opening"] == pytest.approx(touching["opening"], rel=1e-4)
    assert measured["force"] == pytest.approx(touching["force"], rel=1e-4, abs=1e-3)


@pytest.mark.parametrize("slave_first", [True, False])
def test_hard_contact_has_the_stiffness_of_its_elements(keyway, slave_first):
    """KN = 50 E/h of the softer side: here 50 E/1 m of the block, the base is 0.5 m thick.

    The weight presses the surface by p/KN; 1e-9 is the tolerance of the iteration.
    """
    lines = LINES if slave_first else "ROOF, SOLE\n"
    blocks = contact(law(), PAIR + "\n", lines)
    run = keyway(blocks.deck(steps()))
    state = joint_state(run, name="CONTACT1")
    sunk = blocks.weight / blocks.area / (50.0 * YOUNG)
    assert state["opening"] == pytest.approx(-sunk, rel=1e-9)
    assert state["force"][0] == pytest.approx(-blocks.weight, rel=1e-9)
    assert run.csv("energy")["error"].max() < 1e-6
    log = (run.folder / "job.log").read_text()
    assert "KN 5e11 Pa/m, KT 2.5e11 Pa/m" in log


def test_friction_slides_beyond_mu_n(keyway):
    """The top goes down by d and then along by u. While the surface sticks T is proportional to u;
    where all points slide the resultant of the traction is mu N. 1e-6 is the tolerance of the
    iteration."""
    cards = law("LINEAR", "0.5, 1e10", "2e10"), PAIR + "\n", LINES
    runs = {
        u: keyway(contact(*cards).deck(pressed(1e-3, u)), name=f"u{i}")
        for i, u in enumerate((1e-5, 2e-5, 5e-3))
    }
    forces = {u: joint_state(run, 2, "CONTACT1")["force"] for u, run in runs.items()}
    normal = {u: -force[0] for u, force in forces.items()}
    along = {u: np.hypot(*force[1:]) for u, force in forces.items()}
    assert along[5e-3] == pytest.approx(0.5 * normal[5e-3], rel=1e-6)
    assert 0.0 < along[2e-5] < 0.1 * normal[2e-5]
    assert along[2e-5] == pytest.approx(2.0 * along[1e-5], rel=1e-6)


GAP = 1e-3
CLEARANCE = f"*CLEARANCE, MASTER=ROOF, SLAVE=SOLE, VALUE={GAP}\n"


@pytest.mark.parametrize(
    ("cards", "lift", "gap"),
    [
        ([law(stiffness="2e10"), PAIR + "\n", LINES, CLEARANCE], 0.0, GAP),
        ([CLEARANCE, PAIR + "\n", LINES, law(stiffness="2e10")], 0.0, GAP),
        ([CLEARANCE, PAIR + "\n", LINES, law(stiffness="2e10")], 3e-3, GAP),
        ([law(stiffness="2e10"), PAIR + "\n", LINES], GAP, GAP),
        ([law(stiffness="2e10"), PAIR + "\n", LINES], -GAP, -GAP),
        ([law(stiffness="2e10"), PAIR + ", ADJUST=0.5e-3\n", LINES], GAP, GAP),
        ([law(stiffness="2e10"), PAIR + ", ADJUST=2e-3\n", LINES], GAP, 0.0),
        ([law(stiffness="2e10"), PAIR + ", ADJUST=0.\n", LINES], -GAP, 0.0),
        ([law(stiffness="2e10"), PAIR + ", ADJUST=BODY\n", LINES], GAP, 0.0),
    ],
    ids=[
        "card",
        "card_first",
        "card_not_mesh",
        "mesh",
        "overlap",
        "adjust_less",
        "adjust_more",
        "adjust_overlap",
        "adjust_set",
    ],
)
def test_a_gap_closes(keyway, cards, lift, gap):
    """A column pressed by d on its base: F = (d - gap) A/(1 m/E + 1/KN), and no force
    as long as d < gap. 1e-9 is the tolerance of the iteration."""
    blocks = contact(*cards, lift=lift)
    run = keyway(blocks.deck(pressed(2.0 * GAP)))
    state = joint_state(run, name="CONTACT1")
    force = (2.0 * GAP - gap) * blocks.area / (1.0 / YOUNG + 1.0 / 2e10)
    assert state["force"][0] == pytest.approx(-force, rel=1e-9)
    if gap > 0.0:
        open_run = keyway(blocks.deck(pressed(0.9 * gap)), name="open")
        assert np.abs(joint_state(open_run, name="CONTACT1")["force"]).max() == 0.0


def test_tied_contact_pulls(keyway):
    """The top goes up by d: F = d A/(1 m/E + 1/K) in tension."""
    blocks = contact(law("TIED", "0.5, 1e10", "2e10"), PAIR + "\n", LINES)
    state = joint_state(keyway(blocks.deck(pressed(-1e-3))), name="CONTACT1")
    force = 1e-3 * blocks.area / (1.0 / YOUNG + 1.0 / 2e10)
    assert state["force"][0] == pytest.approx(force, rel=1e-9)


def test_surface_of_nodes(keyway):
    """The faces between the nodes of the sole are those of the surface with elements."""
    nodes = "*SURFACE, TYPE=NODE, NAME=NODES\nBOTTOM\n"
    linear = law("LINEAR", "0.5, 1e10", "2e10")
    blocks = contact(linear, nodes, PAIR.replace("SURFACE TO", "NODE TO") + "\nNODES, ROOF\n")
    deck = blocks.deck(pressed(2e-3, 1.5e-3))
    ids = deck[deck.index("*NODE") : deck.index("*ELEMENT")].splitlines()[1:]
    low = [words[0] for words in (line.split(",") for line in ids) if float(words[3]) == 0.0]
    low = low[: 3 * 3]  # the block comes before the base
    deck = deck.replace(nodes, "*NSET, NSET=BOTTOM\n" + ", ".join(low) + "\n" + nodes)
    ours = moved(keyway(deck, name="nodes"))
    other = contact(linear, PAIR + "\n", LINES).deck(pressed(2e-3, 1.5e-3))
    other = moved(keyway(other, name="elements"))
    assert np.abs(ours - other).max() <= 1e-12 * np.abs(other).max()


def test_names_order_and_repeats(keyway):
    """The law below the pairs, a repeated and a reversed pair."""
    cards = [
        PAIR + "\nSOLE, ROOF\nROOF, SOLE\n",
        PAIR + "\nSOLE, ROOF\n",
        law("LINEAR", "0.5", "2e10"),
    ]
    run = keyway(contact(*cards).deck(steps()))
    assert list(run.json["joints"]) == ["CONTACT1"]
    noted = [item["why"] for item in run.json["ignored_input"]]
    assert noted == [
        "the pair ROOF, SOLE has no effect: joint CONTACT1 acts between these surfaces",
        "the pair SOLE, ROOF has no effect: joint CONTACT1 acts between these surfaces",
    ]
    assert run.json["warnings"] == []


def test_finite_sliding_is_said(keyway):
    run = keyway(
        contact(law(friction="0.5"), "*CONTACT PAIR, INTERACTION=LAW\n", LINES).deck(steps())
    )
    assert len(run.json["warnings"]) == 1
    assert "sliding is small" in str(run.json["warnings"])
