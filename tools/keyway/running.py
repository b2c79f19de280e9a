"""Runs the program on a deck."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from keyway_tools.program import given_program

from .deck import Deck
from .run_results import RunResults, open_run

_FAULT = re.compile(r"^(?! |keyway: )(.+?):(?:(\d+):)? (.*) \[([a-z][a-z0-9-]*)\]$", re.MULTILINE)
_WARNING = re.compile(r"(\*[A-Z -]+: )?warning: ")
_DECK_IS_WRONG = 2  # exit code
_GRACE = 30.0  # seconds from the request to end until the program is killed


@dataclass(frozen=True)
class Fault:
    """A message on a place of a deck; `str` gives 'dam.inp:12: text'."""

    file: str  # as the deck or the call names it
    line: int  # from 1; 0: the file as a whole
    text: str  # keyword, what was found and what was expected
    kind: str  # name for `keyway --explain`

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.text}" if self.line else f"{self.file}: {self.text}"


class RunError(RuntimeError):
    """A run that did not finish.

    `code` is the exit code (1 stopped, 2 wrong deck or usage, 3 fault of the system, negative: a
    signal), `message` what the program wrote to its standard error, `faults` the faults of the deck
    in it with file and line, `run` the results up to there, None where there are none.
    """

    def __init__(self, code: int, message: str, run: RunResults | None = None):
        super().__init__(f"{message}\n(exit code {code})" if message else f"exit code {code}")
        self.code = code
        self.message = message
        self.faults = _faults(message) if code == _DECK_IS_WRONG else []
        self.run = run


def run(
    deck: str | os.PathLike[str] | Deck,
    threads: int | None = None,
    results: str | os.PathLike[str] | None = None,
    *,
    options: Sequence[str] = (),
    timeout: float | None = None,
    program: str | os.PathLike[str] | None = None,
) -> RunResults:
    """Run a deck and open its results.

    `results` is the folder of the results, by default results/<name of the deck>; `threads` those
    of the run, by default all processors; `options` further options of the program, as
    ["--umat", "law.for"]. A Deck that was changed is written into the folder of the results and
    runs from there. The program is `program`, else that of `keyway.find_program`: $KEYWAY, the
    build of the checkout, PATH.

    Raises FileNotFoundError where there is no program or no deck, RunError with the message and the
    exit code of the program where the run does not finish, subprocess.TimeoutExpired after
    `timeout` seconds (the run then ends as "stopped" and keeps its results).
    """
    path = given_program(Path(program) if program is not None else None)
    name = deck.path if isinstance(deck, Deck) else Path(deck)
    folder = Path(results) if results is not None else Path("results") / name.stem
    source = _written(deck, folder) if isinstance(deck, Deck) else name
    if not source.is_file():
        raise FileNotFoundError(f"there is no deck '{source}'")
    command = [str(path), "-q", "-o", str(folder)]
    command += [] if threads is None else ["-j", str(threads)]
    code, message = _execute([*command, *options, str(source)], timeout)
    opened = _open(folder, source.stem)
    if code != 0 or opened is None:
        raise RunError(code, message or "the program left no results", opened)
    return opened


def _faults(message: str) -> list[Fault]:
    """The faults of a deck in what the program wrote: first lines with a place, no warnings."""
    return [
        Fault(file, int(line or 0), text, kind)
        for file, line, text, kind in _FAULT.findall(message)
        if not _WARNING.match(text)
    ]


def _written(deck: Deck, folder: Path) -> Path:
    """The file of a deck: its own where nothing was changed."""
    if deck.path.is_file() and not deck.is_changed:
        return deck.path
    target = folder / deck.path.name
    deck.write(target)
    return target


def _open(folder: Path, job: str) -> RunResults | None:
    try:
        found = open_run(folder / f"{job}.json")
    except (OSError, ValueError):
        return None
    return found if "tests" not in found.summary else None


def _execute(command: list[str], timeout: float | None) -> tuple[int, str]:
    """Exit code and standard error of a command that ends with this process."""
    child = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True, errors="replace",
    )  # fmt: skip
    try:
        _, text = child.communicate(timeout=timeout)
    except BaseException:
        _end(child)
        raise
    return child.returncode, text.strip()


def _end(child: subprocess.Popen[str]) -> None:
    child.terminate()
    try:
        child.communicate(timeout=_GRACE)
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
