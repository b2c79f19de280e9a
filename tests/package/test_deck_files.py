"""Decks of several files: what is written where, and the sets in them."""

from __future__ import annotations

import os

import pytest
from harness import ROOT
from keyway import Deck, DeckError

MAIN = """*INCLUDE, INPUT=parts/mesh.inp
*MATERIAL, NAME=CONCRETE
*AMPLITUDE, NAME=MOTION, INPUT=motion.txt
*STEP
*END STEP
"""
MESH = """*NODE, NSET=ALL
*INCLUDE, INPUT=nodes.txt
*ELEMENT, TYPE=C3D8, ELSET=DAM
1, 1, 2, 3, 4,
 5, 6, 7, 8
7, 1,2,3,4,5,6,7,8
*NSET, NSET=Base, GENERATE
1, 5, 2
2, 2
*NSET, NSET=CREST
BASE, 8
"""


@pytest.fixture
def deck(tmp_path) -> Deck:
    folder = tmp_path / "first"
    (folder / "parts").mkdir(parents=True)
    (folder / "dam.inp").write_text(MAIN)
    (folder / "parts/mesh.inp").write_text(MESH)
    (folder / "parts/nodes.txt").write_text("".join(f"{n}, 0., 0., 0.\n" for n in range(1, 9)))
    (folder / "motion.txt").write_text("0. 0.\n")
    return Deck(folder / "dam.inp")


def test_sets(deck):
    assert deck.node_set("ALL").tolist() == [1, 2, 3, 4, 5, 6, 7, 8]
    assert deck.node_set("base").tolist() == [1, 2, 3, 5]
    assert deck.node_set("CREST").tolist() == [1, 2, 3, 5, 8]
    assert deck.element_set("DAM").tolist() == [1, 7]
    deck.add_node_set("TOP", ["CREST", *range(6, 8)])
    assert deck.node_set("TOP").tolist() == [1, 2, 3, 5, 6, 7, 8]
    assert deck.text().startswith("*INCLUDE, INPUT=parts/mesh.inp\n*NSET, NSET=TOP\nCREST, 6, 7\n")
    with pytest.raises(DeckError, match="expected members"):
        deck.add_element_set("NONE", [])


def test_data_below_an_included_file_go_on_with_the_card_above(tmp_path):
    """As the program reads them; they were lost from the sets."""
    (tmp_path / "nodes.txt").write_text("1, 0., 0., 0.\n")
    text = "*NODE, NSET=ALL\n*INCLUDE, INPUT=nodes.txt\n** more\n2, 0., 0., 1.\n*STEP\n"
    deck = Deck.from_text(text, tmp_path / "dam.inp")
    assert deck.node_set("ALL").tolist() == [1, 2]
    assert deck.text() == text


def test_a_range_that_is_none_is_named(tmp_path):
    deck = Deck.from_text("*NSET, NSET=A, GENERATE\n9, 1, -1\n", tmp_path / "dam.inp")
    with pytest.raises(
        DeckError, match=r"dam.inp:1: \*NSET: found '9, 1, -1'; expected first, last"
    ):
        deck.node_set("A")


def test_elsewhere_the_other_files_are_named_where_they_are(deck, tmp_path):
    target = tmp_path / "second/case/dam.inp"
    assert deck.write(target) == [target]
    text = target.read_text()
    assert "*INCLUDE, INPUT=../../first/parts/mesh.inp\n" in text
    assert "INPUT=../../first/motion.txt\n" in text
    assert Deck(target).node_set("CREST").tolist() == [1, 2, 3, 5, 8]


def test_changed_files_are_written_beside_the_new_deck(deck, tmp_path):
    deck.card("NSET", NSET="CREST").data[0][1] = 7
    target = deck.path.with_name("higher.inp")
    assert deck.write(target) == [target, target.with_name("higher_mesh.inp")]
    assert Deck(target).node_set("CREST").tolist() == [1, 2, 3, 5, 7]
    assert Deck(deck.path).node_set("CREST").tolist() == [1, 2, 3, 5, 8]
    assert "INPUT=parts/nodes.txt" in target.with_name("higher_mesh.inp").read_text()
    assert "INPUT=higher_mesh.inp" in target.read_text()


