"""Curves of material tests: stress against strain, damage, energies, beside measured points."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .picture_style import COLOURS, GREY, new_figure, save_figure
from .result_files import Table, read_table

COMPONENTS = ("11", "22", "33", "12", "13", "23")
PER_MILLE, MEGA = 1e3, 1e-6
MARKERS = "osD^vP"


@dataclass(frozen=True)
class Curve:
    """One test: its table and the component to draw."""

    name: str
    table: Table
    component: str

    @property
    def strain(self) -> np.ndarray:
        """In 1e-3."""
        return PER_MILLE * self.table[f"E{self.component}"]

    @property
    def stress(self) -> np.ndarray:
        """In MPa."""
        return MEGA * self.table[f"S{self.component}"]

    def has(self, column: str) -> bool:
        """Whether the column exists and holds more than roundoff (damage, or energy in J/m3)."""
        return column in self.table and bool(np.abs(self.table[column]).max() > 1e-6)


def read_curve(path: Path, component: str | None = None) -> Curve:
    """Read a test; without a component the one whose stress changes most."""
    table = read_table(path)
    missing = [n for n in ("time", "work", "E11", "S11") if n not in table]
    if missing or len(table["time"]) < 2:
        what = f"no column {missing[0]}" if missing else "fewer than two rows"
        raise ValueError(f"{path}: {what}; expected a job_material_NAME.csv of keyway --material")
    component = component or max(COMPONENTS, key=lambda c: np.ptp(table[f"S{c}"]))
    return Curve(path.stem.split("_material_", 1)[-1], table, component)


def read_points(path: Path) -> tuple[str, np.ndarray, np.ndarray]:
    """Measured points: the name in the file, strain in 1e-3, stress in MPa.

    The first two columns are strain and stress in the units of the deck; a line that begins with
    '#' is a remark (the first names the points), a line without numbers a heading.
    """
    label, points = "", []
    with path.open(newline="", encoding="utf-8-sig") as file:
        for row in csv.reader(file):
            if row and row[0].lstrip().startswith("#"):
                label = label or ",".join(row).lstrip("# ").strip()
                continue
            try:
                points.append((float(row[0]), float(row[1])))
            except (ValueError, IndexError):
                continue
    if not points:
        raise ValueError(f"{path}: no points; expected lines of strain, stress")
    strain, stress = np.array(points).T
    return label or path.stem, PER_MILLE * strain, MEGA * stress


def plot_material(curves: list[Curve], experiments: list[Path], path: Path) -> Path:
    """Stress against strain on the left; damage, where there is some, and energies on the right."""
    has_damage = any(c.has("DAMAGET") or c.has("DAMAGEC") for c in curves)
    figure, axes = new_figure(
        2 if has_damage else 1,
        width=10.0,
        row_height=2.7 if has_damage else 3.8,
        columns=2,
        squeeze=False,
        gridspec_kw={"width_ratios": (3, 2)},
    )
    main = axes[0, 0]
    if has_damage:
        grid = axes[0, 0].get_gridspec()
        for axis in axes[:, 0]:
            axis.remove()
        main = figure.add_subplot(grid[:, 0])
        _damage_panel(axes[0, 1], curves)
    _stress_panel(main, curves, experiments)
    _energy_panel(axes[-1, 1], curves)
    return save_figure(figure, path)


def _stress_panel(axis, curves: list[Curve], experiments: list[Path]) -> None:
    """The curves and the points that were measured."""
    for number, experiment in enumerate(experiments):
        label, strain, stress = read_points(experiment)
        marker = MARKERS[number % len(MARKERS)]
        axis.plot(strain, stress, marker, ms=5, mfc="none", mec="black", label=label)
    for number, (curve, colour) in enumerate(zip(curves, _colours(curves), strict=True)):
        width = max(1.0, 1.4 + 0.5 * (len(curves) - 1 - number))  # curves that coincide all show
        axis.plot(curve.strain, curve.stress, color=colour, lw=width, label=curve.name)
    axis.axhline(0.0, color=GREY, lw=0.8)
    axis.axvline(0.0, color=GREY, lw=0.8)
    components = sorted({c.component for c in curves})
    axis.set_title("Stress and strain")
    axis.set_xlabel(f"strain {', '.join('E' + c for c in components)} [1e-3]")
    axis.set_ylabel(f"stress {', '.join('S' + c for c in components)} [MPa]")
    if len(curves) + len(experiments) > 1:
        axis.legend()
    else:
        axis.set_title(curves[0].name)


def _damage_panel(axis, curves: list[Curve]) -> None:
    """Damage over strain: tension as solid lines, compression as dashed lines."""
    lines = (("DAMAGET", "-", "tension"), ("DAMAGEC", "--", "compression"))
    for curve, colour in zip(curves, _colours(curves), strict=True):
        for column, style, _ in lines:
            if curve.has(column):
                axis.plot(curve.strain, curve.table[column], style, color=colour)
    for column, style, label in lines:
        own = [colour for c, colour in zip(curves, _colours(curves), strict=True) if c.has(column)]
        if own:  # grey stands for all colours
            axis.plot([], [], style, color=own[0] if len(own) == 1 else GREY, label=label)
    axis.set_title("Damage")
    axis.set_xlabel("strain [1e-3]")
    axis.set_ylim(-0.02, 1.3)  # the words have room above 1
    axis.set_yticks(np.linspace(0.0, 1.0, 5))
    axis.legend(loc="upper center", ncols=2)


def _energy_panel(axis, curves: list[Curve]) -> None:
    """Work and its parts in time; for several tests the dissipated energy."""
    table = curves[0].table
    top = max(np.abs(c.table["work"]).max() for c in curves)
    scale, unit = (1e-3, "kJ/m3") if top > 2e3 else (1.0, "J/m3")
    if len(curves) == 1:
        for column, colour in zip(
            ("work", "stored", "fracture", "crushing"), COLOURS, strict=False
        ):
            if curves[0].has(column):
                axis.plot(table["time"], scale * table[column], color=colour, label=column)
        axis.set_title("Energy")
        axis.legend()
    else:
        for curve, colour in zip(curves, _colours(curves), strict=True):
            dissipated = curve.table["fracture"] + curve.table["crushing"]
            axis.plot(curve.table["time"], scale * dissipated, color=colour)
        axis.set_title("Energy dissipated")
    axis.set_xlabel("time [s]")
    axis.set_ylabel(unit)
    axis.margins(x=0.0)


def _colours(curves: list[Curve]) -> list[str]:
    """A colour for each curve."""
    return [COLOURS[i % len(COLOURS)] for i in range(len(curves))]
