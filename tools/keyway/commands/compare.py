"""Compares two results folders, or a results folder or file with a reference file.

A and B are folders of results, or A is a folder or file and B a reference file (CSV, JSON, HDF5).
Two values are equal when |a - b| <= absolute + relative |b|; NaN equals only NaN. Rows of tables
are matched by step, increment, node, element and point if both tables have these columns, else by
order. Missing data are a difference, but a reference for a folder may leave out columns, JSON
keys and datasets, and with --subset B may hold less of everything.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from keyway_tools import comparison
from keyway_tools.command import Parser, command
from keyway_tools.comparison import Report, Rules, Tolerance
from keyway_tools.option_types import count_from_zero, from_zero
from keyway_tools.program import reason_of
from keyway_tools.results import Results

EPILOG = """tolerance file (TOML):
  relative = 1e-6          # of every column
  absolute = 1e-12
  [column."U*"]            # patterns: U1, node_TIP:U1, steps.*.energy.error, a dataset's path
  relative = 1e-4
  absolute = 1e-9
  by_column = true         # relative to the column's largest value
  [column."state"]
  ignore = true

exit code: 0 equal, 1 different, 2 usage"""


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = Parser(
        description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("a", metavar="A", type=Path, help="results folder, or a file")
    add("b", metavar="B", type=Path, help="results folder or reference file")
    add("--rel", type=from_zero, help="relative tolerance of every column (1e-6)")
    add("--abs", type=from_zero, help="absolute tolerance of every column (1e-12)")
    add("--tol", action="append", default=[], metavar="COLUMN=REL[,ABS]", help="of one column")
    add("--ignore", action="append", default=[], metavar="COLUMN", help="leave a column out")
    add("--tolerances", type=Path, metavar="FILE", help="tolerances in TOML, see below")
    add("--by-column", action="store_true", help="relative to the column's largest value")
    add("--subset", action="store_true", help="B may hold less than A")
    add("--table", default="", help="the table a CSV reference belongs to, as in node_TIP")
    add("--job", default=None, help="the job, if a folder holds several")
    add(
        "-n",
        type=count_from_zero,
        default=10,
        help="how many of the largest differences to show (10)",
    )
    add("--json", type=Path, metavar="FILE", help="write the findings as JSON")
    return parser.parse_args(arguments)


def make_rules(options: argparse.Namespace) -> Rules:
    """Tolerances of the file, then those of the command line, which take precedence."""
    content = read_tolerances(options.tolerances) if options.tolerances else {}
    columns = content.pop("column", {})
    given = {"relative": options.rel, "absolute": options.abs}
    content |= {name: value for name, value in given.items() if value is not None}
    content["by_column"] = options.by_column or content.get("by_column", False)
    default = Tolerance(**content)
    rules = Rules(default, fewer_columns=options.subset, fewer_rows=options.subset)
    for pattern, values in columns.items():
        rules.patterns.append((pattern, Tolerance(**(default.__dict__ | values))))
    for text in options.tol:
        column, _, numbers = text.rpartition("=")
        relative, _, absolute = numbers.partition(",")
        try:
            size = from_zero(relative), from_zero(absolute or "0")
        except argparse.ArgumentTypeError:
            size = None
        if not column or size is None:
            raise ValueError(f"--tol {text}: expected COLUMN=REL[,ABS], numbers of 0 or more")
        rules.patterns.append((column, Tolerance(*size, options.by_column)))
    rules.patterns += [(column, Tolerance(ignore=True)) for column in options.ignore]
    return rules


def read_tolerances(path: Path) -> dict[str, Any]:
    """The content of a file of tolerances. Raises ValueError."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path}: {error}; expected TOML") from None
    columns = content.get("column", {})
    if not isinstance(columns, dict):
        raise ValueError(f'{path}: column = {columns!r}: expected tables [column."PATTERN"]')
    check_tolerance(f"{path}: ", content, ["relative", "absolute", "by_column", "column"])
    for pattern, values in columns.items():
        place = f'{path}: column."{pattern}"'
        if not isinstance(values, dict):
            raise ValueError(f'{place} = {values!r}: expected a table [column."{pattern}"]')
        check_tolerance(f"{place}: ", values, ["relative", "absolute", "by_column", "ignore"])
    return content


