"""One card of a deck: a keyword with its parameters and data lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .data import Data, is_data
from .fields import BLANKS, split, squeezed, words
from .known import parameters_of
from .parameters import Parameters


@dataclass(eq=False, repr=False)
class Card:
    """A keyword with its parameters and data lines, as they stand in a file.

    `parameters` maps names to values (None for a flag), `data` holds the data lines as lists of
    fields; both can be changed: `card.parameters["ELSET"] = "DAM"`, `card.data[0][1] = 0.18`.
    """

    head: list[str]  # the keyword line and those in which it continues, with their line ends
    body: list[str] = field(default_factory=list)  # data lines, and comments between them
    above: list[str] = field(default_factory=list)  # comments and blank lines above the keyword
    file: Path = field(default_factory=lambda: Path("deck.inp"))
    line: int = 0  # of the keyword in the file when it was read, from 1; 0: a new card

    def __repr__(self) -> str:
        return f"<{self.where}>"

    @property
    def keyword(self) -> str:
        """The keyword in capitals with single blanks, as 'BASE MOTION'.

        '' for data lines that continue the card above: those above the first keyword of an included
        file, and those below *INCLUDE.
        """
        if not self.head:
            return ""
        start, end = split(self.head[0])[0]
        return words(self.head[0][start:end].lstrip("*"))

    @property
    def parameters(self) -> Parameters:
        """The parameters."""
        return Parameters(self.head)

    @property
    def data(self) -> Data:
        """The data lines."""
        return Data(self.body, self.line_end, self.where)

    @property
    def where(self) -> str:
        """The place of the card in messages, as 'dam.inp:12: *ELASTIC'."""
        return f"{self.file}:{self.line}: *{self.keyword}"

    @property
    def line_end(self) -> str:
        """The line end of the card's first line."""
        first = next(iter([*self.head, *self.body]), "\n")
        return "\r\n" if first.endswith("\r\n") else "\n"

    def is_a(self, keyword: str) -> bool:
        """Whether the card has this keyword; case and blanks do not count."""
        return squeezed(self.keyword) == squeezed(keyword.lstrip("*"))

    def has(self, name: str, value: str | bool | None = None) -> bool:
        """Whether the card has the parameter, with this value unless it is None or True."""
        if name not in self.parameters:
            return False
        found = self.parameters[name]
        if value is None or value is True:
            return True
        return found is not None and words(found) == words(str(value))

    def text(self) -> str:
        """The lines of the card, with comments between its data, without those above it."""
        return "".join([*self.head, *self.body])

    def with_file(self, path: str) -> Card:
        """A copy of the card that names another file as INPUT."""
        copy = Card([*self.head], self.body, self.above, self.file, self.line)
        copy.parameters["INPUT"] = path
        return copy


def read_cards(lines: list[str], file: Path) -> Iterator[Card]:
    """The cards of the lines of a file (with line ends); the last one holds what is left over.

    Comments and blank lines between two cards belong to the card below them. The last card has no
    keyword and no data: it has the comments at the end.
    """
    above: list[str] = []
    place = 0
    if _skip_comments(lines, 0) < len(lines) and not _is_keyword(lines[_skip_comments(lines, 0)]):
        body, place = _body(lines, 0)
        yield Card([], body, [], file, 1)
    while place < len(lines):
        if not _is_keyword(lines[place]):
            above.append(lines[place])
            place += 1
            continue
        start = place
        place = _end_of_head(lines, place)
        head = lines[start:place]
        body, place = _body(lines, place)
        card = Card(head, body, above, file, start + 1)
        above = []
        if not (body and card.is_a("INCLUDE")):
            yield card
            continue
        card.body = []
        yield card
        yield Card([], body, [], file, start + len(head) + 1)  # goes on with the included file
    yield Card([], [], above, file, len(lines) + 1)


def _skip_comments(lines: list[str], place: int) -> int:
    while place < len(lines) and not is_data(lines[place]):
        place += 1
    return place


def _is_keyword(line: str) -> bool:
    return is_data(line) and line.lstrip(BLANKS).startswith("*")


def _end_of_head(lines: list[str], place: int) -> int:
    """The line after the keyword line and those in which it continues."""
    parameters = parameters_of(_first_word(lines[place]).lstrip("*"))
    place += 1
    while lines[place - 1].rstrip(BLANKS).endswith(","):
        following = _skip_comments(lines, place)
        if following == len(lines) or _is_keyword(lines[following]):
            break
        if not _goes_on(lines[following], parameters):
            break
        place = following + 1
    return place


def _goes_on(line: str, parameters: frozenset[str] | None) -> bool:
    """Whether a line below a comma has parameters of the keyword; else the comma has no meaning."""
    if parameters is None:  # a keyword that the program does not know
        return "=" in line
    return bool(parameters) and ("=" in line or _first_word(line) in parameters)


def _first_word(line: str) -> str:
    start, end = split(line)[0]
    return words(line[start:end])


def _body(lines: list[str], place: int) -> tuple[list[str], int]:
    """The lines up to the last data line before the next keyword, and where they end."""
    start = end = place
    while place < len(lines) and not _is_keyword(lines[place]):
        place += 1
        if is_data(lines[place - 1]):
            end = place
    return lines[start:end], end
