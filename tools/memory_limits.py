#!/usr/bin/env python3
"""Runs a deck with less and less memory and prints how each run ends.

usage: tools/memory_limits.py DECK [--program FILE] [-j N] [--from MB] [--to MB] [--step MB]

The limit is that of the addresses of the process (ulimit -v). A run ends with code 0, or with code
3 and the part that asked for memory; anything else is an error of the program.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TIME_LIMIT = 600  # s
SYSTEM_FAILED = 3


def run_with(program: Path, deck: Path, threads: int, megabytes: int) -> tuple[int, str]:
    """Exit code and last line of the messages."""
    size = megabytes * 2**20
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(
                [str(program), "-q", "-j", str(threads), "-o", folder, str(deck)],
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
            )
        except subprocess.TimeoutExpired:
            return -1, f"no end after {TIME_LIMIT} s"
    lines = done.stderr.strip().splitlines()
    return done.returncode, lines[-1] if lines else ""


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("deck", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("-j", dest="threads", type=int, default=2)
    parser.add_argument("--from", dest="first", type=int, default=150)
    parser.add_argument("--to", dest="last", type=int, default=1000)
    parser.add_argument("--step", type=int, default=50)
    options = parser.parse_args(arguments)
    failures = 0
    print("| MB | code | message |\n|---|---|---|")
    for megabytes in range(options.first, options.last + 1, options.step):
        code, words = run_with(options.program, options.deck, options.threads, megabytes)
        print(f"| {megabytes} | {code} | {words} |", flush=True)
        is_named = code == SYSTEM_FAILED and "not enough memory in part" in words
        failures += not (code == 0 or is_named)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
