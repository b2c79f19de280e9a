"""The tables of bad decks: edits, places, carets, and how changed messages get into a table."""

import stat
import sys
from pathlib import Path

import error_cases
import pytest
import update_errors
from error_cases import apply, expand, shorten

DECK = "*NODE\n1, 0.\n*ELEMENT\n1, 2\n*NODE\n1, 9.\n"
FILES = {"deck.inp": DECK, "record.txt": "0.3 Inf\n"}
OUTPUT = """deck.inp:6: *NODE: node 1 is defined twice
    6 | 1, 9.
      | ^
  first defined here: deck.inp:2
    2 | 1, 0.
      | ^
deck.inp:5: *NODE: one datum is missing
    5 | *NODE
      |      ^
record.txt:1: *AMPLITUDE: found 'Inf'
    1 | 0.3 Inf
      |     ^^^
deck.inp:3: *ELEMENT: warning: of no effect
and 4 more
"""
SAYS = """*NODE: node 1 is defined twice
    {1}, 9.
  first defined here:
    {1}, 0.
*NODE: one datum is missing
    *NODE{} #2
*AMPLITUDE: found 'Inf'
    0.3 {Inf}
*ELEMENT: warning: of no effect
    *ELEMENT
and 4 more
"""


def test_places_become_the_full_output():
    assert expand(SAYS, FILES) == OUTPUT
    assert shorten(OUTPUT, FILES) == SAYS


@pytest.mark.parametrize(
    ("word", "other"),
    [
        ("is defined twice", "is defined again"),
        ("{1}, 9.", "{1,} 9."),
        ("{1}, 0.", "1, {0.}"),
        (" #2", ""),
        ("    *ELEMENT\n", "    {*ELEMENT}\n"),
        ("and 4 more", "and 5 more"),
    ],
)
def test_every_change_of_a_table_shows(word, other):
    assert word in SAYS
    assert expand(SAYS.replace(word, other), FILES) != OUTPUT


def test_a_line_that_no_deck_has_is_a_fault():
    with pytest.raises(AssertionError, match=r"no deck has 1 lines '2, 9\.'"):
        expand("*NODE: wrong\n    {2}, 9.\n", FILES)


@pytest.mark.parametrize(
    ("edit", "made"),
    [
        ([], DECK),
        (["+*HEADING"], "*HEADING\n" + DECK),
        (["-1, 2", "+1, 3"], DECK.replace("1, 2", "1, 3")),
        ([" *ELEMENT", " *NODE", "+2, 0.", "-1, 9."], DECK.replace("1, 9.", "2, 0.")),
        ([" 1, 9.", "+*STEP"], DECK + "*STEP\n"),
    ],
)
def test_edits(edit, made):
    assert apply(DECK, edit) == made


@pytest.mark.parametrize("edit", [["-9, 9."], [" 1, 9.", "-*ELEMENT"], ["*NODE"]])
def test_an_edit_that_does_not_fit_is_a_fault(edit):
    with pytest.raises(AssertionError):
        apply(DECK, edit)


TABLE = """# A table.
base = "small"

[first]
edit = ['-1, 2', '+1, 3']
says = '''
*ELEMENT: old words
    1, {3}
'''

[warning_second]
says = '''
*NODE: warning: old words
    *NODE
'''
"""


@pytest.fixture
def table(tmp_path, monkeypatch) -> Path:
    """A table in a folder of its own."""
    (tmp_path / "base").mkdir()
    (tmp_path / "base" / "small.inp").write_text(DECK)
    path = tmp_path / "small.toml"
    path.write_text(TABLE)
    monkeypatch.setattr(error_cases, "ERRORS", tmp_path)
    return path


def make_program(path: Path, code: int, says: str) -> str:
    """A program that prints a text to stderr and ends with a code."""
    (path.parent / "text").write_text(says)
    path.write_text(f"#!/bin/sh\ncat {path.parent / 'text'} >&2\nexit {code}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_changed_messages_get_into_the_table(table, tmp_path, capsys):
    output = "deck.inp:4: *ELEMENT: new words\n    4 | 1, 3\n      | ^\n"
    program = make_program(tmp_path / "program", 2, output)
    assert update_errors.main(["--program", program, "first"]) == 0
    assert capsys.readouterr().out == "first: updated\n"
    assert table.read_text() == TABLE.replace(
        "old words\n    1, {3}", "new words\n    {1}, 3"
    )  # the second case stays
    assert next(c for c in error_cases.read_tables() if c.name == "first").stderr == output
    assert update_errors.main(["--program", program, "first"]) == 0
    assert capsys.readouterr().out == ""


def test_another_exit_code_is_reported(table, tmp_path, capsys):
    program = make_program(tmp_path / "program", 2, "deck.inp:1: *NODE: an error now\n")
    assert update_errors.main(["--program", program, "warning_second"]) == 1
    assert "exit code 2, expected 0" in capsys.readouterr().out
    assert table.read_text() == TABLE


def test_two_cases_of_one_name_are_a_fault(table):
    (table.parent / "other.toml").write_text(TABLE)
    with pytest.raises(AssertionError, match="first, warning_second"):
        error_cases.read_tables()


def test_a_key_that_nothing_reads_is_a_fault(table):
    table.write_text(TABLE.replace("edit", "edits"))
    with pytest.raises(AssertionError, match="unknown key edits"):
        error_cases.read_tables()


def test_an_unknown_case_is_a_fault_of_usage(table):
    with pytest.raises(SystemExit):
        update_errors.main(["--program", sys.executable, "third"])
