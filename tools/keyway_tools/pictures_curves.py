"""Histories: joint openings, nodes, energies, damage."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from .picture_style import COLOURS, GREY, Sheet, new_figure
from .result_files import energy_names, natural
from .si_results import SiResults

MOST_CURVES = 6
LEAST = 1e-6  # of the largest value: less is round-off
FEW_POINTS = 3  # a curve of fewer points is drawn with marks
WIDE, NARROW = 3.2, 1.4  # lines of curves that may coincide
QUIET = 0.05  # of the largest displacement: range of a panel in which nothing moves
DIRECTIONS = "123"


def _curves_by(values: dict[str, np.ndarray], key: str) -> dict[int, np.ndarray]:
    """Rows of each node or point."""
    return {int(number): np.flatnonzero(values[key] == number) for number in np.unique(values[key])}


def _look(number: int) -> dict[str, str]:
    """Colour and line of a curve; each pair of both comes once."""
    lines = ("-", "--", ":", "-.")
    times, place = divmod(number, len(COLOURS))
    return {"color": COLOURS[place], "ls": lines[times % len(lines)]}


def mark_of(count: int) -> str:
    """The mark at the points of a curve: one of one point would not be seen."""
    return "o" if count < FEW_POINTS else ""


def mark_one_time(axes: Iterable[Axes]) -> None:
    """Panels above each other that have one time: only this stands at their axis.

    A scale around it would look like a history that is empty.
    """
    axes = list(axes)
    times = {
        float(time)
        for axis in axes
        for line in axis.lines
        if line.get_transform() is axis.transData  # not a line across the panel
        for time in line.get_xdata()
    }
    if len(times) == 1:
        axes[-1].set_xticks(list(times))


def plot_openings(results: SiResults, sheet: Sheet) -> list[Path]:
    """Opening of the points of every *JOINT PRINT in time, one row a joint.

    Static steps and motions have columns of their own: the years of the one hide the seconds of
    the other.
    """
    names = [name for name in results.tables() if name.startswith("joint_")]
    tables = {name.removeprefix("joint_"): results.table(name) for name in names}
    tables = {name: table for name, table in tables.items() if len(table.get("opening", ()))}
    for table in tables.values():
        table["opening"] = results.without_round_off(table["opening"])
    if not tables:
        return []
    columns = _columns(results, list(tables.values()))
    figure, axes = new_figure(
        len(tables), width=12.0 + 4.0 * (len(columns) - 1), row_height=2.9, columns=len(columns),
        sharex="col", squeeze=False,
    )  # fmt: skip
    for row, (name, table) in zip(axes, tables.items(), strict=True):
        for axis, (kind, steps) in zip(row, columns.items(), strict=True):
            _opening_panel(axis, table, Span(results, steps))
            title = f"Opening of joint {results.joint_of_table(name)}"
            axis.set_title(f"{title}{', ' if kind else ''}{kind}")
        row[0].set_ylabel("opening [mm]")
        row[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    for axis, kind in zip(axes[-1], columns, strict=True):
        axis.set_xlabel("time of the deck" if kind == STATIC else "time [s]")
    for column in axes.T:
        mark_one_time(column)
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


class Span:
    """The steps that a panel shows; a curve has a gap where steps between them are not shown."""

    def __init__(self, results: SiResults, shown: set[int]):
        self.shown = list(shown)
        timed = {step.number for step in results.steps() if "FREQUENCY" not in step.procedure}
        self.hidden = np.array(sorted(timed - shown))

    def curve(
        self, table: dict[str, np.ndarray], rows: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of the rows (of some rows of a table) that lie in the steps."""
        chosen = np.isin(table["step"][rows], self.shown)
        before = np.searchsorted(self.hidden, table["step"][rows][chosen])
        gaps = np.flatnonzero(np.diff(before)) + 1
        both = (table["time"][rows][chosen], values[rows][chosen])
        return tuple(np.insert(one, gaps, np.nan) for one in both)


def _largest(values: np.ndarray) -> float:
    """The largest value; 0 where there is none."""
    return float(np.max(values, where=np.isfinite(values), initial=0.0))


