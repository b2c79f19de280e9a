#!/usr/bin/env python3
"""Write docs/fields.md, the fields of results, from `keyway --fields`."""

from __future__ import annotations

import argparse
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WIDTH = 116  # letters of a line of the page
NAME_WIDTH = 16  # where the values begin in keyway --fields NAME
TITLE = """# Fields of results

`tools/make_fields.py` writes this page from `keyway --fields`; a test compares both.
`keyway --fields NAME` prints one field. Units are those of a deck in SI units.
[results.md](results.md) describes the files and when they are written.

"""


def ask(program: Path, *words: str) -> str:
    """The output of keyway --fields."""
    done = subprocess.run([program, "--fields", *words], capture_output=True, text=True, check=True)
    return done.stdout


def read_page(text: str) -> dict[str, str]:
    """Names and values of a page of `keyway --fields NAME`; a value may go on in later lines."""
    page: dict[str, str] = {}
    for line in text.splitlines():
        if name := line[:NAME_WIDTH].strip():
            page[name] = line[NAME_WIDTH:]
        else:
            page[next(reversed(page))] += " " + line[NAME_WIDTH:]
    return page


def read_pages(program: Path) -> list[dict[str, str]]:
    """All fields, in the order of the program."""
    lines = ask(program).split("\n\n")[0].splitlines()[1:]
    return [read_page(ask(program, line.split()[0])) for line in lines]


def table(pages: list[dict[str, str]]) -> str:
    """The page of documentation."""
    cells = ("field", "meaning", "components", "where", "unit", "computed by")
    text = TITLE + "| " + " | ".join(cells) + " |\n" + len(cells) * "|---" + "|\n"
    for page in pages:
        text += "| " + " | ".join(page[cell] for cell in cells) + " |\n"
    for page in pages:
        text += f"\n## {page['field']}: {page['meaning']}\n"
        if "remark" in page:
            text += textwrap.fill(page["remark"], WIDTH, break_on_hyphens=False) + "\n\n"
        text += f"- requested by: {page['requested by']}\n- written to: {page['written to']}\n"
    return text


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/keyway")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs/fields.md")
    given = parser.parse_args(arguments)
    given.output.write_text(table(read_pages(given.program)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
