"""The units of a deck that the tools recognise from its log, and what they say of them."""

import contextlib
import io

import numpy as np
import pytest
from keyway.commands import plot
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.deck_units import open_in_si, recognise
from keyway_tools.report.values import verdict
from keyway_tools.si_results import Units
from synthetic_results import write_results

ECHO = """\
*NODE
** 698 data lines
*MATERIAL, NAME=CONCRETE
*DENSITY
{density}
*ELASTIC, TYPE=ISOTROPIC
{young}, 0.2
*MATERIAL, NAME=ROCK
*ELASTIC, TYPE=ISOTROPIC
{young}, 0.25
*STEP, NAME=WEIGHT, INC=100000
*ELASTIC
9e99
"""
NO_DENSITY = """\
*ELASTIC, TYPE=ISOTROPIC
{young}, 0.2
*STEP
"""


def log_of(folder, density, young):
    path = folder / "job.log"
    text = ECHO if density else NO_DENSITY
    path.write_text(text.format(density=density, young=young))
    return path


@pytest.mark.parametrize(
    ("density", "young", "units", "words"),
    [
        ("2400", "3e10", "m,Pa", ""),
        ("2.4e-09", "30000", "mm,MPa", "in mm and MPa (a *DENSITY of 2.4e-09 beside E = 30000)"),
        ("2.4", "3e7", "m,Pa", "not in SI (a *DENSITY of 2.4): give --units"),
        ("0.0024", "30000", "m,Pa", "not in SI (a *DENSITY of 0.0024): give --units"),  # MN, m
        ("2.4e-06", "3e7", "m,Pa", "not in SI (a *DENSITY of 2.4e-06): give --units"),  # kg, mm
        ("", "30000", "m,Pa", "not in SI (a Young's modulus of 30000): give --units"),
        ("", "3e10", "m,Pa", ""),
        ("** 40 data lines", "** 40 data lines", "m,Pa", ""),  # a law of a user's own: unknown
    ],
)
def test_units_that_a_log_shows(tmp_path, density, young, units, words):
    found = recognise(log_of(tmp_path, density, young))
    assert found.units == Units.parse(units)
    assert words in found.words
    assert bool(found.words) == bool(words) == bool(found.remark)


def test_without_a_log_nothing_is_said(tmp_path):
    assert recognise(tmp_path / "job.log").words == ""


@pytest.fixture
def column(tmp_path):
    mesh, _ = box_mesh((1, 1, 4), stretched((1.0, 1.0, 4.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh)
    log_of(tmp_path, "2.4e-09", "30000")
    return tmp_path


def test_results_of_a_deck_in_mm_are_converted_and_the_page_says_so(column, capsys):
    results = open_in_si(column, "job", None, "report")
    assert results.x.max() == pytest.approx(4.0e-3)
    assert "report: job: the deck is taken to be in mm and MPa" in capsys.readouterr().err
    assert any("in mm and MPa" in text for _, text in verdict(results))
    assert "deck in mm, MPa" in results.note


def test_given_units_count_and_nothing_is_said(column, capsys):
    results = open_in_si(column, "job", Units.parse("m,Pa"), "report")
    assert results.x.max() == 4.0
    assert "deck in" not in results.note
    assert capsys.readouterr().err == ""


def test_pictures_of_a_deck_in_mm(column, tmp_path):
    text = io.StringIO()
    with contextlib.redirect_stderr(text):
        assert plot.main([str(column), "-o", str(tmp_path / "p"), "--format", "svg"]) == 0
    assert "in mm and MPa" in text.getvalue()
    assert "deck in mm, MPa" in (tmp_path / "p" / "job_energy.svg").read_text()
