"""The units of a deck, as the densities and Young's moduli in the echo of its log show them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from .si_results import SiResults, Units

# The rules of src/keywords/magnitudes/deck_units.f90 for decks that are not in SI.
LIGHTEST_SOLID = 100.0  # densities of solids in kg/m3 lie above
SOFTEST_SOLID = 1.0e6  # Young's moduli in Pa lie above, in MPa below
# Concrete in t, mm, s: 2.4e-9 t/mm3 and 3e4 MPa. In kg and mm, with E in kPa, it has 2.4e-6.
DENSITIES_IN_MM, MODULI_IN_MPA = (1.0e-10, 1.0e-7), (1.0e3, 1.0e6)


@dataclass(frozen=True)
class Recognised:
    """The units that a deck has, and what the pages say of them; '' for SI."""

    units: Units
    words: str = ""
    remark: str = ""  # the same in short, below the pictures


def recognise(log: Path) -> Recognised:
    """The units of the deck whose log this is; SI where it does not show others."""
    densities, moduli = solids_in(log)
    heaviest, stiffest = max(densities, default=0.0), max(moduli, default=0.0)
    if heaviest >= LIGHTEST_SOLID:
        return Recognised(Units())
    if heaviest > 0.0:
        sign = f"a *DENSITY of {heaviest:g}"
    elif 0.0 < stiffest < SOFTEST_SOLID:
        sign = f"a Young's modulus of {stiffest:g}"
    else:
        return Recognised(Units())
    if _is_within(heaviest, DENSITIES_IN_MM) and _is_within(stiffest, MODULI_IN_MPA):
        words = f"the deck is taken to be in mm and MPa ({sign} beside E = {stiffest:g})"
        return Recognised(
            Units.parse("mm,MPa"), f"{words}; --units takes other units", "deck in mm, MPa"
        )
    words = f"the deck is not in SI ({sign}): give --units, as in --units m,kPa; without it values"
    return Recognised(Units(), f"{words} are shown as if in m and Pa", "units of the deck unknown")


def _is_within(value: float, ends: tuple[float, float]) -> bool:
    return ends[0] <= value <= ends[1]


def solids_in(log: Path) -> tuple[list[float], list[float]]:
    """Densities and Young's moduli in the echo of the deck, above its first step."""
    found: dict[str, list[float]] = {"*DENSITY": [], "*ELASTIC": []}
    keyword = ""
    try:
        with log.open(encoding="utf-8", errors="replace") as file:
            for line in takewhile(lambda line: not line.startswith("*STEP"), file):
                if keyword in found:
                    found[keyword] += _first_number(line)
                keyword = line.partition(",")[0].strip() if line.startswith("*") else ""
    except OSError:
        pass
    return found["*DENSITY"], found["*ELASTIC"]


def _first_number(line: str) -> list[float]:
    try:
        return [float(line.partition(",")[0])]
    except ValueError:  # the echo leaves out long tables
        return []


def open_in_si(folder: Path, job: str, given: Units | None, tool: str) -> SiResults:
    """Results in SI; without given units in those that the log shows, which stderr names."""
    if given is not None:
        return SiResults(folder, job, given)
    results = SiResults(folder, job)
    found = recognise(results.path(".log"))
    results.units, results.words_on_units = found.units, found.words
    results.remark_on_units = found.remark
    if found.words:
        print(f"{tool}: {job}: {found.words}", file=sys.stderr)
    return results
