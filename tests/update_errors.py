#!/usr/bin/env python3
"""Writes the present messages of the program into the tables of tests/errors.

usage: tests/update_errors.py [--program FILE] [CASE...]

Then read `git diff tests/errors`: each changed message stands there, one a line. A case whose exit
code has changed is reported and left alone, since its deck no longer shows what it is for.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from error_cases import Case, expand, read_tables, replace_says, shorten, without_names

PROGRAM = Path(__file__).resolve().parent.parent / "build" / "release" / "keyway"


def update(case: Case, program: Path) -> str:
    """Updates one case and returns a report; empty without a change."""
    with tempfile.TemporaryDirectory() as folder:
        done = case.run(program, Path(folder))
    if done.returncode != case.code:
        return f"{case.name}: exit code {done.returncode}, expected {case.code}: left as it is"
    printed = without_names(done.stderr)
    if is_expected(case, printed):
        return ""
    says = shorten(printed, case.files)
    assert expand(says, case.files) == printed, f"{case.name}: cannot be shortened"
    replace_says(case.table, case.name, says)
    return f"{case.name}: updated"


def is_expected(case: Case, stderr: str) -> bool:
    """Whether the output is that of the table; a place that the deck lacks is no match."""
    try:
        return case.stderr == stderr
    except AssertionError:
        return False


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--program", type=Path, default=PROGRAM, help="(build/release/keyway)")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="names of cases (all)")
    options = parser.parse_args(arguments)
    cases = read_tables()
    unknown = set(options.cases) - {case.name for case in cases}
    if unknown:
        parser.error(f"there is no case {', '.join(sorted(unknown))}")
    reports = [update(c, options.program) for c in cases if c.name in (options.cases or [c.name])]
    for line in filter(None, reports):
        print(line)
    return 1 if any(line.endswith("left as it is") for line in reports) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
