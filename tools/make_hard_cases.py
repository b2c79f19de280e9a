#!/usr/bin/env python3
"""Runs the hard cases of tests/hard and writes docs/hard_cases.md."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / folder) for folder in ("hard", "verify", ".")]

from catalogue import CASES, PAGE, page_of, row_of, rows_of_page  # noqa: E402
from harness import Program  # noqa: E402

LIMIT = 14400.0  # time of a run [s]


def run_case(case, program: Path) -> str:
    """The row of a case."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return row_of(case, case.run(Program(program, Path(folder), 1, LIMIT)))
        except AssertionError as stopped:
            print(f"{case.name}: {stopped}", file=sys.stderr)
            return row_of(case, None)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/keyway")
    parser.add_argument("--quick", action="store_true", help="leave out the long cases")
    parser.add_argument("--case", action="append", help="run the cases with this in their names")
    options = parser.parse_args()
    for case in CASES:
        is_wanted = not options.case or any(word in case.name for word in options.case)
        if not is_wanted or (options.quick and case.full):
            continue
        row = run_case(case, options.program.resolve())
        print(row, flush=True)
        PAGE.write_text(page_of(rows_of_page() | {case.name: row}), encoding="utf-8")


if __name__ == "__main__":
    main()
