"""Comma-separated fields of a line, with their places in it."""

from __future__ import annotations

from numbers import Integral, Real

from keyway_tools.deck_bytes import capitals

BLANKS = " \t\r\n"
QUOTES = "'\""
Value = str | int | float


def split(line: str) -> list[tuple[int, int]]:
    """Start and end of each field, without the blanks around it; a quoted comma divides nothing.

    A line that ends in a comma has an empty last field.
    """
    found = []
    start, quote = 0, ""
    for place, letter in enumerate(line):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in QUOTES:
            quote = letter
        elif letter == ",":
            found.append(_trimmed(line, start, place))
            start = place + 1
    found.append(_trimmed(line, start, len(line)))
    return found


def _trimmed(line: str, start: int, end: int) -> tuple[int, int]:
    while end > start and line[end - 1] in BLANKS:
        end -= 1
    while start < end and line[start] in BLANKS:
        start += 1
    return start, end


def unquoted(text: str) -> str:
    """The text without the quotes around it."""
    is_quoted = len(text) > 1 and text[0] in QUOTES and text[-1] == text[0]
    return text[1:-1] if is_quoted else text


def quoted_if_needed(text: str) -> str:
    """A name or a path as the value of a parameter."""
    return f'"{text}"' if any(letter in text for letter in " ,\t") else text


def as_text(value: Value) -> str:
    """A value as a field of a deck; reading it gives exactly the same number.

    Raises TypeError for what is neither text nor a number, ValueError for NaN and infinity and for
    text that is more than one field.
    """
    if isinstance(value, bool) or not isinstance(value, str | Real):
        raise TypeError(f"{value!r}: expected a text or a number")
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        number = float(value)
        if number - number != 0.0:
            raise ValueError(f"{value!r}: a deck has no such number")
        return repr(number)
    if "\n" in value or "\r" in value or len(split(value)) > 1:
        raise ValueError(f"{value!r}: expected one field, without commas and ends of lines")
    return value


def as_number(text: str) -> float:
    """The number of a field; Fortran's exponent D is one too. Raises ValueError."""
    if "_" in text:
        raise ValueError(f"'{text}' is no number")
    return float(text.lower().replace("d", "e"))


def words(text: str) -> str:
    """A keyword or a name of a parameter: capitals, single blanks."""
    return " ".join(capitals(text).split())


def squeezed(text: str) -> str:
    """A keyword for comparison: *ELFILE is *EL FILE."""
    return "".join(capitals(text).split())
