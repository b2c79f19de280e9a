"""tools/accuracy: temperatures, initial values, loads and stages on refined meshes; effects."""

import re
import subprocess

import numpy as np
import pytest
from harness import ROOT
from keyway_tools.study.couplings import coupling_rungs
from keyway_tools.study.deck_cards import Card, Deck, read_deck
from keyway_tools.study.effects import list_effects
from keyway_tools.study.errors import errors_of
from keyway_tools.study.facts import facts_of
from keyway_tools.study.flat_deck import flat
from keyway_tools.study.ladder import Outcome
from keyway_tools.study.measured import Measured
from keyway_tools.study.mesh_sets import read_sets, support_of
from keyway_tools.study.refined_mesh import RefinementError, refine
from keyway_tools.study.rungs import BASE, ONCE, TWICE, Rung, as_it_is, base_deck, list_rungs
from keyway_tools.study.words import sentences_of_quantity
from tied_blocks import Blocks, node_set, state_of

LAW = "*DENSITY\n2400.\n*ELASTIC\n2e10, 0.\n*EXPANSION\n1e-5\n"


def deck_of(folder, text: str, name: str = "deck") -> Deck:
    (folder / f"{name}.inp").write_text(text)
    return read_deck(folder / f"{name}.inp")


def brick(n: int = 2) -> Blocks:
    """A cube of 1 m."""
    blocks = Blocks()
    blocks.add("A", *[(n, 0.0, 1.0)] * 3)
    return blocks


def model(blocks: Blocks, cards: str = "") -> str:
    base = node_set("BASE", blocks.side("A", "Z0")) + "*BOUNDARY\nBASE, 1, 3\n"
    return blocks.deck({"": LAW}, base + cards)


def with_all_nodes(deck: Deck, request: str) -> tuple[Deck, np.ndarray]:
    """The deck with a print of all its nodes in every step, and their coordinates."""
    x = read_sets(deck).nodes
    place = next(i for i, card in enumerate(deck.cards) if card.keyword == "STEP")
    deck.cards.insert(place, Card("NSET", {"NSET": "EVERY"}, [str(node) for node in x]))
    for step in deck.steps():
        deck.insert_before_end(step, Card("NODE PRINT", {"NSET": "EVERY"}, [request]))
    return deck, np.array([x[node] for node in sorted(x)])


def run(keyway, deck: Deck, name: str):
    """Results of a deck with its files."""
    deck.write(keyway.folder / f"{name}.inp")
    return keyway(keyway.folder / f"{name}.inp")


def last_temperatures(found, step: int) -> np.ndarray:
    """TEMP of all nodes at the end of a step, in the order of the ids."""
    table = found.csv("node_EVERY")
    chosen = table["step"] == step
    chosen &= table["increment"] == table["increment"][chosen][-1]
    return table["TEMP"][chosen][np.argsort(table["node"][chosen])]


def linear(x: np.ndarray) -> np.ndarray:
    """A temperature that bricks have exactly, on any mesh."""
    return 3.0 + x @ np.array([2.0, -5.0, 7.0])


def lines_of(blocks: Blocks, factor: float) -> str:
    values = (factor * linear(blocks.x)).tolist()
    return "".join(f"{node}, {value!r}\n" for node, value in enumerate(values, 1))


@pytest.mark.parametrize("times", [1, 2])
def test_new_nodes_have_the_temperatures_between_their_parents(keyway, tmp_path, times):
    """Initial values, data lines, those with an amplitude and a file: round-off is left."""
    blocks = brick()
    (tmp_path / "warm.csv").write_text(
        "node, 0, 2\n" + "".join(f"{node}, {value!r}, {3 * value!r}\n" for node, value in
                                 enumerate(linear(blocks.x).tolist(), 1))
    )  # fmt: skip
    step = "*STEP\n*STATIC\n1., 1.\n{}*END STEP\n"
    cards = ("", f"*TEMPERATURE\n{lines_of(blocks, 4.0)}", "*TEMPERATURE, INPUT=warm.csv\n",
             f"*TEMPERATURE, AMPLITUDE=HALF\n{lines_of(blocks, 1.0)}")  # fmt: skip
    text = "*AMPLITUDE, NAME=HALF\n0., 0.5, 1., 0.5\n" + model(
        blocks, f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\n{lines_of(blocks, 1.0)}"
    )
    deck = deck_of(tmp_path, text + "".join(step.format(one) for one in cards))
    for _ in range(times):
        deck = refine(deck)
    deck, x = with_all_nodes(deck, "TEMP")
    assert len(x) == (2 * 2**times + 1) ** 3
    found = run(keyway, deck, "fine")
    # The file has 1 at its start and 3 at 2 s: 2 at the end of the step.
    for number, factor in enumerate((1.0, 4.0, 2.0, 0.5), start=1):
        assert last_temperatures(found, number) == pytest.approx(factor * linear(x), abs=1e-12)


