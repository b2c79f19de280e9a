"""What all commands share: a closed pipe, faults of the system and of the command line in a
sentence."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import NoReturn

from .program import DamagedFileError, reason_of

EXIT_USAGE = 2
# How h5py begins its messages on a part of a file that is damaged.
HDF5_FAULTS = ("Unable to synchronously", "Unable to open object", "Can't synchronously")
Main = Callable[..., int]


class _Pipe(io.FileIO):
    """An output that goes nowhere from when its reader has gone, as in `| head -1`."""

    def write(self, data) -> int:
        """Write, or drop what nobody reads."""
        try:
            return super().write(data)
        except BrokenPipeError:
            _to_nowhere(self.fileno())
            return len(data)


def _to_nowhere(descriptor: int) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def _without_end(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """The same output, which outlives its reader."""
    pipe = _Pipe(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        pipe if stream.write_through else io.BufferedWriter(pipe),
        stream.encoding,
        stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


@contextmanager
def _outputs_without_end() -> Iterator[None]:
    """Both outputs, where nothing has taken their place."""
    usual = {"stdout": sys.__stdout__, "stderr": sys.__stderr__}
    own = {
        name: stream for name, stream in usual.items() if stream and stream is getattr(sys, name)
    }
    lasting = {}
    for name, stream in own.items():
        stream.flush()
        lasting[name] = _without_end(stream)
        setattr(sys, name, lasting[name])
    try:
        yield
    finally:
        for name, stream in own.items():
            setattr(sys, name, stream)
        for stream in lasting.values():
            _flush(stream)


def _flush(stream: io.TextIOWrapper) -> None:
    """Write what is left; raises OSError once where that fails, as on a full disk."""
    try:
        stream.flush()
    except OSError:
        _to_nowhere(stream.fileno())
        raise


def write_file(path: Path, text: str) -> None:
    """Write a text, with the folders of its path. Raises OSError that says what was not written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OSError(
            f"'{path}' could not be written: {error.strerror}; expected a file in a folder in "
            "which you may write"
        ) from None


class Parser(argparse.ArgumentParser):
    """Says what is wrong with the command line in one sentence, without all options."""

    def error(self, message: str) -> NoReturn:
        """End with the code for a fault of usage."""
        self.exit(EXIT_USAGE, f"{self.prog}: {message} (--help shows all options)\n")


def command(name: str) -> Callable[[Main], Main]:
    """For the `main` of a command: says an error of the system as `name: 'file': reason`, exit
    code 2, and goes on to the end where the reader of its output has gone."""

    def around(main: Main) -> Main:
        @wraps(main)
        def guarded(*arguments: list[str] | None) -> int:
            try:
                with _outputs_without_end():
                    try:
                        return main(*arguments)
                    except (OSError, DamagedFileError) as error:
                        print(f"{name}: {reason_of(error)}", file=sys.stderr)
                        return EXIT_USAGE
                    except (KeyError, RuntimeError) as error:
                        if not any(words in str(error) for words in HDF5_FAULTS):
                            raise
                        print(f"{name}: job.h5 is not whole: {reason_of(error)}", file=sys.stderr)
                        return EXIT_USAGE
            except OSError as error:  # of the last lines of the output
                print(f"{name}: output: {reason_of(error)}", file=sys.stderr)
                return EXIT_USAGE

        return guarded

    return around
