"""What accuracy costs in time, for any deck.

Runs variants of the deck (increments, a refined mesh, elements, tolerances, ALPHA, stiffness of
joints, coupling, solvers) within a time budget and writes accuracy.html, which says what to choose
for 10, 5, 2 and 1 %, with accuracy.csv, accuracy.json and accuracy.png. With --effects it switches
each effect of the deck off in turn and writes effects.html. A second call keeps the runs that have
finished. Options of keyway follow a `--`, as in: tools/accuracy dam.inp -- --umat law.for
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path
from typing import Any

from keyway_tools.command import Parser, command
from keyway_tools.deck_runs import DeckRunner
from keyway_tools.option_types import count
from keyway_tools.program import command_name, given_program
from keyway_tools.results import Results

from .couplings import coupling_rungs
from .deck_cards import Deck, read_deck
from .effects import list_effects
from .errors import element_to_check, errors_of
from .facts import facts_of, write_table
from .flat_deck import flat
from .ladder import JOB, Ladder, Outcome
from .page import accuracy_page, effects_page, what_seconds_are
from .pictures import draw
from .rungs import Rung, base_deck, element_check, finer_rung, list_rungs, shortened
from .words import effect_sentences, sentences

# Folders of the deck as it is, in a ladder and among effects
ALL = {False: "the_deck_as_it_is", True: "all_effects"}
UNITS = {"": 1.0, "s": 1.0, "m": 60.0, "h": 3600.0}


class NothingToVaryError(Exception):
    """A deck of which a study has no variant."""


def seconds(text: str) -> float:
    """'90s', '20m' or '1.5h' in seconds."""
    found = re.fullmatch(r"([0-9.]+)\s*([smh]?)", text.strip())
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is no time: expected 90s, 20m or 2h")
    return float(found[1]) * UNITS[found[2]]


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(
        prog=command_name("tools/accuracy"), description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("deck", type=Path, metavar="DECK")
    add("--budget", type=seconds, default=1200.0, metavar="TIME",
        help="time for all runs, as 90s, 20m, 2h; a number alone is seconds (20m)")  # fmt: skip
    add("--effects", action="store_true", help="switch the effects off in turn")
    add("--verify", action="store_true", help="compare with a run finer than the ladder's finest")
    add("--duration", type=seconds, metavar="TIME",
        help="study the first so many seconds of each dynamic step alone")  # fmt: skip
    add("-o", type=Path, metavar="DIR", help="folder of the study (DECK's name with _accuracy)")
    add("--threads", type=count, default=os.cpu_count() or 1, help="of each run (all processors)")
    add("--program", type=Path, help="the program (KEYWAY, build/release of the checkout, PATH)")
    given = parser.parse_args(arguments)
    if given.duration == 0.0:
        parser.error("--duration 0: expected a time above 0")
    return given


def absolute_paths(options: list[str]) -> list[str]:
    """Options with the full paths of files: the runs have folders of their own."""
    return [str(Path(option).resolve()) if Path(option).is_file() else option for option in options]


def check(program: Path, options: list[str], deck: Path) -> str:
    """The errors of a deck, with their places in the user's files; '' for none."""
    command = [str(program), *options, "--check", str(deck)]
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return done.stderr if done.returncode else ""


@command("accuracy")
def main(arguments: list[str] | None = None) -> int:
    arguments = sys.argv[1:] if arguments is None else arguments
    options: list[str] = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, options = arguments[:cut], absolute_paths(arguments[cut + 1 :])
    given = parse(arguments)
    if not given.deck.is_file():
        sys.stderr.write(f"accuracy: there is no deck '{given.deck}'\n")
        return 2
    try:
        given.program = given_program(given.program)
    except FileNotFoundError as error:
        sys.stderr.write(f"accuracy: {error}\n")
        return 2
    if faults := check(given.program, options, given.deck):
        sys.stderr.write(faults)
        return 2
    given.o = given.o or Path(f"{given.deck.stem}_accuracy")
    runner = DeckRunner(given.program, ["-j", str(given.threads), *options])

    def stop(*_: object) -> None:
        runner.is_ending = True
        raise KeyboardInterrupt

    for request in (signal.SIGINT, signal.SIGTERM):
        signal.signal(request, stop)
    try:
        return study(given, runner)
    except KeyboardInterrupt:
        runner.stop()
        sys.stderr.write("accuracy: stopped; the same call goes on, finished runs are kept\n")
        return 130
    except (NothingToVaryError, RuntimeError) as error:
        sys.stderr.write(f"accuracy: {error}\n")
        return 2 if isinstance(error, NothingToVaryError) else 1


