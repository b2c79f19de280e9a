"""All results of a run as named arrays, to compare two runs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from keyway_tools.comparison import distances
from keyway_tools.result_files import as_array, hdf5_items, read_json, read_table

# Files of a run without results: its log, and its output on stdout and stderr.
NO_RESULTS = (".log", ".out")
# Entries of the summary that depend on the machine and the hour, or are prose.
SUMMARY_IGNORED = (
    "program.*",
    "machine.*",
    "deck",
    "deck.*",
    "ledger",
    "ledger.*",
    "*.wall_s",
    "ignored_input.*.file",
    "message",
    "*.message",
    "warnings.*",
)
ENERGIES = {
    *("external", "kinetic", "strain", "damping", "friction", "fracture", "crushing"),
    *("numerical", "stages", "temperature", "work", "stored"),
}
# Numbers that are relative already: their differences are not divided.
RATIOS = ("error", "residual", "largest_residual", "largest_energy_error")
# Shapes of modes: /steps/0001/modes/shape (modes, nodes, 3) and MODE_01 (nodes, 3).
MODES = re.compile(r"modes/shape|\bMODE_\d+$")


@dataclass(frozen=True)
class Values:
    """An array, and its group of arrays, whose largest value scales the differences."""

    data: np.ndarray
    group: str


@dataclass(frozen=True)
class Difference:
    """The largest relative difference of two arrays; infinite where one is missing."""

    place: str
    size: float
    text: str


def group_of(name: str) -> str:
    """Components of a vector or tensor share a measure, and so do energies."""
    last = name.rsplit(".", 1)[-1]
    if last in ENERGIES:
        return name.removesuffix(last) + "energies"
    if re.fullmatch(r"SDV\d+", last):
        return name
    return re.sub(r"(?<=[A-Za-z])\d+$", "", name)


def values_of_csv(path: Path) -> Iterator[tuple[str, Values]]:
    for name, column in read_table(path).items():
        yield name, Values(column, group_of(name))


def values_of_json(path: Path) -> Iterator[tuple[str, Values]]:
    """Numbers and words of a summary; a list of numbers has one measure."""
    for name, leaf in read_json(path).items():
        if not any(fnmatchcase(name, pattern) for pattern in SUMMARY_IGNORED):
            is_number = isinstance(leaf, int | float) and not isinstance(leaf, bool)
            data = np.asarray(leaf, dtype=float if is_number else object)
            yield name, Values(data, re.sub(r"\.\d+$", "", group_of(name)))


def values_of_hdf5(path: Path) -> Iterator[tuple[str, Values]]:
    """Datasets, column by column where columns have names, and attributes; not the ledger."""
    for name, data, attributes in hdf5_items(path):
        if name.split("/")[0] == "ledger":
            continue
        words = [str(attributes.pop(key, "")) for key in ("columns", "components")]
        columns = [column for text in words for column in text.split(",") if column]
        for key, value in attributes.items():
            yield f"{name}@{key}", Values(value, f"{name}@{key}")
        if data is None:
            continue
        if columns and data.ndim == 2 and data.shape[1] == len(columns):
            for k, column in enumerate(columns):
                full = f"{name}.{column}"
                yield full, Values(data[:, k], group_of(full))
        else:
            yield name, Values(data, name)


def values_of_vtu(path: Path) -> Iterator[tuple[str, Values]]:
    import pyvista  # takes a second to load

    grid = pyvista.read(path)
    yield "points", Values(np.asarray(grid.points), "points")
    yield "cells", Values(np.asarray(grid.cells), "cells")
    yield "cell types", Values(np.asarray(grid.celltypes), "cell types")
    fields = (("point", grid.point_data), ("cell", grid.cell_data), ("field", grid.field_data))
    for kind, data in fields:
        for name in data:
            yield f"{kind} {name}", Values(as_array(data[name]), f"{kind} {name}")


def values_of_pvd(path: Path) -> Iterator[tuple[str, Values]]:
    text = path.read_text(encoding="utf-8")
    times = np.array([float(t) for t in re.findall(r'timestep="([^"]*)"', text)])
    yield "times", Values(times, "times")
    yield "files", Values(np.array(re.findall(r'file="([^"]*)"', text), dtype=object), "files")


READERS = {
    ".csv": values_of_csv,
    ".json": values_of_json,
    ".h5": values_of_hdf5,
    ".vtu": values_of_vtu,
    ".pvd": values_of_pvd,
}


def files_of_results(folder: Path) -> set[str]:
    """Paths of the results in a folder, relative to it."""
    return {
        str(path.relative_to(folder))
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith(".") and path.suffix not in NO_RESULTS
    }


def compare_written(before: Path, after: Path) -> Iterator[Difference]:
    """A difference for each array of two folders, also differences of size 0."""
    files = files_of_results(before), files_of_results(after)
    for name in sorted(files[0] | files[1]):
        if name not in files[1] or name not in files[0]:
            yield lacking(name, name in files[0])
        elif read := READERS.get(Path(name).suffix):
            sides = dict(read(before / name)), dict(read(after / name))
            yield from compare_maps(name, *sides)
        elif (before / name).read_bytes() != (after / name).read_bytes():
            yield Difference(name, np.inf, "other content")


def lacking(place: str, is_before: bool) -> Difference:
    return Difference(place, np.inf, f"only {'before' if is_before else 'after'}")


def compare_maps(
    file: str, before: dict[str, Values], after: dict[str, Values]
) -> Iterator[Difference]:
    measures: dict[str, float] = {}
    for values in [*before.values(), *after.values()]:
        measures[values.group] = max(measures.get(values.group, 0.0), largest(values.data))
    for name in [*before, *(n for n in after if n not in before)]:
        place = f"{file}: {name}"
        if name not in before or name not in after:
            yield lacking(place, name in before)
        else:
            measure = 1.0 if name.rsplit(".", 1)[-1] in RATIOS else measures[before[name].group]
            a, b = before[name].data, after[name].data
            if MODES.search(name) and a.shape == b.shape:
                b = with_signs_of(a, b)
            yield Difference(place, *compare_arrays(a, b, measure))


def with_signs_of(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The modes b, each with the sign nearer to a, since the sign of a mode is arbitrary."""
    if a.ndim < 3:
        return b if np.vdot(a, b) >= 0 else -b
    return np.array([with_signs_of(one, other) for one, other in zip(a, b, strict=True)])


def largest(data: np.ndarray) -> float:
    if data.dtype == object or not data.size:
        return 0.0
    size = np.abs(data, dtype=float)
    return float(np.max(size, where=np.isfinite(size), initial=0.0))


def compare_arrays(a: np.ndarray, b: np.ndarray, measure: float) -> tuple[float, str]:
    """The largest difference over the measure, and where it is."""
    if a.shape != b.shape:
        return np.inf, f"shape {a.shape} before, {b.shape} after"
    if object in (a.dtype, b.dtype):
        other = np.asarray(a.astype(str) != b.astype(str))
        if not other.any():
            return 0.0, ""
        place = first_index(other)
        return np.inf, f"{a[place]!r} before, {b[place]!r} after"
    gaps = np.asarray(distances(a.astype(float), b.astype(float)))
    if not gaps.any():
        return 0.0, ""
    place = first_index(gaps == gaps.max())
    size = float(gaps[place]) / measure if measure > 0 else np.inf
    row = f" at {', '.join(map(str, place))}" if place else ""
    return size, f"{a[place]:.9g} before, {b[place]:.9g} after{row}; largest {measure:.3g}"


def first_index(mask: np.ndarray) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(mask)), mask.shape))
