"""Writes docs/keywords.md, the reference of all keywords, from the output of the program, and the
parameters of each keyword for the reader of decks in Python.

usage: make_keywords.py [--program PATH] [-o FILE] [--parameters FILE]
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import textwrap
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "keywords.md"
PARAMETERS = ROOT / "tools" / "keyway" / "deck" / "parameters.json"
WIDTH = 116  # letters of a line of the page
HELP_WIDTH = 96  # letters of a line of keyway --keywords
FIELD_WIDTH = 21  # where the text of a parameter begins in keyway --keywords

INTRODUCTION = """\
# Keywords

All keywords of a deck: what each of them takes, with kinds, ranges, units and defaults.
[deck.md](deck.md) has the rules that hold for all of them. `keyway --keywords NAME` prints the same
text for one keyword.

This page is generated. After a change of a keyword run `python tools/make_keywords.py`; a test
compares the page with the program.
"""


@dataclass
class Keyword:
    """One keyword at one place of the deck."""

    name: str
    remark: str  # 'not available yet' and the like, or nothing
    place: str
    meaning: list[str] = field(default_factory=list)  # paragraphs
    blocks: list[tuple[str, list[tuple[str, str]]]] = field(default_factory=list)
    about: dict[str, list[str]] = field(default_factory=dict)  # texts above the rows
    example: list[str] = field(default_factory=list)


def ask(program: Path, *names: str) -> str:
    """The output of keyway --keywords."""
    command = [str(program), "--keywords", *names]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def read_families(text: str) -> list[tuple[str, list[str]]]:
    """Families and the names of their keywords, in the order of the program."""
    families: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if re.match(r"[A-Z]", line):
            families.append((line.strip().capitalize(), []))
        elif found := re.match(r"  \*(.{30,}?) (?=\S)", line):
            families[-1][1].append(found[1].strip())
    return families


def join_wrapped(lines: list[str]) -> list[str]:
    """Paragraphs of wrapped lines: a line ends a paragraph if the next word would have fitted."""
    paragraphs: list[str] = []
    last = ""
    for line in lines:
        word = line.split()[0]
        if paragraphs and len(last) + 1 + len(word) > HELP_WIDTH:
            paragraphs[-1] += " " + line.strip()
        else:
            paragraphs.append(line.strip())
        last = line
    return paragraphs


def read_rows(lines: list[str]) -> list[tuple[str, str]]:
    """Name and text of each field."""
    rows: list[tuple[str, str]] = []
    for line in lines:
        if line.startswith(" " * FIELD_WIDTH):
            rows[-1] = (rows[-1][0], rows[-1][1] + " " + line.strip())
        elif line[FIELD_WIDTH - 2 : FIELD_WIDTH] == "  " or line[FIELD_WIDTH - 1] == " ":
            rows.append((line[:FIELD_WIDTH].strip(), line[FIELD_WIDTH:].strip()))
        else:  # a name that is longer than its column
            found = re.match(r"  ([A-Z0-9 -]+) (?=\S)", line)
            rows.append((found[1], line[found.end() :].strip()))
    return rows


def read_keywords(text: str) -> list[Keyword]:
    """The keywords of the answer to keyway --keywords NAME."""
    keywords: list[Keyword] = []
    title, lines = "", []

    def close() -> None:
        if not keywords or not lines:
            return
        if title == "meaning":
            keywords[-1].meaning = join_wrapped(lines)
        elif title == "Example":
            keywords[-1].example = [line[2:] for line in lines]
        else:
            keywords[-1].blocks.append((title, read_rows(lines)))

    for line in [*text.splitlines(), "*END  (of text)"]:
        head = re.match(r"\*(.*?)(?: \(([^()]*)\))?  \((.*)\)$", line)
        if title.startswith("With ") and not line and lines and title not in keywords[-1].about:
            keywords[-1].about[title] = join_wrapped(lines)
            lines = []
            continue
        if not head and (not line or line.startswith("  ")):
            lines += [line] if line else []
            continue
        close()
        title, lines = line, []
        if head:
            keywords.append(Keyword(head[1], head[2] or "", head[3]))
            title = "meaning"
        elif line == "No data lines":
            keywords[-1].blocks.append((line, []))
    return keywords[:-1]


def escaped(text: str) -> str:
    """Text of the program as Markdown."""
    return re.sub(r"([*<>|])", r"\\\1", text)


def wrapped(text: str, first: str = "", later: str = "") -> str:
    """A paragraph; no line of it begins like a list or a quotation."""
    lines = textwrap.wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(
        [lines[0], *(re.sub(r"^(\s*)([-+#])(?=\s)", r"\1\\\2", line) for line in lines[1:])]
    )


def section(keyword: Keyword) -> str:
    """The Markdown of one keyword."""
    place = keyword.place[0].upper() + keyword.place[1:]
    status = f" **{keyword.remark.capitalize()}.**" if keyword.remark else ""
    parts = [f"### *{keyword.name}", f"{place}.{status}"]
    parts += [wrapped(escaped(paragraph)) for paragraph in keyword.meaning]
    for title, rows in keyword.blocks:
        parts.append(f"**{title}**" if rows else f"{title}.")
        parts += [wrapped(escaped(paragraph)) for paragraph in keyword.about.get(title, [])]
        if rows:
            parts.append(
                "\n".join(wrapped(f"`{name}`: {escaped(text)}", "- ", "  ") for name, text in rows)
            )
    if keyword.example:
        # A fence, because an indented block below a list would belong to the last item.
        parts.append("\n".join(["```", *keyword.example, "```"]))
    return "\n\n".join(parts) + "\n"


def render(program: Path) -> str:
    """The whole page."""
    parts, seen = [INTRODUCTION], {}
    for family, names in read_families(ask(program)):
        parts.append(f"## {family}\n")
        for name in names:
            # A keyword with two places is listed twice and described in that order.
            place = seen.get(name, 0)
            seen[name] = place + 1
            parts.append(section(read_keywords(ask(program, name))[place]))
    return "\n".join(parts)


def render_parameters(program: Path) -> str:
    """The names of the parameters of each keyword as JSON, a line a keyword."""
    names = [name for _, family in read_families(ask(program)) for name in family]
    found: dict[str, list[str]] = {name: [] for name in sorted(names)}
    for name, parameters in found.items():
        for keyword in read_keywords(ask(program, name)):
            for title, rows in keyword.blocks:
                if title == "Parameters" or title.startswith("With "):
                    parameters += [row[0] for row in rows if row[0] not in parameters]
    lines = [f"{json.dumps(name)}: {json.dumps(sorted(own))}" for name, own in found.items()]
    return "{\n " + ",\n ".join(lines) + "\n}\n"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    parser.add_argument("--parameters", type=Path, default=PARAMETERS)
    options = parser.parse_args(arguments)
    options.output.write_text(render(options.program), encoding="utf-8")
    options.parameters.write_text(render_parameters(options.program), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
