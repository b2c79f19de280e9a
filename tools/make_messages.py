#!/usr/bin/env python3
"""Writes docs/messages.md, the pages on the messages of the program, from the program's output.

usage: make_messages.py [--program PATH] [-o FILE]
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "messages.md"
WIDTH = 116  # letters of a line of the page

INTRODUCTION = """\
# Messages: questions and answers

Each message of the program ends with the short name of its kind in brackets:

    dam.inp:12: *ELASTIC: found '31 GPa'; expected Young's modulus, a number > 0 [Pa] [wrong-value]

Below is the page of every kind: what has happened, and what to do. `keyway --explain wrong-value`
prints the same. Names stay the same from version to version; the words of messages may change
([versions](versions.md)).

This page is generated. After a change of a page run `python tools/make_messages.py`; a test
compares the page with the program.
"""


def ask(program: Path, *name: str) -> str:
    """The output of keyway --explain."""
    command = [str(program), "--explain", *name]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def names_of(program: Path) -> list[str]:
    """The names of all pages, in the order of the program."""
    pages, _, _ = ask(program).partition("\n\n")
    return re.findall(r"^([a-z][a-z0-9-]*) ", pages, re.MULTILINE)


def section(text: str) -> str:
    """The section of one page from what the program prints."""
    name, _, rest = text.partition("\n")
    cause, _, rest = rest.partition("\n\nWhat to do\n")
    remedy, _, example = rest.partition("\n\nExample\n")
    parts = [f"## {name}", wrapped(cause), f"{wrapped(f'What to do: {remedy}')}"]
    if example:
        wrong, right = re.findall(r"^  (?:in place of|take) +(\S.*)$", example, re.MULTILINE)
        parts.append(f"In place of `{wrong}` take `{right}`.")
    return "\n\n".join(parts) + "\n"


def wrapped(text: str) -> str:
    """A paragraph of the page."""
    words = re.sub(r"\bdocs/((\w+/)*\w+\.md)", r"[\1](\1)", " ".join(text.split()))
    words = re.sub(r"(keyway --[a-z]+(?: NAME| FILE)?)", r"`\1`", words).replace("*", "\\*")
    return textwrap.fill(words, WIDTH, break_long_words=False, break_on_hyphens=False)


def render(program: Path) -> str:
    """The whole page."""
    return "\n".join([INTRODUCTION, *(section(ask(program, n)) for n in names_of(program))])


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    options = parser.parse_args(arguments)
    options.output.write_text(render(options.program), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