def _opening_panel(axis, table: dict[str, np.ndarray], span: Span) -> None:
    """The points that open most in all steps, in some of them."""
    points = _curves_by(table, "point")
    most = sorted(points, key=lambda p: -_largest(table["opening"][points[p]]))[:MOST_CURVES]
    for point in most:
        rows = points[point]
        x, y, z = (table[axis_name][rows[0]] for axis_name in "xyz")
        label = f"point {point} ({x:.1f}, {y:.1f}, {z:.1f}) m"
        time, opening = span.curve(table, rows, 1000.0 * table["opening"])
        axis.plot(time, opening, lw=1.0, marker=mark_of(len(time)), label=label)
    axis.axhline(0.0, color=GREY, lw=0.8)
    axis.margins(x=0.0)


@dataclass(frozen=True)
class NodeCurve:
    """The displacements of a node that the deck prints, and how far it moves."""

    name: str  # of the set of nodes
    node: int
    table: dict[str, np.ndarray]
    rows: np.ndarray
    motion: float  # largest range of a component, from the place at the start [m]


def _node_curves(results: SiResults) -> list[list[NodeCurve]]:
    """The nodes of each *NODE PRINT with displacements."""
    sets = []
    for name in (name for name in results.tables() if name.startswith("node_")):
        table = results.table(name)
        if not len(table.get("U1", ())):
            continue
        own, of_set = [], results.set_of_table(name.removeprefix("node_"))
        for node, rows in _curves_by(table, "node").items():
            parts = [table[f"U{k}"][rows] for k in (1, 2, 3)]
            motion = max(_largest(part) + _largest(-part) for part in parts)
            own.append(NodeCurve(of_set, node, table, rows, motion))
        sets.append(own)
    return sets


def choose_curves(sets: list[list[NodeCurve]]) -> list[NodeCurve]:
    """Of each set that moves the node that moves most, then others up to six curves.

    A node that is in several sets is drawn once where they have other nodes that move: small sets
    choose first.
    """
    everything = sorted((one for own in sets for one in own), key=lambda one: -one.motion)
    if not everything:
        return []
    moving = [one for one in everything if one.motion >= LEAST * everything[0].motion]
    chosen: dict[int, NodeCurve] = {}
    twice = []
    for name in sorted({one.name for one in moving}, key=lambda n: _count(moving, n)):
        own = [one for one in moving if one.name == name]
        new = next((one for one in own if one.node not in chosen), None)
        if new:
            chosen[new.node] = new
        else:
            twice.append(own[0])
    for one in moving:
        if len(chosen) + len(twice) < MOST_CURVES:
            chosen.setdefault(one.node, one)
    return sorted([*chosen.values(), *twice], key=lambda one: (natural(one.name), one.node))


def _count(curves: list[NodeCurve], name: str) -> int:
    return sum(one.name == name for one in curves)


