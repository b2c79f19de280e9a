"""A deck: its cards in all its files, changed and written."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from keyway_tools.deck_bytes import capitals

from .card import Card
from .deck_file import DeckError, DeckFile, included_file, read_files, walk
from .fields import Value
from .sets import collect, set_text
from .writing import write_files

_OF_SETS = ("ELEMENT", "NSET", "ELSET")
_OF_MESH = ("HEADING", "NODE", "SURFACE", *_OF_SETS)


class Deck:
    """A deck with all files that it includes.

        deck = keyway.Deck("dam.inp")
        deck.card("ELASTIC").data[0][0] = 30e9
        deck.card("STEP", NAME="WATER").parameters["INC"] = 200
        deck.write("stiff/dam.inp")

    Cards that are not changed, comments and blank lines are written byte for byte. The class knows
    the grammar of decks and what sets are; it does not know what keywords mean: `keyway --check`
    and `keyway.run` say what is wrong with a deck.
    """

    def __init__(self, path: str | os.PathLike[str]):
        """Read a deck. Raises OSError where it cannot be read, DeckError for its includes."""
        self._open(DeckFile.read(Path(path).resolve()))

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Deck:
        """Read a deck, as Deck(path) does."""
        return cls(path)

    @classmethod
    def from_text(cls, text: str, path: str | os.PathLike[str] = "deck.inp") -> Deck:
        """A deck of a text. `path` is where it will be written, and from where it names files."""
        deck = cls.__new__(cls)
        file = DeckFile(Path(path).resolve(), text)
        deck._open(file)
        return deck

    def _open(self, main: DeckFile) -> None:
        self.path = main.path
        self._main = main
        self._files = read_files(main)

    @property
    def files(self) -> list[Path]:
        """Paths of the deck and of all files that it includes."""
        return [*self._files]

    @property
    def is_changed(self) -> bool:
        """Whether a file of the deck differs from what was read or written last."""
        return any(file.is_changed for file in self._files.values())

    @property
    def cards(self) -> list[Card]:
        """All cards as the program reads them: after each *INCLUDE come the cards of its file."""
        return [*walk(self._main, self._files)]

    def find(self, keyword: str, **parameters: str | bool) -> list[Card]:
        """The cards with this keyword and these parameters: find("MATERIAL", NAME="ROCK").

        True stands for any value. Case does not count.
        """
        return [
            card
            for card in self.cards
            if card.is_a(keyword) and all(card.has(name, v) for name, v in parameters.items())
        ]

    def card(self, keyword: str, **parameters: str | bool) -> Card:
        """The one card that `find` finds. Raises DeckError if there is none, or several."""
        found = self.find(keyword, **parameters)
        if len(found) == 1:
            return found[0]
        wanted = ", ".join([f"*{keyword.upper()}", *(f"{k}={v}" for k, v in parameters.items())])
        places = "; ".join(card.where for card in found[:5])
        what = f"{len(found)} cards {wanted}: {places}" if found else f"no card {wanted}"
        raise DeckError(f"{self.path}: {what}; expected one")

    @property
    def steps(self) -> list[list[Card]]:
        """The cards of each step, from *STEP to *END STEP."""
        found: list[list[Card]] = []
        is_inside = False
        for card in self.cards:
            if card.is_a("STEP"):
                found.append([])
                is_inside = True
            if is_inside:
                found[-1].append(card)
            is_inside = is_inside and not card.is_a("END STEP")
        return found

    def add(self, text: str, *, before: Card | None = None, after: Card | None = None,
            step: int | None = None) -> list[Card]:  # fmt: skip
        """Add the cards of a text and return them.

        They come before or after a card, at the end of a step (its position in `steps`), or else
        above the first step. Raises DeckError for a text without a keyword and for a card that is
        not in the deck, IndexError for a step that is not there.
        """
        if sum(choice is not None for choice in (before, after, step)) > 1:
            raise DeckError("expected one of before, after and step")
        if before is None and after is None:
            before, after = self._end_of_step(step) if step is not None else self._first_step()
        known = before or after
        file = self._file_of(known) if known else self._main
        text = text if text.endswith("\n") else text + "\n"
        source = DeckFile(file.path, text)
        if not source.cards or not source.cards[0].head:
            raise DeckError(f"{text.strip()!r}: expected cards, each with a keyword")
        if any(card.is_a("INCLUDE") for card in source.cards):
            self._files.update(read_files(source) | {file.path: file})
        for card in source.cards:
            card.line = 0
        place = file.place_of(known) + (known is after) if known else len(file.cards)
        file.cards[place:place] = source.cards
        return source.cards

    def _first_step(self) -> tuple[Card | None, None]:
        return next((card for card in self.cards if card.is_a("STEP")), None), None

    def _end_of_step(self, number: int) -> tuple[Card | None, Card | None]:
        last = self.steps[number][-1]
        return (last, None) if last.is_a("END STEP") else (None, last)

    def _file_of(self, card: Card) -> DeckFile:
        for file in self._files.values():
            if any(other is card for other in file.cards):
                return file
        raise DeckError(f"{card.where}: the card is not in the deck {self.path}")

    def remove(self, *cards: Card) -> None:
        """Remove cards; comments above them stay. Raises DeckError for one that is not there."""
        for card in cards:
            self._file_of(card).remove(card)

    def node_set(self, name: str) -> np.ndarray:
        """Numbers of the nodes of a set, ascending, shape (nodes,). Raises DeckError."""
        return self._set("NSET", name)

    def element_set(self, name: str) -> np.ndarray:
        """Numbers of the elements of a set, ascending, shape (elements,). Raises DeckError."""
        return self._set("ELSET", name)

    def _set(self, kind: str, name: str) -> np.ndarray:
        sets = collect(self.cards, kind)
        if capitals(name) not in sets:
            known = ", ".join(sets) or "none"
            raise DeckError(f"{self.path}: no {kind} '{name}'; the deck has: {known}")
        return np.array(sorted(sets[capitals(name)]), dtype=int)

    def add_node_set(self, name: str, members: Iterable[Value]) -> Card:
        """Add *NSET of numbers or names of sets below the mesh; return the card."""
        return self._add_set("NSET", name, members)

    def add_element_set(self, name: str, members: Iterable[Value]) -> Card:
        """Add *ELSET of numbers or names of sets below the mesh; return the card."""
        return self._add_set("ELSET", name, members)

    def _add_set(self, kind: str, name: str, members: Iterable[Value]) -> Card:
        after, is_mesh = None, False
        for card in self._main.cards:
            if card.is_a("INCLUDE"):
                file = self._files[included_file(card) or self.path]
                is_mesh = any(c.is_a(k) for c in walk(file, self._files) for k in _OF_SETS)
            if card.is_a("STEP"):
                break
            if any(card.is_a(k) for k in _OF_MESH) or (card.is_a("INCLUDE") and is_mesh):
                after = card
        return self.add(set_text(kind, name, members), after=after)[0]

    def text(self) -> str:
        """The text of the deck itself, without the files that it includes."""
        return self._main.text()

    def write(self, path: str | os.PathLike[str] | None = None) -> list[Path]:
        """Write the deck; return the paths of the files that were written.

        Without a path, or with that of the deck, the files that were changed are written in their
        places. Written elsewhere, the deck names the files that it reads at their old places;
        included files that were changed are written beside it as DECK_NAME, so that the first deck
        stays as it was. Raises OSError, and DeckError where a file that the deck reads would be
        lost.
        """
        return write_files(self._main, self._files, Path(path) if path is not None else None)
