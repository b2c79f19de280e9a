"""Compares numbers, tables and whole results folders within tolerances."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from keyway_tools.result_files import Table, read_hdf5, read_json, read_table
from keyway_tools.results import Results

# Columns that identify a row; two tables are matched by those that both have.
KEYS = ("step", "increment", "node", "element", "point")
# Entries that may differ between two runs of one deck: user, machine and time.
SUMMARY_IGNORED = (
    "program.*",
    "machine.*",
    "deck.*",
    "ledger.*",
    "*.wall_s",
    "ignored_input.*.file",
)


@dataclass(frozen=True)
class Tolerance:
    """|a - b| <= absolute + relative |b|; with by_column, b is the column's largest."""

    relative: float = 1e-6
    absolute: float = 1e-12
    by_column: bool = False
    ignore: bool = False

    def allowed(self, expected: np.ndarray) -> np.ndarray:
        size = np.abs(expected, dtype=float)
        if self.by_column:
            finite = size[np.isfinite(size)]
            size = np.full(size.shape, finite.max() if finite.size else 0.0)
        with np.errstate(over="ignore"):  # beyond the largest number all is allowed
            return self.absolute + self.relative * np.where(np.isfinite(size), size, 0.0)


@dataclass
class Rules:
    """The tolerance of each column: of the last pattern that matches its name, else the default."""

    default: Tolerance = field(default_factory=Tolerance)
    patterns: list[tuple[str, Tolerance]] = field(default_factory=list)
    fewer_columns: bool = False  # B may leave out columns, JSON keys and datasets
    fewer_rows: bool = False  # B may leave out rows and whole files
    used: set[str] = field(default_factory=set)  # patterns that have matched a name

    def of(self, *names: str) -> Tolerance:
        found = [
            (pattern, tolerance)
            for pattern, tolerance in self.patterns
            if any(fnmatchcase(name, pattern) for name in names)
        ]
        self.used.update(pattern for pattern, _ in found)
        return found[-1][1] if found else self.default


@dataclass(frozen=True)
class Difference:
    """The largest difference in a column, or something that one side lacks."""

    place: str
    text: str
    excess: float  # |a - b| over the tolerance; infinite without a value

    @property
    def counts(self) -> bool:
        return self.excess > 1


@dataclass
class Report:
    """All that was compared."""

    found: list[Difference] = field(default_factory=list)
    num_columns: int = 0
    num_values: int = 0

    @property
    def is_equal(self) -> bool:
        return not any(d.counts for d in self.found)

    def lack(self, place: str, text: str) -> None:
        self.found.append(Difference(place, text, np.inf))

    def ranked(self) -> list[Difference]:
        return sorted(self.found, key=lambda d: -d.excess)


def distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|a - b|; 0 for two NaN or two infinities of one sign, infinite for one NaN."""
    with np.errstate(invalid="ignore", over="ignore"):
        distance = np.abs(a - b, dtype=float)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    return np.where(same, 0.0, np.where(np.isnan(distance), np.inf, distance))


def compare_numbers(report: Report, place: str, a: Any, b: Any, tolerance: Tolerance, name) -> None:
    """Adds the largest difference of two arrays of one shape; name(i) is the name of entry i."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    report.num_columns += 1
    report.num_values += a.size
    if not a.size:
        return
    distance, allowed = distances(a, b), tolerance.allowed(b)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        excess = np.where(distance == 0, 0.0, distance / allowed)
        excess[np.isinf(distance)] = np.inf  # a number that one side lacks, at any tolerance
    worst = np.unravel_index(int(np.argmax(excess)), a.shape)
    count = int(np.count_nonzero(excess > 1))
    apart, size = float(distance[worst]), abs(float(b[worst]))
    share = apart / size if 0 < size < np.inf else np.inf
    relative = f", {share:.3g} of it" if share < np.inf else ""
    text = (
        f"{count} of {a.size} past the tolerance; largest at {name(worst)}: "
        f"{a[worst]:.9g} against {b[worst]:.9g} (apart {distance[worst]:.3g}{relative}, "
        f"allowed {allowed[worst]:.3g})"
    )
    if distance[worst] > 0:
        report.found.append(Difference(place, text, float(excess[worst])))


