"""Records in columns: time and one to three components, or the values of one component alone."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from .record import FACTORS, Record, RecordError, choose_unit, unit_named_in

MOST_COMPONENTS = 3
_SEPARATORS = re.compile(r"[,;\s]+")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(,\d*)?([eEdD][+-]?\d+)?")  # 1,5 or 2
_SECONDS = r"s|secs?\.?|seconds?|sek\.?|sekunden?"
_MILLISECONDS = r"ms|msecs?\.?|milliseconds?|millisekunden?"
_OTHER_TIMES = r"min\.?|minutes?|minuten|h|hours?|[\u00b5\u03bcu]s"
# A time with its unit: in brackets, below a fraction line or behind "in", or as another word.
_UNIT_OF_TIME = re.compile(
    r"(?<![a-z])(?:time|zeit|t)(?:"
    r"\s*[\[(]\s*([^\])]*?)\s*[\])]"
    rf"|(?:\s*/\s*|\s+in\s+)({_SECONDS}|{_MILLISECONDS}|{_OTHER_TIMES})(?![a-z])"
    rf"|[\s_]+({_SECONDS}|{_MILLISECONDS})(?![a-z]))",
    re.IGNORECASE,
)
# The last word before those of the components: 'columns: t [s]', 'time'.
_NAME_OF_TIME = re.compile(
    r"(?:^|[\s:])(?:t|time|zeit)\s*(?:[\[(][^\])]*[\])])?\s*$", re.IGNORECASE
)
_UNIT_IN_BRACKETS = re.compile(r"\s*\[[^\]]*\]\s*$")
COLUMNS, ONE_COLUMN = "columns", "one column"  # kinds of files
EVEN = 1.0e-3  # admissible scatter of the time between values, over its mean
# A step without its value is twice as long as the others or, rounded, 1.5 times. Steps of 1 to 1.2
# digits, of which a smaller share is long, are no rate of any instrument (833 to 1000 Hz in ms).
LONG, RARE = 1.5, 0.2
_ROUND_OFF = 1.0e-9  # of times in double precision [s]


def read_columns(path: Path, lines: list[str], unit: str | None, dt: float | None) -> list[Record]:
    """All components of a file in columns."""
    heading, rows = _split_heading(path, lines)
    table = np.array(rows)
    if table.shape[1] == 1:
        if dt is None:
            raise RecordError(f"{path}: one column without times; give the time step with --dt")
        step, values, layout = dt, table, ONE_COLUMN
    else:
        step = _time_step(path, _unit_of_time(path, heading) * table[:, 0])
        values, layout = table[:, 1:], COLUMNS
    if values.shape[1] > MOST_COMPONENTS:
        raise RecordError(
            f"{path}: {values.shape[1] + 1} columns; expected a time and one to three components"
        )
    named = unit_named_in("\n".join(heading))
    unit = choose_unit(path, named, unit, float(np.abs(values).max()))
    names = _names_of(heading, values.shape[1])
    return [
        Record(FACTORS[unit] * column, step, name, path, layout, unit)
        for name, column in zip(names, values.T, strict=True)
    ]


def refuse_dt(records: list[Record], option: str) -> None:
    """Raises RecordError for an option with the time between values, beside a file whose first
    column are times, or beside no file of one column.
    """
    columns = [record for record in records if record.layout == COLUMNS]
    if columns:
        raise RecordError(
            f"{columns[0].source}: {option} beside a file of several columns, the first of which "
            f"are times; expected one value a line, or no {option}"
        )
    if all(record.layout != ONE_COLUMN for record in records):
        raise RecordError(f"{option} has no effect: the files say the time between their values")


def _split_heading(path: Path, lines: list[str]) -> tuple[list[str], list[list[float]]]:
    """The lines above the numbers, and the numbers of each line."""
    heading: list[str] = []
    rows: list[list[float]] = []
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text:
            continue
        row = None if text.startswith(("#", "%", "!", "//", "*")) else _numbers(text)
        if row is None:
            if rows and not text.startswith(("#", "%", "!", "//", "*")):
                raise RecordError(f"{path}:{number}: found '{text[:40]}'; expected numbers")
            heading.append(text)
        elif not all(map(math.isfinite, row)):
            raise RecordError(f"{path}:{number}: found '{text[:40]}'; expected finite numbers")
        elif rows and len(row) != len(rows[0]):
            raise RecordError(
                f"{path}:{number}: {len(row)} numbers; expected {len(rows[0])} as in the rows above"
            )
        else:
            rows.append(row)
    if len(rows) < 2:
        raise RecordError(f"{path}: no record: expected rows of numbers")
    return heading, rows


def _numbers(text: str) -> list[float] | None:
    """The numbers of a line, or None where a word is no number.

    A comma is the decimal mark where other separators part the words (0,02; 1,5)."""
    words = [word for word in re.split(r"[;\s]+", text) if word]
    if len(words) > 1 and "," in text and all(map(_DECIMAL_COMMA.fullmatch, words)):
        words = [word.replace(",", ".") for word in words]
    else:
        words = [word for word in _SEPARATORS.split(text) if word]
    try:
        return [float(re.sub("[dD]", "e", word)) for word in words]
    except ValueError:
        return None


def _unit_of_time(path: Path, heading: list[str]) -> float:
    """The unit of the times that a heading names [s]; 1 where it names none."""
    found = [(match[0], match[match.lastindex or 0]) for match in
             _UNIT_OF_TIME.finditer("\n".join(heading))]  # fmt: skip
    if all(re.fullmatch(_SECONDS, unit, re.IGNORECASE) for _, unit in found):
        return 1.0
    if all(re.fullmatch(_MILLISECONDS, unit, re.IGNORECASE) for _, unit in found):
        return 1.0e-3
    names = " and ".join(f"'{name.strip()}'" for name, _ in found)
    raise RecordError(f"{path}: found {names} in the heading; expected times in s or in ms")


def _time_step(path: Path, time: np.ndarray) -> float:
    """The time between values [s], which must be even."""
    steps = np.diff(time)
    mean = float(steps.mean())
    if not np.all(steps > 0.0):
        place = int(np.argmin(steps > 0.0)) + 1
        raise RecordError(
            f"{path}: time {time[place]:g} after {time[place - 1]:g}; expected times that ascend"
        )
    if not _is_even(time, steps, mean):
        raise RecordError(
            f"{path}: the time between values goes from {steps.min():g} to {steps.max():g} s; "
            "expected equal times"
        )
    return float(f"{mean:.6g}")


def _is_even(time: np.ndarray, steps: np.ndarray, mean: float) -> bool:
    """Whether the times are even, or were before they were rounded to the digits of the file.

    The difference of two rounded times is off by less than their last digit. The line through the
    first and the last time is off by half a digit at each end, and a time by as much. At a few
    digits a step, a value that is missing looks like a time that was rounded: then the long steps
    are rare.
    """
    if np.abs(steps - mean).max() <= EVEN * mean:
        return True
    digit = _resolution(time)
    line = time[0] + mean * np.arange(time.size)
    is_rounded = bool(
        np.abs(steps - mean).max() < digit and np.abs(time - line).max() <= digit + _ROUND_OFF
    )
    share_of_long = float(np.mean(steps > LONG * np.median(steps)))
    return is_rounded and not 0.0 < share_of_long < RARE


def _resolution(time: np.ndarray) -> float:
    """The last digit that times of a file are written with, at most a millisecond [s]."""
    for digits in range(3, 9):
        if np.allclose(np.round(time, digits), time, rtol=0.0, atol=1e-12):
            return 10.0**-digits
    return 0.0


def _names_of(heading: list[str], count: int) -> list[str]:
    """Names of the components from the last line above the numbers, where it has one a column.

    Other words may stand before those of the columns, the first of which is the time:
    'Record of a dam; columns: t [s], x, y [m/s2]'.
    """
    if heading:
        words = [w for w in re.split(r"[,;\t]+|\s{2,}", heading[-1].lstrip("#%!/* ")) if w.strip()]
        if len(words) == count + 1:
            return [word.strip() for word in words[1:]]
        if len(words) > count + 1 and _NAME_OF_TIME.search(words[-count - 1]):
            return [_UNIT_IN_BRACKETS.sub("", word).strip() for word in words[-count:]]
    return [f"column {k + 2}" for k in range(count)] if count > 1 else ["record"]
