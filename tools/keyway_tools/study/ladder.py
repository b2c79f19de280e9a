"""Runs the rungs of a deck within a time budget. Finished runs are kept and not run again."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from keyway_tools.deck_runs import DeckRunner
from keyway_tools.results import Results

from .deck_cards import Deck
from .measured import Measured, measure
from .refined_mesh import RefinementError
from .rungs import Rung, as_it_is

# The order in which the budget is spent.
PRIORITY = (
    "base", "increment", "mesh", "element", "tolerance", "stiffness", "alpha", "solver", "effect",
)  # fmt: skip
JOB = "study"


@dataclass
class Outcome:
    """A rung with what became of it."""

    rung: Rung
    predicted: float | None  # seconds; None: not known before the first run
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
        self.rungs = sorted(rungs, key=lambda rung: PRIORITY.index(rung.axis))
        self.folder = folder
        self.runner = runner
        self.budget = budget  # seconds of all runs
        self.say = say
        self.spent = 0.0

    def run(self) -> list[Outcome]:
        """Runs all rungs that fit into the budget. The first one is the deck as it is."""
        found: list[Outcome] = []
        for rung in self.rungs:
            known = found[0].measured if found else None
            predicted = known.seconds * rung.factor if known else None
            outcome = Outcome(rung, predicted)
            found.append(outcome)
            if predicted is not None and self.spent + predicted > self.budget:
                outcome.why_not = f"would take about {predicted:.0f} s: beyond the budget"
                self.say(f"{rung.name}: {outcome.why_not}")
                continue
            self.run_one(outcome)
            if rung.change is as_it_is and outcome.measured is None:
                raise RuntimeError(f"the deck as it is does not run: {outcome.why_not}")
        return found

    def run_one(self, outcome: Outcome) -> None:
        """Runs one rung, or reads its results."""
        rung = outcome.rung
        name = re.sub(r"[^a-z0-9]+", "_", rung.name.lower()).strip("_")
        folder = self.folder / "runs" / name
        folder.mkdir(parents=True, exist_ok=True)
        deck = folder / f"{JOB}.inp"
        try:
            write_changed(deck, rung.change(self.base).text())
        except RefinementError as error:
            outcome.why_not = str(error)
            self.say(f"{rung.name}: {error}")
            return
        about = "" if outcome.predicted is None else f", about {outcome.predicted:.0f} s"
        self.say(f"{rung.name}{about} ..")
        self.runner.timeout = max(60.0, self.budget - self.spent)
        started = time.monotonic()
        record = self.runner.run(deck, folder / "results")
        self.spent += time.monotonic() - started
        if record.status != "finished":
            outcome.why_not = f"{record.status}: {record.message}".rstrip(": ")
            self.say(f"{rung.name}: {outcome.why_not}")
            return
        outcome.measured = measure(Results(folder / "results", JOB))
        kept = " (kept from an earlier call)" if record.was_kept else ""
        self.say(f"{rung.name}: {outcome.measured.seconds:.1f} s{kept}")


def write_changed(path: Path, text: str) -> None:
    """Writes a file unless it has this text already."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
