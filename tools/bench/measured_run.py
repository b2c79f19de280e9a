"""One measured run of the program."""

from __future__ import annotations

import re
import resource
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from keyway_tools.results import Results


@dataclass(frozen=True)
class Run:
    """The time of a run and its results."""

    wall: float  # [s]
    processor: float  # of all threads, system included [s]
    results: Results

    def cost(self, pattern: str) -> tuple[float, int]:
        """Wall seconds and calls of the ledger's parts whose full name matches."""
        parts = [p for p in self.parts if re.fullmatch(pattern, p["name"])]
        if not parts:
            names = ", ".join(p["name"] for p in self.parts)
            raise SystemExit(f"bench: the ledger has no part like '{pattern}', it has {names}")
        return sum(p["wall_s"] for p in parts), max(p["calls"] for p in parts)

    def mean(self, pattern: str) -> float:
        """Wall seconds of a call."""
        seconds, calls = self.cost(pattern)
        return seconds / calls

    @property
    def parts(self) -> list[dict]:
        return self.results.find("ledger.parts")

    @property
    def unknowns(self) -> int:
        return self.results.find("model.unknowns")


def _summary_in(results: Results, step: int) -> Results | None:
    """The results with their summary of this moment, if the run is in the step."""
    try:
        steps = results.summary["steps"]
    except (OSError, ValueError):
        return None
    is_there = len(steps) >= step and steps[step - 1]["increments"] > 0
    return results if is_there and results.summary["status"] == "running" else None


@dataclass(frozen=True)
class Program:
    """The program under measurement."""

    path: Path
    threads: int = 2

    def run(self, deck: Path, out: Path | None = None, options: Sequence[str] = ()) -> Run:
        out = out or deck.parent / f"results_{deck.stem}"
        words = ["-j", str(self.threads), "-q", *options, "-o", str(out), str(deck)]
        wall, processor = self._time(*words)
        return Run(wall, processor, Results(out, deck.stem))

    def watch(self, deck: Path, step: int) -> tuple[Run | None, Run]:
        """A run, and before it what its summary said first in a step (1, 2, ...), if that was seen.

        A run writes its summary after increments, at most every five seconds.
        """
        out = deck.parent / f"results_{deck.stem}"
        shutil.rmtree(out, ignore_errors=True)
        start, early = time.monotonic(), None
        words = ["-j", str(self.threads), "-q", "-o", str(out), str(deck)]
        silent = subprocess.DEVNULL
        with subprocess.Popen(
            [str(self.path), *words], stdin=silent, stdout=silent, stderr=silent
        ) as process:
            while process.poll() is None:
                time.sleep(0.5)
                if early is None and out.is_dir():
                    early = _summary_in(Results(out, deck.stem), step)
        wall = time.monotonic() - start
        if process.returncode:
            raise SystemExit(f"bench: keyway {' '.join(words)} ended with {process.returncode}")
        run = Run(wall, 0.0, Results(out, deck.stem))
        return (Run(0.0, 0.0, early) if early else None), run

    def check(self, deck: Path) -> float:
        """Processor seconds of reading and verifying a deck."""
        return self._time("--check", str(deck))[1]

    def _time(self, *words: str) -> tuple[float, float]:
        """Wall and processor seconds of a call."""
        start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        silent = subprocess.DEVNULL
        done = subprocess.run([str(self.path), *words], stdin=silent, stdout=silent, stderr=silent)
        wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            raise SystemExit(f"bench: keyway {' '.join(words)} ended with {done.returncode}")
        return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
