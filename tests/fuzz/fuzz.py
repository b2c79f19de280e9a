#!/usr/bin/env python3
"""Mutates decks and lets the program check them: it accepts or refuses each, and never crashes.

usage: tests/fuzz/fuzz.py [--program FILE] [--mutants N] [--seed S] [--all] [--runs] [--keep DIR]

A mutant is good if the program ends in time with code 0 or 2, prints a message with code 2, prints
no text of a run-time library, and leaves no file. Code 3 is good with the message on missing
memory. With --runs mutants that pass the check are also run (code 0 to 3, files allowed). Bad
mutants are kept in DIR. Mutant i of a seed is always the same.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
ROOT = TESTS.parent
TIME_LIMIT = 30  # s; a check takes 0.02 s
MEMORY_LIMIT = 2 * 2**30  # bytes
LARGEST = 20_000  # bytes of a deck: larger ones take most of the time (--all)
NUMBERS_OF_CHANGES = [1, 1, 1, 2, 2, 4]  # of a mutant: many changes end in early errors

NUMBERS = [
    "0", "-1", "1", "2", "-0.", "1e150", "1e151", "-1e308", "1e-320", "1e400", "2147483647",
    "2147483648", "-2147483648", "99999999999999999999", "nan", "inf", "1.D+3", "1e", ".", "+",
    "0.5", "1e-12", "3", "1000000", "", " ", "0x10", "1_8", "1/2", "31 GPa",
]  # fmt: skip
WORDS = [
    "*", "**", ",", "=", "'", '"', "..", ".", "a/b", "\0", "\t", "\r", "é", "\xff", "x" * 300,
    ", ,", "OP=NEW", "GENERATE", "AMPLITUDE=A", "NAME=X", "ELSET=ALL", "TYPE=C3D8", "*END STEP",
    "*STEP", "*INCLUDE, INPUT=deck.inp", "*INCLUDE, INPUT=/dev/zero", "*INCLUDE, INPUT=..",
]  # fmt: skip
TEXTS_OF_A_CRASH = re.compile(
    r"Backtrace|Fortran runtime error|SIGSEGV|ERROR STOP|AddressSanitizer|runtime error:|"
    r"fault of the program|terminate called|free\(\)|malloc\(\)|double free"
)


@dataclass(frozen=True)
class Deck:
    """A deck and the options that it needs."""

    path: Path
    text: str
    options: tuple[str, ...]


@dataclass(frozen=True)
class Outcome:
    """What the program did with a mutant."""

    number: int
    code: int
    problem: str  # '' for a good mutant


def all_decks(largest: int = LARGEST) -> list[Deck]:
    """Decks of the tests and of input/ up to a size."""
    paths = sorted((TESTS / "errors" / "base").glob("*.inp"))
    paths += sorted((TESTS / "decks").glob("*/*.inp")) + sorted((ROOT / "input").glob("**/*.inp"))
    decks = []
    for path in paths:
        text = path.read_text(encoding="utf-8")
        if len(text) > largest or any(other in text for other in ("_mesh.inp", "motion.txt")):
            continue
        is_test = "*MATERIAL TEST" in text.upper()
        decks.append(Deck(path, text, ("--material",) if is_test else ()))
    return decks


def mutate(chance: random.Random, deck: Deck, others: list[Deck]) -> str:
    """A deck with a few changes."""
    text = deck.text
    for _ in range(chance.choice(NUMBERS_OF_CHANGES)):
        text = chance.choice(CHANGES)(chance, text, others)
    return text


def change_number(chance: random.Random, text: str, _: list[Deck]) -> str:
    places = list(re.finditer(r"[-+]?\d+\.?\d*(?:[eEdD][-+]?\d+)?", text))
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + chance.choice(NUMBERS) + text[place.end() :]


def change_word(chance: random.Random, text: str, others: list[Deck]) -> str:
    """Puts a word of this or of another deck, or a special one, in place of a word."""
    places = list(re.finditer(r"[A-Za-z_][A-Za-z0-9_ ]*", text))
    if not places:
        return text
    place = chance.choice(places)
    source = chance.choice([text, chance.choice(others).text])
    words = re.findall(r"[A-Za-z_][A-Za-z0-9_ ]*", source) + WORDS
    return text[: place.start()] + chance.choice(words) + text[place.end() :]


def change_lines(chance: random.Random, text: str, others: list[Deck]) -> str:
    """Removes, repeats, moves, joins or borrows lines."""
    lines = text.split("\n")
    first = chance.randrange(len(lines))
    last = min(len(lines), first + chance.choice([1, 1, 1, 2, 5, 20]))
    block = lines[first:last]
    what = chance.randrange(5)
    if what == 0:
        lines[first:last] = []
    elif what == 1:
        lines[first:first] = block
    elif what == 2:
        del lines[first:last]
        place = chance.randint(0, len(lines))
        lines[place:place] = block
    elif what == 3:
        lines[first:last] = ["".join(block)]
    else:
        borrowed = chance.choice(others).text.split("\n")
        start = chance.randrange(len(borrowed))
        lines[first:first] = borrowed[start : start + chance.choice([1, 2, 5])]
    return "\n".join(lines)


def change_card(chance: random.Random, text: str, others: list[Deck]) -> str:
    """Removes a whole card, or adds one of another deck."""
    cards = re.split(r"(?m)^(?=\*[^*])", text)
    if chance.random() < 0.5 and len(cards) > 1:
        del cards[chance.randrange(len(cards))]
    else:
        borrowed = re.split(r"(?m)^(?=\*[^*])", chance.choice(others).text)
        cards.insert(chance.randint(0, len(cards)), chance.choice(borrowed))
    return "".join(cards)


def change_bytes(chance: random.Random, text: str, _: list[Deck]) -> str:
    """Puts odd text somewhere, removes some, or cuts the rest off."""
    place = chance.randint(0, len(text))
    what = chance.randrange(4)
    if what == 0:
        return text[:place]
    if what == 1:
        return text[:place] + text[place + chance.choice([1, 2, 10, 100]) :]
    return text[:place] + chance.choice([*WORDS, chr(chance.randrange(256))]) + text[place:]


CHANGES = [change_number, change_number, change_word, change_lines, change_card, change_bytes]


class Fuzzer:
    """Mutants of a seed, and the program that checks them."""

    def __init__(self, program: Path, seed: int, decks: list[Deck], *, runs: bool = False):
        self.program = program.resolve()
        self.seed = seed
        self.decks = decks
        self.runs = runs
        self.keep: Path | None = None  # folder for bad mutants
        settings = {"OMP_WAIT_POLICY": "PASSIVE", "OMP_NUM_THREADS": "1"}
        self.environment = {**os.environ, **settings}
        # Memory that is held until the end of the program is no error (tools/check_memory).
        self.environment.setdefault("ASAN_OPTIONS", "detect_leaks=0")
        if kernels := kernels_of(self.program, decks[0], self.environment):
            self.environment["OPENBLAS_CORETYPE"] = kernels

    def mutant(self, number: int) -> tuple[Deck, str]:
        chance = random.Random(f"{self.seed} {number}")
        deck = chance.choice(self.decks)
        return deck, mutate(chance, deck, self.decks)

    def try_one(self, number: int) -> Outcome:
        deck, text = self.mutant(number)
        with tempfile.TemporaryDirectory(prefix="keyway_fuzz_") as name:
            folder = Path(name)
            (folder / "deck.inp").write_bytes(text.encode("utf-8", "surrogateescape"))
            code, problem = self.call(folder, "--check", *deck.options)
            left = sorted(path.name for path in folder.iterdir() if path.name != "deck.inp")
            if not problem and left:
                problem = f"leaves {', '.join(left)}"
            if self.runs and not problem and code == 0:
                code, problem = self.call(folder, "-q", "-j", "1", *deck.options)
            if problem and self.keep:
                self.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(folder / "deck.inp", self.keep / f"{self.seed}_{number}.inp")
        return Outcome(number, code, problem)

    def call(self, folder: Path, *options: str) -> tuple[int, str]:
        """Exit code, and what is wrong with the call."""
        try:
            done = subprocess.run(
                [str(self.program), *options, "deck.inp"],
                cwd=folder,
                capture_output=True,
                timeout=TIME_LIMIT,
                stdin=subprocess.DEVNULL,
                env=self.environment,
                preexec_fn=None if is_sanitized(self.program) else limit_memory,
            )
        except subprocess.TimeoutExpired:
            return -1, f"no end after {TIME_LIMIT} s"
        words = done.stderr.decode("utf-8", "replace")
        if found := TEXTS_OF_A_CRASH.search(words):
            return done.returncode, f"prints '{found[0]}'"
        good = {0, 2} if "--check" in options else {0, 1, 2, 3}
        if done.returncode == 3 and "not enough memory" in words:
            return 3, ""
        if done.returncode not in good:
            return done.returncode, f"ends with code {done.returncode}"
        if done.returncode != 0 and not words.strip():
            return done.returncode, "ends without a message"
        return done.returncode, ""

    def try_many(self, first: int, last: int, workers: int) -> list[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            return list(pool.map(self.try_one, range(first, last)))


def kernels_of(program: Path, deck: Deck, environment: dict[str, str]) -> str:
    """The kernels of OpenBLAS that the program starts again for, '' for none.

    With their name in the environment it need not start twice, which is a third of a check.
    """
    done = subprocess.run(
        [str(program), "--check", *deck.options, str(deck.path)],
        capture_output=True,
        text=True,
        errors="replace",
        env={**environment, "OPENBLAS_VERBOSE": "2"},
    )
    found = re.findall(r"Core: (\w+)", done.stderr)
    return found[-1] if found else ""


def limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def is_sanitized(program: Path) -> bool:
    """A sanitizer reserves terabytes of addresses."""
    return "sanitize" in program.parts


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("--mutants", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", action="store_true", help="also run what passes the check")
    parser.add_argument("--all", action="store_true", help="also decks above 20 kB")
    parser.add_argument("--keep", type=Path, default=Path("build/fuzz"), metavar="DIR")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args(arguments)
    decks = all_decks(sys.maxsize if options.all else LARGEST)
    fuzzer = Fuzzer(options.program, options.seed, decks, runs=options.runs)
    fuzzer.keep = options.keep
    outcomes = fuzzer.try_many(0, options.mutants, options.workers)
    codes = Counter(outcome.code for outcome in outcomes)
    print(f"{len(outcomes)} mutants of {len(fuzzer.decks)} decks, seed {options.seed}")
    for code, count in sorted(codes.items()):
        print(f"  code {code}: {count}")
    bad = [outcome for outcome in outcomes if outcome.problem]
    print(f"  bad: {len(bad)}")
    for outcome in bad[:50]:
        print(f"    mutant {outcome.number}: {outcome.problem}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
