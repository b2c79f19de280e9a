"""Cards of decks that are read and changed: what is not changed stays byte for byte."""

from __future__ import annotations

import numpy as np
import pytest
from harness import ROOT
from keyway import Deck, DeckError
from keyway.deck.deck_file import DeckFile

DECKS = sorted((ROOT / "input").rglob("*.inp")) + sorted((ROOT / "tests/decks").rglob("*.inp"))

TEXT = """** A deck
*HEADING
Two blocks, with a comma
*NODE, NSET=ALL
1, 0., 0., 0.
** between the data
2,	1., 0., 0.
3, 2., 0., 0.

*MATERIAL, NAME="Mass concrete"
* Elastic
  31.027e9 ,  0.2  ,
** above the step
*STEP, NAME=WATER,
 INC=100
*STATIC, DIRECT
0.1, 1.
*End Step
** the end
"""


@pytest.fixture
def deck(tmp_path) -> Deck:
    return Deck.from_text(TEXT, tmp_path / "deck.inp")


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_every_deck_is_written_as_it_was_read(path):
    file = DeckFile.read(path)
    assert not file.is_changed
    assert file.text().encode() == path.read_bytes()


@pytest.mark.parametrize(
    "content",
    [
        b"*NODE\r\n1, 0.\r\n** end",
        b"\xef\xbb\xbf*HEADING\n M\xfcller\n*NODE\n1, 0.",
        b"** only a comment\n",
        b"",
        b"\n\n*STEP\n\n",
        b"1, 2, 3\n** data alone\n4, 5\n",
        b"*NODE\n1, 0., 0.\x0b\x0c, 0.\n*END STEP",
    ],
)
def test_bytes_of_odd_files_stay(content, tmp_path):
    path = tmp_path / "odd.inp"
    path.write_bytes(content)
    deck = Deck(path)
    written = deck.write(tmp_path / "new" / "odd.inp")
    assert [file.read_bytes() for file in written] == [content]


def test_keywords_parameters_and_data(deck):
    assert [card.keyword for card in deck.cards] == [
        "HEADING", "NODE", "MATERIAL", "ELASTIC", "STEP", "STATIC", "END STEP",
    ]  # fmt: skip
    assert deck.card("material").parameters == {"NAME": "Mass concrete"}
    assert deck.card("STEP").parameters == {"NAME": "WATER", "INC": "100"}
    assert deck.card("Static").parameters == {"DIRECT": None}
    assert deck.card("ELASTIC").data == [["31.027e9", "0.2"]]
    assert deck.card("endstep").line == 18
    nodes = deck.card("NODE").data
    assert len(nodes) == 3
    assert np.array_equal(nodes.array()[:, 1], [0.0, 1.0, 2.0])
    assert np.array_equal(deck.node_set("all"), [1, 2, 3])


def test_a_change_touches_one_value(deck):
    deck.card("ELASTIC").data[0][0] = 30e9
    deck.card("NODE").data[1][1] = "1.5"
    deck.card("STEP").parameters["inc"] = 200
    changed = TEXT.replace("31.027e9 ", "30000000000.0 ").replace("	1.,", "	1.5,")
    assert deck.text() == changed.replace("INC=100", "INC=200")


def test_parameters_come_and_go(deck):
    step, static = deck.card("STEP").parameters, deck.card("STATIC").parameters
    step["NLGEOM"] = "NO"
    assert deck.card("STEP").head == ["*STEP, NAME=WATER,\n", " INC=100, NLGEOM=NO\n"]
    del step["NAME"]
    assert deck.card("STEP").head == ["*STEP, INC=100, NLGEOM=NO\n"]
    static["DIRECT"] = "YES"
    assert deck.card("STATIC").text() == "*STATIC, DIRECT=YES\n0.1, 1.\n"
    static["DIRECT"] = None
    static["ALPHA"] = -0.05
    assert deck.card("STATIC").head == ["*STATIC, DIRECT, ALPHA=-0.05\n"]
    deck.card("MATERIAL").parameters["NAME"] = "a, b"
    assert deck.card("MATERIAL").head == ['*MATERIAL, NAME="a, b"\n']
    with pytest.raises(KeyError):
        del static["INC"]


