"""Tools read decks in Latin-1 as the program does."""

import doctest
import sys

import h5py
import pytest
from harness import ROOT
from keyway_tools import deck_bytes
from keyway_tools.concrete_constants import main
from keyway_tools.report.values import deck_of
from keyway_tools.si_results import SiResults
from keyway_tools.study.deck_cards import read_deck

# A byte of the second comment ends a line for str.splitlines.
DECK = (
    (ROOT / "tests/errors/base/concrete.inp")
    .read_text()
    .replace("*NODE,", "** Höhe über Grund\n** usw\x85 Größe\n*HEADING\nMauer über Tal\n*NODE,", 1)
    .replace("ELSET=DAM", "ELSET=MAUERÄ")
    .replace("DAM, GRAV", "MAUERÄ, GRAV")
    .replace("CONCRETE\n*DENSITY", "BETÖN\n*DENSITY")
    .replace("MATERIAL=CONCRETE", "MATERIAL=BETÖN")
)


@pytest.fixture(params=["latin-1", "utf-8", "utf-8-sig"])
def path(request, tmp_path):
    path = tmp_path / "job.inp"
    path.write_bytes(DECK.replace("\n", "\r\n").encode(request.param))
    return path


def test_example_of_the_reader():
    assert doctest.testmod(deck_bytes).failed == 0


def test_decks_that_are_written_again_keep_their_names(path, keyway):
    text = read_deck(path).text()
    assert "MAUERÄ" in text and "BETÖN" in text and "Größe" not in text
    written = keyway(text, name="again").json
    assert written["status"] == "finished"


def test_names_of_materials_are_whole_in_the_results(keyway):
    """80 letters of two bytes each, the last of which tells two materials apart."""
    names = ["Ä" * 79 + last for last in "ÖÜ"]
    second = (
        DECK[DECK.index("*MATERIAL, NAME=BETÖN") :].split("*SOLID")[0].replace("BETÖN", names[1])
    )
    run = keyway(second + DECK.replace("BETÖN", names[0]))
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        assert {name.decode() for name in file["mesh/material_names"][:]} >= set(names)


def test_report_shows_the_remarks(path, keyway):
    run = keyway(path)
    header = deck_of(SiResults(run.folder))
    assert header.title == "Mauer über Tal"
    assert "Höhe über Grund" in header.remarks
    assert header.caution == ""


def test_constants_of_concrete_have_its_name(path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["make_umat", str(path)])
    main()
    assert "*MATERIAL, NAME=BETÖN\n" in capsys.readouterr().out
