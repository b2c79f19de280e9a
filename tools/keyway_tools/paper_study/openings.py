"""Openings of joints over the height, and in time at crest, mid-height and base."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..picture_style import COLOURS, Sheet, headline, new_figure
from ..pictures_curves import mark_of, mark_one_time
from ..si_results import SiResults

HEIGHTS = ("crest", "mid-height", "base")
FACES = ("upstream", "downstream")


def profile(results: SiResults, name: str) -> dict[str, np.ndarray]:
    """Largest openings over the last step along the two edges of a joint, by face: z, opening.

    An edge has, at every height, the node of the joint's face that is farthest to its side.
    """
    step = [step for step in results.steps() if "OPENING" in step.envelopes][-1]
    joint = results.joint_faces(name)
    nodes = np.unique(joint.facets) if joint is not None else np.zeros(0, dtype=int)
    x, opening = results.x[nodes], np.nan_to_num(step.envelopes["OPENING"][nodes])
    rows = x[:, 2].round(4)
    edges: dict[str, list[tuple[float, float]]] = {face: [] for face in FACES}
    for z in np.unique(rows):
        at = np.flatnonzero(rows == z)
        for face, place in zip(FACES, (at[x[at, 1].argmin()], at[x[at, 1].argmax()]), strict=True):
            edges[face].append((z, opening[place]))
    return {face: np.array(rows).reshape(-1, 2) for face, rows in edges.items()}


def plot_profiles(runs: dict[str, SiResults], sheet: Sheet) -> list[Path]:
    """Largest openings over the height: a panel for each joint and face, a line for each run.

    Where no joint opens there is no picture.
    """
    names = next(iter(runs.values())).joint_names()
    edges = {
        (label, name): profile(results, name) for label, results in runs.items() for name in names
    }
    if not any(rows[:, 1].any() for both in edges.values() for rows in both.values()):
        return []
    figure, axes = new_figure(
        2, width=max(9.0, 2.6 * len(names)), row_height=3.4, columns=len(names), squeeze=False,
        sharex=True, sharey=True,
    )  # fmt: skip
    for column, name in enumerate(names):
        for label, colour in zip(runs, COLOURS, strict=False):
            for axis, rows in zip(axes[:, column], edges[label, name].values(), strict=True):
                axis.plot(1e3 * rows[:, 1], rows[:, 0], color=colour, label=label)
        axes[0, column].set_title(name)
        axes[1, column].set_xlabel("opening [mm]")
    for axis, face in zip(axes[:, 0], FACES, strict=True):
        axis.set_ylabel(f"{face} edge\nheight z [m]")
    if len(runs) > 1:
        axes[1, -1].legend(loc="lower right", fontsize=9)
    headline(figure, "Largest joint openings over the height")
    return sheet.save(figure)


def plot_histories(results: SiResults, sheet: Sheet) -> list[Path]:
    """Openings in time at the printed points: a row for each joint, a panel for each height."""
    names = [name for name in results.joint_names() if f"joint_{name}" in results.tables()]
    if not names:
        return []
    figure, axes = new_figure(
        len(names), width=13.0, row_height=2.1, columns=3, squeeze=False, sharex=True
    )
    for row, name in enumerate(names):
        table = results.table(f"joint_{name}")
        opening = 1e3 * results.without_round_off(table["opening"])
        for axis, height, points in zip(axes[row], HEIGHTS, by_height(table), strict=True):
            for face, rows in points.items():
                colour = COLOURS[FACES.index(face)]
                mark = mark_of(len(rows))
                axis.plot(table["time"][rows], opening[rows], color=colour, lw=1.0, marker=mark,
                          label=face)  # fmt: skip
            where = f", z = {table['z'][next(iter(points.values()))[0]]:.4g} m" if points else ""
            axis.set_title(f"{name}, {height}{where}", fontsize=11)
            axis.margins(x=0.0)
        axes[row, 0].set_ylabel("opening [mm]")
    for column in axes.T:
        column[-1].set_xlabel("time [s]")
        mark_one_time(column)
    axes[0, 0].legend(loc="upper left")
    headline(figure, "Openings in time (below zero: compressed)")
    return sheet.save(figure)


def by_height(table: dict[str, np.ndarray]) -> list[dict[str, np.ndarray]]:
    """Rows of a table of a joint at crest, mid-height and base, by face."""
    z = table["z"].round(4)
    heights = np.unique(z)[::-1]
    wanted = [heights[0], heights[len(heights) // 2], heights[-1]] if len(heights) > 2 else []
    found = []
    for height in wanted or [*heights, *[np.nan] * (3 - len(heights))]:
        rows = np.flatnonzero(z == height)
        points = np.unique(table["point"][rows])
        y = {point: table["y"][rows[table["point"][rows] == point][0]] for point in points}
        order = sorted(points, key=lambda point: y[point])
        ends = dict(zip(FACES, (order[0], order[-1]), strict=True)) if order else {}
        found.append({face: rows[table["point"][rows] == point] for face, point in ends.items()})
    return found
