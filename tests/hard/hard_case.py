"""A hard case: what is hard, the number that judges it, and the effort of its runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from dam_trials import increments_of
from harness import Program, Run

Judge = Callable[[Program], tuple[float, list[Run]]]


@dataclass(frozen=True)
class HardCase:
    """A case holds where its runs end and its number is at most `limit`."""

    name: str
    hard: str  # what is hard
    criterion: str  # what the number is
    limit: float
    judge: Judge
    full: bool = False
    waits_for: str = ""  # the part of the program that the case waits for

    def run(self, program: Program) -> Finding:
        value, runs = self.judge(program)
        return Finding(self, value, runs)


@dataclass
class Finding:
    """The number of a case and its runs."""

    case: HardCase
    value: float
    runs: list[Run]

    @property
    def holds(self) -> bool:
        return bool(self.value <= self.case.limit)  # a NaN does not hold

    @cached_property
    def unknowns(self) -> int:
        return max(run.json["model"]["unknowns"] for run in self.runs)

    @cached_property
    def iterations(self) -> int:
        """The most in one increment."""
        return max(int(increments_of(run)["iterations"].max(initial=0)) for run in self.runs)

    @property
    def increments(self) -> int:
        return sum(step["increments"] for run in self.runs for step in run.json["steps"])

    @property
    def cuts(self) -> int:
        return sum(step["cutbacks"] for run in self.runs for step in run.json["steps"])

    @property
    def seconds(self) -> float:
        return sum(run.json["ledger"]["wall_s"] for run in self.runs)


class Recorder:
    """A program that keeps its runs."""

    def __init__(self, program: Program):
        self.program = program
        self.runs: list[Run] = []

    def __call__(self, *arguments, **options) -> Run:
        self.runs.append(self.program(*arguments, **options))
        return self.runs[-1]


class Chapter:
    """Cases of one kind, in the order of their functions."""

    def __init__(self, title: str):
        self.title = title
        self.cases: list[HardCase] = []

    def case(self, name: str, hard: str, criterion: str, limit: float, **more):
        """Adds the function below as a case; it returns the number and the runs."""

        def add(judge: Judge) -> Judge:
            self.cases.append(HardCase(name, hard, criterion, limit, judge, **more))
            return judge

        return add


def energies(run: Run) -> dict[str, np.ndarray]:
    return run.csv("energy")


def fed(run: Run) -> float:
    """Energy that nothing supplies: the largest rise of kinetic and strain energy less the work of
    the loads, over the largest of these three."""
    table = energies(run)
    mechanical = table["kinetic"] + table["strain"] - table["external"]
    rise = np.max(mechanical - np.minimum.accumulate(mechanical))
    largest = max(np.abs(table[name]).max() for name in ("kinetic", "strain", "external"))
    return float(rise / largest)


def supplied(run: Run) -> float:
    """Energy that the time stepping has added by the end, over the largest; 0 if it has taken."""
    table = energies(run)
    largest = max(np.abs(table[name]).max() for name in ("kinetic", "strain", "external"))
    return float(max(-table["numerical"][-1] / largest, 0.0))


def unbalance(run: Run) -> float:
    """The largest error of the energy balance."""
    return float(max(step["energy"]["error"] for step in run.json["steps"]))


def off(found, exact, scale: float | None = None) -> float:
    """The largest difference over the largest exact value."""
    wrong = np.abs(np.asarray(found) - np.asarray(exact)).max()
    return float(wrong / (scale or np.abs(exact).max()))


def over_limits(energy: float, cuts: int, iterations: int = 0) -> float:
    """At most 1 where energy is right to 1e-6, no increment was cut, and none took more than 25
    iterations."""
    return max(energy / 1e-6, iterations / 25, 1.0 + cuts if cuts else 0.0)
