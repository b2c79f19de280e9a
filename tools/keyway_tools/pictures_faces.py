"""Envelopes on the dam's faces, with the numbers and places of their extremes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import MaxNLocator

from .colour_scale import FIELDS, Field, Limits, Scales
from .dam_views import Faces
from .picture_style import GREY, Sheet, headline, hide_frame, new_figure, plt
from .render_dam import Paint, Picture, View, render_views
from .results import Step

MARK = "#0091B2"
TALLEST = 7.0  # [inches] an image


@dataclass(frozen=True)
class Mark:
    """A ring around an extreme, with its number."""

    at: np.ndarray  # (2) in the view [m]
    text: str


@dataclass(frozen=True)
class Drawing:
    """What `compose` puts on one page."""

    pictures: dict[str, Picture]
    limits: Limits
    colours: str
    label: str
    heading: str
    marks: dict[str, Mark] = field(default_factory=dict)
    sides: tuple[str, ...] = ()  # what lies to the left and to the right of each image


def place_of(x: np.ndarray, size: float) -> str:
    """A place in words, in a body of this size [m]; round-off is zero."""
    least = min(5e-3, 5e-5 * size)

    def word(v: float) -> str:
        if abs(v) < least:
            return "0"
        return f"{v:.1f}" if abs(v) >= 1e5 else f"{v:.5g}"

    return f"({', '.join(word(float(v)) for v in x)}) m"


def plot_envelope(
    faces: Faces,
    step: Step,
    name: str,
    scales: Scales,
    sheet: Sheet,
    views: dict[str, View] | None = None,
) -> list[Path]:
    """One field's envelope over a step, on every view, with the line of a given value."""
    shown = FIELDS[name]
    values = shown.scale * step.envelopes[name]
    limits = scales.limits(name, step.envelopes[name][faces.nodes])
    level = scales.levels.get(name)
    paint = Paint(values, limits.ends, shown.colours, limits.bands, level)
    pictures = render_views(views or faces.views, faces.grid(), paint, faces.joint_lines())
    heading = f"{shown.label} over step {step.name}\n"
    heading += _extreme_in_words(faces, step, name)
    marks = _marks(faces, values, shown)
    label = shown.label.lower() + (f", {shown.on_nodes}" if shown.on_nodes else "")
    label += f" [{shown.unit}]" if shown.unit else ""
    if level is not None:
        label += f"; blue line: {shown.with_unit(level)}"
    return compose(Drawing(pictures, limits, shown.colours, label, heading, marks), sheet)


def _extreme_in_words(faces: Faces, step: Step, name: str) -> str:
    """Value, place and time of the extreme of an envelope."""
    shown = FIELDS[name]
    values = shown.scale * step.envelopes[name]
    place = faces.nodes[np.nanargmax(shown.sign * values[faces.nodes])]
    when = faces.results.envelope_time(step, name)[place]
    inside = "" if np.any(faces.normals[place]) else ", inside the dam"
    where = place_of(faces.results.x[place], faces.size)
    what = "extreme of the means" if shown.on_nodes else "extreme"
    return f"{what} {shown.with_unit(values[place])} at {where}, t = {when:.5g} s{inside}"


def _marks(faces: Faces, values: np.ndarray, shown: Field) -> dict[str, Mark]:
    """The extreme of the side that each view shows."""
    found = {}
    for title, view in faces.views.items():
        nodes = faces.shown_on(title)
        nodes = nodes[np.isfinite(values[nodes])]
        if nodes.size == 0 or (shown.sign * values[nodes]).max() <= 0.0:
            continue
        place = nodes[(shown.sign * values[nodes]).argmax()]
        text = shown.with_unit(values[place])
        found[title] = Mark(view.project(faces.results.x[place]), text)
    return found


def compose(drawing: Drawing, sheet: Sheet) -> list[Path]:
    """Images side by side with one colour bar and a bar for the length."""
    return sheet.save(draw_page(drawing))


