"""A digest of all that the results of a run depend on: results of equal digests are kept."""

from __future__ import annotations

import hashlib
import os
import re
import shlex
from itertools import pairwise
from pathlib import Path

from keyway.deck.deck_file import named_files

OUTPUT = "--umat-library"  # names a file that the run writes
FLAGS = "--umat-flags"
# A line of Fortran or of the preprocessor that takes a file into the source of a UMAT.
_INCLUDE = re.compile(
    rb"^[ \t]*#?[ \t]*include[ \t]*['\"<]([^'\">\n]+)['\">]", re.IGNORECASE | re.MULTILINE
)


def digest_of(deck: Path, program: str, options: list[str]) -> str:
    """A digest of the deck, the files that its cards name, those that the options name (a UMAT with
    what its source includes), and the version of the program. Raises OSError.

    What else the program reads, as the environment, changes no more than round-off and the time.
    """
    total = hashlib.sha256(program.encode())
    for path in [*named_files(deck), *files_of_options(options)]:
        total.update(os.fsencode(path.name))
        total.update(path.read_bytes() if path.is_file() else b"missing")
    return total.hexdigest()


def files_of_options(options: list[str]) -> list[Path]:
    """The files that options of the program name, and those that sources among them include."""
    pairs = [*pairwise(["", *options])]  # a word with that before it
    words = [word for before, word in pairs if before not in (OUTPUT, FLAGS)]
    given = [Path(word).resolve() for word in words if _is_file(Path(word))]
    folders = [place for before, text in pairs if before == FLAGS for place in _folders_of(text)]
    found: list[Path] = []
    waiting = [(path, path.parent) for path in given]
    while waiting:
        path, folder = waiting.pop(0)
        if path in found:
            continue
        found.append(path)
        for name in _INCLUDE.findall(path.read_bytes()):
            places = [place / os.fsdecode(name) for place in (path.parent, folder, *folders)]
            waiting += [(place.resolve(), folder) for place in places if _is_file(place)][:1]
    return found


def _folders_of(flags: str) -> list[Path]:
    """The folders that flags of the compiler name: -IFOLDER or -I FOLDER."""
    try:
        words = shlex.split(flags)
    except ValueError:  # a quote that nothing closes
        words = flags.split()
    pairs = pairwise(["", *words])
    names = [
        word if before == "-I" else word[2:]
        for before, word in pairs
        if before == "-I" or word.startswith("-I")
    ]
    return [Path(name) for name in names if name]


def _is_file(path: Path) -> bool:
    """Whether there is a file of this name; a text that is too long for a name is none."""
    try:
        return path.is_file()
    except OSError:
        return False
