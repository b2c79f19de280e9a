"""Where the program is, and the name by which a command was called."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

PROGRAM = "keyway"
VARIABLE = "KEYWAY"  # of the environment: the path of the program
_CHECKOUT = Path(__file__).resolve().parents[2]
BUILT = _CHECKOUT / "build" / "release" / PROGRAM


def find_program() -> Path:
    """Path of the program: $KEYWAY, else the build of the checkout that holds this file, else PATH.

    Raises FileNotFoundError if $KEYWAY names no file, or where none of the three has a program.
    """
    named = os.environ.get(VARIABLE)
    if named:
        path = Path(named)
        if path.is_file():
            return path.resolve()
        raise FileNotFoundError(f"{VARIABLE}={named}: there is no such program")
    if BUILT.is_file():
        return BUILT
    if found := shutil.which(PROGRAM):
        return Path(found).resolve()
    places = f"{VARIABLE} is not set, {BUILT} is not built, and PATH has none"
    raise FileNotFoundError(f"no program '{PROGRAM}': {places}")


def given_program(path: Path | None) -> Path:
    """The program that a command was given with --program, else that of `find_program`.

    Raises FileNotFoundError where there is no such file.
    """
    if path is None:
        return find_program()
    if not path.is_file():
        raise FileNotFoundError(f"no program '{path}'")
    return path.resolve()


class DamagedFileError(ValueError):
    """A file of results that is not whole."""


def reason_of(error: Exception) -> str:
    """What a command says of an error: of one of the system the file and the reason."""
    if isinstance(error, OSError) and error.strerror and error.filename:
        return f"'{error.filename}': {error.strerror}"
    if isinstance(error, KeyError) and error.args:
        return str(error.args[0])  # without the marks around a name
    return str(error)


def command_name(script: str) -> str:
    """Name for the help of a command: that of an entry point (keyway-report), else `script`."""
    name = Path(sys.argv[0]).name
    return name if name.startswith(f"{PROGRAM}-") else script
