#!/usr/bin/env python3
"""Runs decks with two programs and compares all their results.

BEFORE and AFTER are two executables. The decks are those of input/ and tests/decks, and each DECK.
A difference is relative to the largest value of its column or array; vector components share it,
and so do energies. Times, memory, the ledger and the wording of messages are not compared.
"""

from __future__ import annotations

import argparse
import hashlib
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
import numpy as np
from keyway.batch.cases import has_step
from keyway.deck.deck_file import named_files
from keyway_tools.command import Parser, command
from keyway_tools.input_digest import digest_of
from keyway_tools.option_types import count, count_from_zero, from_zero
from keyway_tools.written_values import Difference, compare_written

ROOT = Path(__file__).resolve().parent.parent
# Two numbers of 13 digits that differ by one in the last digit differ by about 1e-12.
SLACK = 1 + 1e-3


@dataclass(frozen=True)
class Comparison:
    """The two runs of a deck."""

    deck: str
    seconds: tuple[float, float]
    differences: list[Difference]
    num_compared: int

    @property
    def worst(self) -> float:
        return max((d.size for d in self.differences), default=0.0)


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="exit code: 0 the same, 1 differences, 2 usage",
    )
    add = parser.add_argument
    add("before", metavar="BEFORE", type=Path, help="the program to compare with")
    add("after", metavar="AFTER", type=Path, help="the program to judge")
    add("decks", metavar="DECK", type=Path, nargs="*", help="further decks")
    add("-j", metavar="N", type=count, default=1, help="decks at a time (1)")
    add("--threads", metavar="N[,M]", default="1", help="threads of BEFORE and of AFTER (1)")
    add("--only", metavar="TEXT", default="", help="decks whose name holds this text")
    add("--tolerance", type=from_zero, default=1e-12, help="largest difference allowed (1e-12)")
    add("--ignore", action="append", default=[], metavar="PATTERN", help="leave these places out")
    add("-n", type=count_from_zero, default=10, help="differences to show of each deck (10)")
    add(
        "--keep",
        type=Path,
        metavar="DIR",
        help="keep results here; decks with results here are not run again",
    )
    return parser.parse_args(arguments)


def find_decks(more: list[Path], only: str) -> dict[str, Path]:
    """Decks by name, large ones first; a file without steps and tests of materials is no deck."""
    places = [*(ROOT / "input").rglob("*.inp"), *(ROOT / "tests/decks").rglob("*.inp")]
    decks = {name_of(p.resolve()): p.resolve() for p in [*sorted(places), *more]}
    chosen = {n: p for n, p in decks.items() if only in n and (has_step(p) or tests_materials(p))}
    if not chosen:
        raise ValueError("no decks to run")
    size = {n: sum(f.stat().st_size for f in named_files(p) if f.is_file())
            for n, p in chosen.items()}  # fmt: skip
    return {name: chosen[name] for name in sorted(chosen, key=lambda n: -size[n])}


def name_of(deck: Path) -> str:
    """The path from the root of the project, or the name with that of the folder."""
    inside = deck.is_relative_to(ROOT)
    parts = deck.relative_to(ROOT).parts if inside else deck.parts[-2:]
    return "_".join(parts).removesuffix(".inp")


def tests_materials(deck: Path) -> bool:
    return "*MATERIAL TEST" in deck.read_text(encoding="utf-8", errors="replace").upper()


def options_of(deck: Path) -> list[str]:
    """A deck without steps tests materials; a UMAT lies beside its deck and has its name."""
    options = [] if has_step(deck) else ["--material"]
    for ending in (".for", ".f90"):
        source = deck.with_suffix(ending)
        if source.exists():
            options += ["--umat", str(source)]
    return options


def run(program: Path, deck: Path, threads: str, folder: Path) -> tuple[Path, float]:
    """The folder of the results, and the seconds that the run took (0 for results kept)."""
    text = digest_of(deck, sha256(program), options_of(deck)) + threads
    final = folder / f"{name_of(deck)}_{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    if final.exists():
        return final, 0.0
    # The results are moved to their folder at the end, so that others never read a part of them.
    with tempfile.TemporaryDirectory(dir=folder) as place:
        out = Path(place) / "results"
        out.mkdir()
        command = [str(program), "-q", "-o", str(out), "-j", threads, *options_of(deck), str(deck)]
        start = time.monotonic()
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        seconds = time.monotonic() - start
        (out / "run.csv").write_text(f"exit_code\n{done.returncode}\n", encoding="utf-8")
        (out / "run.out").write_text(done.stdout + done.stderr, encoding="utf-8")
        if not final.exists():
            out.rename(final)
    return final, seconds


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def compare(name: str, deck: Path, folder: Path, options: argparse.Namespace) -> Comparison:
    threads = options.threads.split(",")
    before, seconds_before = run(options.before, deck, threads[0], folder)
    after, seconds_after = run(options.after, deck, threads[-1], folder)
    found = [
        d
        for d in compare_written(before, after)
        if not any(fnmatchcase(d.place, pattern) for pattern in options.ignore)
    ]
    past = sorted((d for d in found if d.size > 0), key=lambda d: -d.size)
    if not options.keep:
        for place in {before, after}:
            shutil.rmtree(place)
    return Comparison(name, (seconds_before, seconds_after), past, len(found))


def report(result: Comparison, tolerance: float, count: int) -> bool:
    """Prints the comparison; true when nothing is past the tolerance."""
    past = [d for d in result.differences if d.size > SLACK * tolerance]
    finite = max((d.size for d in result.differences if np.isfinite(d.size)), default=0.0)
    times = " and ".join(f"{s:.1f} s" if s else "kept" for s in result.seconds)
    word = "DIFFERS" if past else "same   "
    tail = f", {len(past)} of them past the tolerance" if past else ""
    print(
        f"{word} {result.deck}: largest {finite:.2e} in {result.num_compared} arrays{tail}; {times}"
    )
    for difference in past[:count]:
        print(f"    {difference.size:.2e} {difference.place}: {difference.text}")
    if len(past) > count:
        print(f"    ... and {len(past) - count} more")
    sys.stdout.flush()
    return not past


def run_all(options: argparse.Namespace, decks: dict[str, Path], folder: Path) -> bool:
    with ThreadPoolExecutor(options.j) as pool:
        futures = [pool.submit(compare, n, p, folder, options) for n, p in decks.items()]
        same = [report(future.result(), options.tolerance, options.n) for future in futures]
    print(f"{sum(same)} of {len(same)} decks the same to {options.tolerance:g}")
    return all(same)


@command("same_results")
def main(arguments: list[str]) -> int:
    options = parse(arguments)
    try:
        options.before, options.after = options.before.resolve(), options.after.resolve()
        for program in (options.before, options.after):
            if not program.is_file():
                raise FileNotFoundError(f"there is no program '{program}'")
        decks = find_decks(options.decks, options.only)
    except (OSError, ValueError) as error:
        print(f"same_results: {error}", file=sys.stderr)
        return 2
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
        return 0 if run_all(options, decks, options.keep.resolve()) else 1
    with tempfile.TemporaryDirectory() as place:
        return 0 if run_all(options, decks, Path(place)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
