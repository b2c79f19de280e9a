"""Numbers that make no sense are refused with what was expected, before anything is written."""

import make_dam
import make_jinping
import make_motion
import make_temperature
import pytest
from keyway_tools.option_types import (
    above_zero,
    count,
    count_from_zero,
    deck_path,
    finite,
    from_zero,
)

BAD = [
    (make_dam, "-o .", ".: expected the name of a deck"),
    (make_dam, "--joints -1", "-1: expected a whole number, 0 or more"),
    (make_dam, "--unknowns -3", "-3: expected a whole number, 1 or more"),
    (make_dam, "--friction nan", "nan: expected a number of 0 or more"),
    (make_dam, "--increment 0", "0: expected a number above 0"),
    (make_dam, "--crest-overhang inf", "inf: expected a finite number"),
    (make_dam, "--concrete -1 0.2 2400", "--concrete -1 0.2 2400: expected E above 0"),
    (make_dam, "--rock 1e9 0.5", "expected E above 0, NU in -1..0.5"),
    (make_dam, "--damping 0.05 0 0", "expected frequencies above 0, F1 below F2"),
    (make_dam, "--lifts 2 --grouting 1 2 --temperatures 1e-5 16 10 --seasons a.csv nan 1",
     "expected a file and two numbers above 0"),
    (make_dam, "--joint-places 900", "900 m is not on the crest; expected 0 to 444.86 m"),
    (make_dam, "--joint-places 20 30 --joints 3", "20 and 30 m are nearest to one column"),
    (make_dam, "--lifts 0", "0: expected a whole number, 1 or more"),
    (make_dam, "--lifts 3 --grouting 3 --grout-pressure -1", "-1: expected a number of 0 or more"),
    (make_dam, "--corbel-depth 0", "0: expected a number above 0"),
    (make_dam, "--water -1", "-1: expected a number of 0 or more"),
    (make_motion, "--pga nan", "nan: expected a number above 0"),
    (make_motion, "--pga -1", "-1: expected a number above 0"),
    (make_motion, "--factor nan", "nan: expected a finite number"),
    (make_motion, "--tg 0", "0: expected a number above 0"),
    (make_motion, "--seed -1", "-1: expected a whole number, 0 or more"),
    (make_motion, "--record a.at2 --resample -1", "-1: expected a number above 0"),
    (make_motion, "--duration 1e9", "expected 50 to 1e+06 times dt"),
    (make_temperature, "dam.inp --air nan 10", "nan: expected a finite number"),
    (make_temperature, "dam.inp --air 9 9 --year 0", "0: expected a number above 0"),
    (make_temperature, "dam.inp --air 9 9 --diffusivity 0", "0: expected a number above 0"),
    (make_temperature, "dam.inp --air 9 9 --harmonics 0", "0: expected a whole number, 1 or more"),
    (make_jinping, "dam.inp --unknowns 0", "0: expected a whole number, 1 or more"),
]  # fmt: skip


def test_a_fault_of_an_option_is_one_sentence(capsys):
    """Without the usage, which is 41 lines of make_dam."""
    with pytest.raises(SystemExit):
        make_dam.main(["--height", "-3"])
    said = capsys.readouterr().err
    words = "argument --height: -3: expected a number above 0 (--help shows all options)\n"
    assert said.partition(": ")[2] == words


@pytest.mark.parametrize(("tool", "options", "expected"), BAD)
def test_numbers_without_sense_are_refused(tmp_path, monkeypatch, capsys, tool, options, expected):
    monkeypatch.chdir(tmp_path)
    try:
        code = tool.main(options.split())
    except SystemExit as stop:
        code = stop.code
    assert code == 2
    assert expected in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_numbers_with_sense_are_taken():
    assert (finite("-1e3"), above_zero("2"), from_zero("0")) == (-1000.0, 2.0, 0.0)
    assert (count("1"), count_from_zero("0")) == (1, 0)


def test_temperatures_of_a_deck_with_parts(tmp_path, capsys):
    deck = tmp_path / "parts.inp"
    deck.write_text("*PART, NAME=P\n*NODE\n1, 0., 0., 0.\n*END PART\n")
    assert make_temperature.main([str(deck), "--air", "9", "9"]) == 2
    told = capsys.readouterr().err
    assert "has parts and instances (*PART); expected *NODE and *ELEMENT outside of parts" in told
    assert "refined" not in told


@pytest.mark.parametrize("name", ["my/d am", "my/d am.inp", "dam.v2", "DAM.INP"])
def test_decks_end_in_inp(name):
    path = deck_path(name)
    assert path.suffix.lower() == ".inp"
    assert str(path) in (name, f"{name}.inp")
