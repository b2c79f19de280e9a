"""The small decks of input/ are what the tool writes, and their meshes are sound."""

import make_input
import pytest
from keyway_tools.small_decks import SMALL_DECKS


@pytest.mark.parametrize("name", SMALL_DECKS)
def test_committed_deck_is_what_the_tool_writes(name):
    assert (make_input.INPUT / name).read_text() == SMALL_DECKS[name]()


@pytest.mark.parametrize("name", [name for name in SMALL_DECKS if name.endswith(".inp")])
def test_header_says_what_it_shows_assumes_and_expects(name):
    header = SMALL_DECKS[name]().split("*NODE\n")[0]
    for word in ("** Shows:", "** Assumes:", "** Expect"):
        assert word in header
    assert any(word in header for word in ("Source:", "from the statics"))
    assert max(map(len, header.splitlines())) <= 110
