"""Arch dams that are built in lifts and grouted: decks of tools/make_dam.py."""

from __future__ import annotations

import make_dam
import make_jinping
import numpy as np
import pytest
from keyway_tools.results import Results
from keyway_tools.study.deck_cards import read_deck
from keyway_tools.study.mesh_sets import read_sets

GROUTED = ["--lifts", "3", "--grouting", "1", "3"]
WARM = [*GROUTED, "--temperatures", "1e-5", "16", "9"]
CHAIN = ["--join", "chain", "--refine", "1", "--fine", "2", "--fine-refine", "2"]
SMALL = ["--arc", "14", "--levels", "6", "--bottom", "2", "--thick", "2"]


def make(folder, *options):
    deck = folder / "dam.inp"
    assert make_dam.main(["-o", str(deck), *SMALL, *options]) == 0
    return read_deck(deck)


def test_lifts_are_all_of_the_dam(tmp_path):
    """Each element of the dam is in one lift; the lifts lie one above the other."""
    sets = read_sets(make(tmp_path, "--lifts", "3"))
    lifts = [sets.element_sets[f"LIFT{k}"] for k in (1, 2, 3)]
    assert set.union(*lifts) == sets.element_sets["DAM"]
    assert sum(map(len, lifts)) == len(sets.element_sets["DAM"])
    assert len(lifts[0]) < len(lifts[1]) < len(lifts[2])  # the valley widens


def test_steps_of_the_construction(tmp_path):
    deck = make(tmp_path, "--lifts", "3", "--grouting", "1", "3", "--grout-pressure", "2e5")
    steps = deck.steps()
    names = [step[0].value("NAME") for step in steps]
    assert names == ["LIFT1", "GROUT1", "LIFT2", "LIFT3", "GROUT2", "WATER"]
    assert [card.keyword for card in steps[0]][2:4] == ["MODEL CHANGE", "DLOAD"]
    assert steps[0][2].lines == ["LIFT2, LIFT3"]
    assert steps[2][2].lines == ["LIFT2"]
    assert "ADD" in steps[2][2].parameters
    grouts = [card for card in steps[4] if card.keyword == "GROUT"]
    assert [card.value("JOINT") for card in grouts] == ["JOINT1", "JOINT2"]
    assert {card.value("PRESSURE") for card in grouts} == {"200000"}
    assert [card.keyword for card in steps[5] if card.keyword == "RESERVOIR"]


def test_steps_with_temperatures(tmp_path):
    """Concrete is cooled before each campaign; the seasons come after the water."""
    deck = make(tmp_path, *WARM, "--seasons", "field.csv", "12", "0.5")
    steps = deck.steps()
    names = [step[0].value("NAME") for step in steps]
    assert names == [
        "LIFT1", "COOL1", "GROUT1", "LIFT2", "LIFT3", "COOL2", "GROUT2", "WATER", "SEASONS"
    ]  # fmt: skip
    assert steps[1][-1].lines == ["UP_TO_GROUT1, 9"]
    assert steps[8][1].lines == ["0.5, 12, , 0.5"]
    assert steps[8][2].value("INPUT").endswith("FIELD.CSV")
    assert [card.lines for card in deck.of("INITIAL CONDITIONS")] == [["UP_TO_CREST, 16"]]
    assert [card.lines for card in deck.of("EXPANSION")] == [["1e-05"]]
    sets = read_sets(deck)
    assert sets.node_sets["UP_TO_GROUT1"] < sets.node_sets["UP_TO_GROUT2"]
    assert sets.node_sets["UP_TO_GROUT2"] == sets.node_sets["UP_TO_CREST"]


def test_one_lift_has_no_stages(tmp_path, keyway):
    make(tmp_path, "--lifts", "1", "--grouting", "1", "--no-rock")
    files = {"dam_mesh.inp": (tmp_path / "dam_mesh.inp").read_text()}
    run = keyway((tmp_path / "dam.inp").read_text(), "--check", files=files)
    assert "STAGE" not in run.stderr


