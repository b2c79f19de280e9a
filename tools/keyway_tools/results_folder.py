"""What a run leaves behind: the summary, the tables and the HDF5 file of a results folder."""

from __future__ import annotations

import csv
import json
import math
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

Table = dict[str, np.ndarray]


class ResultsFolder:
    """The results of one job in a folder."""

    def __init__(self, folder: Path | str, job: str | None = None):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise FileNotFoundError(f"there is no folder '{self.folder}'")
        self.job = job or self._find_job()

    def _find_job(self) -> str:
        jobs = [p.stem for p in sorted(self.folder.glob("*.json")) if is_summary(p)]
        if len(jobs) == 1:
            return jobs[0]
        if not jobs:
            raise FileNotFoundError(f"no results of Keyway in '{self.folder}'")
        raise ValueError(f"several jobs in '{self.folder}': {', '.join(jobs)}; name one of them")

    def path(self, ending: str) -> Path:
        """File of the job, as in path('.json') or path('_node_TIP.csv')."""
        return self.folder / f"{self.job}{ending}"

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The summary JOB.json."""
        return json.loads(self.path(".json").read_text(encoding="utf-8"))

    def tables(self) -> list[str]:
        """Names of the tables, as in ['node_TIP', 'joint_J1']."""
        start = f"{self.job}_"
        return sorted(p.stem.removeprefix(start) for p in self.folder.glob("*.csv") if
                      p.name.startswith(start))  # fmt: skip

    def table(self, name: str) -> Table:
        """Columns of the table JOB_NAME.csv."""
        return read_table(self.path(f"_{name}.csv"))

    def find(self, path: str) -> Any:
        """Value in the summary, as in find('steps.0.frequencies.2.hz')."""
        value: Any = self.summary
        for key in path.split("."):
            try:
                value = value[int(key)] if isinstance(value, list) else value[key]
            except (KeyError, IndexError, ValueError, TypeError):
                raise KeyError(f"{self.path('.json').name} has no '{path}' (at '{key}')") from None
        return value


def is_summary(path: Path) -> bool:
    """Whether a JSON file is the summary of an analysis (one of material tests holds 'tests')."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    has_keys = isinstance(content, dict) and {"program", "status"} <= content.keys()
    return has_keys and "tests" not in content


def read_table(path: Path | str) -> Table:
    """Columns of a CSV file with one header line: numbers where all are, else texts."""
    with Path(path).open(newline="", encoding="utf-8-sig") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        raise ValueError(f"{path}: empty, expected a header line")
    header = [name.strip() for name in rows[0]]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise ValueError(f"{path}:{number}: {len(row)} values, expected {len(header)}")
    columns = zip(*rows[1:], strict=True) if len(rows) > 1 else [()] * len(header)
    return {name: as_numbers(column) for name, column in zip(header, columns, strict=True)}


def as_numbers(column: tuple[str, ...]) -> np.ndarray:
    """The column as numbers if every field is one or empty (NaN), else as texts."""
    try:
        return np.array([float(field) if field.strip() else math.nan for field in column])
    except ValueError:
        return np.array([field.strip() for field in column], dtype=object)


def read_json(path: Path | str) -> dict[str, Any]:
    """Leaves of a JSON file under their paths, as in 'steps.0.energy.error'."""
    content = json.loads(Path(path).read_text(encoding="utf-8"))
    return dict(leaves(content, ""))


def leaves(value: Any, path: str):
    """Pairs (path, leaf); an empty list or object is a leaf, so that it is not lost."""
    if isinstance(value, dict | list) and value:
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            yield from leaves(inner, f"{path}.{key}" if path else str(key))
    else:
        yield path, value


def read_hdf5(path: Path | str) -> Table:
    """All datasets of an HDF5 file under their paths."""
    found: Table = {}

    def keep(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            is_text = item.dtype.kind in "OS"
            value = item.asstr()[()] if is_text else item[()]
            found[name] = np.asarray(value, dtype=object if is_text else None)

    with h5py.File(path, "r") as file:
        file.visititems(keep)
    return found
