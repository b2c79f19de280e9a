"""What a batch runs: written to a file, so that each run can start as a process of its own."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import asdict, dataclass
from pathlib import Path

from keyway_tools.deck_runs import DeckRunner, Record

from .cases import Case


@dataclass(frozen=True)
class Plan:
    """Decks with the folders of their results, and how they are run."""

    program: str
    options: list[str]  # of the program
    timeout: float | None  # [s] of a run
    again: bool  # also runs that have finished
    tasks: list[tuple[str, str]]  # deck and folder

    @classmethod
    def of(cls, program: Path, options: list[str], timeout: float | None, again: bool,
           cases: list[Case]) -> Plan:  # fmt: skip
        tasks = [(str(case.deck.resolve()), str(case.folder.resolve())) for case in cases]
        return cls(str(program), options, timeout, again, tasks)

    @classmethod
    def read(cls, path: Path) -> Plan:
        content = json.loads(path.read_text(encoding="utf-8"))
        content["tasks"] = [(deck, folder) for deck, folder in content["tasks"]]
        return cls(**content)

    def write(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")

    def runner(self) -> DeckRunner:
        return DeckRunner(Path(self.program), self.options, self.timeout)

    def unfinished(self) -> list[int]:
        """Positions of the tasks that have no finished run yet."""
        runner = self.runner()
        return [
            number
            for number, (deck, folder) in enumerate(self.tasks)
            if self.again or not runner.is_kept(Path(deck), Path(folder))
        ]

    def records(self) -> list[Record]:
        """What the runs have left in their folders; 'not run' where there is nothing."""
        runner = self.runner()
        return [runner.record_of(Path(deck), Path(folder)) for deck, folder in self.tasks]


@dataclass(frozen=True)
class Forecast:
    """Time [s] and memory [MB] of a run, as `keyway --check` forecasts them."""

    time: float
    memory: float


def forecast(plan: Plan, number: int) -> Forecast | None:
    """The forecast of a task; None where the program has none (models that are too large)."""
    deck, _ = plan.tasks[number]
    command = [plan.program, *plan.options, "--check", deck]
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    section = done.stdout.partition("Cost on this machine")[2]
    found = [re.search(rf"^ *{name} +about (\S+)", section, re.M) for name in ("time", "memory")]
    if done.returncode or found[0] is None or found[1] is None:
        return None
    return Forecast(float(found[0][1]), float(found[1][1]))
