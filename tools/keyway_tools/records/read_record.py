"""Reads a file of recorded acceleration of any known kind."""

from __future__ import annotations

from pathlib import Path

from .columns import read_columns
from .networks import (
    AT2_COUNT,
    AT2_OLD_COUNT,
    COSMOS_DATA,
    COSMOS_REALS,
    CSMIP_DATA,
    MOST_HEADERS,
    read_at2,
    read_cosmos,
    read_csmip,
    read_kyoshin,
)
from .record import Record, RecordError


def read_record(path: Path, unit: str | None = None, dt: float | None = None) -> list[Record]:
    """The components of a file [m/s2].

    `unit` is needed where the file names none, `dt` [s] where the file has one column.
    Raises RecordError with the file, what is wrong and what is expected.
    """
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as fault:
        raise RecordError(f"{path}: {fault.strerror}") from None
    first = lines[:MOST_HEADERS]
    if first and first[0].startswith("Origin Time"):
        records = read_kyoshin(path, lines, unit)
    elif any(CSMIP_DATA.match(line) for line in first):
        records = read_csmip(path, lines, unit)
    elif any(COSMOS_REALS.match(line) or COSMOS_DATA.match(line) for line in first):
        records = read_cosmos(path, lines, unit)
    elif len(lines) > 4 and (AT2_COUNT.search(lines[3]) or AT2_OLD_COUNT.search(lines[3])):
        records = read_at2(path, lines, unit)
    elif path.suffix.upper() == ".AT2":
        raise RecordError(f"{path}:4: expected NPTS= and DT= in the fourth line of an AT2 file")
    else:
        return read_columns(path, lines, unit, dt)
    if not records:
        raise RecordError(f"{path}: no channel of acceleration")
    return records
