"""A deck as a list of cards that can be changed and written again.

The reader knows the grammar of decks (keyword lines, parameters, data lines, *INCLUDE), of keywords
their names alone. Keyway itself checks the deck.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

from ..deck_bytes import capitals, place_of, read_deck_text

# Cards with files beside the deck: the file is named by this parameter.
FILE_PARAMETER = "INPUT"
LONGEST_LINE = 100
# Keywords of several words: a deck may leave the blanks out
OF_SEVERAL_WORDS = (
    "END PART", "END INSTANCE", "END ASSEMBLY", "USER MATERIAL", "CONCRETE DAMAGED PLASTICITY",
    "CONCRETE COMPRESSION HARDENING", "CONCRETE TENSION STIFFENING", "CONCRETE COMPRESSION DAMAGE",
    "CONCRETE TENSION DAMAGE", "MATERIAL TEST", "SOLID SECTION", "JOINT LAW", "SURFACE INTERACTION",
    "SURFACE BEHAVIOR", "CONTACT PAIR", "BASE MOTION", "INITIAL CONDITIONS", "END STEP",
    "MODEL CHANGE", "NODE PRINT", "EL PRINT", "JOINT PRINT", "NODE FILE", "EL FILE", "NODE OUTPUT",
    "ELEMENT OUTPUT",
)  # fmt: skip
WHOLE_NAMES = {name.replace(" ", ""): name for name in OF_SEVERAL_WORDS}
# Parameters without a value: a line that begins with one may go on with those of the keyword
FLAGS = (
    "DIRECT", "FIELD", "GENERATE", "HISTORY", "INTERNAL", "MODAL", "PERTURBATION", "REDUCED",
    "REMOVE", "SMALL SLIDING", "UNSORTED", "UNSYMM", "WRITE",
)  # fmt: skip


@dataclass
class Card:
    """A keyword with its parameters and data lines."""

    keyword: str  # in capitals, as "BASE MOTION"
    parameters: dict[str, str | None] = field(default_factory=dict)  # names in capitals
    lines: list[str] = field(default_factory=list)

    def value(self, name: str) -> str:
        """Value of a parameter in capitals; '' where there is none."""
        return plain_name(self.parameters.get(name) or "")

    def text(self) -> str:
        """The card as lines of a deck."""
        parts = [f"*{self.keyword}"]
        parts += [name if value is None else f"{name}={value}" for name, value in
                  self.parameters.items()]  # fmt: skip
        rows, row = [], parts[0]
        for part in parts[1:]:
            if len(row) + len(part) + 3 > LONGEST_LINE:
                rows.append(row + ",")
                row = "   " + part
            else:
                row += f", {part}"
        return "\n".join([*rows, row, *self.lines]) + "\n"


def plain_name(label: str) -> str:
    """A name of a deck in capitals, without quotes and the blanks around it."""
    return capitals(label.strip().strip("\"'"))


def quoted(name: str) -> str:
    """A name as a deck has it: one with a comma has quotes."""
    return f'"{name}"' if "," in name else name


def fields_of(line: str) -> list[str]:
    """The fields of a data line; commas within quotes belong to a name."""
    fields = [""]
    for piece in re.findall(r""""[^"]*"|'[^']*'|,|[^,"']+|.""", line):
        if piece == ",":
            fields.append("")
        else:
            fields[-1] += piece
    return fields


def number_of(item: str) -> float:
    """A number of a data line; Fortran's exponent D is one too. Raises ValueError."""
    return float(item.strip().lower().replace("d", "e"))


