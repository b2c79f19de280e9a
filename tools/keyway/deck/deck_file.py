"""The files of a deck: the deck itself and those that it includes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from keyway_tools.deck_bytes import BYTE_ORDER_MARK, bytes_like, exact_text, place_of

from .card import Card, read_cards


class DeckError(ValueError):
    """A deck that cannot be read or written as asked; the text names file and line."""


class DeckFile:
    """One file of a deck as a list of cards."""

    def __init__(self, path: Path, text: str, content: bytes = b""):
        self.path = path
        self._mark = BYTE_ORDER_MARK if text.startswith(BYTE_ORDER_MARK) else ""
        self._read = text  # what the file holds
        self._content = content  # the same as bytes
        *self.cards, self._rest = read_cards(_lines(text[len(self._mark) :]), path)

    @classmethod
    def read(cls, path: Path) -> DeckFile:
        """Read a file in UTF-8 or Latin-1, as the program does. Raises OSError."""
        content = path.read_bytes()
        return cls(path, exact_text(content), content)

    @property
    def is_changed(self) -> bool:
        """Whether the cards differ from the file that was read."""
        return self.text() != self._read

    def text(self, change: Callable[[Card], Card] = lambda card: card) -> str:
        """The text of the file, each card after `change`."""
        parts = [self._mark]
        for card in self.cards:
            parts += [*card.above, change(card).text()]
            if not parts[-1].endswith("\n"):
                parts[-1] += card.line_end
        is_whole = not self.cards or self._rest.above or self._read.endswith(("\n", "\r"))
        parts += self._rest.above
        text = "".join(parts)
        return text if is_whole or not self._read else text.removesuffix("\n").removesuffix("\r")

    def write(self, path: Path, text: str) -> None:
        """Write a text as the contents of this file, whole or not at all. Raises OSError."""
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f".{path.name}.part")
        content = bytes_like(self._content, text)
        part.write_bytes(content)
        part.replace(path)
        if path == self.path:
            self._read, self._content = text, content

    def remove(self, card: Card) -> None:
        """Remove a card; comments above it stay, above the next card."""
        place = self.place_of(card)
        following = [*self.cards[place + 1 :], self._rest][0]
        following.above[:0] = card.above
        del self.cards[place]

    def place_of(self, card: Card) -> int:
        """Position of a card. Raises DeckError."""
        for place, other in enumerate(self.cards):
            if other is card:
                return place
        raise DeckError(f"{card.where}: the card is not in {self.path}")


def included_file(card: Card) -> Path | None:
    """The file that a card names with INPUT; None where it names none."""
    name = card.parameters.get("INPUT") if card.head else None
    return place_of(card.file.parent, name) if name else None


def named_files(deck: Path) -> list[Path]:
    """The deck and all files that its cards and those of included files name with INPUT, each once,
    also those that are not there. Raises OSError for one that cannot be read.
    """
    found, waiting = [], [deck.resolve()]
    while waiting:
        path = waiting.pop(0)
        found.append(path)
        cards = DeckFile.read(path).cards if path.is_file() else []
        for card in cards:
            named = included_file(card)
            if named is None or named in found or named in waiting:
                continue
            (waiting if card.is_a("INCLUDE") else found).append(named)
    return found


def _lines(text: str) -> list[str]:
    """The lines with their ends; only line feeds end a line."""
    parts = text.split("\n")
    lines = [part + "\n" for part in parts[:-1]]
    return [*lines, parts[-1]] if parts[-1] else lines


def read_files(main: DeckFile) -> dict[Path, DeckFile]:
    """The main file and all that it includes, by their paths.

    Raises DeckError where a file is missing or includes itself.
    """
    files = {main.path: main}

    def read(file: DeckFile, parents: tuple[Path, ...]) -> None:
        for card in file.cards:
            if not card.is_a("INCLUDE"):
                continue
            path = included_file(card)
            if path is None:
                raise DeckError(f"{card.where}: no file is named; expected INPUT=file")
            if path in parents:
                raise DeckError(f"{card.where}: the file includes itself")
            if path not in files:
                try:
                    files[path] = DeckFile.read(path)
                except OSError as error:
                    raise DeckError(f"{card.where}: {error.strerror}: '{path}'") from error
            read(files[path], (*parents, path))

    read(main, (main.path,))
    return files


def walk(file: DeckFile, files: dict[Path, DeckFile]) -> Iterator[Card]:
    """All cards in the order in which the program reads them; *INCLUDE is followed by its file."""
    for card in file.cards:
        yield card
        path = included_file(card) if card.is_a("INCLUDE") else None
        if path is not None:
            yield from walk(files[path], files)
