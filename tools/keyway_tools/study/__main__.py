"""What accuracy costs in time, for any deck.

Runs variants of the deck (increments, a refined mesh, elements, tolerances, ALPHA, stiffness of
joints, solvers) within a time budget and writes accuracy.csv, accuracy.png and accuracy.html, which
says what to choose for 10, 5, 2 and 1 %. With --effects it switches each effect of the deck off in
turn and writes effects.html. A second call keeps the runs that have finished. Options of keyway
follow a `--`, as in: tools/accuracy dam.inp -- --umat law.for
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

from keyway_tools.deck_runs import DeckRunner

from .deck_cards import read_deck
from .effects import list_effects
from .errors import errors_of
from .ladder import Ladder, Outcome
from .page import accuracy_page, draw, effect_sentences, effects_page, sentences, write_table
from .rungs import base_deck, list_rungs

ROOT = Path(__file__).resolve().parents[3]
UNITS = {"": 1.0, "s": 1.0, "m": 60.0, "h": 3600.0}


def seconds(text: str) -> float:
    """'90s', '20m' or '1.5h' in seconds."""
    found = re.fullmatch(r"([0-9.]+)\s*([smh]?)", text.strip())
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is no time: expected 90s, 20m or 2h")
    return float(found[1]) * UNITS[found[2]]


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tools/accuracy", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("deck", type=Path, metavar="DECK")
    add("--budget", type=seconds, default=1200.0, metavar="TIME",
        help="time for all runs, as 90s, 20m, 2h (20m)")  # fmt: skip
    add("--effects", action="store_true", help="switch the effects off in turn")
    add("-o", type=Path, metavar="DIR", help="folder of the study (DECK's name with _accuracy)")
    add("--threads", type=int, default=os.cpu_count() or 1, help="of each run (all processors)")
    add("--program", type=Path, default=ROOT / "build/release/keyway", help="the program")
    return parser.parse_args(arguments)


def absolute_paths(options: list[str]) -> list[str]:
    """Options with the full paths of files: the runs have folders of their own."""
    return [str(Path(option).resolve()) if Path(option).is_file() else option for option in options]


def check(program: Path, options: list[str], deck: Path) -> str:
    """The errors of a deck, with their places in the user's files; '' for none."""
    command = [str(program), *options, "--check", str(deck)]
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return done.stderr if done.returncode else ""


def main(arguments: list[str]) -> int:
    options: list[str] = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, options = arguments[:cut], absolute_paths(arguments[cut + 1 :])
    given = parse(arguments)
    if not given.deck.is_file():
        sys.stderr.write(f"accuracy: there is no deck '{given.deck}'\n")
        return 2
    if not given.program.is_file():
        sys.stderr.write(f"accuracy: no program '{given.program}'; tools/setup builds it\n")
        return 2
    if faults := check(given.program.resolve(), options, given.deck):
        sys.stderr.write(faults)
        return 2
    folder = given.o or Path(f"{given.deck.stem}_accuracy")
    folder.mkdir(parents=True, exist_ok=True)
    deck = base_deck(read_deck(given.deck))
    rungs = list_effects(deck) if given.effects else list_rungs(deck)
    runner = DeckRunner(given.program.resolve(), ["-j", str(given.threads), *options])
    version = runner.version.splitlines()[0]
    try:
        outcomes = Ladder(deck, rungs, folder, runner, given.budget).run()
    except RuntimeError as error:
        sys.stderr.write(f"accuracy: {error}\n")
        return 1
    write = write_effects if given.effects else write_accuracy
    return write(folder, given.deck, version, outcomes)


def write_accuracy(folder: Path, deck: Path, version: str, outcomes: list[Outcome]) -> int:
    errors = errors_of(outcomes)
    if not errors:
        sys.stderr.write("accuracy: the deck has no displacement, stress or frequency to compare\n")
        return 1
    write_table(folder / "accuracy.csv", outcomes, errors)
    if picture := draw(outcomes, errors):
        (folder / "accuracy.png").write_bytes(picture)
    text = accuracy_page(deck, version, outcomes, errors)
    (folder / "accuracy.html").write_text(text, encoding="utf-8")
    sys.stdout.write("\n".join(sentences(outcomes, errors)) + f"\n{folder / 'accuracy.html'}\n")
    return 0


def write_effects(folder: Path, deck: Path, version: str, outcomes: list[Outcome]) -> int:
    (folder / "effects.html").write_text(effects_page(deck, version, outcomes), encoding="utf-8")
    sys.stdout.write("\n".join(effect_sentences(outcomes)) + f"\n{folder / 'effects.html'}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
