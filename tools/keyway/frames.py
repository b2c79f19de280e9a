"""Tables and lists of results as pandas frames."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from keyway_tools.results import Results

if TYPE_CHECKING:
    import pandas as pd

# Columns of tables that are counts and numbers of the deck.
_INTEGERS = ("step", "increment", "node", "element", "point", "iterations", "state")
_HISTORY = ("step", "increment", "time")


def frame_of(columns: dict[str, Any]) -> pd.DataFrame:
    """Columns as a frame; counts and numbers of the deck as integers where none is missing."""
    import pandas as pd

    frame = pd.DataFrame(columns)
    for name in _INTEGERS:
        if name in frame and frame[name].notna().all():
            frame[name] = frame[name].astype("int64")
    return frame


def opening_frame(results: Results) -> pd.DataFrame:
    """Largest opening of each joint in each increment."""
    columns: dict[str, Any] = {}
    for joint in results.joint_names():
        history = results.history(f"joints/{joint}")
        if not history:
            continue
        for name in _HISTORY:
            columns.setdefault(name, history[name])
        columns[joint] = history["opening"]
    return frame_of(columns or {name: [] for name in _HISTORY})


def extremes_frame(summary: dict[str, Any], part: str) -> pd.DataFrame:
    """The extremes in a part of the summary: of `envelopes`, of `joints`, of `displacement`."""
    names = ["field", "place", "value", "time", "x", "y", "z"]
    rows = list(_extremes(summary.get(part) or {}, ()))
    if part == "joints":
        names = ["joint", *names]
    if part == "displacement":
        rows = [("U", *row) for row in rows]
    return frame_of({name: [row[k] for row in rows] for k, name in enumerate(names)})


def _extremes(value: Any, path: tuple[str, ...]) -> Iterator[tuple[Any, ...]]:
    """Rows of all extremes below a part: their path, value, time and place."""
    if not isinstance(value, dict):
        return
    if "value" in value and path:
        x = [*(value.get("x") or []), *[float("nan")] * 3][:3]
        yield (*path, value["value"], value.get("time", float("nan")), *x)
        return
    for name, inner in value.items():
        yield from _extremes(inner, (*path, name))


def frequency_frame(summary: dict[str, Any]) -> pd.DataFrame:
    """The modes of all *FREQUENCY steps."""
    columns: dict[str, list[Any]] = {
        name: []
        for name in ("step", "mode", "hz", "effective_mass_x", "effective_mass_y",
                     "effective_mass_z")
    }  # fmt: skip
    for number, step in enumerate(summary.get("steps") or [], 1):
        for mode in step.get("frequencies") or []:
            row = (number, mode["mode"], mode["hz"], *mode["effective_mass"])
            for column, value in zip(columns.values(), row, strict=True):
                column.append(value)
    return frame_of(columns)
