"""job.h5 of a run that was killed."""

from __future__ import annotations

import time
from pathlib import Path

import h5py

LONGEST_WAIT = 5.0  # [s] a child process has the file until its last page is written


def open_h5(path: Path) -> h5py.File:
    """The file, as soon as it is free."""
    give_up = time.monotonic() + LONGEST_WAIT
    while True:
        try:
            return h5py.File(path)
        except BlockingIOError:
            if time.monotonic() > give_up:
                raise
            time.sleep(0.001)
