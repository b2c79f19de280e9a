"""The text of a deck from its bytes, as the program reads it."""

from __future__ import annotations

import codecs
import contextlib
import os
from pathlib import Path


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


def text_of(content: bytes) -> str:
    r"""The text without a byte order mark and with line feeds alone; lines that are no UTF-8 are in
    Latin-1.

    >>> text_of("FUGEÄ, é\r\n".encode("latin-1") + "Ö".encode())
    'FUGEÄ, é\nÖ'
    """
    lines = content.removeprefix(codecs.BOM_UTF8).split(b"\n")
    return "\n".join(_text_of_line(line.removesuffix(b"\r")) for line in lines)


def _text_of_line(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")