def test_data_lines_come_and_go(deck):
    data = deck.card("NODE").data
    data.append([4, 3.0, 0.0, 0.0])
    data.insert(0, [9, 0.1])
    del data[1]
    assert deck.card("NODE").body == [
        "9, 0.1\n", "** between the data\n", "2,	1., 0., 0.\n", "3, 2., 0., 0.\n",
        "4, 3.0, 0.0, 0.0\n",
    ]  # fmt: skip
    data[0].append(np.float64(0.2))
    assert data[0] == ["9", "0.1", "0.2"]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1, 2", "1\n2"])
def test_no_value_that_a_deck_cannot_hold(deck, value):
    with pytest.raises(ValueError, match=r"expected one field|no such number"):
        deck.card("ELASTIC").data[0][0] = value
    assert deck.text() == TEXT


def test_faults_name_the_place(deck):
    deck.card("NODE").data[2][2] = "zero"
    with pytest.raises(ValueError, match=r"deck\.inp:4: \*NODE, data line 3: 'zero'"):
        deck.card("NODE").data.array()
    with pytest.raises(DeckError, match=r"no card \*DENSITY; expected one"):
        deck.card("DENSITY")
    with pytest.raises(DeckError, match="no NSET 'CREST'; the deck has: ALL"):
        deck.node_set("CREST")


def test_cards_come_and_go(deck):
    deck.remove(deck.card("STEP"), deck.card("STATIC"))
    assert "0.2  ,\n** above the step\n*End Step\n** the end\n" in deck.text()
    deck = Deck.from_text(TEXT)
    (card,) = deck.add("*DENSITY\n2400.", after=deck.card("ELASTIC"))
    deck.add("** why\n*BOUNDARY\n1, 1, 3\n", step=0)
    deck.add("*AMPLITUDE, NAME=A\n0., 0.\n")
    names = [card.keyword for card in deck.cards]
    assert names[3:] == ["ELASTIC", "DENSITY", "AMPLITUDE", "STEP", "STATIC", "BOUNDARY",
                         "END STEP"]  # fmt: skip
    assert card.data.array() == [[2400.0]]
    assert "0.1, 1.\n** why\n*BOUNDARY\n1, 1, 3\n*End Step" in deck.text()
    assert len(deck.steps) == 1
    deck.remove(card)
    with pytest.raises(DeckError, match="is not in the deck"):
        deck.remove(card)
    with pytest.raises(DeckError, match="each with a keyword"):
        deck.add("1, 2, 3")


def test_a_step_can_follow_the_last_one(deck):
    last = deck.cards[-1]
    deck.add("*STEP\n*FREQUENCY\n5\n*END STEP", after=last)
    assert len(deck.steps) == 2
    assert deck.text().endswith("*End Step\n*STEP\n*FREQUENCY\n5\n*END STEP\n** the end\n")


def test_case_counts_in_letters_beyond_ascii(tmp_path):
    """As in the program: öä and Öä are two names."""
    text = "*NODE, NSET=öä\n1, 0, 0, 0\n*NODE, NSET=Öä\n2, 0, 0, 0\n*NSET, NSET=ÖÄ\nÖä\n"
    deck = Deck.from_text(text, tmp_path / "deck.inp")
    sets = {name: deck.node_set(name).tolist() for name in ("öä", "Öä", "ÖÄ")}
    assert sets == {"öä": [1], "Öä": [2], "ÖÄ": [2]}
    assert [len(deck.find("NODE", NSET=name)) for name in ("öä", "öÄ")] == [1, 0]


@pytest.mark.parametrize(
    ("text", "num_lines"),
    [
        ("*NSET, NSET=B,\nUNSORTED\n1, 2\n", 1),
        ("*NSET, NSET=B,\n Generate\n1, 9, 2\n", 1),
        ("*CONTACTPAIR, INTERACTION=I,\nsmall  sliding,\nTYPE=SURFACE TO SURFACE\nA, B\n", 1),
        ("*STEP,\nPERTURBATION\n", 0),
        ("*SURFACE, NAME=S,\nINTERNAL\nE, S1\n", 1),
        ("*BOUNDARY,\nBASE, 1, 3\n", 1),  # the comma has no meaning
        ("*HEADING,\nlevel = 9 m\n", 1),  # a keyword without parameters
        ("*NO KEYWORD,\nUNSORTED\n", 1),
        ("*NO KEYWORD,\nA=1\n", 0),
    ],
)
def test_lines_in_which_a_keyword_goes_on(text, num_lines):
    """As the program reads them: with the parameters that each keyword has."""
    (card,) = Deck.from_text(text).cards
    assert len(card.data) == num_lines
