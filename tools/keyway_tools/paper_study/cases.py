"""A case of the study: what it is, and the commands that make its deck."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

import make_dam
import make_jinping
import make_temperature

from .motions import MOTION, Motion

Log = Callable[[str], None]
# Expansion [1/K]; concrete is placed at 16 degrees and cooled to 10 before its joints are grouted.
HEAT = "--temperatures 1e-5 16 10"
CLIMATE = "--air 10 14 --water 12 10 6 --year 12 --start 9 --linear --no-picture"
MONTHS = {"summer": 10.5, "winter": 4.5}  # from 1 October to the middle of August, of February


@dataclass(frozen=True)
class Case:
    """One run: tool and options."""

    name: str
    group: str  # xingbiling, jinping, sensitivity, checks, records
    title: str
    tool: str  # make_dam or make_jinping
    options: str
    factor: str = ""  # of a sensitivity: what it changes
    value: str = ""
    motion: Motion = MOTION
    season: str = ""  # in which the earthquake comes: summer or winter
    level: float = 0.0  # of the water, for the season [m]

    def commands(self, deck: Path, motions: Path) -> list[str]:
        """The command lines that make the deck; `motions` is the folder of made motions."""
        found = [] if self.motion.is_kept else [self.motion.command(motions)]
        found.append(shlex.join([f"tools/{self.tool}.py", *self._arguments(deck, motions)]))
        if self.season:
            words = ["tools/make_temperature.py", *self._climate(deck)]
            found.append(shlex.join(words))
        return found

    def make(self, deck: Path, motions: Path) -> None:
        """Write the deck; raises RuntimeError when that fails."""
        deck.parent.mkdir(parents=True, exist_ok=True)
        self.motion.make(motions)
        tool = make_jinping if self.tool == "make_jinping" else make_dam
        if tool.main(self._arguments(deck, motions)):
            raise RuntimeError(f"case {self.name}: the deck could not be made")
        if self.season and make_temperature.main(self._climate(deck)):
            raise RuntimeError(f"case {self.name}: the temperatures could not be made")

    def _arguments(self, deck: Path, motions: Path) -> list[str]:
        options = shlex.split(self.options)
        if self.season:
            file, months = f"{self.name}_seasons.csv", f"{MONTHS[self.season]:g}"
            options += [*HEAT.split(), "--seasons", file, months, "0.5"]
        motion = self.motion.folder(motions)
        if self.tool == "make_jinping":
            return [str(deck), *options, "--motion-of", str(motion)]
        files = [str(motion / f"motion_{axis}.txt") for axis in "xyz"]
        return ["-o", str(deck), *options, "--motion", *files]

    def _climate(self, deck: Path) -> list[str]:
        months = [str(month) for month in range(int(MONTHS[self.season]) + 2)]
        file = deck.with_name(f"{self.name}_seasons.csv")
        level = ["--level", f"{self.level:g}"]
        return [str(deck), *CLIMATE.split(), *level, "--times", *months, "-o", str(file)]


def choose(cases: list[Case], patterns: list[str]) -> list[Case]:
    """Cases whose name or group fits a pattern; a name goes before a group.

    Raises ValueError where a pattern fits none.
    """
    chosen: list[Case] = []
    for pattern in patterns or ["*"]:
        found = [case for case in cases if case.name == pattern]
        found = found or [c for c in cases if fnmatch(c.name, pattern) or c.group == pattern]
        if not found:
            names = ", ".join(c.name for c in cases if c.group != "records")
            records = [c.name for c in cases if c.group == "records"]
            names += f", {records[0]} to {records[-1]}" if records else ""
            raise ValueError(f"no case fits '{pattern}'; there are {names}")
        chosen += found
    return [case for case in cases if case in chosen]
