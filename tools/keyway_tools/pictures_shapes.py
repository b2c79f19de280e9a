"""Displaced bodies: the deformed shape and the modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .picture_style import new_figure, save_figure
from .pictures_faces import FIELDS, Faces, compose, nice_limits
from .render_dam import render


def plot_deformed(faces: Faces, path: Path) -> Path | None:
    """The saved state in which the dam is displaced most, drawn large, coloured by its size."""
    saved = faces.results.displacements()
    if not saved:
        return None
    file = faces.results.file
    size = [np.linalg.norm(file[place][:][faces.nodes], axis=1).max() for place, _ in saved]
    place, time = saved[int(np.argmax(size))]
    u = file[place][:]
    length = 1000.0 * np.linalg.norm(u, axis=1)
    body = float(np.ptp(faces.results.x[faces.nodes], axis=0).max())
    factor = 0.06 * body / max(max(size), 1e-300)
    factor = float(f"{factor:.0e}")
    field = FIELDS["U"]
    limits = nice_limits(length[faces.nodes], field)
    wire = faces.surface()
    lines = faces.joint_lines(factor * u)
    pictures = {
        title: render(
            faces.grid(factor * u), view, length, (0.0, limits[-1]), field.colours, lines, wire,
            bands=len(limits) - 1,
        )
        for title, view in faces.views.items()
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
