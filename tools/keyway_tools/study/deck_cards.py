"""A deck as one list of cards, with those of included files, that is changed and written again.

keyway.deck reads the cards. Keyway itself checks the deck.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

import keyway.deck
from keyway.deck.data import is_data
from keyway.deck.deck_file import included_file
from keyway.deck.known import whole_name

from ..deck_bytes import capitals

# Cards with files beside the deck: the file is named by this parameter.
FILE_PARAMETER = "INPUT"
LONGEST_LINE = 100


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

    Raises OSError for a file that cannot be read, DeckError for one that a deck cannot include.
    """
    source = keyway.deck.Deck(path)
    cards: list[Card] = []
    for card in source.cards:
        if card.is_a("INCLUDE"):
            continue
        if card.keyword:
            cards.append(_card_of(card))
        elif cards:  # the data of the card above go on
            cards[-1].lines += _data_of(card)
    return Deck(cards, sources=set(source.files))


def _card_of(card: keyway.deck.Card) -> Card:
    """The card alone; the file that it names is that on the disk."""
    own = {name: card.parameters.as_written(name) for name in card.parameters}
    if (named := included_file(card)) is not None:
        own[FILE_PARAMETER] = f'"{named}"'
    return Card(whole_name(card.keyword), own, _data_of(card))


def _data_of(card: keyway.deck.Card) -> list[str]:
    return [line.strip() for line in card.body if is_data(line)]
