"""The small decks of input/ are what the tool writes, and their meshes are valid."""

import shutil

import make_input
import pytest
from keyway_tools.small_decks import SMALL_DECKS


@pytest.mark.parametrize("name", SMALL_DECKS)
def test_committed_deck_is_what_the_tool_writes(name):
    assert (make_input.INPUT / name).read_text() == SMALL_DECKS[name]()


DECKS = [name for name in SMALL_DECKS if name.endswith(".inp") and not name.startswith("meshes/")]


@pytest.mark.parametrize("name", DECKS)
def test_header_gives_purpose_assumptions_and_results(name):
    header = "\n".join(line for line in SMALL_DECKS[name]().splitlines() if line.startswith("**"))
    for word in ("** Shows:", "** Assumes:", "** Expect"):
        assert word in header
    assert any(word in header for word in ("Source:", "from the statics"))
    assert max(map(len, header.splitlines())) <= 110


def test_the_tutorial_shows_cards_of_its_deck():
    """The page named RECOVERY=ENERGY, which the deck did not have."""
    page = (make_input.INPUT.parent / "docs/tutorials/cracking_dam.md").read_text()
    cards = [line.strip() for line in page.splitlines() if line.startswith("    *")]
    assert cards and set(cards) <= set(SMALL_DECKS["cracking_monolith.inp"]().splitlines())


def test_committed_dam_is_what_the_tools_describe():
    """Sizes in the deck's header and files on the disk; the record itself depends on the FFT."""
    folder = make_input.INPUT / "xingbiling_matching"
    deck = (folder / "xingbiling_matching.inp").read_text()
    for words in ("height 135.5 m", "crest arc 444.86 m", "2 vertical planes", "LEVEL=105"):
        assert words in deck
    for name in ("README.md", "xingbiling_matching_mesh.inp", "motion_x.txt", "motion.json"):
        assert (folder / name).exists()


def test_main_dam_is_what_the_tool_writes(keyway, tmp_path):
    """The deck as it is kept; its mesh is made; the program takes both and starts well."""
    kept = make_input.INPUT / "xingbiling"
    folder = tmp_path / "xingbiling"
    folder.mkdir()
    for axis in "xyz":
        shutil.copy(kept / f"motion_{axis}.txt", folder)
    make_input.main([str(tmp_path), "--only", "main"])
    deck = folder / "xingbiling.inp"
    text = deck.read_text()
    assert text == (kept / "xingbiling.inp").read_text()
    short = text.replace("0.01, 20\n", "0.01, 0.02\n").replace("*FREQUENCY\n8\n", "*FREQUENCY\n1\n")
    assert short != text
    deck.write_text(short)
    run = keyway(deck)
    assert run.json["model"]["unknowns"] >= 40_000
    assert [step["name"] for step in run.json["steps"]] == ["WEIGHT", "MODES", "EARTHQUAKE"]
