"""The kinds of files that a run writes, read as arrays under names."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .program import DamagedFileError

Table = dict[str, np.ndarray]


def read_table(path: Path | str) -> Table:
    """Columns of a CSV file with one header line: numbers where all are, else texts."""
    with Path(path).open(newline="", encoding="utf-8-sig") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        raise DamagedFileError(f"{path}: empty, expected a header line")
    header = [name.strip() for name in rows[0]]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise DamagedFileError(f"{path}:{number}: {len(row)} values, expected {len(header)}")
    columns = zip(*rows[1:], strict=True) if len(rows) > 1 else [()] * len(header)
    return {name: as_numbers(column) for name, column in zip(header, columns, strict=True)}


def natural(name: str) -> list[tuple[bool, int, str]]:
    """A key for sorting, by which JOINT2 comes before JOINT10."""
    words = re.findall(r"\d+|\D+", name)
    return [(not word.isdecimal(), int(word) if word.isdecimal() else 0, word) for word in words]


def as_file_word(name: str) -> str:
    """The name of a set or joint in the name of its table.

    >>> as_file_word("FUGE Ü 1")
    'FUGE____1'
    """
    return re.sub(rb"[^A-Za-z0-9_.-]", b"_", name.encode()).decode()


def energy_names(table: Table) -> list[str]:
    """The energies among the columns of a balance of energy, those of all decks first.

    Decks with stages and with temperatures have more of them.
    """
    usual = ("external", "strain", "kinetic")
    names = [name for name in table if name not in ("step", "increment", "time", "error")]
    return [n for n in usual if n in names] + [n for n in names if n not in usual]


def as_numbers(column: tuple[str, ...]) -> np.ndarray:
    """The column as numbers if every field is one or empty (NaN), else as texts."""
    try:
        return np.array([float(field) if field.strip() else math.nan for field in column])
    except ValueError:
        return np.array([field.strip() for field in column], dtype=object)


def read_json(path: Path | str) -> dict[str, Any]:
    """Leaves of a JSON file under their paths, as in 'steps.0.energy.error'."""
    return dict(leaves(load_json(path), ""))


def load_json(path: Path | str) -> Any:
    """The content of a JSON file. Raises ValueError with the name of the file."""
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise DamagedFileError(f"{path} cannot be read, it is not whole: {error}") from None


def leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Pairs (path, leaf); an empty list or object is a leaf, so that it is not lost."""
    if isinstance(value, dict | list) and value:
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            yield from leaves(inner, f"{path}.{key}" if path else str(key))
    else:
        yield path, value


def read_hdf5(path: Path | str) -> Table:
    """All datasets of an HDF5 file under their paths."""
    return {name: data for name, data, _ in hdf5_items(path) if data is not None}


def hdf5_items(path: Path | str) -> list[tuple[str, np.ndarray | None, Table]]:
    """Path, data and attributes of every dataset; groups have no data."""
    found = []

    def keep(name: str, item: Any) -> None:
        data = as_array(item[()]) if isinstance(item, h5py.Dataset) else None
        found.append((name, data, {key: as_array(value) for key, value in item.attrs.items()}))

    with h5py.File(path, "r") as file:
        file.visititems(keep)
    return found


def as_array(value: Any) -> np.ndarray:
    """Numbers as they are, texts without the blanks that fill them."""
    data = np.asarray(value)
    if data.dtype.kind not in "OSU":
        return data
    words = [w.decode() if isinstance(w, bytes) else str(w) for w in data.ravel().tolist()]
    return np.array([w.strip() for w in words], dtype=object).reshape(data.shape)
