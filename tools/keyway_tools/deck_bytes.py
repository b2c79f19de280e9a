"""The text of a deck from its bytes, as the program reads it."""

from __future__ import annotations

import codecs
import contextlib
import os
import string
from pathlib import Path

BYTE_ORDER_MARK = "\ufeff"
_CAPITALS = {ord(letter): letter.upper() for letter in string.ascii_lowercase}


def read_deck_text(path: Path) -> str:
    """The text of a file of a deck. Raises OSError."""
    return text_of(path.read_bytes())


def place_of(folder: Path, name: str) -> Path:
    """The file that a deck names, relative to a folder; its name may be in Latin-1 on the disk."""
    path = folder / name
    if not path.exists():
        with contextlib.suppress(UnicodeEncodeError):
            other = folder / os.fsdecode(name.encode("latin-1"))
            path = other if other.exists() else path
    return path.resolve()


def capitals(text: str) -> str:
    """A name as the program compares it: of the letters a to z alone case does not count.

    >>> capitals("Fuß ö")
    'FUß ö'
    """
    return text.translate(_CAPITALS)


def text_of(content: bytes) -> str:
    r"""The text without a byte order mark and with line feeds alone; lines that are no UTF-8 are in
    Latin-1.

    >>> text_of("FUGEÄ, é\r\n".encode("latin-1") + "Ö".encode())
    'FUGEÄ, é\nÖ'
    """
    lines = exact_text(content).removeprefix(BYTE_ORDER_MARK).split("\n")
    return "\n".join(line.removesuffix("\r") for line in lines)


def exact_text(content: bytes) -> str:
    """The same with its byte order mark and line ends."""
    mark = BYTE_ORDER_MARK if content.startswith(codecs.BOM_UTF8) else ""
    lines = content.removeprefix(codecs.BOM_UTF8).split(b"\n")
    return mark + "\n".join(map(_text_of_line, lines))


def bytes_like(content: bytes, text: str) -> bytes:
    r"""The bytes of a text that takes the place of others: in Latin-1 where those were, and where
    this has all letters and is read as the same text; else in UTF-8.

    >>> bytes_like("Ä".encode("latin-1"), "ÄÖ"), bytes_like("Ä".encode("latin-1"), "Ω")
    (b'\xc4\xd6', b'\xce\xa9')
    """
    old = exact_text(content)
    if text == old:
        return content
    if content != old.encode():
        with contextlib.suppress(UnicodeEncodeError):
            latin1 = text.encode("latin-1")
            if exact_text(latin1) == text:
                return latin1
    return text.encode()


def _text_of_line(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")
