"""Runs the rungs of a deck within a time budget. Finished runs are kept and not run again."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from keyway_tools.deck_runs import DeckRunner, Record
from keyway_tools.results import Results

from .deck_cards import Deck
from .measured import Measured, measure, time_in_words
from .refined_mesh import RefinementError
from .rungs import ELEMENT_CHECK, TWICE, Rung

# The order in which the budget is spent.
PRIORITY = (
    "base", "increment", "mesh", "element", "tolerance", "coupling", "stiffness", "alpha", "solver",
    "effect", "finer", ELEMENT_CHECK,
)  # fmt: skip
# Axes that change the size of the model.
FORECAST_BY_COUNTS = ("mesh", "coupling", "finer", ELEMENT_CHECK)
JOB = "study"
SHORTEST = 10.0  # time that a run has at least before the budget ends it [s]


@dataclass
class Outcome:
    """A rung with what became of it."""

    rung: Rung
    predicted: float | None  # seconds; None: not known
    measured: Measured | None = None
    why_not: str = ""  # why there are no numbers

    @property
    def name(self) -> str:
        return self.rung.name


class Ladder:
    """The rungs of one deck in one folder."""

    def __init__(
        self,
        base: Deck,
        rungs: Sequence[Rung],
        folder: Path,
        runner: DeckRunner,
        budget: float,
        say: Callable[[str], None] = print,
    ):
        self.base = base
        self.rungs = sorted(rungs, key=lambda r: (r.name == TWICE, PRIORITY.index(r.axis)))
        self.folder = folder
        self.runner = runner
        self.budget = budget  # seconds of all runs
        self.say = say
        self.spent = 0.0
        self.waited, self.worked = 0.0, 0.0  # time of the fresh runs: by the clock, measured

    def run(self) -> list[Outcome]:
        """Runs all rungs that fit into the budget. The first one is the deck as it is."""
        first = Outcome(self.rungs[0], self.forecast(self.rungs[0]))
        if (first.predicted or 0.0) > self.budget and not self.is_kept(first.rung):
            raise RuntimeError(
                f"the deck as it is would take about {time_in_words(first.predicted or 0.0)}, "
                f"the budget is {time_in_words(self.budget)}"
            )
        self.run_one(first)
        if first.measured is None:
            raise RuntimeError(f"the deck as it is does not run: {first.why_not}")
        found = [first, *(self.planned(rung, first) for rung in self.rungs[1:])]
        self.say_plan(found)
        self.run_planned(found)
        return found

    def go_on(self, found: list[Outcome], rung: Rung) -> None:
        """Runs one more rung that the results ask for, and adds it."""
        outcome = self.planned(rung, found[0])
        self.run_planned([found[0], outcome])
        found.append(outcome)

    def run_planned(self, found: list[Outcome]) -> None:
        """Runs what fits into the budget; the first one, the deck as it is, has run."""
        for outcome in found[1:]:
            if outcome.why_not:
                self.say(f"{outcome.name}: {outcome.why_not}")
                continue
            if outcome.name == TWICE:
                outcome.predicted = predicted_twice(found) or outcome.predicted
            left = self.budget - self.spent
            needed = self.delay() * (outcome.predicted or 0.0)
            if needed > left and not self.is_kept(outcome.rung):
                outcome.why_not = f"would take about {time_in_words(needed)}: beyond the budget"
                self.say(f"{outcome.name}: {outcome.why_not}")
                continue
            self.run_one(outcome)

    def planned(self, rung: Rung, base: Outcome) -> Outcome:
        """A rung with its predicted time, or with the reason why it cannot be run."""
        try:
            return Outcome(rung, self.predict(rung, base))
        except RefinementError as error:
            return Outcome(rung, None, why_not=str(error))

    def delay(self) -> float:
        """How long a measured second takes: other programs may keep the machine busy."""
        return max(1.0, self.waited / self.worked) if self.worked > 1.0 else 1.0

    def say_plan(self, outcomes: list[Outcome]) -> None:
        """The predicted time of all rungs before they run."""
        self.say(f"predicted time of the variants, budget {time_in_words(self.budget)}:")
        for outcome in outcomes[1:]:
            if not outcome.why_not:
                self.say(f"  {time_in_words(outcome.predicted or 0.0):>10}  {outcome.name}")
        total = sum(outcome.predicted or 0.0 for outcome in outcomes)
        self.say(f"  {time_in_words(total):>10}  in all")

    def predict(self, rung: Rung, base: Outcome) -> float:
        """Seconds of a rung, from those of the deck as it is.

        Where the size of the model changes, the forecasts of the program give the ratio.
        """
        assert base.measured
        factor = rung.factor
        # The deck of a mesh that is refined twice is large: it is written when it is run.
        if rung.axis in FORECAST_BY_COUNTS and rung.name != TWICE and base.predicted:
            found = self.forecast(rung)
            if found is not None:
                factor = found / base.predicted
        return base.measured.seconds * factor

    def forecast(self, rung: Rung) -> float | None:
        """What the program says that the deck of a rung takes [s]; None if it says nothing.

        Raises RefinementError.
        """
        deck = self.write_deck(rung)
        command = [str(self.runner.program), *self.runner.options, "--check", str(deck)]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        found = re.search(r"time +about (\S+) s", done.stdout.partition("Cost on this machine")[2])
        return float(found[1]) if found else None

    def folder_of(self, rung: Rung) -> Path:
        name = re.sub(r"[^a-z0-9]+", "_", rung.name.lower()).strip("_")
        return self.folder / "runs" / name

    def write_deck(self, rung: Rung) -> Path:
        """The deck of a rung; it is left alone if it is the same as before."""
        folder = self.folder_of(rung)
        found = rung.change(self.base)
        folder.mkdir(parents=True, exist_ok=True)
        deck = folder / f"{JOB}.inp"
        found.write(deck)
        return deck

    def is_kept(self, rung: Rung) -> bool:
        """Whether an earlier call has finished this rung."""
        try:
            deck = self.write_deck(rung)
        except RefinementError:
            return False
        return self.runner.is_kept(deck, self.folder_of(rung) / "results")

    def run_one(self, outcome: Outcome) -> None:
        """Runs one rung, or reads its results."""
        rung = outcome.rung
        try:
            deck = self.write_deck(rung)
        except RefinementError as error:
            outcome.why_not = str(error)
            self.say(f"{rung.name}: {error}")
            return
        about = "" if outcome.predicted is None else f", about {time_in_words(outcome.predicted)}"
        self.say(f"{rung.name}{about} ..")
        self.runner.timeout = max(SHORTEST, self.budget - self.spent)
        started = time.monotonic()
        record = self.runner.run(deck, self.folder_of(rung) / "results")
        elapsed = time.monotonic() - started
        self.spent += elapsed
        if self.runner.is_ending:
            raise KeyboardInterrupt
        if record.status != "finished":
            outcome.why_not = why_not(record)
            self.say(f"{rung.name}: {outcome.why_not}")
            return
        outcome.measured = self.measure(rung, record)
        if not record.was_kept:
            self.waited += elapsed
            self.worked += outcome.measured.seconds
        kept = " (kept from an earlier call)" if record.was_kept else ""
        self.say(f"{rung.name}: {time_in_words(outcome.measured.seconds)}{kept}")

    def measure(self, rung: Rung, record: Record) -> Measured:
        """The numbers of a run. One thread: its own seconds, whatever else the machine does."""
        found = measure(Results(self.folder_of(rung) / "results", JOB))
        found.processor = record.processor_s or 0.0
        if is_alone(self.runner.options) and record.processor_s:
            found.seconds = record.processor_s
        return found


def predicted_twice(found: Sequence[Outcome]) -> float | None:
    """Seconds of the mesh refined twice: the second refinement multiplies the time as the first
    did. None where the first was not run."""
    base, once = found[0], next((o for o in found if o.rung.axis == "mesh"), None)
    if not once or not once.measured or not base.measured:
        return None
    return once.measured.seconds**2 / base.measured.seconds


def is_alone(options: list[str]) -> bool:
    """Whether a run has one thread."""
    return "-j" in options and options[options.index("-j") + 1] == "1"


def why_not(record: Record) -> str:
    """Why a run gives no numbers."""
    if record.status == "timed out":
        return "did not end within the budget"
    return f"{record.status}: {record.message}".rstrip(": ")
