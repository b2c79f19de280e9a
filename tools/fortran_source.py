"""Reads logical lines and program units of Fortran sources, for the style checks."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

UNIT = re.compile(
    r"^(?:(?:pure|impure|elemental|recursive|non_recursive|module)\s+)*"
    r"(?:(?:real|integer|logical|character|complex|type)\s*(?:\([^()]*(?:\([^()]*\)[^()]*)*\))?\s+)?"
    r"(?:(?:pure|impure|elemental|recursive|module)\s+)*"
    r"(?P<kind>subroutine|function|procedure)\s+(?P<name>\w+)\s*(?P<arguments>\([^)]*\))?"
)
END_UNIT = re.compile(r"^end\s*(?:subroutine|function|procedure)\b")


@dataclass(frozen=True)
class Statement:
    """A statement with its continuation lines joined, comments and texts taken out."""

    line: int
    text: str


@dataclass
class Procedure:
    """A subroutine or function: its place, length without those it contains, and arguments."""

    name: str
    line: int
    lines: int
    arguments: list[str] = field(default_factory=list)
    deepest: int = 0


def bare(line: str) -> str:
    """The line in lower case, without comment and without the contents of texts."""
    kept, quote = [], ""
    for letter in line:
        if quote:
            if letter == quote:
                quote = ""
                kept.append(letter)
        elif letter in "'\"":
            quote = letter
            kept.append(letter)
        elif letter == "!":
            break
        else:
            kept.append(letter)
    return "".join(kept).strip().lower()


def statements(text: str) -> list[Statement]:
    """All statements of a free-form source."""
    found, pending, start = [], "", 0
    for number, line in enumerate(text.splitlines(), 1):
        code = bare(line)
        if not code:
            continue
        if not pending:
            start = number
        code = code.removeprefix("&").lstrip() if pending else code
        if code.endswith("&"):
            pending += code[:-1].rstrip() + " "
            continue
        found.extend(Statement(start, part.strip()) for part in (pending + code).split(";"))
        pending = ""
    return found


def uses(text: str) -> list[tuple[int, str]]:
    """Line and module of every use statement that is not `use, intrinsic`."""
    pattern = re.compile(r"^use(?:\s*,\s*(?P<nature>\w+)\s*::|\s*::|\s)\s*(?P<name>\w+)\s*(?:,|$)")
    matches = ((s.line, pattern.match(s.text)) for s in statements(text))
    return [(n, m["name"]) for n, m in matches if m and m["nature"] != "intrinsic"]


def unit_name(text: str) -> str | None:
    """Name of the module, submodule or program a file holds."""
    pattern = re.compile(r"^(?:module|program|submodule\s*\([^)]*\))\s*(?P<name>\w+)$")
    for statement in statements(text):
        if found := pattern.match(statement.text):
            return found["name"]
    return None


def parent_name(text: str) -> str | None:
    """Name of the module whose bodies a submodule holds."""
    found = re.search(r"^\s*submodule\s*\(\s*(\w+)", text, re.MULTILINE | re.IGNORECASE)
    return found[1].lower() if found else None


def nesting_change(text: str) -> int:
    """+1 where a statement opens a construct, -1 where it closes one."""
    text = re.sub(r"^\w+\s*:\s*(?!:)", "", text)
    if re.match(
        r"^end\s*(?:do|if|select|associate|block|where|forall|critical)\b(?!\s*=)",
        text,
    ):
        return -1
    opens = (
        r"^(?:do\b(?!\s*=)|if\s*\(.*\)\s*then$|select\s*(?:case|type)\b|associate\s*\(|block$"
        r"|where\s*\((?:[^()]|\([^()]*\))*\)$)"
    )
    return 1 if re.match(opens, text) else 0


def procedures(text: str) -> list[Procedure]:
    """Every procedure with a body; interface blocks only declare theirs."""
    done: list[Procedure] = []
    opened: list[tuple[Procedure, int]] = []
    in_interface, depth, inner = False, 0, []
    last_line = 0
    for statement in statements(text):
        last_line = statement.line
        if re.match(r"^(?:abstract\s+)?interface\b", statement.text):
            in_interface = True
        elif re.match(r"^end\s*interface\b", statement.text):
            in_interface = False
        if in_interface:
            continue
        if END_UNIT.match(statement.text) or (opened and statement.text == "end"):
            procedure, contained = opened.pop()
            length = statement.line - procedure.line + 1
            procedure.lines = length - contained
            done.append(procedure)
            if opened:
                opened[-1] = (opened[-1][0], opened[-1][1] + length)
            depth = inner.pop()
        elif (found := UNIT.match(statement.text)) and "::" not in statement.text:
            arguments = re.findall(r"\w+", found["arguments"] or "")
            opened.append((Procedure(found["name"], statement.line, 0, arguments), 0))
            inner.append(depth)
            depth = 0
        elif opened:
            depth += nesting_change(statement.text)
            opened[-1][0].deepest = max(opened[-1][0].deepest, depth)
    assert not opened, f"a procedure is not ended before line {last_line}"
    return sorted(done, key=lambda p: p.line)


def sources_under(folder: Path) -> list[Path]:
    """Fortran files below a folder, in a fixed order."""
    return sorted(folder.rglob("*.f90"))