def draw_page(drawing: Drawing):
    """The figure of `compose`; its images are the first image of each axis."""
    pictures, limits = drawing.pictures, drawing.limits
    count = len(pictures)
    shape = max(p.image.shape[0] / p.image.shape[1] for p in pictures.values())
    width = min({1: 9.0, 2: 6.2}.get(count, 4.6), TALLEST / shape)
    # Images must be limited by their width, else their titles run into the headline.
    height = width * (shape + 0.1) + 2.1
    figure, axes = new_figure(
        1, width=max(width * count, 9.0), row_height=height, columns=count, squeeze=False
    )
    for axis, (title, picture) in zip(axes[0], pictures.items(), strict=True):
        axis.imshow(picture.image, extent=picture.extent, interpolation="antialiased")
        hide_frame(axis)
        axis.set_title(title)
        for at, text, end in zip((-0.02, 1.02), drawing.sides, ("right", "left"), strict=False):
            axis.text(at, 0.5, text, ha=end, va="center", color=GREY, transform=axis.transAxes)
        _scale_bar(axis, picture.extent)
        if title in drawing.marks:
            _draw_mark(axis, drawing.marks[title], picture.extent)
    _colour_bar(figure, axes, drawing, limits)
    headline(figure, drawing.heading)
    return figure


def _colour_bar(figure, axes, drawing: Drawing, limits: Limits) -> None:
    """One bar for all images; where the scale is cut, its last number is a bound."""
    norm = BoundaryNorm(limits.borders, plt.get_cmap(drawing.colours).N)
    count = axes.size
    bar = figure.colorbar(
        ScalarMappable(norm, drawing.colours), ax=axes[0].tolist(), location="bottom",
        shrink=0.8 / max(1.0, 0.5 * count), aspect=40, ticks=limits.borders,
        spacing="proportional",
    )  # fmt: skip
    texts = [f"{border:.6g}" for border in limits.borders]
    if limits.remark:
        end = -1 if limits.borders[-1] > 0.0 else 0
        texts[end] = ("≥ " if end else "≤ ") + texts[end]
    bar.ax.set_xticklabels(texts)
    bar.set_label("\n".join(text for text in (drawing.label, limits.remark) if text))
    bar.outline.set_visible(False)


def _draw_mark(axis, mark: Mark, extent) -> None:
    """A ring and the number beside it, towards the middle of the image."""
    axis.plot(*mark.at, marker="o", ms=13, mfc="none", mec="white", mew=4.0)
    axis.plot(*mark.at, marker="o", ms=13, mfc="none", mec=MARK, mew=2.2)
    is_right = mark.at[0] > 0.5 * (extent[0] + extent[1])
    is_high = mark.at[1] > 0.5 * (extent[2] + extent[3])
    axis.annotate(
        mark.text, mark.at, (-14.0 if is_right else 14.0, -14.0 if is_high else 14.0),
        textcoords="offset points", ha="right" if is_right else "left",
        va="top" if is_high else "bottom", color="black", fontweight="bold",
        bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": MARK, "alpha": 0.9},
    )  # fmt: skip


def _scale_bar(axis, extent) -> None:
    """A bar of a round length below the image, off the dam."""
    width, height = extent[1] - extent[0], extent[3] - extent[2]
    size = max(width, 0.6 * height)
    length = MaxNLocator(nbins=1, steps=[1, 2, 5, 10]).tick_values(0.0, 0.15 * size)[1]
    strip = 0.09 * size
    left, bottom = extent[0] + 0.03 * width, extent[2] - 0.8 * strip
    axis.set_ylim(extent[2] - strip, extent[3])
    axis.plot([left, left + length], [bottom, bottom], color=GREY, lw=4.0, solid_capstyle="butt")
    text = f"{length:g} m" if length >= 0.1 else f"{1e3 * length:g} mm"
    middle = bottom + 0.15 * strip
    axis.text(left + length / 2.0, middle, text, color=GREY, ha="center", va="bottom")


def plot_face_openings(faces: Faces, step: Step, scales: Scales, sheet: Sheet) -> list[Path]:
    """Largest opening along the lines where the joints meet the faces."""
    shown = FIELDS["OPENING"]
    opening = np.nan_to_num(step.envelopes["OPENING"])
    values = shown.scale * opening
    lines = faces.joint_lines(values=values)
    if lines is None or values.max() <= 0.0:
        return []
    limits = scales.limits("OPENING", opening)
    paint = Paint(None, limits.ends, shown.colours, limits.bands)
    pictures = render_views(faces.views, faces.grid(), paint, lines)
    heading = f"{shown.label} over step {step.name}\n"
    heading += _extreme_in_words(faces, step, "OPENING")
    marks = _marks(faces, values, shown)
    drawing = Drawing(pictures, limits, shown.colours, "largest opening [mm]", heading, marks)
    return compose(drawing, sheet)
