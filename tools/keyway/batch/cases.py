"""The cases of a batch: decks that are named, or a template deck with a table of values."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from keyway_tools.deck_bytes import exact_text

from keyway.deck import Deck
from keyway.deck.data import is_data

NAME = "case"  # column of the table that names the cases
_PLACE = re.compile(r"\{(\w+)\}")


class BatchError(ValueError):
    """A batch that cannot be run as asked; the text names file and line."""


@dataclass(frozen=True)
class Case:
    """A deck that is run once, with the folder of its results."""

    deck: Path
    folder: Path
    values: dict[str, str] = field(default_factory=dict)  # of the table, by its columns

    @property
    def name(self) -> str:
        return self.folder.name


def cases_of_decks(places: list[Path], top: Path) -> list[Case]:
    """The decks named, and the files *.inp with a step in the folders named.

    The results are in `top`, under the name of the deck, after the name of its folder where decks
    share a name. Raises FileNotFoundError, and ValueError where these names are the same, too.
    """
    decks = find_decks(places)
    count = Counter(deck.stem for deck in decks)
    names = [d.stem if count[d.stem] == 1 else f"{d.parent.name}_{d.stem}" for d in decks]
    if len(set(names)) < len(names):
        raise ValueError("several decks have the same name and folder name; rename them")
    return [Case(deck, top / name) for deck, name in zip(decks, names, strict=True)]


def find_decks(places: list[Path]) -> list[Path]:
    """The decks named, and the files *.inp with a step in the folders named."""
    found: list[Path] = []
    for place in places:
        if place.is_dir():
            found += [p for p in sorted(place.rglob("*.inp")) if has_step(p)]
        elif place.is_file():
            found.append(place)
        else:
            raise FileNotFoundError(f"there is no deck '{place}'")
    if not found:
        raise FileNotFoundError("no decks found")
    return list(dict.fromkeys(p.resolve() for p in found))


def has_step(path: Path) -> bool:
    """Whether a file is a whole deck, not a part to be included."""
    text = path.read_text(encoding="utf-8", errors="replace")
    return re.search(r"^\s*\*\s*STEP\b", text, re.IGNORECASE | re.MULTILINE) is not None


def cases_of_table(template: Path, table: Path, top: Path) -> list[Case]:
    """A case for each row of a table; writes their decks, top/NAME/NAME.inp.

    The columns of the table (CSV with one header line) are the names in braces of the template:
    {FRICTION}. The column `case`, if there is one, names the cases. Raises OSError, and BatchError
    for a name without a column, a column that the template does not use, names that are no names
    of files or are given twice.
    """
    text = exact_text(template.read_bytes())
    columns, rows = read_values(table)
    _check_names(template, text, table, columns)
    cases = []
    width = max(3, len(str(len(rows))))
    for number, row in enumerate(rows, 1):
        name = row.get(NAME) or f"{template.stem}_{number:0{width}d}"
        deck = top / name / f"{name}.inp"
        cases.append(Case(deck.resolve(), top / name, row))
    _check_cases(table, cases)
    for case in cases:
        filled = _filled(text, case.values)
        Deck.from_text(filled, template).write(case.deck)
    return cases


def _filled(text: str, values: dict[str, str]) -> str:
    """The template with the values of a case in place of their names."""
    return _PLACE.sub(lambda found: values.get(found[1], found[0]), text)


def read_values(table: Path) -> tuple[list[str], list[dict[str, str]]]:
    """Columns and rows of a table. Raises BatchError, with file and line."""
    lines = _lines_of(table)
    if len(lines) < 2:
        raise BatchError(f"{table}: expected a header line and a line for each case")
    number, header = lines[0]
    if len(set(header)) < len(header) or not all(re.fullmatch(r"\w+", name) for name in header):
        fault = f"found '{','.join(header)}'; expected the names of the columns, with commas in "
        fault += "between, each once, of letters, digits and _"
        raise BatchError(f"{table}:{number}: {fault}")
    for number, line in lines[1:]:
        if len(line) != len(header) or not all(line):
            fault = f"{len([cell for cell in line if cell])} values; expected {len(header)}"
            raise BatchError(f"{table}:{number}: {fault}: {', '.join(header)}")
    return header, [dict(zip(header, line, strict=True)) for _, line in lines[1:]]


def _lines_of(table: Path) -> list[tuple[int, list[str]]]:
    """The lines of a CSV file that are not blank, with their numbers from 1."""
    try:
        with table.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            lines = [(reader.line_num, [cell.strip() for cell in line]) for line in reader]
    except OSError as error:
        raise BatchError(f"cannot read '{table}': {error.strerror}") from error
    except (ValueError, csv.Error) as error:
        raise BatchError(f"'{table}' is no CSV file in UTF-8: {error}") from error
    return [(number, line) for number, line in lines if any(line)]


def _places(text: str) -> Iterator[tuple[int, str]]:
    """Line and name of all names in braces outside of comments."""
    for number, line in enumerate(text.split("\n"), 1):
        if is_data(line):
            yield from ((number, name) for name in _PLACE.findall(line))


def _check_names(template: Path, text: str, table: Path, columns: list[str]) -> None:
    used = set()
    for number, name in _places(text):
        used.add(name)
        if name not in columns:
            known = ", ".join(columns)
            fault = f"{{{name}}} is no column of {table}; expected one of {known}"
            raise BatchError(f"{template}:{number}: {fault}")
    for name in columns:
        if name not in used and name != NAME:
            raise BatchError(f"{table}: no line of {template} has {{{name}}}")


def _check_cases(table: Path, cases: list[Case]) -> None:
    count = Counter(case.name for case in cases)
    for case in cases:
        given = case.values.get(NAME, case.name)
        if not re.fullmatch(r"[\w.-]+", given) or given.startswith("."):
            raise BatchError(f"{table}: '{given}' is no name of a case; expected letters, "
                             "digits, _, - and .")  # fmt: skip
        if count[case.name] > 1:
            raise BatchError(f"{table}: the case '{case.name}' is there twice")