@dataclass
class Deck:
    """The cards of a deck in their order."""

    cards: list[Card]
    files: dict[str, str] = field(default_factory=dict)  # texts that stand beside the deck
    sources: set[Path] = field(default_factory=set, compare=False)  # files that it was read from

    def copy(self) -> Deck:
        return deepcopy(self)

    def of(self, *keywords: str) -> Iterator[Card]:
        """All cards with one of these keywords."""
        return (card for card in self.cards if card.keyword in keywords)

    def has(self, keyword: str) -> bool:
        return any(True for _ in self.of(keyword))

    def without(self, unwanted: Iterable[Card]) -> None:
        """Removes cards."""
        gone = {id(card) for card in unwanted}
        self.cards = [card for card in self.cards if id(card) not in gone]

    def steps(self) -> list[list[Card]]:
        """The cards of each step, from *STEP to the card before *END STEP."""
        found: list[list[Card]] = []
        is_inside = False
        for card in self.cards:
            if card.keyword == "STEP":
                found.append([])
                is_inside = True
            if card.keyword == "END STEP":
                is_inside = False
            if is_inside:
                found[-1].append(card)
        return found

    def insert_before_end(self, step: list[Card], card: Card) -> None:
        """Adds a card at the end of a step."""
        place = next(i for i, other in enumerate(self.cards) if other is step[-1])
        self.cards.insert(place + 1, card)
        step.append(card)

    def text(self) -> str:
        return "".join(card.text() for card in self.cards)

    def write(self, path: Path) -> None:
        """Writes the deck and its files. What is there as it should be is left alone."""
        texts = {path.name: self.text(), **self.files}
        for name, text in texts.items():
            file = path.parent / name
            if not file.exists() or file.read_bytes() != text.encode():
                file.write_text(text, encoding="utf-8")


def read_deck(path: Path) -> Deck:
    """A deck with all its *INCLUDE files. Other files keep their place on the disk.

    Raises OSError for a file that cannot be read.
    """
    sources: set[Path] = set()
    return Deck(list(_cards_of_lines(_lines_of(path.resolve(), sources))), sources=sources)


def _lines_of(path: Path, sources: set[Path]) -> Iterator[tuple[str, Path]]:
    """The lines of a file without comments, with the folder of their file. Those of an included
    file stand in place of *INCLUDE, also among the data of a keyword. Adds to `sources` the files.
    """
    sources.add(path)
    include, is_open = None, False
    for line in map(str.strip, read_deck_text(path).split("\n")):
        if not line or line.startswith("**"):
            continue
        if include and is_open and not line.startswith("*") and _has_parameters(line):
            is_open = _add_parameters(include, line)
            continue
        if include:
            yield from _lines_of(_place_of(include, path.parent), sources)
            include = None
        keyword, rest = _head_of(line)
        if keyword == "INCLUDE":
            include = Card(keyword)
            is_open = _add_parameters(include, rest)
        else:
            yield line, path.parent
    if include:
        yield from _lines_of(_place_of(include, path.parent), sources)


def _head_of(line: str) -> tuple[str, str]:
    """Keyword and parameters of a line; no keyword for data."""
    if not line.startswith("*"):
        return "", line
    head, _, rest = line[1:].partition(",")
    name = " ".join(head.upper().split())
    return WHOLE_NAMES.get(name.replace(" ", ""), name), rest


def _place_of(card: Card, folder: Path) -> Path:
    """The file of a card; its path is relative to the file that names it."""
    return place_of(folder, (card.parameters[FILE_PARAMETER] or "").strip("\"'"))


def _cards_of_lines(lines: Iterable[tuple[str, Path]]) -> Iterator[Card]:
    card = None
    is_open = False  # the keyword line goes on in the next line
    for line, folder in lines:
        keyword, rest = _head_of(line)
        is_open = is_open and not keyword and _has_parameters(line)
        if keyword:
            if card:
                yield card
            card = Card(keyword)
            is_open = (bool(rest) or line.endswith(",")) and _add_parameters(card, rest)
            is_open = is_open and keyword != "HEADING"
        elif is_open and card:
            is_open = _add_parameters(card, line)
        elif card:
            card.lines.append(line)
            continue
        if card and card.parameters.get(FILE_PARAMETER):
            card.parameters[FILE_PARAMETER] = f'"{_place_of(card, folder)}"'
    if card:
        yield card


def _has_parameters(line: str) -> bool:
    """Whether a line below a comma goes on with the keyword; else the comma has no meaning."""
    return "=" in line or " ".join(line.partition(",")[0].upper().split()) in FLAGS


def _add_parameters(card: Card, text: str) -> bool:
    """Adds the parameters of a line; whether the next line goes on with them."""
    for item in fields_of(text):
        name, equals, value = item.partition("=")
        name = " ".join(name.upper().split())
        if name:
            card.parameters[name] = value.strip() if equals else None
    return text.rstrip().endswith(",") or not text.strip()