def test_the_header_says_how_the_dam_is_built(tmp_path):
    make(tmp_path, "--lifts", "3", "--grouting", "3")
    head = (tmp_path / "dam.inp").read_text().replace("\n**  ", "")
    assert "3 lifts that appear without stress" in head
    assert "until they are grouted, after lift 3" in head
    assert "no stages of building" not in head


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--lifts", "7"], "7 lifts; expected at most one for each of 6 levels"),
        (["--lifts", "3", "--grouting", "2", "4"], "grouting after the lifts 2 4; expected"),
        (["--lifts", "3", "--grouting", "2", "2"], "expected growing numbers, 1 to 3"),
        (["--grouting", "2"], "--grouting and --grout-pressure need --lifts"),
        (["--lifts", "3", "--grout-pressure", "1e5"], "--grout-pressure needs --grouting"),
        (["--temperatures", "1e-5", "16", "9"], "--temperatures needs --lifts and --grouting"),
        (["--seasons", "x.csv", "12", "1"], "--seasons needs --temperatures"),
        ([*GROUTED, "--temperatures", "0", "16", "9"], "expansion: 0 1/K; expected > 0"),
        ([*WARM, "--seasons", "x.csv", "12", "m"], "expected a file and two numbers"),
        ([*WARM, "--seasons", "x.csv", "1", "2"], "expected 0 < increment <= duration"),
        (["--lifts", "3", *CHAIN], "--lifts with a chain: expected --join auto or surfaces"),
    ],
)
def test_constructions_that_cannot_be(tmp_path, capsys, options, message):
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), *SMALL, *options]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "x.inp").exists()


def test_weight_by_cantilevers_leaves_the_arch_alone(tmp_path, keyway):
    """Mean stress across the outer joints of a dam with an empty reservoir.

    Weight on the finished arch pulls them by 0.4 MPa: the crest sinks between its abutments. Built
    in lifts the joints carry what the blocks on the slopes of the valley lean on each other, below
    1 % of that. Both numbers are the program's own; the signs are the physics.
    """
    shape = ["--arc", "20", "--levels", "8", "--bottom", "4", "--joints", "4", "--water", "0"]
    stress = {}
    for name, options in (("lifts", ["--lifts", "8", "--grouting", "8"]), ("once", ["--bonded"])):
        deck = tmp_path / f"{name}.inp"
        assert make_dam.main(["-o", str(deck), *shape, "--thick", "2", *options]) == 0
        run = keyway(deck, name=name)
        results = Results(run.folder)
        step = sorted(results.file["steps"])[-1]
        increments = results.file[f"steps/{step}/increments"]
        last = increments[sorted(increments)[-1]]
        area = results.file["joints/JOINT1/area"][:]
        stress[name] = np.average(last["joints/JOINT1/traction"][:, 0], weights=area)
    assert stress["once"] > 0.3e6
    assert abs(stress["lifts"]) < 0.01 * stress["once"]


def test_grout_without_a_change_finds_its_equilibrium(tmp_path, keyway):
    """Joints that were open by millimetres are grouted, and nothing else happens.

    Jumps count from the grouted openings, and are a thousandth of these: the round-off of the
    openings is no correction of an equilibrium.
    """
    deck = tmp_path / "dam.inp"
    options = ["--unknowns", "6000", "--join", "auto", "--lifts", "4", "--grouting", "2", "4"]
    assert make_jinping.main([str(deck), *options, "--law", "elastic"]) == 0
    text = deck.read_text()
    deck.write_text(text[: text.index("*STEP, NAME=LIFT3")])
    steps = keyway(deck).json["steps"]
    assert [step["name"] for step in steps] == ["LIFT1", "LIFT2", "GROUT1"]
    assert steps[2]["cutbacks"] == 0
    assert steps[2]["iterations"] <= 2
