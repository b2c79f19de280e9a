"""Records of networks: PEER (AT2), COSMOS and CSMIP volume 2, K-NET and KiK-net.

Layouts: PEER Ground Motion Database, "File format"; COSMOS Strong Motion Data Format, version 1.20
(2001): real header 62 is the time between values in ms; NIED, "K-NET ASCII format": counts times
the scale factor are gal, and the mean is taken off.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from .record import FACTORS, Record, RecordError, choose_unit, unit_named_in, units_named_in

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
AT2_COUNT = re.compile(rf"NPTS\s*[=:]\s*(\d+).*?DT\s*[=:]\s*({NUMBER.pattern})", re.IGNORECASE)
AT2_OLD_COUNT = re.compile(rf"^\s*(\d+)\s+({NUMBER.pattern})\s+NPTS\s*,\s*DT", re.IGNORECASE)
AT2_BETWEEN = re.compile(r"[\s,;=():]+")
AT2_SECONDS = re.compile(r"s\.?|secs?\.?|seconds?", re.IGNORECASE)
AT2_KIND = re.compile(r"\b(?:accel|veloc|displ)|\b(?:series|history)\b", re.IGNORECASE)
COSMOS_DATA = re.compile(r"^\s*(\d+)\s+(\w+)\s+pts.*?units?\s*=\s*([^,(]+)", re.IGNORECASE)
COSMOS_REALS = re.compile(r"^\s*(\d+)\s+Real-header values", re.IGNORECASE)
CSMIP_DATA = re.compile(
    r"^\s*(\d+)\s+points of accel data equally spaced at\s*([0-9.]+)\s*sec,?\s*in\s*([^.(]+)",
    re.IGNORECASE,
)
FORMAT = re.compile(r"(\d+)\s*[FE]\s*(\d+)\.(\d+)", re.IGNORECASE)
CHANNEL = re.compile(r"\bCh(?:an|annel)?\s*\.?\s*(\d+)\s*:?\s*([\w .-]{0,12})", re.IGNORECASE)
END_OF_DATA = re.compile(r"\bEnd[ -]of[ -]data\b", re.IGNORECASE)
COSMOS_INTERVAL = 62  # number of the real header with the time between values [ms]
LONGEST_NAME = 12  # of the direction of a PEER record
NO_NUMBER = re.compile(
    r"nan|inf|\*\*", re.IGNORECASE
)  # also a number that its field was too narrow for
MOST_HEADERS = 60  # lines of a channel above its values, without comments


def numbers_in(
    lines: list[str], count: int, width: int | None, path: Path, are_all: bool = False
) -> np.ndarray:
    """The first numbers of some lines, in columns of a width where it is known; `are_all`: the
    lines hold no others.
    """
    values: list[float] = []
    if count < 2:
        raise RecordError(f"{path}: its header says {count} values; expected a record")
    for line in lines:
        _refuse_no_number(path, line)
        if width:
            text = line.rstrip("\n")
            words = [text[k : k + width] for k in range(0, len(text), width)]
            words = [word for word in words if word.strip()]
        else:
            words = NUMBER.findall(line)
        try:
            own = [_real(word) for word in words]
        except ValueError:
            raise RecordError(f"{path}: found '{line.strip()[:40]}'; expected numbers") from None
        if not all(map(math.isfinite, own)):
            raise RecordError(f"{path}: found '{line.strip()[:40]}'; expected finite numbers")
        values += own
        if len(values) >= count and not are_all:
            return np.array(values[:count])
    if len(values) == count:
        return np.array(values)
    raise RecordError(f"{path}: {len(values)} values; its header says {count}")


def _real(word: str) -> float:
    """A number whose exponent may have a D, as Fortran writes it. Raises ValueError."""
    return float(word.upper().replace("D", "E"))


def _refuse_no_number(path: Path, line: str) -> None:
    """Error: a word in place of a number, which a search for numbers would leave out."""
    if NO_NUMBER.search(line):
        raise RecordError(f"{path}: found '{line.strip()[:40]}'; expected finite numbers")


def _interval(path: Path, text: str) -> float:
    """The time between values [s] of a header."""
    try:
        value = _real(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < math.inf:
        raise RecordError(f"{path}: time between values '{text}'; expected a number above 0")
    return value


def read_at2(path: Path, lines: list[str], unit: str | None) -> list[Record]:
    """A PEER file: four lines, then values."""
    found = AT2_COUNT.search(lines[3]) or AT2_OLD_COUNT.search(lines[3])
    if not found:
        raise RecordError(f"{path}:4: found '{lines[3].strip()[:60]}'; expected NPTS= and DT=")
    _refuse_other_words(path, lines[3])
    if re.search(r"velocity|displacement", lines[2], re.IGNORECASE):
        raise RecordError(f"{path}:3: '{lines[2].strip()[:60]}'; expected an acceleration")
    values = numbers_in(lines[4:], int(found[1]), None, path, are_all=True)
    unit = choose_unit(path, _unit_of_at2(path, lines[:3], unit), unit, np.abs(values).max())
    name = lines[1].split(",")[-1].strip()
    if "," not in lines[1] or len(name) > LONGEST_NAME:
        name = path.stem
    return [Record(FACTORS[unit] * values, _interval(path, found[2]), name, path, "PEER AT2", unit)]


def _refuse_other_words(path: Path, line: str) -> None:
    """Error: the fourth line of a PEER file names another unit than seconds."""
    names_interval = False
    for word in AT2_BETWEEN.split(line.strip()):
        if not word or NUMBER.fullmatch(word) or word.upper() == "NPTS":
            continue
        if word.upper() == "DT":
            names_interval = True
        elif not AT2_SECONDS.fullmatch(word):
            raise RecordError(f"{path}:4: found '{word}'; expected NPTS= and DT= in seconds (SEC)")
        elif names_interval:
            return  # what follows does not belong to DT


def _unit_of_at2(path: Path, header: list[str], asked: str | None) -> str | None:
    """The unit of a header: that of the lines that say what the record is, else that of all. Of two
    units the one that is asked for counts.
    """
    own = [line for line in header if AT2_KIND.search(line)]
    named = units_named_in("\n".join(own)) or units_named_in("\n".join(header))
    if len(named) > 1 and asked not in named:
        raise RecordError(
            f"{path}: the file names the units {' and '.join(named)}; give that of its values"
        )
    return asked if len(named) > 1 else next(iter(named), None)


def read_cosmos(path: Path, lines: list[str], unit: str | None) -> list[Record]:
    """The channels of acceleration of a COSMOS file."""
    records, start = [], 0
    for number, line in enumerate(lines):
        found = COSMOS_DATA.match(line)
        if not found:
            continue
        heading, start = lines[start:number], number + 1
        if not found[2].lower().startswith("accel"):
            continue
        width = int(FORMAT.search(line)[2]) if FORMAT.search(line) else None
        values = numbers_in(lines[number + 1 :], int(found[1]), width, path)
        own = unit_named_in(f"({found[3].strip()})") or unit_named_in(found[3])
        chosen = choose_unit(path, own, unit, np.abs(values).max())
        step = _cosmos_interval(path, heading)
        name = _channel_of(heading, len(records) + 1)
        records.append(Record(FACTORS[chosen] * values, step, name, path, "COSMOS", chosen))
    return records


def _cosmos_interval(path: Path, heading: list[str]) -> float:
    """The time between values [s] from the real header of a channel."""
    for number, line in enumerate(heading):
        found = COSMOS_REALS.match(line)
        if found:
            layout = FORMAT.search(line)
            width = int(layout[2]) if layout else None
            count = int(found[1])
            if count < COSMOS_INTERVAL:
                raise RecordError(f"{path}: {count} real headers; expected {COSMOS_INTERVAL}")
            values = numbers_in(heading[number + 1 :], count, width, path)
            return 1.0e-3 * _interval(path, f"{values[COSMOS_INTERVAL - 1]:g}")
    raise RecordError(f"{path}: no real header; expected '100 Real-header values follow'")


def read_csmip(path: Path, lines: list[str], unit: str | None) -> list[Record]:
    """The channels of acceleration of a file of the Californian network (volume 2)."""
    records, start = [], 0
    for number, line in enumerate(lines):
        found = CSMIP_DATA.match(line)
        if not found:
            continue
        width = int(FORMAT.search(line)[2]) if FORMAT.search(line) else None
        values = numbers_in(lines[number + 1 :], int(found[1]), width, path)
        chosen = choose_unit(path, unit_named_in(found[3]), unit, np.abs(values).max())
        name = _channel_of(lines[max(start, number - MOST_HEADERS) : number], len(records) + 1)
        step = _interval(path, found[2])
        records.append(Record(FACTORS[chosen] * values, step, name, path, "CSMIP", chosen))
        start = number + 1
    return records


def _channel_of(heading: list[str], number: int) -> str:
    """Number and direction of a channel as its header names them. The line at the end of the
    channel before, which the lines above a header may hold, names that channel.
    """
    for line in heading:
        found = CHANNEL.search(line)
        if found and not END_OF_DATA.search(line):
            return f"channel {found[1]} {found[2].strip()}".strip()
    return f"channel {number}"


def read_kyoshin(path: Path, lines: list[str], unit: str | None) -> list[Record]:
    """A file of K-NET or KiK-net."""
    facts = {line[:18].strip(): line[18:].strip() for line in lines[:17]}
    try:
        interval = 1.0 / float(NUMBER.search(facts["Sampling Freq(Hz)"])[0])
        factor, counts = (float(NUMBER.search(s)[0]) for s in facts["Scale Factor"].split("/"))
        scale = factor / counts
        direction = facts["Dir."]
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        raise RecordError(
            f"{path}: expected Sampling Freq(Hz), Dir. and Scale Factor in the first 17 lines"
        ) from None
    choose_unit(path, "CM/S2", unit, 0.0)
    for line in lines[17:]:
        _refuse_no_number(path, line)
    text = [NUMBER.findall(line) for line in lines[17:]]
    values = np.array([float(word) for words in text for word in words]) * scale
    if values.size < 2:
        raise RecordError(f"{path}: no values after the first 17 lines")
    values = 0.01 * (values - values.mean())
    return [Record(values, interval, direction, path, "K-NET", "CM/S2")]