def study(given: argparse.Namespace, runner: DeckRunner) -> int:
    """Runs the variants and writes what they show."""
    given.o.mkdir(parents=True, exist_ok=True)
    deck, rungs = what_to_run(given, runner)
    ladder = Ladder(deck, rungs, given.o, runner, given.budget, say)
    outcomes = ladder.run()
    while not given.effects and (kind := element_to_check(outcomes)):
        ladder.go_on(outcomes, element_check(kind))
    header = header_of(given, runner, outcomes[0])
    meaning, is_busy = what_seconds_are(given.threads, outcomes)
    if given.effects:
        page = given.o / "effects.html"
        text = effects_page(given.deck, header, meaning, outcomes)
        lines = effect_sentences(outcomes)
    else:
        page = given.o / "accuracy.html"
        errors = errors_of(outcomes)
        if not errors:
            raise RuntimeError("the deck has no displacement, stress or frequency to compare")
        facts = facts_of(outcomes, errors)
        facts |= {"deck": given.deck.name, "header": header, "what_seconds_are": meaning}
        write_files(given.o, facts)
        text = accuracy_page(given.deck, facts)
        lines = sentences(facts)
    page.write_text(text, encoding="utf-8")
    if is_busy:
        lines.append(meaning)
    say("\n".join([*lines, str(page)]))
    return 0


def what_to_run(given: argparse.Namespace, runner: DeckRunner) -> tuple[Deck, list[Rung]]:
    """The deck of the study and its variants, itself first."""
    deck = base_deck(flat_deck(given, runner))
    if given.duration:
        deck = shortened_deck(given, deck)
    rungs = list_effects(deck) if given.effects else rungs_of(deck, given.verify)
    if len(rungs) > 1:
        return deck, rungs
    what = "no effect to switch off: no joints, loads, motion, damping or nonlinear materials"
    raise NothingToVaryError(f"{given.deck}: {what if given.effects else 'nothing to vary'}")


def shortened_deck(given: argparse.Namespace, deck: Deck) -> Deck:
    """The deck with shorter dynamic steps; says so where --duration changes none."""
    new = shortened(deck, given.duration)
    before, after = ([card.lines for card in one.of("DYNAMIC")] for one in (deck, new))
    if before == after:
        why = f"longer than {given.duration:g} s" if before else "at all"
        say(f"--duration {given.duration:g}s: no effect, the deck has no dynamic step {why}")
        given.duration = None
    return new


def rungs_of(deck: Deck, is_verified: bool) -> list[Rung]:
    """All variants; a run that verifies is finer than them, so that they are refined once only."""
    found = [*list_rungs(deck, refines_twice=not is_verified), *coupling_rungs(deck)]
    return [*found, finer_rung(deck)] if is_verified else found


def flat_deck(given: argparse.Namespace, runner: DeckRunner) -> Deck:
    """The deck without parts and instances, if the program takes what was made of it."""
    deck = read_deck(given.deck)
    keeps_c3d8 = any(option.startswith("--c3d8") for option in runner.options)
    try:
        new = flat(deck, keeps_c3d8)
    except (LookupError, ValueError) as error:
        say(f"parts and instances stay as they are: {error}")
        return deck
    if new is deck:
        return deck
    new.write(given.o / "flat.inp")
    if faults := check(given.program, runner.options, given.o / "flat.inp"):
        say(f"parts and instances stay as they are: {faults}")
        return deck
    return new


def say(text: str) -> None:
    """Prints at once: a run may take long."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def header_of(given: argparse.Namespace, runner: DeckRunner, base: Outcome) -> list[list[str]]:
    """Deck, date, program and machine of a study."""
    digest = hashlib.sha256(given.deck.read_bytes()).hexdigest()
    machine = Results(given.o / "runs" / ALL[given.effects] / "results", JOB).find("machine")
    assert base.measured
    part = f"the first {given.duration or 0.0:g} s of each dynamic step"
    return [
        ["Deck", str(given.deck)],
        ["Digest", f"sha256 {digest}"],
        ["Date", datetime.now().strftime("%Y-%m-%d %H:%M")],
        ["Program", runner.version.splitlines()[0]],
        ["Machine", f"{machine['processor']}, {machine['processors']} processors, kernels "
                    f"{machine['blas_kernels']}, {machine['memory_mb']} MB"],
        ["Threads", str(given.threads)],
        ["Model", f"{base.measured.unknowns:,} unknowns, {count_of(base.measured.increments)}"],
        *([["Duration", part]] if given.duration else []),
    ]  # fmt: skip


def count_of(increments: int) -> str:
    """'1 increment', '1,001 increments'."""
    return f"{increments:,} increment{'' if increments == 1 else 's'}"


def write_files(folder: Path, facts: dict[str, Any]) -> None:
    """Table, picture and data beside the page."""
    write_table(folder / "accuracy.csv", facts)
    (folder / "accuracy.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    if picture := draw(facts):
        (folder / "accuracy.png").write_bytes(picture)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