def compare_values(report: Report, place: str, a: Any, b: Any, tolerance: Tolerance) -> None:
    """Two single values of a JSON file; texts, truths and nulls must be equal."""
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in (a, b)):
        compare_numbers(report, place, a, b, tolerance, lambda _: "this value")
        return
    report.num_columns += 1
    report.num_values += 1
    if type(a) is not type(b) or a != b:
        report.lack(place, f"{a!r} against {b!r}")


def compare_maps(report: Report, place: str, a: dict, b: dict, rules: Rules) -> None:
    """Leaves of two JSON files."""
    for key in [*b, *(k for k in a if k not in b)]:
        tolerance = rules.of(f"{place}:{key}", key)
        if tolerance.ignore:
            continue
        if key not in a:
            report.lack(f"{place}: {key}", "missing in the first")
        elif key in b:
            compare_values(report, f"{place}: {key}", a[key], b[key], tolerance)
        elif not rules.fewer_columns:
            report.lack(f"{place}: {key}", "missing in the second")


def row_keys(table: Table, names: list[str]) -> list[tuple] | None:
    """The key of each row, or None if two rows have the same key."""
    keys = list(zip(*(table[n].tolist() for n in names), strict=True))
    return keys if names and len(set(keys)) == len(keys) else None


def match_rows(report: Report, place: str, a: Table, b: Table, fewer_rows: bool):
    """Matching row numbers of both tables, and a function that names a row of b."""
    names = [n for n in KEYS if n in a and n in b]
    count_a, count_b = (len(next(iter(t.values()))) for t in (a, b))
    keys_a, keys_b = row_keys(a, names), row_keys(b, names)
    if keys_a is None or keys_b is None:
        if count_a < count_b or (count_a > count_b and not fewer_rows):
            report.lack(place, f"{count_a} rows against {count_b}")
        rows = np.arange(min(count_a, count_b))
        return rows, rows, lambda row: f"row {row + 1}" + time_of(b, row)

    def title(key: tuple) -> str:
        return ", ".join(f"{n}={v:g}" for n, v in zip(names, key, strict=True))

    row_of_key = {key: row for row, key in enumerate(keys_a)}
    missing = [key for key in keys_b if key not in row_of_key]
    if missing:
        report.lack(place, f"{len(missing)} rows missing in the first, as {title(missing[0])}")
    known = set(keys_b)
    extra = [] if fewer_rows else [key for key in keys_a if key not in known]
    if extra:
        report.lack(place, f"{len(extra)} rows missing in the second, as {title(extra[0])}")
    rows_b = np.array([r for r, key in enumerate(keys_b) if key in row_of_key], dtype=int)
    rows_a = np.array([row_of_key[keys_b[r]] for r in rows_b], dtype=int)
    return rows_a, rows_b, lambda row: title(keys_b[rows_b[row]]) + time_of(b, rows_b[row])


def time_of(table: Table, row: int) -> str:
    times = table.get("time")
    return f", time={times[row]:g}" if times is not None and times.dtype != object else ""


def compare_tables(report: Report, place: str, a: Table, b: Table, rules: Rules) -> None:
    """Two CSV tables, column by column."""
    rows_a, rows_b, name = match_rows(report, place, a, b, rules.fewer_rows)
    for column in [*b, *(c for c in a if c not in b)]:
        tolerance = rules.of(f"{place}:{column}", column)
        where = f"{place}: {column}"
        if tolerance.ignore:
            continue
        if column not in a:
            report.lack(where, "column missing in the first")
        elif column not in b:
            if not rules.fewer_columns:
                report.lack(where, "column missing in the second")
        elif object in (a[column].dtype, b[column].dtype):
            texts = a[column][rows_a].astype(str) != b[column][rows_b].astype(str)
            report.num_columns += 1
            if texts.any():
                row = int(np.argmax(texts))
                report.lack(where, f"{texts.sum()} texts differ, as at {name(row)}")
        else:
            compare_numbers(
                report, where, a[column][rows_a], b[column][rows_b], tolerance,
                lambda index: name(index[0]),
            )  # fmt: skip


