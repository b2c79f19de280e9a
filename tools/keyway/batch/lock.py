"""One batch at a time in a folder of results."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from .cases import BatchError

LOCK = "batch.lock"


@contextmanager
def lock_of(folder: Path) -> Iterator[None]:
    """Hold the folder of the results of a batch; the end of the process gives it back.

    A folder that is still empty at the end is removed.
    Raises BatchError where another batch holds it, OSError where nothing can be written there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK
    with path.open("w", encoding="utf-8") as file:
        if not _is_ours(file, path):
            fault = f"another batch runs in '{folder}'; wait for its end, or choose another -o"
            raise BatchError(fault)
        try:
            yield
        finally:
            path.unlink(missing_ok=True)
            with suppress(OSError):  # it holds results
                folder.rmdir()


def _is_ours(file: TextIO, path: Path) -> bool:
    """Take the lock; False where another process holds it, or has just removed the file."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return path.exists() and path.stat().st_ino == os.fstat(file.fileno()).st_ino