def test_parents_without_a_temperature_keep_theirs(keyway, tmp_path):
    """One corner is warmed: a node in the middle of an edge has half of its temperature."""
    steps = "*STEP\n*STATIC\n1., 1.\n*TEMPERATURE\n27, 8.\n*END STEP\n"
    deck, x = with_all_nodes(refine(deck_of(tmp_path, model(brick()) + steps)), "TEMP")
    warm = last_temperatures(run(keyway, deck, "fine"), 1)
    shape = 8.0 * np.prod(np.maximum(1.0 - 2.0 * np.abs(x - 1.0), 0.0), axis=1)
    assert warm == pytest.approx(shape, abs=1e-12)


def test_temperatures_of_different_histories_are_not_mixed(tmp_path):
    steps = "*AMPLITUDE, NAME=SLOW\n0., 0., 1., 1.\n" + model(brick()) + "*STEP\n*STATIC\n"
    steps += "*TEMPERATURE, AMPLITUDE=SLOW\n1, 8.\n*TEMPERATURE\n2, 8.\n*END STEP\n"
    with pytest.raises(RefinementError, match="temperatures with different histories"):
        refine(deck_of(tmp_path, steps))


def test_new_nodes_start_with_the_mean_velocity(keyway, tmp_path):
    """Inside the brick, too: all nodes above the base move, the first increment shows it."""
    blocks = brick()
    lines = "".join(f"{n + 1}, 1, {z!r}\n" for n, z in enumerate(blocks.x[:, 2].tolist()) if z)
    text = model(blocks, f"*INITIAL CONDITIONS, TYPE=VELOCITY\n{lines}")
    step = "*STEP\n*DYNAMIC, DIRECT\n1e-9, 1e-9\n*END STEP\n"
    deck, x = with_all_nodes(refine(deck_of(tmp_path, text + step)), "U")
    u = state_of(run(keyway, deck, "fine"), "EVERY")
    # In 1e-9 s waves pass 3e-6 m: the elastic part of the motion is below 1e-4 of it.
    assert u[:, 0] == pytest.approx(1e-9 * x[:, 2], abs=1e-13)


@pytest.mark.parametrize("load", ["*DLOAD\nA, HP6, 2e4, 1., 0.\n", "*DLOAD\nA, P6, 1e4\n"])
def test_pressures_on_elements_stay_on_their_face(keyway, tmp_path, load):
    """One layer of bricks behind the face; the reaction is the resultant of the pressure, 1e4 N."""
    blocks = Blocks()
    blocks.add("A", (1, 0.0, 1.0), (2, 0.0, 1.0), (2, 0.0, 1.0))
    text = model(blocks) + f"*STEP\n*STATIC\n{load}*END STEP\n"
    deck, _ = with_all_nodes(refine(deck_of(tmp_path, text)), "RF")
    reaction = state_of(run(keyway, deck, "fine"), "EVERY", "RF")
    assert reaction.sum(axis=0) == pytest.approx([-1e4, 0.0, 0.0], abs=1e-6)


