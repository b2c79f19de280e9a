"""docs/keywords.md is what tools/make_keywords.py makes of the program's own reference."""

from pathlib import Path

import make_keywords


def test_page_is_that_of_the_program(program_path: Path) -> None:
    expected = make_keywords.render(program_path.resolve())
    assert make_keywords.PAGE.read_text(encoding="utf-8") == expected, (
        "docs/keywords.md is out of date: run python tools/make_keywords.py"
    )


def test_parameters_for_python_are_those_of_the_program(program_path: Path) -> None:
    expected = make_keywords.render_parameters(program_path.resolve())
    assert make_keywords.PARAMETERS.read_text(encoding="utf-8") == expected, (
        "tools/keyway/deck/parameters.json is out of date: run python tools/make_keywords.py"
    )


HELP = """\
*JOINT LAW  (in the model)
  The law of a contraction joint, which is wrapped where the line of the page has no more room
  for the next word.
  A second paragraph.

Parameters
  KN                 normal stiffness; a number > 0 [Pa/m]; default E/THICKNESS of the slave
                     side
  COMPRESSION RECOVERY w_c of Eq. 16; a number; default 1

No data lines

Example
  *JOINT LAW, NAME=A
  1, 2
"""


def test_answer_of_the_program_is_read() -> None:
    (keyword,) = make_keywords.read_keywords(HELP)
    assert (keyword.name, keyword.remark, keyword.place) == ("JOINT LAW", "", "in the model")
    assert keyword.meaning[0].endswith("has no more room for the next word.")
    assert keyword.meaning[1:] == ["A second paragraph."]
    parameters = dict(keyword.blocks[0][1])
    assert parameters["KN"].endswith("default E/THICKNESS of the slave side")
    assert parameters["COMPRESSION RECOVERY"] == "w_c of Eq. 16; a number; default 1"
    assert keyword.blocks[1] == ("No data lines", [])
    assert keyword.example == ["*JOINT LAW, NAME=A", "1, 2"]


def test_variants_of_a_keyword_have_a_text_of_their_own() -> None:
    variant = "With TYPE=SOFT\n  It gives.\n\n  G                  energy; a number; required\n\n"
    (keyword,) = make_keywords.read_keywords(
        HELP.replace("No data lines", variant + "No data lines")
    )
    assert keyword.about == {"With TYPE=SOFT": ["It gives."]}
    assert keyword.blocks[1] == ("With TYPE=SOFT", [("G", "energy; a number; required")])
    assert "**With TYPE=SOFT**\n\nIt gives.\n\n- `G`: energy" in make_keywords.section(keyword)


def test_keyword_with_two_places_has_two_sections() -> None:
    later = HELP.replace("LAW  (in the model)", "LAW (not available yet)  (in a step)")
    first, second = make_keywords.read_keywords(HELP + "\n" + later)
    assert (first.remark, first.place) == ("", "in the model")
    assert (second.remark, second.place) == ("not available yet", "in a step")
