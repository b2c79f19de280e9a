"""A recorded acceleration, and the units that records come in."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..response_spectrum import GRAVITY

AXES = ("x", "y", "z")
FACTORS = {"G": GRAVITY, "M/S2": 1.0, "CM/S2": 0.01, "MM/S2": 0.001}  # to m/s2
_PER_SECOND_SQUARED = r"\s*/\s*(?:s(?:ec)?\s*(?:\^|\*\*)?\s*2|s(?:ec)?\s*/\s*s(?:ec)?)(?![0-9])"
_NAMES = {
    "MM/S2": re.compile(rf"(?<![a-z])mm{_PER_SECOND_SQUARED}", re.IGNORECASE),
    "CM/S2": re.compile(rf"(?<![a-z])(?:cm{_PER_SECOND_SQUARED}|gals?(?![a-z]))", re.IGNORECASE),
    "M/S2": re.compile(rf"(?<![a-z])m{_PER_SECOND_SQUARED}", re.IGNORECASE),
    "G": re.compile(
        r"\(\s*g\s*\)|\[\s*g\s*\]|units? (?:of|are|=|:)?\s*\(?g\)?(?![a-z])|_g\b", re.I
    ),
}


class RecordError(ValueError):
    """A file that is no record, or lacks what is needed to read it."""


@dataclass(frozen=True)
class Record:
    """One component."""

    acceleration: np.ndarray  # [m/s2] at equal times from 0
    dt: float  # [s]
    name: str  # of the component in its file
    source: Path
    layout: str  # kind of the file
    unit: str  # of the values in the file

    @property
    def peak(self) -> float:
        """Largest acceleration [m/s2]."""
        return float(np.abs(self.acceleration).max())

    def with_values(self, acceleration: np.ndarray, dt: float | None = None) -> Record:
        """The same component with other values."""
        return replace(self, acceleration=acceleration, dt=self.dt if dt is None else dt)


def unit_named_in(text: str) -> str | None:
    """The unit that a text names; None if it names none, or more than one."""
    found = units_named_in(text)
    return found[0] if len(found) == 1 else None


def units_named_in(text: str) -> list[str]:
    """All units that a text names."""
    return [unit for unit, pattern in _NAMES.items() if pattern.search(text)]


def choose_unit(path: Path, named: str | None, asked: str | None, largest: float) -> str:
    """The unit asked for, or the one that the file names."""
    if asked:
        if named and named != asked:
            raise RecordError(
                f"{path}: the file names the unit {named}, and the unit given is {asked}"
            )
        return asked
    if named is None:
        raise RecordError(
            f"{path}: the file names no unit; its largest value is {largest:.4g}; "
            f"give the unit of its values: {', '.join(FACTORS)}"
        )
    return named
