"""Histories: joint openings, nodes, energies; openings over the area of a joint."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from .picture_style import COLOURS, GREY, new_figure, save_figure
from .results_reader import Results, Step, read_csv

MOST_CURVES = 6


def _curves_by(values: dict[str, np.ndarray], key: str) -> dict[int, np.ndarray]:
    """Rows of each node or point."""
    return {int(number): np.flatnonzero(values[key] == number) for number in np.unique(values[key])}


def plot_openings(results: Results, path: Path) -> Path | None:
    """Opening of the points of every *JOINT PRINT in time, one panel a joint."""
    stem = f"{results.job}_joint_"
    files = sorted(results.folder.glob(f"{stem}*.csv"))
    tables = {file.stem.removeprefix(stem): read_csv(file) for file in files}
    tables = {name: table for name, table in tables.items() if len(table.get("time", ()))}
    if not tables:
        return None
    figure, axes = new_figure(len(tables), width=10.0, row_height=2.5, sharex=True, squeeze=False)
    for axis, (name, table) in zip(axes[:, 0], tables.items(), strict=True):
        _opening_panel(axis, name, table)
    axes[-1, 0].set_xlabel("time [s]")
    return save_figure(figure, path)


def _opening_panel(axis, name: str, table: dict[str, np.ndarray]) -> None:
    """The points that open most."""
    points = _curves_by(table, "point")
    most = sorted(points, key=lambda p: -table["opening"][points[p]].max())[:MOST_CURVES]
    for point in most:
        rows = points[point]
        x, y, z = (table[axis_name][rows[0]] for axis_name in "xyz")
        label = f"point {point} ({x:.1f}, {y:.1f}, {z:.1f}) m"
        axis.plot(table["time"][rows], 1000.0 * table["opening"][rows], lw=1.0, label=label)
    axis.axhline(0.0, color=GREY, lw=0.8)
    axis.set_title(f"Opening of joint {name}")
    axis.set_ylabel("opening [mm]")
    axis.margins(x=0.0)
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def plot_nodes(results: Results, path: Path) -> Path | None:
    """Displacements of every *NODE PRINT in time, one panel a direction."""
    stem = f"{results.job}_node_"
    curves = []
    for file in sorted(results.folder.glob(f"{stem}*.csv")):
        table = read_csv(file)
        if "U1" not in table or len(np.unique(table["time"])) < 3:
            continue
        for node, rows in list(_curves_by(table, "node").items())[:MOST_CURVES]:
            curves.append((f"{file.stem.removeprefix(stem)}, node {node}", table, rows))
    if not curves:
        return None
    figure, axes = new_figure(3, width=10.0, row_height=1.9, sharex=True)
    for label, table, rows in curves[:MOST_CURVES]:
        for axis, direction in zip(axes, "123", strict=True):
            values = 1000.0 * table[f"U{direction}"][rows]
            axis.plot(table["time"][rows], values, lw=1.0, label=label)
    for axis, direction in zip(axes, "123", strict=True):
        axis.set_ylabel(f"U{direction} [mm]")
        axis.margins(x=0.0)
    axes[0].set_title("Displacements relative to the base")
    axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    return save_figure(figure, path)


def plot_energy(results: Results, path: Path) -> Path | None:
    """Energies in time and the imbalance between them."""
    table = results.table("history/energy")
    if len(table.get("time", ())) < 3:
        return None
    largest = max(np.abs(table[name]).max() for name in ("external", "kinetic", "strain"))
    scale, unit = (1e-6, "MJ") if largest > 1e5 else (1e-3, "kJ") if largest > 1e2 else (1.0, "J")
    figure, axes = new_figure(
        2, width=10.0, row_height=2.6, sharex=True, gridspec_kw={"height_ratios": (3, 1)}
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
    return save_figure(figure, path)


def plot_damage_growth(results: Results, path: Path) -> Path | None:
    """Damaged volumes, and the energy that cracks and crushing took, in time."""
    table = results.table("history/damage")
    if len(table.get("time", ())) < 3 or table["inelastic_volume"].max() <= 0.0:
        return None
    figure, axes = new_figure(2, width=10.0, row_height=2.6, sharex=True)
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
    return save_figure(figure, path)


def plot_joint_areas(results: Results, step: Step, path: Path) -> Path | None:
    """Largest opening over the area of every joint, seen square to it."""
    values = 1000.0 * step.envelopes["OPENING"]
    quads = {name: results.joint_quads(name) for name in results.joint_names()}
    quads = {name: faces for name, faces in quads.items() if len(faces)}
    if not quads or np.nanmax(values) <= 0.0:
        return None
    columns = min(3, len(quads))
    rows = -(-len(quads) // columns)
    figure, axes = new_figure(
        rows, width=2.6 * columns + 1.6, row_height=4.6, columns=columns, squeeze=False, sharey=True
    )
    top = max(np.nanmax(np.append(values[faces], 0.0)) for faces in quads.values())
    shade = None
    for axis, (name, faces) in zip(axes.flat, quads.items(), strict=False):
        shade = _joint_panel(axis, results.x, faces, np.nan_to_num(values), top or 1.0)
        largest = np.nanmax(np.append(values[faces], 0.0))
        axis.set_title(f"{name}: {largest:.3g} mm")
    for axis in axes.flat[len(quads) :]:
        axis.set_axis_off()
    bar = figure.colorbar(shade, ax=axes.ravel().tolist(), shrink=0.8, aspect=30)
    bar.set_label("largest opening [mm]")
    bar.outline.set_visible(False)
    title = f"Joint openings over step {step.name.title()}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")
    return save_figure(figure, path)


def _joint_panel(axis, x: np.ndarray, faces: np.ndarray, values: np.ndarray, top: float):
    """One joint in its own plane: along it and up, or in plan where it lies flat."""
    nodes = np.unique(faces)
    size = np.ptp(x[nodes], axis=0)
    if size[2] > 0.05 * size.max():
        plan = x[nodes, :2] - x[nodes, :2].mean(axis=0)
        across = np.linalg.svd(plan, full_matrices=False)[2][0]
        across = across if across[np.abs(across).argmax()] > 0.0 else -across
        along, up = x[:, :2] @ across, x[:, 2]
        along = along - along[nodes].min()
        labels = ("along the joint [m]", "height z [m]")
    else:
        along, up, labels = x[:, 0], x[:, 1], ("x [m]", "y [m]")
    triangles = np.vstack([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    levels = MaxNLocator(nbins=10, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, top)
    shade = axis.tricontourf(
        Triangulation(along, up, triangles), values, levels=levels, cmap="viridis_r"
    )
    ring = np.stack([along[faces], up[faces]], axis=-1)
    axis.add_collection(PolyCollection(ring, facecolors="none", edgecolors="#00000030", lw=0.6))
    margin = 0.03 * size.max()
    axis.set_aspect("equal")
    axis.set_xlim(along[nodes].min() - margin, along[nodes].max() + margin)
    axis.set_ylim(up[nodes].min() - margin, up[nodes].max() + margin)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    axis.grid(False)
    return shade
