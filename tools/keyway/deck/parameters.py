"""The parameters of a keyword, in the text of its lines."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass

from .data import is_data
from .fields import Value, as_text, quoted_if_needed, split, unquoted, words


@dataclass(frozen=True)
class _Given:
    """A parameter with its places in a line."""

    line: int
    name: str
    name_end: int
    value: tuple[int, int] | None  # start and end


class Parameters(MutableMapping[str, str | None]):
    """Names in capitals with their values; None for a flag. Names compare without regard to case.

    A change of one value leaves all other letters of the lines. A value of True or None is a flag.
    """

    def __init__(self, lines: list[str]):
        self._lines = lines  # the keyword line and those in which it continues, with line ends

    def _given(self) -> Iterator[_Given]:
        for number, line in enumerate(self._lines):
            if number > 0 and not is_data(line):
                continue
            for start, end in split(line)[1 if number == 0 else 0 :]:
                name, equals, value = line[start:end].partition("=")
                if not words(name):
                    continue
                name_end = start + len(name.rstrip())
                first = end - len(value.lstrip())
                yield _Given(number, words(name), name_end, (first, end) if equals else None)

    def _find(self, name: str) -> _Given | None:
        return next((given for given in self._given() if given.name == words(name)), None)

    def __getitem__(self, name: str) -> str | None:
        value = self.as_written(name)
        return None if value is None else unquoted(value)

    def as_written(self, name: str) -> str | None:
        """The value with its quotes; None for a flag. Raises KeyError."""
        given = self._find(name)
        if given is None:
            raise KeyError(name)
        return None if given.value is None else self._lines[given.line][slice(*given.value)]

    def __setitem__(self, name: str, value: Value | bool | None) -> None:
        is_flag = value is None or value is True
        text = None if is_flag else quoted_if_needed(_one_value(value))
        given = self._find(name)
        if given is None:
            self._append(words(name) if text is None else f"{words(name)}={text}")
        else:
            self._replace(given, "" if text is None else f"={text}")

    def _append(self, text: str) -> None:
        last = max(n for n, line in enumerate(self._lines) if n == 0 or is_data(line))
        line = self._lines[last]
        body = line.rstrip()
        end = line[len(line.rstrip("\r\n")) :]
        self._lines[last] = f"{body.rstrip(',').rstrip()}, {text}{end}"

    def _replace(self, given: _Given, text: str) -> None:
        line = self._lines[given.line]
        start, end = given.name_end, given.name_end
        if given.value is not None:
            if text and given.value[0] < given.value[1]:  # the blanks around "=" stay
                start, text = given.value[0], text[1:]
            end = given.value[1]
        self._lines[given.line] = line[:start] + text + line[end:]

    def __delitem__(self, name: str) -> None:
        """Remove a parameter; the others follow each other in one line."""
        if self._find(name) is None:
            raise KeyError(name)
        head = self._lines[0]
        parts = [head[slice(*split(head)[0])]]
        for given in self._given():
            if given.name == words(name):
                continue
            value = given.value and self._lines[given.line][slice(*given.value)]
            parts.append(given.name if value is None else f"{given.name}={value}")
        end = head[len(head.rstrip("\r\n")) :]
        comments = [line for line in self._lines[1:] if not is_data(line)]
        self._lines[:] = [", ".join(parts) + end, *comments]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(given.name for given in self._given()))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._find(name) is not None

    def __repr__(self) -> str:
        return repr(dict(self))


def _one_value(value: Value | bool | None) -> str:
    """A value as text; paths and names may hold commas, which are quoted."""
    if isinstance(value, str) and "\n" not in value and '"' not in value:
        return value
    assert value is not None
    return as_text(value)