def compare_arrays(report: Report, place: str, a: Table, b: Table, rules: Rules) -> None:
    """Datasets of two HDF5 files."""
    for key in [*b, *(k for k in a if k not in b)]:
        tolerance = rules.of(f"{place}:{key}", key, key.rsplit("/", 1)[-1])
        where = f"{place}: {key}"
        if tolerance.ignore:
            continue
        if key not in a or key not in b:
            if key not in a or not rules.fewer_columns:
                report.lack(where, f"missing in the {'second' if key in a else 'first'}")
        elif a[key].shape != b[key].shape:
            report.lack(where, f"shape {a[key].shape} against {b[key].shape}")
        elif "O" in (a[key].dtype.kind, b[key].dtype.kind):
            report.num_columns += 1
            if np.any(a[key].astype(str) != b[key].astype(str)):
                report.lack(where, "texts differ")
        else:
            compare_numbers(report, where, a[key], b[key], tolerance, describe_index)


def describe_index(index: tuple[int, ...]) -> str:
    return f"[{', '.join(map(str, index))}]" if index else "this value"


READERS = {
    ".json": (read_json, compare_maps),
    ".csv": (read_table, compare_tables),
    ".h5": (read_hdf5, compare_arrays),
    ".hdf5": (read_hdf5, compare_arrays),
}


def compare_files(report: Report, a: Path, b: Path, rules: Rules, place: str = "") -> None:
    """Two files of one kind."""
    read, compare = READERS[b.suffix.lower()]
    compare(report, place or b.name, read(a), read(b), rules)


def without(rules: Rules, *patterns: str) -> Rules:
    """The rules, without the entries of these patterns."""
    ignored = [(pattern, Tolerance(ignore=True)) for pattern in patterns]
    return replace(rules, patterns=ignored + rules.patterns)


def summary_of(results: Results) -> dict:
    """The leaves of job.json; names of files and places in the deck without the name of the job."""
    leaves = read_json(results.path(".json"))
    for key, text in leaves.items():
        if key.startswith("files."):
            leaves[key] = text.removeprefix(results.job).replace(f"/{results.job}_", "/_")
        elif key.startswith("warnings."):
            leaves[key] = re.sub(rf"^\S*{re.escape(results.job)}\.inp:", ":", str(text))
    return leaves


def compare_folders(a: Results, b: Results, rules: Rules) -> Report:
    """Summary, tables and HDF5 file of two runs; the VTK files hold the same data."""
    report = Report()
    summary = without(rules, *SUMMARY_IGNORED)
    compare_maps(report, "summary", summary_of(a), summary_of(b), summary)
    for table in sorted({*a.tables(), *b.tables()}):
        sides = [table in side.tables() for side in (a, b)]
        if all(sides):
            compare_files(report, *(s.path(f"_{table}.csv") for s in (a, b)), rules, table)
        elif sides[1] or not rules.fewer_rows:
            report.lack(table, f"table missing in the {'first' if sides[1] else 'second'}")
    files = [side.path(".h5") for side in (a, b)]
    if all(f.exists() for f in files):
        compare_files(report, *files, without(rules, "ledger/*"), "hdf5")
    elif files[1].exists() or (files[0].exists() and not rules.fewer_rows):
        report.lack("hdf5", f"missing in the {'first' if files[1].exists() else 'second'}")
    return report


def compare_with_reference(a: Results, b: Path, rules: Rules, table: str) -> Report:
    """Compares the run's file of the reference's kind; of several tables, the one named."""
    report = Report()
    if b.suffix.lower() == ".csv":
        compare_files(report, a.path(f"_{table or choose_table(a, b)}.csv"), b, rules)
    else:
        ending = ".json" if b.suffix.lower() == ".json" else ".h5"
        compare_files(report, a.path(ending), b, rules)
    return report


def choose_table(a: Results, reference: Path) -> str:
    """The table whose name ends the name of the reference file, or the only table."""
    tables = a.tables()
    named = [t for t in tables if reference.stem == t or reference.stem.endswith(f"_{t}")]
    if named or len(tables) == 1:
        return max(named, key=len) if named else tables[0]
    raise ValueError(
        f"'{reference.name}' could be any of the tables {', '.join(tables) or '(none)'}; "
        "choose one with --table"
    )
