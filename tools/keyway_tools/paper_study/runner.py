"""Makes the decks of cases and runs them within a budget; finished runs are kept."""

from __future__ import annotations

import contextlib
import io
import shutil
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from ..deck_runs import DeckRunner, Record, earlier_record
from .cases import Case, Log

LEFT_OUT = "not run: the budget is spent"


@dataclass(frozen=True)
class Outcome:
    """A case and how its run went."""

    case: Case
    record: Record

    @property
    def is_finished(self) -> bool:
        """Whether the run has come to its end."""
        return self.record.status == "finished"

    @property
    def folder(self) -> Path:
        """The results."""
        return Path(self.record.folder)


class Study:
    """The folder of a study: decks, motions and runs."""

    def __init__(self, folder: Path, runner: DeckRunner, budget: float, log: Log):
        self.folder, self.runner, self.log = folder, runner, log
        self.until = time.monotonic() + budget
        self._making = threading.Lock()  # decks are made one by one: they share the output

    def run(self, cases: list[Case], at_once: int) -> list[Outcome]:
        """All cases, some at a time; those that the budget leaves out are not run."""
        if at_once == 1:  # without threads a run ends with this process, however that ends
            return [Outcome(case, self._run(case)) for case in cases]
        with ThreadPoolExecutor(at_once) as pool:
            waiting = [(case, pool.submit(self._run, case)) for case in cases]
            try:
                return [Outcome(case, future.result()) for case, future in waiting]
            except KeyboardInterrupt:
                self.runner.end()
                raise

    def with_kept(self, outcomes: list[Outcome], cases: list[Case]) -> list[Outcome]:
        """`outcomes` and what earlier calls have finished of the other `cases`, in their order."""
        known = {outcome.case.name: outcome for outcome in outcomes}
        for case in cases:
            folder = self.folder / "runs" / case.name
            if case.name in known or not has_finished(folder):
                continue
            deck = self.deck_of(case)
            if self.runner.is_kept(deck, folder):
                known[case.name] = Outcome(case, self.runner.run(deck, folder))
        return [known[case.name] for case in cases if case.name in known]

    def deck_of(self, case: Case) -> Path:
        """The deck of a case, made anew: the same options give the same bytes."""
        deck = self.folder / "decks" / case.name / f"{case.name}.inp"
        with self._making, contextlib.redirect_stdout(io.StringIO()):
            case.make(deck, self.folder / "motions")
        return deck

    def _run(self, case: Case) -> Record:
        folder = self.folder / "runs" / case.name
        left_out = Record("", str(folder), LEFT_OUT)
        if self._is_over() and not has_finished(folder):  # its deck may take minutes to make
            return left_out
        try:
            deck = self.deck_of(case)
        except (RuntimeError, ValueError, OSError) as fault:
            return Record("", str(folder), "no deck", message=str(fault))
        if not self.runner.is_kept(deck, folder):
            if self._is_over():
                return left_out
            if shutil.disk_usage(self.folder).free < 1 << 30:
                return Record("", str(folder), "not run: less than 1 GB of the disk is free")
            self.log(f"{case.name}: running")
        record = self.runner.run(deck, folder)
        kept = " (kept)" if record.was_kept else f", {record.wall_s:.1f} s"
        self.log(f"{case.name}: {record.status}{kept}")
        return record

    def _is_over(self) -> bool:
        """Whether no case may start any more."""
        return time.monotonic() > self.until or self.runner.is_ending


def has_finished(folder: Path) -> bool:
    """Whether some run, perhaps of an older deck, has finished in the folder."""
    earlier = earlier_record(folder)
    return earlier is not None and earlier.status == "finished"
