"""Fractiles of the results of a batch, as a table and a picture."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from .table import ResultTable

FRACTILES = (0.16, 0.5, 0.84)
FEWEST = 4  # cases: fewer have no fractiles worth the name
_MOST_PANELS = 12
_COLUMNS = 3


def write_fractiles(table: ResultTable, folder: Path) -> list[Path]:
    """Write batch_fractiles.csv and batch_fractiles.png of the finished cases; their paths.

    Each result has a row: number of cases, smallest, fractiles, largest. The picture shows the
    first twelve results that differ between the cases. Fewer than four cases have neither; files of
    an earlier call are removed.
    """
    for name in ("batch_fractiles.csv", "batch_fractiles.png"):
        (folder / name).unlink(missing_ok=True)
    results = {name: values for name, values in _results(table).items() if len(values) >= FEWEST}
    if not results:
        return []
    path = folder / "batch_fractiles.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["result", "cases", "smallest", *FRACTILES, "largest"])
        for name, values in results.items():
            inner = [float(np.quantile(values, fractile)) for fractile in FRACTILES]
            writer.writerow([name, len(values), values.min(), *inner, values.max()])
    shown = {name: values for name, values in results.items() if np.ptp(values) > 0.0}
    return [path] + (_draw(shown, folder) if shown else [])


def _results(table: ResultTable) -> dict[str, np.ndarray]:
    """The results of the finished cases."""
    status = table.columns.index("status")
    rows = [row for row in table.rows if row[status] == "finished"]
    found = {}
    for name in table.results:
        place = table.columns.index(name)
        found[name] = np.array([row[place] for row in rows if row[place] is not None], dtype=float)
    return found


def _draw(results: dict[str, np.ndarray], folder: Path) -> list[Path]:
    """The share of the cases that stay below a value, a panel for each result."""
    from keyway_tools.picture_style import Sheet, headline, new_figure

    names = list(results)[:_MOST_PANELS]
    columns = min(len(names), _COLUMNS)
    rows = math.ceil(len(names) / columns)
    figure, axes = new_figure(rows, 4.2 * columns, 3.2, columns, squeeze=False)
    for axis, name in zip(axes.flat, names, strict=False):
        values = np.sort(results[name])
        share = np.arange(1, len(values) + 1) / len(values)
        axis.step([values[0], *values], [0.0, *share], where="post")
        for fractile in FRACTILES:
            value = float(np.quantile(values, fractile))
            label = f"{100.0 * fractile:.0f} %: {value:.3g}"
            axis.plot(value, fractile, "o", label=label)
        axis.set(xlabel=name, ylim=(0.0, 1.02))
        axis.locator_params(axis="x", nbins=4)
        axis.ticklabel_format(axis="x", scilimits=(-3, 4))
        axis.legend(loc="lower right", fontsize=10)
    for axis in axes.flat[len(names) :]:
        axis.set_visible(False)
    for row in axes:
        row[0].set_ylabel("share of cases below")
    of_all = "" if len(names) == len(results) else f", {len(names)} of {len(results)} results"
    headline(figure, f"Fractiles of {max(map(len, results.values()))} cases{of_all}")
    note = f"{folder.resolve().name} · units of the deck"
    files: list[Path] = Sheet(folder / "batch_fractiles", note=note).save(figure)
    return files
