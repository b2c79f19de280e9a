"""Displaced bodies: the deformed shape and the modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .colour_scale import FIELDS, Scales
from .dam_views import Faces
from .picture_style import Sheet, headline, hide_frame, new_figure, plt
from .pictures_faces import Drawing, compose
from .render_dam import Paint, Picture, View, render_views
from .si_results import SiResults

ENLARGED = 0.06  # the largest displacement as drawn over the size of the dam


def largest_state(results: SiResults, nodes: np.ndarray) -> tuple[str, float] | None:
    """The saved displacements with the largest joint opening, else the largest displacements."""
    saved = results.displacements()
    if not saved:
        return None
    opening = np.zeros(len(saved))
    times = np.array([time for _, time in saved])
    for name in results.joint_names():
        table = results.history(f"joints/{name}")
        if len(table.get("time", ())):
            opened = results.without_round_off(table["opening"])
            opening = np.maximum(opening, np.interp(times, table["time"], opened))
    if opening.max() > 0.0:
        return saved[int(opening.argmax())]
    size = [np.linalg.norm(results.displacement(p)[nodes], axis=1).max() for p, _ in saved]
    return saved[int(np.argmax(size))]


def round_factor(size: float, largest: float) -> float:
    """Enlargement with one digit that draws the largest displacement at a part of the size."""
    return float(f"{ENLARGED * size / largest:.0e}") if largest > 0.0 else 1.0


def plot_deformed(faces: Faces, scales: Scales, sheet: Sheet) -> list[Path]:
    """The state of `largest_state`, displacements enlarged, coloured by size, also from above."""
    state = largest_state(faces.results, faces.nodes)
    if state is None:
        return []
    place, time = state
    faces = faces.at(place)
    u = faces.results.displacement(place)
    length = np.linalg.norm(u, axis=1)
    largest = float(length[faces.nodes].max())
    factor = round_factor(faces.size, largest)
    shown = FIELDS["U"]
    limits = scales.limits("U", length[faces.nodes])
    wire, lines = faces.surface(), faces.joint_lines(factor * u)
    paint = Paint(shown.scale * length, limits.ends, shown.colours, limits.bands)
    pictures = render_views(faces.with_above(), faces.grid(factor * u), paint, lines, wire)
    heading = f"Deformed shape at t = {time:.5g} s, displacements drawn {factor:g} times\n"
    heading += f"largest displacement {shown.with_unit(1e3 * largest)}"
    drawing = Drawing(pictures, limits, shown.colours, "displacement [mm]", heading)
    return compose(drawing, sheet)


def plot_modes(faces: Faces, sheet: Sheet, most: int = 6) -> list[Path]:
    """The first mode shapes from a side and from above, frequencies and effective masses."""
    modes = faces.results.modes()
    if modes is None or len(modes[0]) == 0:
        return []
    hz, shapes = modes
    mass = faces.results.effective_mass()
    count = min(most, len(hz))
    views = dict(list(faces.with_above().items())[:: max(1, len(faces.with_above()) - 1)])
    columns = min(3, count)
    rows = -(-count // columns) * len(views)
    pictures = [_mode_pictures(faces, shapes[k], views) for k in range(count)]
    shape = max(p.image.shape[0] / p.image.shape[1] for many in pictures for p in many)
    figure, axes = new_figure(
        rows, width=4.6 * columns, row_height=4.0 * min(shape, 1.2) + 0.35, columns=columns,
        squeeze=False,
    )  # fmt: skip
    for axis in axes.flat:
        hide_frame(axis)
    for k in range(count):
        for row, picture in enumerate(pictures[k]):
            axis = axes[(k // columns) * len(views) + row, k % columns]
            axis.imshow(picture.image, extent=picture.extent)
            if row == 0:
                axis.set_title(_mode_title(k, hz[k], mass), fontsize=12)
    shades = plt.cm.ScalarMappable(plt.Normalize(0.0, 1.0), "viridis_r")
    bar = figure.colorbar(shades, ax=axes.ravel().tolist(), shrink=0.6, aspect=30)
    bar.set_label("size of the shape over its largest")
    titles = " and ".join(title.lower() for title in views if title)
    part = f", the first {count} of {len(hz)}" if count < len(hz) else ""
    headline(figure, f"Mode shapes{', ' + titles if titles else ''}{part}")
    return sheet.save(figure)


def _mode_pictures(faces: Faces, shape: np.ndarray, views: dict[str, View]) -> list[Picture]:
    """A mode from all sides, enlarged to 8 % of the dam, coloured by its size."""
    size = np.linalg.norm(shape, axis=1)
    largest = size[faces.nodes].max() or 1.0
    body, wire = faces.grid(0.08 * faces.size / largest * shape), faces.surface()
    paint = Paint(size / largest, (0.0, 1.0), "viridis_r")
    return list(render_views(views, body, paint, wire=wire).values())


def _mode_title(k: int, hz: float, mass: np.ndarray | None) -> str:
    """Number and frequency, and the effective masses that count."""
    title = f"mode {k + 1}: {hz:.4g} Hz"
    if mass is None:
        return title
    return f"{title}\neffective mass {masses_in_words(mass[k])}"


def masses_in_words(mass: np.ndarray) -> str:
    """Effective masses along x, y, z with their unit."""
    largest = float(np.abs(mass).max())
    scale, unit = (1e-6, "kt") if largest > 1e6 else (1e-3, "t") if largest > 1e3 else (1.0, "kg")
    parts = [
        f"{axis} {scale * m:.3g}" for axis, m in zip("xyz", mass, strict=True) if m > 1e-3 * largest
    ]
    return f"{', '.join(parts)} {unit}" if parts else "0"