def check_tolerance(place: str, values: dict[str, Any], known: list[str]) -> None:
    """Names and values of a tolerance. Raises ValueError."""
    for name, value in values.items():
        if name not in known:
            raise ValueError(f"{place}unknown '{name}'; expected {', '.join(known)}")
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if name in ("relative", "absolute") and not (is_number and value >= 0):
            raise ValueError(f"{place}{name} = {value!r}: expected a number of 0 or more")
        if name in ("by_column", "ignore") and not isinstance(value, bool):
            raise ValueError(f"{place}{name} = {value!r}: expected true or false")


def warn_unused(rules: Rules, options: argparse.Namespace) -> None:
    """Says which options of the command line have no effect: a name may have a typing error."""
    given = [(f"--tol {text}", text.rpartition("=")[0]) for text in options.tol]
    given += [(f"--ignore {text}", text) for text in options.ignore]
    for option, pattern in given:
        if pattern not in rules.used:
            what = f"nothing that was compared has the name '{pattern}'"
            print(f"compare: {option}: no effect, {what}", file=sys.stderr)


def compare(a: Path, b: Path, rules: Rules, job: str | None = None, table: str = "") -> Report:
    """Folders with folders, files with files, a folder with a reference file."""
    for path in (a, b):
        if not path.exists():
            raise FileNotFoundError(f"there is no '{path}'")
    if b.is_dir():
        if not a.is_dir():
            raise ValueError("B is a folder but A is not")
        if table:
            raise ValueError("--table belongs to a reference in CSV: two folders have all tables")
        return comparison.compare_folders(Results(a, job), Results(b, job), rules)
    if b.suffix.lower() not in comparison.READERS:
        raise ValueError(f"'{b.name}': expected a reference in CSV, JSON or HDF5")
    if a.is_dir():
        rules.fewer_columns = True
        return comparison.compare_with_reference(Results(a, job), b, rules, table)
    if a.suffix.lower() != b.suffix.lower():
        raise ValueError(f"'{a.name}' and '{b.name}' are of different kinds")
    report = Report()
    comparison.compare_files(report, a, b, rules)
    return report


def show(report: Report, count: int) -> None:
    shown = report.ranked()[:count]
    for difference in shown:
        mark = "DIFFERS" if difference.counts else "within "
        print(f"{mark} {difference.place}: {difference.text}")
    hidden = len(report.found) - len(shown)
    if hidden > 0:
        print(f"... and {hidden} more")
    past = sum(d.counts for d in report.found)
    verdict = "equal within the tolerances" if report.is_equal else f"different: {past} columns"
    print(f"{verdict}; compared {report.num_columns} columns, {report.num_values} values")


def write_json(report: Report, path: Path) -> None:
    found = [
        {"place": d.place, "text": d.text, "excess": d.excess, "differs": d.counts}
        for d in report.ranked()
    ]
    content = {"equal": report.is_equal, "values": report.num_values, "differences": found}
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


@command("compare")
def main(arguments: list[str] | None = None) -> int:
    """Compare and print what differs."""
    options = parse(sys.argv[1:] if arguments is None else arguments)
    try:
        rules = make_rules(options)
        report = compare(options.a, options.b, rules, options.job, options.table)
    except (OSError, ValueError, TypeError, KeyError) as error:
        print(f"compare: {reason_of(error)}", file=sys.stderr)
        return 2
    warn_unused(rules, options)
    show(report, options.n)
    if options.json:
        write_json(report, options.json)
    return 0 if report.is_equal else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
