"""Reads the tables of bad decks in tests/errors; tests/errors/README.md describes the format."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ERRORS = Path(__file__).resolve().parent / "errors"
DECK = "deck.inp"
KEYS = {"base", "deck", "edit", "files", "options", "says"}
NAME = re.compile(r" \[([a-z][a-z0-9-]*)\]$", re.MULTILINE)  # of the kind of a message, at its end
PLACE = "    "  # begins the line of `says` that quotes the deck
EARLIER = "  "  # begins a line such as 'first defined here:', which ends with its place


@dataclass(frozen=True)
class Case:
    """A bad deck, its files, and the messages of the program."""

    name: str
    table: Path
    files: dict[str, str]
    options: list[str]
    says: str

    @property
    def code(self) -> int:
        """Exit code of the program: a warning lets the deck pass."""
        return 0 if self.name.startswith("warning_") else 2

    @property
    def stderr(self) -> str:
        """The expected output, every byte of it."""
        return expand(self.says, self.files)

    def run(self, program: Path, folder: Path) -> subprocess.CompletedProcess[str]:
        """Lets the program check the deck in a folder."""
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        command = [str(program.resolve()), "--check", *self.options, DECK]
        return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def without_names(stderr: str) -> str:
    """The messages without the names of their kinds, which the tables leave out."""
    return NAME.sub("", stderr)


def headlines(stderr: str) -> list[str]:
    """The first line of each message, without quoted lines, carets, places and sums."""
    quoted = re.compile(r" *\d* \| |  \S|and \d+ more ")
    return [line for line in stderr.splitlines() if not quoted.match(line)]


def base_decks() -> list[Path]:
    return sorted((ERRORS / "base").glob("*.inp"))


def read_tables() -> list[Case]:
    """All cases, in the order of the tables."""
    cases = [case for path in sorted(ERRORS.glob("*.toml")) for case in read_table(path)]
    names = [case.name for case in cases]
    twice = {name for name in names if names.count(name) > 1}
    assert not twice, f"two cases of one name: {', '.join(sorted(twice))}"
    return cases


def read_table(path: Path) -> list[Case]:
    """The cases of one table; what stands before the first case holds for all of them."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    shared = {key: value for key, value in content.items() if not isinstance(value, dict)}
    return [
        make_case(name, path, shared | own)
        for name, own in content.items()
        if isinstance(own, dict)
    ]


def make_case(name: str, table: Path, content: dict[str, Any]) -> Case:
    unknown = content.keys() - KEYS
    assert not unknown, f"{table.name}: {name}: unknown key {', '.join(sorted(unknown))}"
    if "deck" in content:
        deck = content["deck"]
    else:
        edit = content.get("edit", [])
        base = (ERRORS / "base" / f"{content['base']}.inp").read_text(encoding="utf-8")
        deck = apply(base, edit.splitlines() if isinstance(edit, str) else edit)
    files = {DECK: deck, **content.get("files", {})}
    return Case(name, table, files, content.get("options", []), content["says"])


def apply(text: str, edit: list[str]) -> str:
    """The deck with lines inserted (+) and removed (-); other lines ( ) give the place."""
    lines, done, made = text.splitlines(), 0, []
    for step in edit:
        sign, line = step[:1], step[1:]
        assert sign in ("+", "-", " "), f"'{step}': expected +, - or a blank before the line"
        if sign == "+":
            made.append(line)
            continue
        assert line in lines[done:], f"the base deck has no line '{line}' here"
        found = lines.index(line, done)
        made += lines[done : found + (sign == " ")]
        done = found + 1
    return "".join(f"{line}\n" for line in made + lines[done:])


def expand(says: str, files: dict[str, str]) -> str:
    """The full output: places get file and number, quoted lines their number and the carets."""
    lines, made = says.splitlines(), []
    for number, line in enumerate(lines):
        following = lines[number + 1] if number + 1 < len(lines) else ""
        if line.startswith(PLACE):
            assert number > 0, f"no message before '{line.strip()}'"
            made += quote(line, files)
        elif not following.startswith(PLACE):
            made.append(line)
        else:
            name, row, _ = find(following, files)
            is_earlier = line.startswith(EARLIER)
            made.append(f"{line} {name}:{row}" if is_earlier else f"{name}:{row}: {line}")
    return "".join(f"{line}\n" for line in made)


def quote(place: str, files: dict[str, str]) -> list[str]:
    """The line of the deck with the carets below the marked word; nothing where none is marked."""
    _, row, marked = find(place, files)
    if "{" not in marked:
        return []
    start, end = marked.index("{"), marked.index("}") - 1
    carets = " " * start + "^" * max(end - start, 1)  # {} marks the end of the line
    return [f"{row:5d} | {unmarked(marked)}", f"      | {carets}"]


def unmarked(line: str) -> str:
    return line.replace("{", "").replace("}", "")


def find(place: str, files: dict[str, str]) -> tuple[str, int, str]:
    """File, number and marked text of a line; `#2` after it means the second one alike."""
    text = place.removeprefix(PLACE)
    count = 1
    if counted := re.fullmatch(r"(.*) #(\d+)", text):
        text, count = counted[1], int(counted[2])
    places = occurrences(unmarked(text), files)
    assert len(places) >= count, f"no deck has {count} lines '{unmarked(text)}'"
    return (*places[count - 1], text)


def occurrences(line: str, files: dict[str, str]) -> list[tuple[str, int]]:
    """File and number of every line with this text."""
    return [
        (name, row)
        for name, content in files.items()
        for row, found in enumerate(content.splitlines(), 1)
        if found == line
    ]


def shorten(stderr: str, files: dict[str, str]) -> str:
    """The opposite of expand: what the key `says` of a case holds for this output."""
    lines, made = stderr.splitlines(), []
    number = 0
    while number < len(lines):
        line = lines[number]
        number += 1
        message = re.fullmatch(r"(\S+):(\d+): (.*)", line)
        earlier = re.fullmatch(r"( {2}\S.*:) (\S+):(\d+)", line)
        if not (message or earlier):
            made.append(line)
            continue
        groups = message.groups() if message else earlier.groups()  # type: ignore[union-attr]
        name, row, text = groups if message else (groups[1], groups[2], groups[0])
        carets = re.fullmatch(r" {6}\| ( *)(\^+)", "".join(lines[number + 1 : number + 2]))
        made += [text, place_of(name, int(row), carets, files)]
        number += 2 if carets else 0
    return "".join(f"{line}\n" for line in made)


def place_of(name: str, row: int, carets: re.Match[str] | None, files: dict[str, str]) -> str:
    """The line of `says` that names a place."""
    line = files[name].splitlines()[row - 1]
    count = occurrences(line, files).index((name, row)) + 1
    if carets:
        start, end = len(carets[1]), len(carets[1]) + len(carets[2])
        line = f"{line[:start]}{{{line[start:end]}}}{line[end:]}"
    return PLACE + line + (f" #{count}" if count > 1 else "")


def replace_says(table: Path, name: str, says: str) -> None:
    """Writes another `says` into a table and leaves everything else as it is."""
    text = table.read_text(encoding="utf-8")
    assert "'''" not in says, "a message with three quotes in a row does not fit into the table"
    pattern = rf"(^\[{re.escape(name)}\]\n(?:(?!\[\w+\]\n).*\n)*?says = ''')\n(?s:.*?)(^'''$)"
    made, count = re.subn(
        pattern, lambda m: f"{m[1]}\n{says}{m[2]}", text, count=1, flags=re.MULTILINE
    )
    assert count == 1, f"{table.name}: no says = ''' of [{name}]"
    table.write_text(made, encoding="utf-8")