def test_prescribed_values_of_single_nodes_have_means(tmp_path):
    """A top that is tilted stays a plane; nodes of one edge are held across, too."""
    blocks = brick()
    top = [(n + 1, x) for n, (x, _, z) in enumerate(blocks.x.tolist()) if z == 1.0]
    lines = "".join(f"{node}, 3, 3, {0.2 * x!r}\n" for node, x in top)
    lines += "".join(f"{node}, 1\n" for node, x in top if x == 0.0)
    text = model(blocks) + f"*STEP\n*STATIC\n*BOUNDARY\n{lines}*END STEP\n"
    fine = refine(deck_of(tmp_path, text))
    (card,) = [card for card in fine.of("BOUNDARY") if len(card.lines) > 1]
    x = read_sets(fine).nodes
    found = {tuple(line.split(", ")[:2]): line.split(", ")[3:] for line in card.lines}
    on_top = [node for node in x if x[node][2] == 1.0]
    assert len(found) == len(card.lines) == 25 + 5
    for node in on_top:
        assert float((found[str(node), "3"] or ["0"])[0]) == pytest.approx(0.2 * x[node][0])
        assert ((str(node), "1") in found) == (x[node][0] == 0.0)


SIDES = {"A": "BASE, 1, 3\nSIDE, 1\n", "B": "BASE, 1, 3\n*BOUNDARY\nSIDE, XSYMM\n"}


@pytest.mark.parametrize("cards", [*SIDES.values(), "BASE, 1, 3\n{}*BOUNDARY\n{}"])
def test_supports_of_several_sets_have_no_gap(tmp_path, cards):
    """Base and side have no node in common: the new nodes between them are on a held face."""
    blocks = brick()
    on_base = set(blocks.side("A", "Z0"))
    above = sorted(set(blocks.side("A", "X0")) - on_base)
    cards = cards.format(*["".join(f"{n + 1}, 1, 1\n" for n in part) for part in
                           (above[:2], above[2:])])  # fmt: skip
    sets = node_set("BASE", sorted(on_base)) + node_set("SIDE", above)
    text = blocks.deck({"": LAW}, f"{sets}*BOUNDARY\n{cards}")
    fine = refine(deck_of(tmp_path, text + "*STEP\n*STATIC\n1., 1.\n*END STEP\n"))
    new = read_sets(fine)
    lines = [line for card in fine.of("BOUNDARY") for line in card.lines]
    held = [node for line in lines for node in new.nodes_of(support_of(line)[0])
            if 1 in support_of(line)[1]]  # fmt: skip
    assert sorted(held) == sorted(n for n, x in new.nodes.items() if x[0] == 0.0 or x[2] == 0.0)


def test_a_brick_between_two_supports_is_not_held(tmp_path):
    """Base and top, one brick apart: the edges between them are free."""
    blocks = Blocks()
    blocks.add("A", *[(1, 0.0, 1.0)] * 3)
    text = model(blocks, node_set("TOP", blocks.side("A", "Z1")) + "*BOUNDARY\nTOP, 1, 3\n")
    fine = refine(deck_of(tmp_path, text + "*STEP\n*STATIC\n1., 1.\n*END STEP\n"))
    lines = [line for card in fine.of("BOUNDARY") for line in card.lines]
    assert lines == ["BASE_AND_NEW, 1, 3", "TOP_AND_NEW, 1, 3"]


def test_stages_name_the_children_of_single_elements(tmp_path):
    step = "*STEP\n*STATIC\n*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n5, 6, A\n*END STEP\n"
    (card,) = refine(deck_of(tmp_path, model(brick()) + step)).of("MODEL CHANGE")
    assert card.lines == [str(child) for child in range(33, 49)] + ["A"]


@pytest.mark.parametrize("card", ["*EQUATION\n2\n26, 1, 1., 27, 1, -1.\n", "*MPC\nTIE, 26, 27\n"])
def test_relations_between_nodes_are_not_lost_in_silence(tmp_path, card):
    with pytest.raises(RefinementError, match=r"names nodes: new nodes would lack it"):
        refine(deck_of(tmp_path, model(brick(), card)))


