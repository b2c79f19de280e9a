"""The folder of a job: whether a run writes in it, and whose results it holds."""

from __future__ import annotations

import fcntl
import hashlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .result_files import load_json

PATIENCE = 60.0  # [s] for a run to end whose batch, or whose worker, is lost
PICTURES = (".vtu", ".pvd")  # they show what job.h5 holds


def wait_until_free(folder: Path, job: str, is_ending: Callable[[], bool]) -> None:
    """Wait until no run of the job is alive in the folder: it holds the lock of job.lock.

    At most `PATIENCE` seconds, and not where `is_ending` says that nothing will run any more.
    """
    until = time.monotonic() + PATIENCE
    while is_locked(folder / f"{job}.lock") and time.monotonic() < until and not is_ending():
        time.sleep(0.2)


def is_locked(path: Path) -> bool:
    """Whether a process holds the lock of a file."""
    try:
        with path.open(encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # no such file, or a file system without locks
        return False
    return False


def state_of(path: Path) -> tuple[int, int] | None:
    """A file as it was written last; None without it. The program writes job.json as a new file."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def summary_of(folder: Path, deck: Path) -> dict[str, Any] | None:
    """The summary job.json where it is that of the deck as it is now, without its included files.

    A summary that names no sha256, as that of *MATERIAL TEST, may be of any deck of this name.
    """
    try:
        summary = load_json(folder / f"{deck.stem}.json")
        entry = summary.get("deck")
        given = entry.get("sha256") if isinstance(entry, dict) else None
        if given is None or given == hashlib.sha256(deck.read_bytes()).hexdigest():
            return dict(summary)
    except (OSError, ValueError, AttributeError):
        pass
    return None


def has_results(folder: Path, deck: Path) -> bool:
    """Whether the folder holds the summary of the deck and the files that it lists, but pictures:
    users remove these to save room."""
    summary = summary_of(folder, deck)
    if summary is None:
        return False
    names = [name for name in summary.get("files") or [] if not name.endswith(PICTURES)]
    return all((folder / name).is_file() for name in names)
