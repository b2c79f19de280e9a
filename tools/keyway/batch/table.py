"""The table of a batch: on the terminal, and with all results as CSV and Parquet."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from keyway_tools.deck_runs import EXTREMES, Record
from keyway_tools.job_folder import summary_of

from ..deck.fields import as_number
from .cases import NAME, Case


def cell(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def table_of(records: list[Record]) -> str:
    """One line for each run; extremes that a run has."""
    shown = [name for name in EXTREMES if any(r.extremes.get(name) is not None for r in records)]
    rows: list[tuple[str, ...]] = [("deck", "status", "time [s]", "memory [MB]", *shown)]
    for record in records:
        rows.append(
            (
                Path(record.folder).name,
                record.status + (" (kept)" if record.was_kept else ""),
                cell(record.wall_s, ".1f"),
                cell(record.peak_memory_mb, ".0f"),
                *(cell(record.extremes.get(name), ".4g") for name in shown),
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


@dataclass(frozen=True)
class ResultTable:
    """A row for each case: its values, how the run went, and its extremes."""

    columns: list[str]
    rows: list[list[Any]]  # None where there is no value
    results: list[str]  # the columns with extremes

    def write(self, folder: Path) -> list[Path]:
        """Write batch.csv, and batch.parquet where pyarrow is installed; their paths."""
        folder.mkdir(parents=True, exist_ok=True)
        paths = [folder / "batch.csv"]
        with paths[0].open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows([["" if v is None else v for v in row] for row in self.rows])
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            return paths
        columns = zip(*self.rows, strict=True) if self.rows else [()] * len(self.columns)
        arrays = [pyarrow.array(column) for column in map(list, columns)]
        paths.append(folder / "batch.parquet")
        pyarrow.parquet.write_table(pyarrow.table(arrays, names=self.columns), paths[1])
        return paths


def result_table(cases: list[Case], records: list[Record]) -> ResultTable:
    """Values, costs and extremes of all cases.

    Extremes are those of job.json: S1, S3, OPENING, U, DAMAGET, .. of *ENVELOPE (largest, of S3
    smallest, anywhere), `displacement`, `opening_NAME` and `slip_NAME` of each joint.
    """
    runs = [_run(record) for record in records]
    extremes = [
        _extremes(case) if record.has_results else {}
        for case, record in zip(cases, records, strict=True)
    ]
    results = [*dict.fromkeys(name for one in extremes for name in one)]
    taken = {name for row in [*runs, *extremes] for name in row}
    found = []
    for k, values in enumerate(_values([case.values for case in cases])):
        # a value with the name of a result has a column of its own
        named = {f"{name}_given" if name in taken else name: v for name, v in values.items()}
        found.append({NAME: cases[k].name, **named, **runs[k], **extremes[k]})
    columns = list(dict.fromkeys(name for row in found for name in row))
    return ResultTable(columns, [[row.get(name) for name in columns] for row in found], results)


def _run(record: Record) -> dict[str, Any]:
    """How a run went, by columns."""
    names = ("status", "exit_code", "wall_s", "processor_s", "peak_memory_mb", "message")
    return {name: getattr(record, name) for name in names}


def _extremes(case: Case) -> dict[str, float | None]:
    summary = summary_of(case.folder, case.deck)
    if summary is None:
        return {}
    found = {"displacement": _anywhere(summary.get("displacement"))}
    found |= {name: _anywhere(one) for name, one in (summary.get("envelopes") or {}).items()}
    for joint, extremes in (summary.get("joints") or {}).items():
        for name in ("opening", "slip"):
            found[f"{name}_{joint}"] = _anywhere(extremes.get(name))
    if damage := summary.get("damage"):
        found["DAMAGET"] = damage["DAMAGET"]["value"]
    return found


def _anywhere(places: Any) -> float | None:
    value = ((places or {}).get("anywhere") or {}).get("value")
    return None if value is None else float(value)


def _values(rows: list[dict[str, str]]) -> list[dict[str, Any]]:
    """The values of the table of cases: a column is numbers where all its values are."""
    names = [name for name in (rows[0] if rows else {}) if name != NAME]
    columns: dict[str, Sequence[float | str]] = {}
    for name in names:
        texts = [row[name] for row in rows]
        columns[name] = _numbers(texts) or texts
    return [{name: columns[name][k] for name in names} for k in range(len(rows))]


def _numbers(column: list[str]) -> list[float] | None:
    """Numbers as a deck reads them: 2.D3 is one; 1_2 and nan, which may be names, are none."""
    try:
        found = [as_number(text) for text in column]
    except ValueError:
        return None
    return found if all(map(isfinite, found)) else None
