"""The style of all pictures: type, colours safe for the colour-blind, thin frames."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # after the choice of a back end without a display
from cycler import cycler

# Okabe and Ito's palette, in an order in which neighbours differ also in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#666666"

_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "axes.titlesize": 11.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.prop_cycle": cycler(color=COLOURS),
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 9.0,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 120,
}


def new_figure(
    rows: int = 1, width: float = 8.0, row_height: float = 2.6, columns: int = 1, **more
):
    """A figure and its axes (an array for several) in the common style [inches]."""
    plt.rcParams.update(_STYLE)
    return plt.subplots(rows, columns, figsize=(width, row_height * rows + 0.6), **more)


def save_figure(figure, path: Path) -> Path:
    """Write and close a figure; returns its path. Without date: same data give the same bytes."""
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)
    return path
