"""Both dams of Xu, Chen, Li and Yue (2014): runs their cases and writes one page.

    tools/paper_study.py --size small -o results/paper      # some minutes a case
    tools/paper_study.py --cases 'xingbiling*' jinping --budget 2h
    tools/paper_study.py --list

A second call keeps the cases that have finished and goes on with the others; so does a call after
the study was stopped or killed. No case starts after the budget; one that runs goes on to its end.
The page holds what has run so far in the folder, also the cases that this call does not choose.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path

from ..command import Parser, command
from ..deck_runs import DeckRunner
from ..option_types import count
from ..pictures_material import plot_material, read_curve
from ..study.__main__ import seconds
from .case_table import list_cases
from .cases import choose
from .page import write_page
from .runner import LEFT_OUT, Study
from .sizes import SIZES

ROOT = Path(__file__).resolve().parents[3]
EXIT_INTERRUPTED = 130


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(
        prog="tools/paper_study.py", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="exit code: 0 all cases finished, 1 some did not, 2 usage, 130 interrupted",
    )  # fmt: skip
    add = parser.add_argument
    add("-o", type=Path, default=ROOT / "results" / "paper_study", metavar="DIR", help="folder")
    add("--size", choices=tuple(SIZES), default="full", help="of all dams (full)")
    add("--cases", nargs="+", default=[], metavar="PATTERN", help="names or groups, as in 'xing*'")
    add(
        "--budget",
        type=seconds,
        default=float("inf"),
        metavar="TIME",
        help="for all runs, as 90s, 20m, 2h; a number alone is seconds (no end)",
    )
    add("-j", type=count, default=1, metavar="RUNS", help="runs at a time (1)")
    add("--threads", type=count, help="of each run (processors / runs)")
    add("--program", type=Path, default=ROOT / "build/release/keyway", help="the program")
    add("--list", action="store_true", help="only print the cases and their commands")
    add("--no-page", action="store_true", help="only run")
    given = parser.parse_args(arguments)
    given.all_cases = list_cases(SIZES[given.size])
    try:
        given.chosen = choose(given.all_cases, given.cases)
    except ValueError as fault:
        parser.error(str(fault))
    if not given.list and not os.access(given.program, os.X_OK):
        parser.error(f"there is no program '{given.program}'")
    given.threads = given.threads or max(1, len(os.sched_getaffinity(0)) // given.j)
    return given


@command("paper_study")
def main(arguments: list[str] | None = None) -> int:
    """Run the cases and write the page."""
    given = parse(arguments)
    if given.list:
        for case in given.chosen:
            commands = case.commands(Path(case.name + ".inp"), Path("motions"))
            print("\n    ".join([f"{case.name}: {case.title}", *commands]))
        return 0
    given.o.mkdir(parents=True, exist_ok=True)
    runner = DeckRunner(given.program, [], threads=given.threads)

    def stop(*_: object) -> None:
        runner.is_ending = True
        raise KeyboardInterrupt

    before = {sign: signal.signal(sign, stop) for sign in (signal.SIGINT, signal.SIGTERM)}
    try:
        study = Study(given.o, runner, given.budget, say)
        outcomes = study.run(given.chosen, given.j)
    except KeyboardInterrupt:
        runner.stop()
    finally:
        for sign, handler in before.items():
            signal.signal(sign, handler)
    if runner.is_ending:  # Python drops an exception that is raised in one of its clean-ups
        sys.stderr.write("paper_study: stopped; the same call goes on, finished cases are kept\n")
        return EXIT_INTERRUPTED
    if left_out := [o.case.name for o in outcomes if o.record.status == LEFT_OUT]:
        say(f"{len(left_out)} of {len(outcomes)} cases were {LEFT_OUT}")
    if not given.no_page:
        shown = study.with_kept(outcomes, given.all_cases)
        say(str(write_page(given.o, header_of(given, runner), shown, concrete(given))))
    return 0 if all(outcome.is_finished for outcome in outcomes) else 1


def say(text: str) -> None:
    """Print at once: a run may take long."""
    print(text, flush=True)


def header_of(given: argparse.Namespace, runner: DeckRunner) -> list[list[str]]:
    """What the study is about."""
    size = SIZES[given.size]
    return [
        ["Size", f"{given.size}: {size.duration:g} s of motion, Jinping with at least "
                 f"{size.jinping} unknowns, sensitivity with {size.sensitivity}, "
                 f"{size.num_records} records"],
        ["Date", datetime.now().strftime("%Y-%m-%d %H:%M")],
        ["Program", runner.version.splitlines()[0]],
        ["Threads", f"{given.threads} a run, {given.j} runs at a time, in the last call"],
    ]  # fmt: skip


def concrete(given: argparse.Namespace) -> list[Path]:
    """Fig. 12: the material test of Table 1, drawn; nothing where the test fails."""
    deck = ROOT / "input" / "material" / "table1_tension.inp"
    folder = given.o / "runs" / "table1"
    folder.mkdir(parents=True, exist_ok=True)
    command = [str(given.program), "--material", "-o", str(folder), str(deck)]
    done = subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, check=False)
    curve = folder / "table1_tension_material_TABLE.csv"
    if done.returncode or not curve.exists():
        return []
    picture = given.o / "pictures" / "table1.png"
    picture.parent.mkdir(exist_ok=True)
    points = deck.with_name("table1_points.csv")
    return [Path(plot_material([read_curve(curve)], [points], picture))]


if __name__ == "__main__":
    sys.exit(main())
