"""Histories: joint openings, nodes, energies, damage."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .picture_style import COLOURS, GREY, Sheet, new_figure
from .si_results import SiResults

MOST_CURVES = 6


def _curves_by(values: dict[str, np.ndarray], key: str) -> dict[int, np.ndarray]:
    """Rows of each node or point."""
    return {int(number): np.flatnonzero(values[key] == number) for number in np.unique(values[key])}


def plot_openings(results: SiResults, sheet: Sheet) -> list[Path]:
    """Opening of the points of every *JOINT PRINT in time, one row a joint.

    Static steps and motions have columns of their own: the years of the one hide the seconds of
    the other.
    """
    names = [name for name in results.tables() if name.startswith("joint_")]
    tables = {name.removeprefix("joint_"): results.table(name) for name in names}
    tables = {name: table for name, table in tables.items() if len(table.get("time", ()))}
    if not tables:
        return []
    columns = _columns(results, list(tables.values()))
    figure, axes = new_figure(
        len(tables), width=12.0 + 4.0 * (len(columns) - 1), row_height=2.9, columns=len(columns),
        sharex="col", squeeze=False,
    )  # fmt: skip
    for row, (name, table) in zip(axes, tables.items(), strict=True):
        for axis, (kind, steps) in zip(row, columns.items(), strict=True):
            _opening_panel(axis, table, steps)
            axis.set_title(f"Opening of joint {name}{', ' if kind else ''}{kind}")
        row[0].set_ylabel("opening [mm]")
        row[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    for axis, kind in zip(axes[-1], columns, strict=True):
        axis.set_xlabel("time of the deck" if kind == STATIC else "time [s]")
    return sheet.save(figure)


STATIC, MOTION = "static steps", "motion"


def _columns(results: SiResults, tables: list[dict[str, np.ndarray]]) -> dict[str, set[int]]:
    """Numbers of the steps in each column; one column without a name where one serves all."""
    found: dict[str, set[int]] = {STATIC: set(), MOTION: set()}
    for step in results.steps():
        found[MOTION if "DYNAMIC" in step.procedure else STATIC].add(step.number)
    for kind, steps in list(found.items()):
        times = {t for table in tables for t in table["time"][np.isin(table["step"], list(steps))]}
        if len(times) < 3:
            del found[kind]
    return found if len(found) > 1 else {"": {int(s) for table in tables for s in table["step"]}}


def _opening_panel(axis, table: dict[str, np.ndarray], steps: set[int]) -> None:
    """The points that open most in all steps, in some of them."""
    points = _curves_by(table, "point")
    most = sorted(points, key=lambda p: -table["opening"][points[p]].max())[:MOST_CURVES]
    for point in most:
        rows = points[point][np.isin(table["step"][points[point]], list(steps))]
        x, y, z = (table[axis_name][points[point][0]] for axis_name in "xyz")
        label = f"point {point} ({x:.1f}, {y:.1f}, {z:.1f}) m"
        axis.plot(table["time"][rows], 1000.0 * table["opening"][rows], lw=1.0, label=label)
    axis.axhline(0.0, color=GREY, lw=0.8)
    axis.margins(x=0.0)


def plot_nodes(results: SiResults, sheet: Sheet) -> list[Path]:
    """Displacements of every *NODE PRINT in time, one row a direction, columns as of openings."""
    curves = []
    nodes = [name for name in results.tables() if name.startswith("node_")]
    for name in nodes:
        table, title = results.table(name), name.removeprefix("node_")
        if "U1" not in table or len(np.unique(table["time"])) < 3:
            continue
        for node, rows in list(_curves_by(table, "node").items())[:MOST_CURVES]:
            curves.append((f"{title}, node {node}", table, rows))
    if not curves:
        return []
    columns = _columns(results, [table for _, table, _ in curves])
    figure, axes = new_figure(
        3, width=12.0 + 4.0 * (len(columns) - 1), row_height=2.2, columns=len(columns),
        sharex="col", squeeze=False,
    )  # fmt: skip
    for column, (kind, steps) in zip(axes.T, columns.items(), strict=True):
        for label, table, rows in curves[:MOST_CURVES]:
            shown = rows[np.isin(table["step"][rows], list(steps))]
            for axis, direction in zip(column, "123", strict=True):
                values = 1000.0 * table[f"U{direction}"][shown]
                axis.plot(table["time"][shown], values, lw=1.0, label=label)
        for axis in column:
            axis.margins(x=0.0)
        column[0].set_title(f"Displacements relative to the base{', ' if kind else ''}{kind}")
        column[-1].set_xlabel("time of the deck" if kind == STATIC else "time [s]")
    for axis, direction in zip(axes[:, 0], "123", strict=True):
        axis.set_ylabel(f"U{direction} [mm]")
    axes[0, -1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.align_ylabels(axes[:, 0])
    return sheet.save(figure)


def plot_energy(results: SiResults, sheet: Sheet) -> list[Path]:
    """Energies in time and the imbalance between them."""
    table = results.history("energy")
    if len(table.get("time", ())) < 3:
        return []
    largest = max(np.abs(table[name]).max() for name in ("external", "kinetic", "strain"))
    scale, unit = (1e-6, "MJ") if largest > 1e5 else (1e-3, "kJ") if largest > 1e2 else (1.0, "J")
    figure, axes = new_figure(
        2, width=12.0, row_height=2.9, sharex=True, gridspec_kw={"height_ratios": (3, 1)}
    )
    names = ("external", "strain", "kinetic", "damping", "friction", "fracture", "numerical")
    shown = [n for n in names if np.abs(table[n]).max() > 1e-6 * largest]
    for name, colour in zip(shown, COLOURS, strict=False):
        axes[0].plot(table["time"], scale * table[name], color=colour, label=name)
    axes[0].set_title("Energy balance")
    axes[0].set_ylabel(f"energy [{unit}]")
    axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes[1].plot(table["time"], 100.0 * table["error"], color=GREY)
    axes[1].set_ylabel("imbalance [%]")
    axes[1].set_xlabel("time [s]")
    axes[1].margins(x=0.0)
    figure.align_ylabels()
    return sheet.save(figure)


def plot_damage_growth(results: SiResults, sheet: Sheet) -> list[Path]:
    """Damaged volumes, and the energy dissipated by cracks and crushing, in time."""
    table = results.history("damage")
    if len(table.get("time", ())) < 3 or table["inelastic_volume"].max() <= 0.0:
        return []
    figure, axes = new_figure(2, width=12.0, row_height=2.9, sharex=True)
    axes[0].plot(table["time"], table["inelastic_volume"], color=GREY, label="beyond elasticity")
    for percent, colour in zip((10, 50, 90), COLOURS, strict=False):
        axes[0].plot(
            table["time"], table[f"volume_{percent}"], color=colour, label=f"damage ≥ {percent} %"
        )
    axes[0].set_title("Growth of damage in tension")
    axes[0].set_ylabel("volume [m³]")
    for name, colour in zip(("cracking", "crushing"), COLOURS, strict=False):
        axes[1].plot(table["time"], 1.0e-3 * table[name], color=colour, label=name)
    axes[1].set_ylabel("dissipated [kJ]")
    axes[1].set_xlabel("time [s]")
    for axis in axes:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axis.margins(x=0.0)
    figure.align_ylabels()
    return sheet.save(figure)
