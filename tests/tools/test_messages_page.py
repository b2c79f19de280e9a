"""docs/messages.md is what tools/make_messages.py makes of the program's own pages."""

from pathlib import Path

import make_messages

PAGE = """\
no-support
  A body can move without a force: *BOUNDARY is missing, and the equations have no solution, which
  a run would find out.

What to do
  Hold the body. keyway --check names it; docs/tutorials/first_dam.md has supports.

Example
  in place of  *BOUNDARY missing
  take         *BOUNDARY; BASE, 1, 3
"""


def test_page_is_that_of_the_program(program_path: Path) -> None:
    expected = make_messages.render(program_path.resolve())
    assert make_messages.PAGE.read_text(encoding="utf-8") == expected, (
        "docs/messages.md is out of date: run python tools/make_messages.py"
    )


def test_a_page_becomes_a_section() -> None:
    text = make_messages.section(PAGE)
    assert text.startswith("## no-support\n\nA body can move without a force: \\*BOUNDARY is")
    assert "`keyway --check` names it; [tutorials/first_dam.md](tutorials/first_dam.md)" in text
    assert text.endswith("In place of `*BOUNDARY missing` take `*BOUNDARY; BASE, 1, 3`.\n")
