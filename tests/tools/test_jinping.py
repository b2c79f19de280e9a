"""The decks of input/jinping: what the tool writes, what they assume, and that they run."""

import make_jinping
import numpy as np
import pytest
from keyway_tools.jinping.concrete import TABLE_1, law_cards
from keyway_tools.jinping.decks import SHAPE, SMALL, JinpingDeck, write_deck

FOLDER = make_jinping.INPUT / "jinping"


@pytest.mark.parametrize("name", make_jinping.KEPT)
def test_kept_deck_is_what_the_tool_writes(name, tmp_path):
    folder = tmp_path / "jinping"
    (tmp_path / "xingbiling").symlink_to(make_jinping.INPUT / "xingbiling")
    deck = folder / f"{name}.inp"
    assert write_deck(make_jinping.KEPT[name], deck, tmp_path / "xingbiling") == 0
    text = deck.read_text()
    assert text == (FOLDER / f"{name}.inp").read_text()
    for words in ("height 306.5 m", "crest arc 563.77 m", "6 vertical planes", "LEVEL=300,"):
        assert words in text
    assert not list(folder.glob("*.txt"))


def test_largest_thicknesses_are_those_of_the_paper():
    """18.5 m and 66 m (section 4.2)."""
    words = SHAPE.split()
    value = dict(zip(words[::2], words[1::2], strict=True))
    crest, base = (float(value[f"--{place}-thickness"]) for place in ("crest", "base"))
    growth = float(value["--abutment-thickening"])
    assert crest * growth == pytest.approx(18.5, rel=1e-12)
    assert base * growth == pytest.approx(66.0, abs=5e-4)  # three digits of a millimetre


def test_table_is_that_of_the_material_deck():
    """input/material/table1_tension.inp has the table by hand."""
    by_hand = (make_jinping.INPUT / "material" / "table1_tension.inp").read_text()
    lines = by_hand.splitlines()
    start = lines.index("*CONCRETE TENSION STIFFENING, TYPE=STRAIN") + 1
    rows = [[float(word) for word in line.split(",")] for line in lines[start : start + 8]]
    assert np.array(rows) == pytest.approx(np.array([(1e6 * s, 1e-3 * e) for s, e, _ in TABLE_1]))
    cards = law_cards("table1", "SIGN")
    assert "RECOVERY=SIGN" in cards
    assert "0.169e6, 1.664e-3" in cards
    assert "0.964, 1.664e-3" in cards


def test_unknown_laws_and_lonely_options_are_refused(capsys):
    with pytest.raises(ValueError, match="expected a law of table1"):
        law_cards("steel", "SIGN")
    with pytest.raises(SystemExit):
        make_jinping.main(["--law", "elastic"])
    assert "name the deck" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--joints", "0"], "make_jinping: 0 joints: the outlets stand in block 4"),
        (["--joint-places", "100", "300"], "expected --no-outlets, or --fine with another block"),
        (["--height", "80"], "--water 300: expected 0 to 80 m, the --height"),
        (["--crest-arc", "100", "--unknowns", "3000"], "do not fit into a block of 14.29 m"),
        (["--crest-arc", "100", "--no-outlets", "--unknowns", "3000"], "expected a longer --crest"),
    ],
)
def test_faults_name_options(tmp_path, capsys, options, message):
    assert make_jinping.main([str(tmp_path / "dam.inp"), *options]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_options_of_make_dam_go_through(tmp_path):
    deck = tmp_path / "dam.inp"
    options = ["--unknowns", str(SMALL), "--law", "elastic", "--kn", "1e11", "--friction", "0.3"]
    assert make_jinping.main([str(deck), *options]) == 0
    text = deck.read_text()
    assert "KN=1e+11" in text
    assert "FRICTION=0.3" in text
    assert "*DYNAMIC, DIRECT" in text


def test_small_dam_cracks_and_goes_on(keyway, tmp_path):
    """Weight, water and the first moments of the motion, with openings at three heights."""
    deck = tmp_path / "small.inp"
    small = JinpingDeck(unknowns=SMALL, duration=0.05)
    assert write_deck(small, deck, make_jinping.INPUT / "xingbiling") == 0
    run = keyway(deck)
    assert run.json["status"] == "finished"
    assert run.json["model"]["unknowns"] >= SMALL
    assert run.json["damage"]["inelastic"]["elements"] > 0
    assert max(abs(step["energy"]["error"]) for step in run.json["steps"]) < 1e-6
    table = run.csv("joint_JOINT1")
    assert len(set(zip(table["x"], table["y"], table["z"], strict=True))) == 6
