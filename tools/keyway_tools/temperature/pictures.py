"""The temperature of a dam on four dates: both faces, and a section from face to face."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import MaxNLocator

from ..picture_style import headline, hide_frame, new_figure, plt, save_figure
from ..render_dam import Paint, Picture, View, render
from ..render_dam import solid_grid as grid_of
from .climate import MONTHS
from .dam_in_deck import Dam
from .periodic_wall import Waves

DATES = {"mid January": 0.5, "mid April": 3.5, "mid July": 6.5, "mid October": 9.5}
COLOURS = "RdYlBu_r"
TILT = 12.0  # [deg] from above


def plot_seasons(dam: Dam, field: Waves, path: Path) -> Path:
    """Four columns of pictures, one a date; the rows share their place, all share the colours."""
    values = field.at(np.array(list(DATES.values())) / MONTHS)
    borders = MaxNLocator(nbins=12).tick_values(values.min(), values.max())
    paint = Paint(None, (borders[0], borders[-1]), COLOURS, len(borders) - 1)
    across, middle = _across(dam)
    views = {
        "upstream face": View.from_direction(-across, TILT),
        "downstream face": View.from_direction(across, TILT),
        "section": View.from_direction(np.cross(across, [0.0, 0.0, 1.0]), 0.0),
    }
    pictures = [
        [_picture(dam, replace(paint, values=one), view, middle if name == "section" else None)
         for one in values.T]
        for name, view in views.items()
    ]  # fmt: skip
    shapes = [min(row[0].image.shape[0] / row[0].image.shape[1], 1.2) for row in pictures]
    figure, axes = new_figure(
        len(views), width=15.0, row_height=3.4 * sum(shapes) / len(shapes) + 0.4,
        columns=len(DATES), gridspec_kw={"height_ratios": shapes},
    )  # fmt: skip
    for row, name in enumerate(views):
        axes[row, 0].set_ylabel(name)
        for column, title in enumerate(DATES):
            picture, axis = pictures[row][column], axes[row, column]
            axis.imshow(picture.image, extent=picture.extent)
            hide_frame(axis)
            axis.set_title(title if row == 0 else "")
    shades = ScalarMappable(BoundaryNorm(borders, plt.get_cmap(COLOURS).N), COLOURS)
    bar = figure.colorbar(shades, ax=axes.ravel().tolist(), shrink=0.8, aspect=40)
    bar.set_label("temperature [°C]")
    bar.outline.set_visible(False)
    headline(figure, "Temperature of the dam through the year")
    return save_figure(figure, path)


def _across(dam: Dam) -> tuple[np.ndarray, np.ndarray]:
    """The horizontal direction from the upstream to the downstream face, and the lowest place."""
    low = dam.x[:, 2] < dam.x[:, 2].min() + 0.1 * np.ptp(dam.x[:, 2])
    near, far = (np.unique(np.concatenate(f)) for f in (dam.upstream, dam.downstream))
    across = dam.x[far].mean(axis=0) - dam.x[near].mean(axis=0)
    across[2] = 0.0
    length = np.linalg.norm(across)
    across = across / length if length > 0.0 else np.array([0.0, 1.0, 0.0])
    return across, dam.x[low].mean(axis=0)


def _picture(dam: Dam, paint: Paint, view: View, origin: np.ndarray | None) -> Picture:
    """The body, or its section at `origin` across the dam."""
    body = grid_of(dam.x, dam.bricks)
    if origin is None:
        return render(body, view, paint)
    body.point_data["of_node"] = paint.values
    aside = 1e-4 * float(np.ptp(dam.x, axis=0).max())  # a plane on faces of elements cuts nothing
    cut: pv.PolyData = body.slice(normal=view.towards, origin=origin + aside * view.towards)
    return render(
        cut, view, Paint(cut.point_data["of_node"], paint.ends, paint.colours, paint.bands)
    )
