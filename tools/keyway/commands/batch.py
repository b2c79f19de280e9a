"""Runs many decks, several at a time, and prints a table of the runs.

    keyway-batch DECKS ... [-o DIR] [-j RUNS]
    keyway-batch TEMPLATE --table VALUES.csv [-o DIR] [-j RUNS]
    keyway-batch ... --on slurm [--sbatch=--partition=long]
    keyway-batch ... --on dask://HOST:8786

The results of a deck are in DIR/<name of the deck>. A deck that finished before with the same
content (also of the files that the deck and the options name), options and version of the program
is not run again: the same call goes on after an interruption. Options of keyway follow a `--`, as
in: keyway-batch input/*/*.inp -j 2 -- -q

With --table each row of the CSV file is a case: the template has the names of its columns in
braces, as in *JOINT LAW, FRICTION={FRICTION}; a column `case` names the cases. DIR/batch.csv, and
batch.parquet where pyarrow is installed, has values, costs and extremes of all cases;
batch_fractiles.csv and .png show the fractiles of four finished cases or more.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path

from keyway_tools.command import Parser, command
from keyway_tools.deck_runs import Record
from keyway_tools.option_types import above_zero, count
from keyway_tools.program import given_program, reason_of

from keyway.batch.cases import BatchError, Case, cases_of_decks, cases_of_table
from keyway.batch.fractiles import write_fractiles
from keyway.batch.lock import lock_of
from keyway.batch.on_dask import run_on_dask
from keyway.batch.on_local import run_locally
from keyway.batch.on_slurm import request_for, run_on_slurm, script_of
from keyway.batch.plan import Plan
from keyway.batch.table import result_table, table_of

EXIT_INTERRUPTED = 130
PLAN = "batch_plan.json"


def parse(arguments: list[str]) -> argparse.Namespace:
    options: list[str] = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, options = arguments[:cut], arguments[cut + 1 :]
    parser = Parser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="exit code: 0 all finished, 1 some did not, 2 usage, 130 interrupted",
    )
    add = parser.add_argument
    add("decks", nargs="+", type=Path, metavar="DECKS", help="decks, or folders with decks")
    add("-o", type=Path, default=Path("results"), metavar="DIR", help="folder of results (results)")
    add("--table", type=Path, metavar="CSV", help="values of the cases; DECKS is one template")
    add("--on", type=place, default="local", help="local, slurm or dask://HOST:PORT (local)")
    add("-j", type=count, metavar="RUNS", help="runs at a time (1; on Slurm 20)")
    add("--threads", type=count, help="threads of each run (processors / runs; else 1)")
    add("--timeout", type=above_zero, metavar="SECONDS", help="ends a run that takes longer")
    add("--again", action="store_true", help="run finished decks again")
    add("--program", type=Path, help="the program (KEYWAY, build/release of the checkout, PATH)")
    add("--json", metavar="FILE", help="write the table also as JSON; -: only JSON, on stdout")
    slurm = parser.add_argument_group("on Slurm")
    text = "of each job (three times the forecast of --check, and 10 minutes)"
    slurm.add_argument("--minutes", type=count, help=text)
    text = "MB of each job (1.5 times the forecast of --check, and 200 MB)"
    slurm.add_argument("--memory", type=count, help=text)
    slurm.add_argument("--sbatch", action="append", default=[], metavar="OPTION",
                       help="further option of sbatch; may be repeated")  # fmt: skip
    result = parser.parse_args(arguments)
    if result.table and (len(result.decks) != 1 or not result.decks[0].is_file()):
        parser.error("--table takes one template deck")
    is_local = result.on == "local"
    result.j = result.j or (1 if is_local else 20)
    processors = len(os.sched_getaffinity(0)) if is_local else result.j
    result.threads = result.threads or max(1, processors // result.j)
    result.options = ["-j", str(result.threads), *options]
    return result


def place(text: str) -> str:
    """Where the runs are: local, slurm or an address of Dask."""
    if text in ("local", "slurm") or text.startswith(("dask://", "tcp://")):
        return text
    raise argparse.ArgumentTypeError(f"'{text}'; expected local, slurm or dask://HOST:PORT")


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def run_plan(plan: Plan, options: argparse.Namespace) -> tuple[list[Record], bool]:
    """Run a plan where it is wanted: the records, and whether it was interrupted."""
    if options.on == "local":
        return run_locally(plan, options.j, say)
    file = options.o / PLAN
    numbers = plan.unfinished()
    is_whole = True
    if numbers and options.on == "slurm":
        asked = numbers[:1] if options.table else numbers  # rows of a table share their mesh
        request = request_for(plan, asked, options.threads, options.minutes, options.memory)
        script = script_of(file, numbers, options.j, request, options.sbatch)
        is_whole = run_on_slurm(plan, file, script, say)
    elif numbers:
        is_whole = run_on_dask(plan, file, options.on, say)
    return plan.records(), not is_whole


def report(records: list[Record], target: str | None) -> None:
    content = json.dumps([asdict(record) for record in records], indent=2)
    if target == "-":
        print(content)
        return
    print(table_of(records))
    if target:
        Path(target).write_text(content + "\n", encoding="utf-8")


def find_cases(options: argparse.Namespace) -> list[Case]:
    if options.table:
        return cases_of_table(options.decks[0], options.table, options.o)
    return cases_of_decks(options.decks, options.o)


def run_batch(options: argparse.Namespace) -> int:
    """Run the cases and write their tables; the exit code."""
    cases = find_cases(options)
    program = given_program(options.program)
    plan = Plan.of(program, options.options, options.timeout, options.again, cases)
    records, is_interrupted = run_plan(plan, options)
    report(records, options.json)
    table = result_table(cases, records)
    for path in table.write(options.o) + (
        write_fractiles(table, options.o) if options.table else []
    ):
        say(f"wrote {path}")
    if is_interrupted:
        return EXIT_INTERRUPTED
    return 0 if all(record.status == "finished" for record in records) else 1


@command("batch")
def main(arguments: list[str] | None = None) -> int:
    """Run the decks and print the table."""
    options = parse(sys.argv[1:] if arguments is None else arguments)
    try:
        with lock_of(options.o):
            return run_batch(options)
    except (OSError, ValueError, BatchError) as error:
        print(f"batch: {reason_of(error)}", file=sys.stderr)
        return 2
