"""Results in metres, newtons, kilograms and seconds, whatever the units of the deck are."""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .result_files import Table
from .results import Results, Step

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "in": 0.0254}  # [m]
STRESSES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "psi": 6894.757293}  # [Pa]

ROUND_OFF = 1e-10  # of the size of the model; displacements are solved to some 1e-12 of it

_LENGTH = re.compile(r"(?:[xyzUVA]|[UVA][123]|opening|slip[12]?|clearance|PENETRATION)$")
_STRESS = re.compile(r"(?:t[n12]|S[123][123]|SP[123]|S[13](?:_POINT)?|pressure|water)$")
_ENERGY = re.compile(
    r"(?:external|kinetic|strain|damping|friction|fracture|crushing|numerical|cracking|created"
    r"|stages|temperature)$"
)
_VOLUME = re.compile(r"(?:volume.*|inelastic_volume)$")


@dataclass(frozen=True)
class Units:
    """Units of length and stress of a deck; those of mass and energy follow (time in s)."""

    length: float = 1.0  # [m]
    stress: float = 1.0  # [Pa]

    @staticmethod
    def parse(text: str) -> Units:
        """Units from a word such as 'mm,MPa'."""
        length, _, stress = text.partition(",")
        try:
            return Units(LENGTHS[length.strip()], STRESSES[stress.strip()])
        except KeyError:
            known = f"{', '.join(LENGTHS)} and {', '.join(STRESSES)}"
            raise ValueError(f"units '{text}': expected a length and a stress of {known}") from None

    @property
    def energy(self) -> float:
        """The unit of energy [J]."""
        return self.stress * self.length**3

    @property
    def mass(self) -> float:
        """The unit of mass [kg]: force over acceleration."""
        return self.stress * self.length

    def of(self, name: str) -> float:
        """The SI value of the unit of a column or field."""
        kinds = ((_LENGTH, self.length), (_STRESS, self.stress), (_ENERGY, self.energy))
        for pattern, factor in (*kinds, (_VOLUME, self.length**3)):
            if pattern.match(name):
                return factor
        return 1.0


class SiResults(Results):
    """Results of a job in SI units."""

    def __init__(self, folder: Path | str, job: str | None = None, units: Units | None = None):
        super().__init__(folder, job)
        self.units = units or Units()
        self.words_on_units = self.remark_on_units = ""  # where the tool has chosen them

    @cached_property
    def x(self) -> np.ndarray:
        """Coordinates of the nodes [m]."""
        return self.units.length * self.file["mesh/x"][:]

    def steps(self) -> list[Step]:
        """The steps, their envelopes in SI units; openings without round-off."""
        found = super().steps()
        for step in found:
            for name, values in step.envelopes.items():
                step.envelopes[name] = self._envelope_unit(name) * values
            if "OPENING" in step.envelopes:
                step.envelopes["OPENING"] = self.without_round_off(step.envelopes["OPENING"])
        return found

    def without_round_off(self, lengths: np.ndarray | float) -> np.ndarray:
        """Openings or slips [m] in which round-off is zero.

        A closed joint, whose faces have displacements of centimetres, may open by 1e-18 m.
        """
        least = ROUND_OFF * float(np.ptp(self.x, axis=0).max())
        return np.where(np.abs(lengths) <= least, 0.0, lengths)

    def _envelope_unit(self, field: str) -> float:
        return self.units.length if field == "OPENING" else self.units.of(field)

    def displacement(self, place: str) -> np.ndarray:
        """A saved displacement field [m], shape (nodes, 3)."""
        return self.units.length * self.file[place][:]

    def effective_mass(self) -> np.ndarray | None:
        """Effective masses of the modes [kg], shape (modes, 3)."""
        for step in reversed(list(self.file["steps"].values())):
            if "modes" in step:
                if "effective_mass" not in step["modes"]:
                    return None
                return self.units.mass * step["modes/effective_mass"][:]
        return None

    def table(self, name: str) -> Table:
        """Columns of a table in SI units."""
        return self._in_si(super().table(name))

    def history(self, name: str) -> Table:
        """A history in SI units."""
        return self._in_si(super().history(name))

    def _in_si(self, table: Table) -> Table:
        return {
            name: column if column.dtype.kind == "O" else self.units.of(name) * column
            for name, column in table.items()
        }

    @cached_property
    def si_summary(self) -> dict[str, Any]:
        """The summary JOB.json, its values and places in SI units."""
        content = dict(self.summary)
        content["envelopes"] = {
            field: self._extremes(values, self._envelope_unit(field))
            for field, values in content.get("envelopes", {}).items()
        }
        if isinstance(content.get("displacement"), dict):
            moved = content["displacement"]
            content["displacement"] = self._extremes(moved, self.units.length)
        content["joints"] = {
            name: {
                key: self._extremes(value, self.units.of(key)) if isinstance(value, dict) else value
                for key, value in joint.items()
            }
            for name, joint in content.get("joints", {}).items()
        }
        return content

    def _extremes(self, values: dict[str, Any], unit: float) -> dict[str, Any]:
        found = {}
        for where, extreme in values.items():
            changed = dict(extreme)
            if isinstance(extreme.get("value"), int | float):
                changed["value"] = unit * extreme["value"]
            if "x" in extreme:
                changed["x"] = [self.units.length * v for v in extreme["x"]]
            found[where] = changed
        return found

    @property
    def deck_name(self) -> str:
        """The deck's file without its folder; the job where the summary does not name it."""
        try:
            return Path(self.find("deck.file")).name
        except (KeyError, OSError, ValueError):
            return self.job

    @property
    def date(self) -> str:
        """The day and hour at which the summary was written last."""
        try:
            stamp = self.path(".json").stat().st_mtime
        except OSError:
            return ""
        return datetime.datetime.fromtimestamp(stamp).astimezone().strftime("%Y-%m-%d %H:%M")

    @property
    def note(self) -> str:
        """Deck, date and program in one line; with units that the tool has chosen."""
        program = self.summary.get("program", {}) if self.path(".json").exists() else {}
        name = " ".join(str(program[key]) for key in ("name", "version") if key in program)
        words = (self.deck_name, self.remark_on_units, self.date, name)
        return " · ".join(word for word in words if word)


def saved_increments(results: Results) -> Iterator[tuple[Any, float]]:
    """Groups of all saved increments in job.h5 and their times, in their order."""
    for key in sorted(results.file["steps"]):
        for _, group in sorted(results.file["steps"][key].get("increments", {}).items()):
            yield group, float(np.ravel(group.attrs["time"])[0])