def test_a_change_deep_down_changes_all_that_name_it(deck, tmp_path):
    deck.cards[3].data[0][0] = 9
    names = {path.name for path in deck.write(tmp_path / "deep.inp")}
    assert names == {"deep.inp", "deep_mesh.inp", "deep_nodes.txt"}
    assert 9 in Deck(tmp_path / "deep.inp").node_set("ALL")


def test_in_place_only_changed_files_are_written(deck):
    assert deck.write() == []
    before = {path: path.stat().st_mtime_ns for path in deck.files}
    deck.card("NSET", NSET="CREST").data[0][1] = 7
    assert [path.name for path in deck.write()] == ["mesh.inp"]
    assert not deck.is_changed
    changed = [path.name for path in deck.files if path.stat().st_mtime_ns != before[path]]
    assert changed == ["mesh.inp"]


def test_no_file_that_is_read_is_lost(deck):
    for name in ("motion.txt", "parts/mesh.inp"):
        with pytest.raises(DeckError, match="reads this file"):
            deck.write(deck.path.parent / name)


def test_missing_files_and_cycles_are_named(tmp_path):
    path = tmp_path / "dam.inp"
    path.write_text("*HEADING\n*INCLUDE, INPUT=none.inp\n")
    with pytest.raises(DeckError, match=r"dam\.inp:2: \*INCLUDE: No such file"):
        Deck(path)
    path.write_text("*INCLUDE, INPUT=dam.inp\n")
    with pytest.raises(DeckError, match="includes itself"):
        Deck(path)
    with pytest.raises(FileNotFoundError):
        Deck(tmp_path / "none.inp")


def test_paths_with_blanks(tmp_path):
    folder = tmp_path / "a folder"
    folder.mkdir()
    (folder / "mesh, fine.inp").write_text("*NODE\n1, 0., 0., 0.\n")
    path = folder / "dam.inp"
    path.write_text('*INCLUDE, INPUT="mesh, fine.inp"\n')
    Deck(path).write(tmp_path / "other/dam.inp")
    assert len(Deck(tmp_path / "other/dam.inp").cards) == 2
    text = (tmp_path / "other/dam.inp").read_text()
    assert text == f'*INCLUDE, INPUT="{os.path.join("..", "a folder", "mesh, fine.inp")}"\n'  # noqa: PTH118


def test_the_program_reads_what_was_written(keyway, tmp_path):
    """Water and density of a dam twice those of the deck: the base carries twice the thrust."""
    deck = Deck(ROOT / "input/monolith_water.inp")
    once = keyway(deck.path).csv("node_BASE")["RF1"].sum()
    deck.card("RESERVOIR").parameters["DENSITY"] = 2000.0
    deck.write(tmp_path / "double.inp")
    twice = keyway(tmp_path / "double.inp").csv("node_BASE")["RF1"].sum()
    assert twice == pytest.approx(2.0 * once, rel=1e-9)  # linear; residuals of 1e-12


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8"])
@pytest.mark.parametrize("on_disk", ["latin-1", "utf-8"])
def test_names_with_umlauts(tmp_path, encoding, on_disk):
    """Decks and names of files in both encodings; a changed deck keeps its own where it can."""
    path = tmp_path / "dam.inp"
    path.write_bytes("*INCLUDE, INPUT=Hügel.inp\n*STEP\n*END STEP\n".encode(encoding))
    included = tmp_path / os.fsdecode("Hügel.inp".encode(on_disk))
    included.write_bytes("*NODE, NSET=SÄULE\n3, 0., 0., 0.\n".encode(encoding))
    deck = Deck(path)
    assert deck.node_set("sÄule").tolist() == [3]
    deck.add_node_set("FÜSSE", [3])
    deck.write()
    assert "FÜSSE" in path.read_bytes().decode(encoding)
    assert Deck(path).node_set("FÜSSE").tolist() == [3]
    copy = Deck(path)
    copy.write(tmp_path / "other/dam.inp")
    assert Deck(tmp_path / "other/dam.inp").node_set("FÜSSE").tolist() == [3]
    deck.add_node_set("Ω", [3])
    deck.write()
    assert "Ω" in path.read_text(encoding="utf-8")
    assert Deck(path).node_set("FÜSSE").tolist() == [3]
