"""The data lines of a card: a change of one value leaves all other letters of its line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, MutableSequence
from typing import overload

import numpy as np

from .fields import BLANKS, Value, as_number, as_text, split, unquoted


def is_data(line: str) -> bool:
    """Whether a line below a keyword is neither blank nor a comment."""
    text = line.strip(BLANKS)
    return bool(text) and not text.startswith("**")


class Row(MutableSequence[str]):
    """One data line as its fields; empty fields at the end do not count."""

    def __init__(self, lines: list[str], place: int):
        self._lines = lines
        self._place = place

    def _spans(self) -> list[tuple[int, int]]:
        spans = split(self._lines[self._place])
        while spans and spans[-1][0] == spans[-1][1]:
            spans.pop()
        return spans

    def __len__(self) -> int:
        return len(self._spans())

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        line = self._lines[self._place]
        spans = self._spans()
        if isinstance(index, slice):
            return [unquoted(line[start:end]) for start, end in spans[index]]
        start, end = spans[index]
        return unquoted(line[start:end])

    def __setitem__(self, index: int | slice, value: Value) -> None:  # type: ignore[override]
        if isinstance(index, slice):
            raise TypeError("set the values of a row one by one")
        line = self._lines[self._place]
        start, end = self._spans()[index]
        self._lines[self._place] = line[:start] + as_text(value) + line[end:]

    def __delitem__(self, index: int | slice) -> None:
        values = list(self)
        del values[index]
        self._replace(values)

    def insert(self, index: int, value: Value) -> None:
        """Insert a value before a field."""
        values = list(self)
        values.insert(index, as_text(value))
        self._replace(values)

    def _replace(self, values: list[str]) -> None:
        line = self._lines[self._place]
        end = line[len(line.rstrip("\r\n")) :]
        self._lines[self._place] = ", ".join(values) + end

    def __repr__(self) -> str:
        return repr(list(self))

    def __eq__(self, other: object) -> bool:
        return list(self) == other if isinstance(other, list | tuple | Row) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


class Data(MutableSequence[Row]):
    """The data lines of a card, without comments and blank lines."""

    def __init__(self, lines: list[str], line_end: str, where: str):
        self._lines = lines
        self._line_end = line_end
        self._where = where  # of the card, for messages

    def _places(self) -> list[int]:
        return [place for place, line in enumerate(self._lines) if is_data(line)]

    def __len__(self) -> int:
        return len(self._places())

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> list[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | list[Row]:
        places = self._places()
        if isinstance(index, slice):
            return [Row(self._lines, place) for place in places[index]]
        return Row(self._lines, places[index])

    def __iter__(self) -> Iterator[Row]:
        return (Row(self._lines, place) for place in self._places())

    def __setitem__(  # type: ignore[override]
        self, index: int | slice, values: Iterable[Value]
    ) -> None:
        """Replace a line. Raises TypeError for a slice."""
        if isinstance(index, slice):
            raise TypeError("set the rows one by one")
        self._lines[self._places()[index]] = self._line(values)

    def __delitem__(self, index: int | slice) -> None:
        places = self._places()
        chosen = places[index] if isinstance(index, slice) else [places[index]]
        for place in sorted(chosen, reverse=True):
            del self._lines[place]

    def insert(self, index: int, values: Iterable[Value]) -> None:
        """Insert a line before a data line."""
        places = self._places()
        after_all = places[-1] + 1 if places else len(self._lines)
        place = places[index] if -len(places) <= index < len(places) else after_all
        if place > 0 and not self._lines[place - 1].endswith("\n"):
            self._lines[place - 1] += self._line_end
        self._lines.insert(place, self._line(values))

    def _line(self, values: Iterable[Value]) -> str:
        if isinstance(values, str):
            raise TypeError(f"{values!r}: expected the values of a line, one by one")
        return ", ".join(as_text(value) for value in values) + self._line_end

    def array(self) -> np.ndarray:
        """All values as numbers, shape (lines, most fields of a line); NaN for an empty field.

        Raises ValueError, with the place of the card, where a field is no number.
        """
        rows = [row[:] for row in self]
        values = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
        for number, row in enumerate(rows):
            for column, text in enumerate(row):
                try:
                    values[number, column] = as_number(text) if text else np.nan
                except ValueError:
                    fault = f"data line {number + 1}: '{text}' is no number"
                    raise ValueError(f"{self._where}, {fault}") from None
        return values

    def __repr__(self) -> str:
        return repr([list(row) for row in self])

    def __eq__(self, other: object) -> bool:
        return list(self) == other if isinstance(other, list) else NotImplemented

    __hash__ = None  # type: ignore[assignment]
