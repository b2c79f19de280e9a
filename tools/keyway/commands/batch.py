"""Runs many decks, several at a time, and prints a table of the runs.

The results of a deck are in DIR/<name of the deck>. A deck that finished before with the same
content (included files too), options and version of the program is not run again. Options of
keyway follow a `--`, as in: keyway-batch input/*/*.inp -j 2 -- -q
"""

from __future__ import annotations

import argparse
import json
import os
import re
import signal
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

from keyway_tools.deck_runs import EXTREMES, DeckRunner, Record
from keyway_tools.program import given_program

EXIT_INTERRUPTED = 130


def parse(arguments: list[str]) -> argparse.Namespace:
    options: list[str] = []
    if "--" in arguments:
        cut = arguments.index("--")
        arguments, options = arguments[:cut], arguments[cut + 1 :]
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="exit code: 0 all finished, 1 some did not, 2 usage, 130 interrupted",
    )
    add = parser.add_argument
    add("decks", nargs="+", type=Path, metavar="DECKS", help="decks, or folders with decks")
    add(
        "-o",
        type=Path,
        default=Path("results"),
        metavar="DIR",
        help="folder of the results (results)",
    )
    add("-j", type=positive, default=1, metavar="RUNS", help="runs at a time (1)")
    add("--threads", type=positive, help="threads of each run (processors / runs)")
    add("--timeout", type=float, metavar="SECONDS", help="ends a run that takes longer")
    add("--again", action="store_true", help="run finished decks again")
    add("--program", type=Path, help="the program (KEYWAY, build/release of the checkout, PATH)")
    add("--json", metavar="FILE", help="write the table also as JSON; -: only JSON, on stdout")
    result = parser.parse_args(arguments)
    processors = len(os.sched_getaffinity(0))
    threads = result.threads or max(1, processors // result.j)
    result.options = ["-j", str(threads), *options]
    return result


def positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise ValueError
    return value


def find_decks(places: list[Path]) -> list[Path]:
    """The decks named, and the files *.inp with a step in the folders named."""
    found: list[Path] = []
    for place in places:
        if place.is_dir():
            found += [p for p in sorted(place.rglob("*.inp")) if has_step(p)]
        elif place.is_file():
            found.append(place)
        else:
            raise FileNotFoundError(f"there is no deck '{place}'")
    if not found:
        raise FileNotFoundError("no decks found")
    return list(dict.fromkeys(p.resolve() for p in found))


def has_step(path: Path) -> bool:
    text = path.read_text(encoding="utf-8", errors="replace")
    return re.search(r"^\s*\*\s*STEP\b", text, re.IGNORECASE | re.MULTILINE) is not None


def folders_of(decks: list[Path], top: Path) -> dict[Path, Path]:
    """A folder for each deck: its name, after the name of its parent if two decks share a name."""
    count = Counter(deck.stem for deck in decks)
    folders = {
        deck: top / (deck.stem if count[deck.stem] == 1 else f"{deck.parent.name}_{deck.stem}")
        for deck in decks
    }
    if len({*folders.values()}) < len(decks):
        raise ValueError("several decks have the same name and folder name; rename them")
    return folders


def run_all(runner: DeckRunner, folders: dict[Path, Path], options) -> list[Record]:
    """Runs the decks on options.j threads; an interruption ends running and waiting decks."""
    handler = signal.signal(signal.SIGTERM, signal.default_int_handler)
    done = 0
    with ThreadPoolExecutor(options.j) as pool:
        futures = [pool.submit(runner.run, d, f, options.again) for d, f in folders.items()]
        try:
            for future in futures:
                record = future.result()
                done += 1
                kept = " (kept)" if record.was_kept else ""
                name = Path(record.folder).name
                print(f"{done}/{len(futures)} {name}: {record.status}{kept}", file=sys.stderr)
        except KeyboardInterrupt:
            print("batch: interrupted, ending the runs", file=sys.stderr)
            runner.end()
    signal.signal(signal.SIGTERM, handler)
    return [future.result() for future in futures]


def cell(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def table_of(records: list[Record]) -> str:
    """One line for each run."""
    rows = [("deck", "status", "time [s]", "memory [MB]", *EXTREMES)]
    for record in records:
        rows.append(
            (
                Path(record.folder).name,
                record.status + (" (kept)" if record.was_kept else ""),
                cell(record.wall_s, ".1f"),
                cell(record.peak_memory_mb, ".0f"),
                *(cell(record.extremes.get(name), ".4g") for name in EXTREMES),
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        left = [text.ljust(width) for text, width in zip(row[:2], widths[:2], strict=True)]
        right = [text.rjust(width) for text, width in zip(row[2:], widths[2:], strict=True)]
        lines.append("  ".join(left + right))
    failed = [r for r in records if r.status != "finished" and r.message]
    lines += [f"{Path(r.folder).name}: {r.message}" for r in failed]
    return "\n".join(lines)


def report(records: list[Record], target: str | None) -> None:
    content = json.dumps([asdict(record) for record in records], indent=2)
    if target == "-":
        print(content)
        return
    print(table_of(records))
    if target:
        Path(target).write_text(content + "\n", encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Run the decks and print the table."""
    options = parse(sys.argv[1:] if arguments is None else arguments)
    try:
        folders = folders_of(find_decks(options.decks), options.o)
        runner = DeckRunner(given_program(options.program), options.options, options.timeout)
    except (OSError, ValueError) as error:
        print(f"batch: {error}", file=sys.stderr)
        return 2
    records = run_all(runner, folders, options)
    report(records, options.json)
    if runner.is_ending:
        return EXIT_INTERRUPTED
    return 0 if all(record.status == "finished" for record in records) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