def test_surfaces_of_nodes_have_the_new_nodes(program_path, tmp_path):
    blocks = brick()
    face = node_set("FACE", blocks.side("A", "X0")) + "*SURFACE, NAME=WET, TYPE=NODE\nFACE\n"
    text = model(blocks, face) + "*STEP\n*STATIC\n*DSLOAD\nWET, P, 1e4\n*END STEP\n"
    refine(deck_of(tmp_path, text)).write(tmp_path / "fine.inp")
    command = [program_path, "--check", tmp_path / "fine.inp"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert re.search(r"WET +16 faces", done.stdout), done.stderr


@pytest.mark.parametrize("name", ["U", '"Upper 1-1"'])
@pytest.mark.parametrize("angle", [90.0, 30.0])
def test_instances_made_flat_are_the_same_model(keyway, tmp_path, name, angle):
    """Two instances, one moved, rotated and held, under weight and pressure, and warmed at one node
    by a file; and refined."""
    text = (ROOT / "tests/errors/base/assembly.inp").read_text()
    text = text.replace(" 1., 90.", f" 1., {angle!r}").replace("U.10", f"{name}.10")
    text = re.sub(r"=U\b", f"={name}", text).replace("C3D8I", "C3D8")
    heat = f"*TEMPERATURE, INPUT=warm.csv\n*NODE PRINT, NSET={name}.5\nU\n"
    text = text.replace("*END STEP", f"{heat}*END STEP").replace(
        "*DENSITY", "*EXPANSION\n1e-5\n*DENSITY"
    )
    plain = name.replace(chr(34), "")
    (tmp_path / "warm.csv").write_text(f"node, 0, 1\n{plain}.105, 0, 9.\nl.5, 0, 4.\n")
    text = text.replace("*END PART\n*ASSEMBLY", "*NSET, NSET=5\n105\n*END PART\n*ASSEMBLY")
    text = re.sub(r"(\*SOLID SECTION.*\n)", r"\g<1>1.,\n", text)
    made = flat(deck_of(tmp_path, text, "parts"))
    assert {card.value("TYPE") for card in made.of("ELEMENT")} == {"C3D8B"}
    moved = [run(keyway, deck, job).json["displacement"]["anywhere"]["value"] for deck, job in
             ((read_deck(tmp_path / "parts.inp"), "parts"), (made, "flat"))]  # fmt: skip
    assert moved[1] == pytest.approx(moved[0], rel=1e-12)  # round-off of the rotation
    assert run(keyway, refine(made), "fine").json["model"]["elements"] == 16


def test_parts_are_left_as_they_are_by_name(tmp_path):
    """No variant of a deck with instances needs its sets, but for those that say why not."""
    part = "*PART, NAME=P\n*NODE\n1, 0., 0., 0.\n*END PART\n"
    deck = deck_of(tmp_path, part + "*TIE, NAME=T\nP.A, P.B\n")
    why = []
    for rung in [*list_rungs(base_deck(deck)), *coupling_rungs(deck)]:
        try:
            rung.change(deck)
        except RefinementError as error:
            why.append((rung.name, str(error)))
    reason = "the mesh has parts and instances (*PART), which are not refined"
    names = ("mesh refined", TWICE, "ties by springs", "ties by joints that stay closed")
    assert why == [(name, reason) for name in names]


def test_increments_that_were_not_run_have_no_error_of_zero():
    """A budget for the refined mesh alone: the error of the increment is not known."""
    base = Outcome(Rung("base", BASE, 1.0, 1.0, as_it_is), 1.0, Measured(1.0, 1.0, 9, 5, 0))
    fine = Outcome(Rung("mesh", ONCE, 8.0, 0.5, as_it_is), 8.0, Measured(8.0, 1.0, 50, 5, 0))
    half = Outcome(Rung("increment", "increment x 0.5", 2.0, 0.5, as_it_is), 2.0, why_not="late")
    base.measured.values["displacement"], fine.measured.values["displacement"] = 1.0, 1.1
    outcomes = [base, fine, half]
    (quantity,) = facts_of(outcomes, errors_of(outcomes))["quantities"]
    assert (quantity["error"], quantity["increment"]) == (None, None)
    (sentence,) = sentences_of_quantity(quantity, 1.0)
    # From 1.0 and 1.1 first order gives 1.2, second 1.1333: 0.2 of the mean 1.1667.
    assert sentence == (
        "largest displacement: the error of the increment is not known, as no run with another "
        "increment is there. The mesh alone leaves 17 %."
    )
    (quantity,) = facts_of([base, fine], errors_of([base, fine]))["quantities"]
    assert quantity["error"] == pytest.approx(1.25 * 0.2 / 1.1667, rel=1e-4)


def test_effects_of_stages_heat_and_contact_have_names(tmp_path):
    deck = deck_of(tmp_path, """*MATERIAL, NAME=M
*PLASTIC
1e8
*SURFACE INTERACTION, NAME=I
*FRICTION
0.7
*STEP
*STATIC
*MODEL CHANGE, TYPE=ELEMENT, REMOVE
LIFT
*GROUT, JOINT=J
*TEMPERATURE
ALL, 4.
*CLOAD
1, 1, 5.
*DLOAD
FACE, HP3, 1e5, 1., 0.
*DSLOAD
TOP, P, 1e5
*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=QUAKE
BASE, 1, 2, 1.5
*END STEP
""")  # fmt: skip
    rungs = list_effects(deck)
    assert [rung.name.removeprefix("without ") for rung in rungs[1:]] == [
        "the motion along x", "the motion along y", "yielding of the metal",
        "friction of the contact", "changes of temperature", "construction in stages",
        "grouting of the joints", "the point forces", "the pressures on faces",
    ]  # fmt: skip
    still, moved = rungs[1].change(deck).of("BOUNDARY")
    assert (still.parameters, still.lines) == ({}, ["BASE, 1, 1"])
    assert moved.lines == ["BASE, 2, 2,  1.5"]
    dry = rungs[-1].change(deck)
    assert not dry.has("DSLOAD")
    assert not dry.has("DLOAD")


ODD_DECK = """* Heading,
x = 3, a text
*node, nset=All
1, 0., 0., 0.D0
2, 1.D0, 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 1., 0.
11, 2., 0., 1.
12, 2., 1., 1.
*Element, type=C3D8I, elset=Left
1, 1, 2, 3, 4, 5, 6, 7, 8,
*Element, type=C3D8I, elset="Right side",
2, 2, 9, 10
3, 6, 11, 12, 7
*Elset, elset=Both
Left, "right Side"
*Nset, nset='The base',
Generate
1, 4, 1
*nset, nset='The base'
9, 10
*material, name=m
*elastic,
2e10, 0.2
*density,
2400.
*solidsection, elset=Both, material=m
*boundary
"THE BASE", pinned
*step
*static,
1., 1.
*dload
"Right side", GRAV, 10., 0., 0., -1.
*nodeprint, nset="The base"
RF
*endstep
"""


def test_included_files_may_hold_data_alone(keyway, tmp_path):
    """The file ends the data of the card above it, and the lines below go on with its last card."""
    (tmp_path / "in").mkdir()
    text = ODD_DECK.replace("9, 2., 0., 0.\n", "*include,\ninput=in/nodes.txt\n")
    (tmp_path / "in/nodes.txt").write_text("9, 2., 0., 0.\n** remark\n*INCLUDE, INPUT=more.txt")
    (tmp_path / "in/more.txt").write_text("10, 2., 1., 0.\n")
    deck = deck_of(tmp_path, text.replace("\n10, 2., 1., 0.", "", 1))
    assert deck == deck_of(tmp_path, ODD_DECK)


def test_odd_decks_are_read_as_the_program_reads_them(keyway, tmp_path):
    """Exponents of Fortran, quotes, commas without meaning, elements on several lines, keywords
    without blanks; a weight of 24 kN stays on the base."""
    fine, _ = with_all_nodes(refine(deck_of(tmp_path, ODD_DECK)), "RF")
    reaction = state_of(run(keyway, fine, "fine"), "EVERY", "RF")
    assert reaction.sum(axis=0) == pytest.approx([0.0, 0.0, 24e3], abs=1e-6)


def test_data_lines_below_a_file_of_temperatures(tmp_path):
    """They are final values, with no history of the file."""
    (tmp_path / "warm.csv").write_text(
        "node, 0, 2\n" + "".join(f"{n}, 1, 3\n" for n in range(1, 19))
    )
    cards = "*TEMPERATURE, INPUT=warm.csv\n" + "".join(f"{n}, 8.\n" for n in range(1, 28))
    step = f"*STEP\n*STATIC\n1., 1.\n{cards}*END STEP\n"
    fine = refine(deck_of(tmp_path, model(brick()) + step))
    card = list(fine.of("TEMPERATURE"))[-1]
    assert len(card.lines) == 125 - 27
    assert {line.split(", ")[1] for line in card.lines} == {"8.0"}