def plot_nodes(results: SiResults, sheet: Sheet) -> list[Path]:
    """Displacements of every *NODE PRINT in time, one row a direction, columns as of openings."""
    curves = choose_curves(_node_curves(results))
    if not curves:
        return []
    columns = _columns(results, [one.table for one in curves])
    sizes = {d: max(_size(one, d) for one in curves) for d in DIRECTIONS}
    largest = max(sizes.values())
    shown = [d for d in DIRECTIONS if sizes[d] >= LEAST * largest]
    figure, axes = new_figure(
        len(shown), width=12.0 + 4.0 * (len(columns) - 1), row_height=2.2, columns=len(columns),
        sharex="col", squeeze=False,
    )  # fmt: skip
    for column, (kind, steps) in zip(axes.T, columns.items(), strict=True):
        _node_panels(dict(zip(shown, column, strict=True)), curves, Span(results, steps), largest)
        column[0].set_title(f"Displacements relative to the base{', ' if kind else ''}{kind}")
        column[-1].set_xlabel("time of the deck" if kind == STATIC else "time [s]")
        mark_one_time(column)
    for axis, direction in zip(axes[:, 0], shown, strict=True):
        axis.set_ylabel(f"U{direction} [mm]")
    if len(shown) < len(DIRECTIONS):
        left_out = " and ".join(f"U{d}" for d in DIRECTIONS if d not in shown)
        remark = f"{left_out} not drawn: less than {LEAST:g} of the largest displacement"
        axes[0, 0].set_title(f"{axes[0, 0].get_title(loc='left')}\n{remark}")
    axes[0, -1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    figure.align_ylabels(axes[:, 0])
    return sheet.save(figure)


def _size(curve: NodeCurve, direction: str) -> float:
    """The largest displacement in a direction [m]."""
    return _largest(np.abs(curve.table[f"U{direction}"][curve.rows]))


def _node_panels(
    panels: dict[str, Axes], curves: list[NodeCurve], span: Span, largest: float
) -> None:
    """The directions of some steps; the scale of round-off would make a signal of it."""
    for number, one in enumerate(curves):
        for direction, axis in panels.items():
            time, moved = span.curve(one.table, one.rows, 1000.0 * one.table[f"U{direction}"])
            axis.plot(
                time, moved, lw=1.0, marker=mark_of(len(time)),
                label=f"{one.name}, node {one.node}", **_look(number),
            )  # fmt: skip
    for axis in panels.values():
        axis.margins(x=0.0)
        size = max(_largest(np.abs(line.get_ydata())) for line in axis.lines)  # [mm]
        if size < LEAST * 1000.0 * largest:
            axis.set_ylim(-QUIET * 1000.0 * largest, QUIET * 1000.0 * largest)


def plot_energy(results: SiResults, sheet: Sheet) -> list[Path]:
    """Energies in time and the imbalance between them."""
    table = results.history("energy")
    energies = {name: _largest(np.abs(table[name])) for name in energy_names(table)}
    largest = max(energies.values(), default=0.0)
    if not largest > 0.0:
        return []
    mark = mark_of(len(table["time"]))
    scale, unit = (1e-6, "MJ") if largest > 1e5 else (1e-3, "kJ") if largest > 1e2 else (1.0, "J")
    figure, axes = new_figure(
        2, width=12.0, row_height=2.9, sharex=True, gridspec_kw={"height_ratios": (3, 1)}
    )
    shown = [name for name, size in energies.items() if size > LEAST * largest]
    for number, name in enumerate(shown):
        values = scale * table[name]
        width = WIDE if number == 0 else NARROW  # the first may coincide with another one
        axes[0].plot(
            table["time"], values, marker=mark, ms=4.0 * width, lw=width, label=name,
            **_look(number),
        )  # fmt: skip
    # Without zero the scale of one increment is round-off.
    axes[0].axhline(0.0, color=GREY, lw=0.8)
    axes[0].set_title("Energy balance")
    axes[0].set_ylabel(f"energy [{unit}]")
    axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes[1].plot(table["time"], 100.0 * table["error"], color=GREY, marker=mark)
    axes[1].set_ylabel("imbalance [%]")
    axes[1].set_xlabel("time [s]")
    axes[1].margins(x=0.0)
    mark_one_time(axes)
    figure.align_ylabels()
    return sheet.save(figure)


def plot_damage_growth(results: SiResults, sheet: Sheet) -> list[Path]:
    """Damaged volumes, and the energy dissipated by cracks and crushing, in time."""
    table = results.history("damage")
    if _largest(table.get("inelastic_volume", np.zeros(0))) <= 0.0:
        return []
    mark = mark_of(len(table["time"]))
    figure, axes = new_figure(2, width=12.0, row_height=2.9, sharex=True)
    volume = table["inelastic_volume"]
    axes[0].plot(table["time"], volume, color=GREY, marker=mark, label="beyond elasticity")
    for percent, colour in zip((10, 50, 90), COLOURS, strict=False):
        axes[0].plot(
            table["time"], table[f"volume_{percent}"], color=colour, marker=mark,
            label=f"damage ≥ {percent} %",
        )  # fmt: skip
    axes[0].set_title("Growth of damage in tension")
    axes[0].set_ylabel("volume [m³]")
    for name, colour in zip(("cracking", "crushing"), COLOURS, strict=False):
        values = 1.0e-3 * table[name]
        axes[1].plot(table["time"], values, color=colour, marker=mark, label=name)
    axes[1].set_ylabel("dissipated [kJ]")
    axes[1].set_xlabel("time [s]")
    for axis in axes:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axis.margins(x=0.0)
    mark_one_time(axes)
    figure.align_ylabels()
    return sheet.save(figure)
