"""Error over seconds of the variants of a deck, one panel a quantity."""

from __future__ import annotations

import io
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from keyway_tools.picture_style import GREY, new_figure

from .facts import NAMES

COLOURS = {"base": "#111111", "increment": "#1f5fa8", "mesh": "#b3401f", "element": "#d98a1b"}
LEAST = 1e-3  # an error that is drawn [%]
# Places of a label around its point: offset in points, alignment
PLACES = (
    ((7, 3), "left"), ((-7, 3), "right"), ((7, -11), "left"), ((-7, -11), "right"),
    ((0, 9), "center"), ((0, -17), "center"), ((7, 15), "left"), ((7, -23), "left"),
)  # fmt: skip


def draw(facts: dict[str, Any]) -> bytes:
    """PNG; empty where no mesh was refined: the errors of the mesh are not known then."""
    shown = [one["quantity"] for one in facts["quantities"] if one["error"] is not None]
    if not shown:
        return b""
    columns = min(2, len(shown))
    rows = -(-len(shown) // columns)
    figure, axes = new_figure(rows, 6.4 * columns, 4.2, columns, squeeze=False)
    for axis in axes.ravel()[len(shown) :]:
        axis.set_axis_off()
    for axis, quantity in zip(axes.ravel(), shown, strict=False):
        draw_one(axis, facts["rungs"], quantity)
    figure.canvas.draw()
    for axis, quantity in zip(axes.ravel(), shown, strict=False):
        label(axis, points_of(facts["rungs"], quantity))
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110, metadata={"Software": None})
    plt.close(figure)
    return buffer.getvalue()


def points_of(rungs: list[dict[str, Any]], quantity: str) -> list[tuple[float, float, str, str]]:
    """Seconds, error [%], name and axis of each variant with an error."""
    points = [
        (rung["seconds"], max(100.0 * rung["errors"][quantity], LEAST), rung["name"], rung["axis"])
        for rung in rungs if quantity in rung.get("errors", {})
    ]  # fmt: skip
    return sorted(points)


def draw_one(axis, rungs: list[dict[str, Any]], quantity: str) -> None:
    """The points, and the line through those that nothing quicker beats."""
    points = points_of(rungs, quantity)
    front: list[tuple[float, float]] = []
    for seconds, size, *_ in points:
        if not front or size < front[-1][1]:
            front.append((seconds, size))
    axis.plot(*zip(*front, strict=True), color=GREY, alpha=0.4, linewidth=3, zorder=1)
    for seconds, size, _, kind in points:
        axis.scatter(seconds, size, s=50, color=COLOURS[kind], zorder=2)
    axis.set(xscale="log", yscale="log", xlabel="seconds", ylabel="error [%]")
    axis.set_title(NAMES[quantity], fontsize=12)
    for line in (axis.xaxis, axis.yaxis):
        line.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        line.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        line.set_minor_formatter(NullFormatter())
    axis.margins(0.3)


def label(axis, points: list[tuple[float, float, str, str]]) -> None:
    """Names beside the points, where they hide no point and no other name."""
    renderer = axis.figure.canvas.get_renderer()
    spots = axis.transData.transform([(seconds, size) for seconds, size, *_ in points])
    taken: list = []
    for seconds, size, name, _ in points:
        for offset, alignment in PLACES:
            text = axis.annotate(name, (seconds, size), xytext=offset, ha=alignment, fontsize=9,
                                 textcoords="offset points")  # fmt: skip
            box = text.get_window_extent(renderer)
            if not any(box.overlaps(other) for other in taken) and not any(
                box.contains(*spot) for spot in spots
            ):
                break
            text.remove()
        else:
            text = axis.annotate(name, (seconds, size), xytext=PLACES[0][0], fontsize=9,
                                 textcoords="offset points")  # fmt: skip
            box = text.get_window_extent(renderer)
        taken.append(box)
