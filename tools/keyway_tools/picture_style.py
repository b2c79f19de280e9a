"""The style of all pictures: type, colours safe for the colour-blind, thin frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # after the choice of a back end without a display
from cycler import cycler

# Okabe and Ito's palette, in an order in which neighbours differ also in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#555555"

# Letters that can be read on a slide: a picture 12 inches wide fills one.
_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 13.0,
    "axes.titlesize": 14.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 13.0,
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
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 12.0,
    "figure.constrained_layout.use": True,
    "figure.titlesize": 15.0,
    "figure.titleweight": "bold",
    "savefig.dpi": 120,
    "svg.hashsalt": "keyway",
}
FORMATS = ("png", "svg", "pdf")
WIDEST_TITLE = 0.98  # over the width of the figure
LINE = 0.27  # [inches] of a title
STRIP, NOTE_UP = 0.3, 0.05  # [inches] height of the strip for the note, the note over its foot
# No date of drawing in a file: the same data give the same bytes.
_UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


@dataclass(frozen=True)
class Sheet:
    """Where a picture goes, its formats, and the line below it."""

    path: Path
    formats: tuple[str, ...] = ("png",)
    note: str = ""

    def save(self, figure) -> list[Path]:
        """Write and close a figure; returns the files."""
        if self.note:
            strip = STRIP / figure.get_figheight()
            figure.get_layout_engine().set(rect=(0.0, strip, 1.0, 1.0 - strip))
            place = (0.995, NOTE_UP / figure.get_figheight())
            figure.text(*place, self.note, ha="right", va="bottom", color=GREY, fontsize=11)
        files = [self.path.with_name(f"{self.path.name}.{kind}") for kind in self.formats]
        for file, kind in zip(files, self.formats, strict=True):
            figure.savefig(file, metadata=_UNDATED[kind])
        plt.close(figure)
        return files


def new_figure(
    rows: int = 1, width: float = 8.0, row_height: float = 2.6, columns: int = 1, **more
):
    """A figure and its axes (an array for several) in the common style [inches]."""
    plt.rcParams.update(_STYLE)
    return plt.subplots(rows, columns, figsize=(width, row_height * rows + 0.6), **more)


def headline(figure, text: str, grows: bool = True) -> None:
    """The title of a figure, at its left border; lines that are too long are broken.

    The figure grows by the lines more, unless it is to keep its size.
    """
    title = figure.suptitle(text, x=0.01, ha="left")
    renderer = figure.canvas.get_renderer()

    def width(words: str) -> float:
        title.set_text(words)
        return title.get_window_extent(renderer).width / figure.bbox.width

    lines = [line for given in text.split("\n") for line in _broken(given, width)]
    widest = width("\n".join(lines))
    if widest > WIDEST_TITLE:  # a word that is longer than the figure is wide
        title.set_fontsize(title.get_fontsize() * WIDEST_TITLE / widest)
    more = len(lines) - 1 - text.count("\n")
    if more and grows:
        figure.set_figheight(figure.get_figheight() + more * LINE)


def _broken(line: str, width: Callable[[str], float]) -> list[str]:
    """Parts of a line that fit into the figure, broken at blanks."""
    parts = [""]
    for word in line.split(" "):
        longer = f"{parts[-1]} {word}" if parts[-1] else word
        if parts[-1] and width(longer) > WIDEST_TITLE:
            parts.append(word)
        else:
            parts[-1] = longer
    return parts


def hide_frame(axis) -> None:
    """No frame or ticks; unlike set_axis_off, titles keep their room in the layout."""
    axis.set_xticks([])
    axis.set_yticks([])
    axis.grid(False)
    axis.patch.set_visible(False)
    for spine in axis.spines.values():
        spine.set_visible(False)


def save_figure(figure, path: Path) -> Path:
    """Write and close a figure; returns its path."""
    figure.savefig(path, metadata=_UNDATED[path.suffix.removeprefix(".")])
    plt.close(figure)
    return path
