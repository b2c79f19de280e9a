#!/usr/bin/env python3
"""Runs a deck with less and less memory and prints how each run ends.

usage: tools/memory_limits.py DECK [--program FILE] [--umat FILE] [-j N] [--from MB] [--to MB]
                              [--step MB]

The limit is that of the addresses of the process (ulimit -v). A run ends with code 0, or with code
3 and the part that asked for memory. No file job.lock and no status "running" is left. Anything
else is an error of the program.
"""

from __future__ import annotations

import argparse
import json
import re
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TIME_LIMIT = 600  # s
SYSTEM_FAILED = 3
NO_MEMORY = re.compile("not enough memory in part '.+'|no memory for .+")


@dataclass(frozen=True)
class Outcome:
    """How a run has ended."""

    code: int
    words: str  # line of the messages that names a part, else the last one
    fault: str  # what the folder must not hold, '' for nothing

    @property
    def is_good(self) -> bool:
        is_named = self.code == SYSTEM_FAILED and NO_MEMORY.search(self.words) is not None
        return (self.code == 0 or is_named) and not self.fault


def fault_of(folder: Path, job: str) -> str:
    """What an ended run must not leave."""
    if (folder / f"{job}.lock").exists():
        return "job.lock is left"
    summary = folder / f"{job}.json"
    if summary.exists() and json.loads(summary.read_text())["status"] == "running":
        return 'job.json says "running"'
    return ""


def run_with(program: Path, deck: Path, options: list[str], megabytes: int) -> Outcome:
    """Runs the deck with so much memory."""
    size = megabytes * 2**20
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(
                [str(program), "-q", *options, "-o", folder, str(deck)],
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
            )
        except subprocess.TimeoutExpired:
            return Outcome(-1, f"no end after {TIME_LIMIT} s", "")
        fault = fault_of(Path(folder), deck.stem)
    lines = done.stderr.strip().splitlines()
    words = next(filter(NO_MEMORY.search, lines), lines[-1] if lines else "")
    return Outcome(done.returncode, words, fault)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("deck", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("--umat", type=Path, help="a library; sources need memory of their own")
    parser.add_argument("-j", dest="threads", type=int, default=2)
    parser.add_argument("--from", dest="first", type=int, default=150)
    parser.add_argument("--to", dest="last", type=int, default=1000)
    parser.add_argument("--step", type=int, default=50)
    options = parser.parse_args(arguments)
    words = ["-j", str(options.threads)]
    words += ["--umat", str(options.umat)] if options.umat else []
    failures = 0
    print("| MB | code | message | fault |\n|---|---|---|---|")
    for megabytes in range(options.first, options.last + 1, options.step):
        end = run_with(options.program, options.deck, words, megabytes)
        print(f"| {megabytes} | {end.code} | {end.words} | {end.fault} |", flush=True)
        failures += not end.is_good
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
