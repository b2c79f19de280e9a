"""Displaced bodies: the deformed shape and the modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .picture_style import new_figure, save_figure
from .pictures_faces import FIELDS, Faces, compose, nice_limits
from .render_dam import View, render


def _largest_state(faces: Faces) -> tuple[str, float] | None:
    """The saved displacements with the largest joint opening, else the largest displacements."""
    saved = faces.results.displacements()
    if not saved:
        return None
    opening = np.zeros(len(saved))
    times = np.array([time for _, time in saved])
    for name in faces.results.joint_names():
        table = faces.results.history(f"joints/{name}")
        if len(table.get("time", ())):
            opening = np.maximum(opening, np.interp(times, table["time"], table["opening"]))
    if opening.max() > 0.0:
        return saved[int(opening.argmax())]
    file = faces.results.file
    size = [np.linalg.norm(file[place][:][faces.nodes], axis=1).max() for place, _ in saved]
    return saved[int(np.argmax(size))]


def plot_deformed(faces: Faces, path: Path) -> Path | None:
    """The state of `_largest_state`, displacements enlarged, coloured by size, also from above."""
    state = _largest_state(faces)
    if state is None:
        return None
    place, time = state
    u = faces.results.file[place][:]
    length = 1000.0 * np.linalg.norm(u, axis=1)
    body = float(np.ptp(faces.results.x[faces.nodes], axis=0).max())
    factor = float(f"{60.0 * body / max(length[faces.nodes].max(), 1e-300):.0e}")
    field = FIELDS["U"]
    limits = nice_limits(length[faces.nodes], field)
    wire, lines = faces.surface(), faces.joint_lines(factor * u)
    views = dict(faces.views)
    if len(views) > 1:
        views["From above"] = View.from_direction(views["Downstream face"].towards, 89.9)
    pictures = {
        title: render(
            faces.grid(factor * u), view, length, (0.0, limits[-1]), field.colours, lines, wire,
            bands=len(limits) - 1,
        )
        for title, view in views.items()
    }  # fmt: skip
    heading = f"Deformed shape at t = {time:.2f} s, displacements drawn {factor:g} times"
    return compose(pictures, limits, field.colours, "displacement [mm]", heading, {}, path)


def plot_modes(faces: Faces, path: Path, most: int = 6) -> Path | None:
    """The first mode shapes with their frequencies."""
    modes = faces.results.modes()
    if modes is None:
        return None
    hz, shapes = modes
    count = min(most, len(hz))
    columns = min(3, count)
    rows = -(-count // columns)
    figure, axes = new_figure(
        rows, width=4.2 * columns, row_height=3.0, columns=columns, squeeze=False
    )
    title, view = next(iter(faces.views.items()))
    body = float(np.ptp(faces.results.x[faces.nodes], axis=0).max())
    for axis in axes.flat[count:]:
        axis.set_axis_off()
    for k, axis in zip(range(count), axes.flat, strict=False):
        size = np.linalg.norm(shapes[k], axis=1)
        largest = size[faces.nodes].max()
        shift = 0.08 * body / largest * shapes[k]
        picture = render(
            faces.grid(shift), view, size / largest, (0.0, 1.0), "viridis_r", wire=faces.surface()
        )
        axis.imshow(picture.image, extent=picture.extent)
        axis.set_axis_off()
        axis.set_title(f"mode {k + 1}: {hz[k]:.3f} Hz")
    where = f", {title.lower()}" if title else ""
    figure.suptitle(f"Mode shapes{where}", x=0.01, ha="left", fontsize=12, fontweight="bold")
    return save_figure(figure, path)
