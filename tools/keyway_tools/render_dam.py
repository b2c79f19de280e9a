"""Pictures of bodies without a display: VTK renders, the caller sets the frame.

VTK chooses the back end: a display if there is one, else EGL (packages libegl1 and
libgl1-mesa-dri draw in software), else OSMesa.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonCore import vtkLogger

from .upright import Z, horizontal

vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # no warnings about a missing X server

PIXELS = (1500, 1000)
MARGIN = 1.06
LEVEL = "#00C8E6"  # of lines of equal values, apart from all scales
WEDGE = (
    0,
    2,
    1,
    4,
    6,
    5,
)  # corners of a brick with 3 = 4 and 7 = 8, for outward normals in VTK
UPWARD = np.eye(3)[Z]


@dataclass(frozen=True)
class View:
    """A parallel projection: unit vectors to the right, up and towards the viewer."""

    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray

    @staticmethod
    def from_direction(towards: np.ndarray, elevation: float, upward: np.ndarray = UPWARD) -> View:
        """View from the side of `towards` (made horizontal), a little from above."""
        level = horizontal(towards, upward)
        level /= np.linalg.norm(level)
        angle = np.radians(elevation)
        out = np.cos(angle) * level + np.sin(angle) * upward
        right = np.cross(upward, level)
        return View(right, np.cross(out, right), out)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Coordinates to the right and up [m]."""
        return np.stack([x @ self.right, x @ self.up], axis=-1)


@dataclass(frozen=True)
class Paint:
    """Values on the nodes of a body (None: of its cells, or none at all), and their colours."""

    values: np.ndarray | None
    ends: tuple[float, float]
    colours: str
    bands: int = 64
    level: float | None = None  # of a line of equal values on nodes


@dataclass(frozen=True)
class Picture:
    """A rendered image and where it lies in the projection [m]: left, right, bottom, top."""

    image: np.ndarray
    extent: tuple[float, float, float, float]


def solid_grid(x: np.ndarray, connectivity: np.ndarray) -> pv.UnstructuredGrid:
    """Bricks and their wedges (corners 3 = 4 and 7 = 8) as a VTK grid."""
    is_wedge = (connectivity[:, 2] == connectivity[:, 3]) & (
        connectivity[:, 6] == connectivity[:, 7]
    )
    cells, kinds = [], []
    for nodes, wedge in zip(connectivity.tolist(), is_wedge.tolist(), strict=True):
        corners = [nodes[k] for k in WEDGE] if wedge else nodes
        cells += [len(corners), *corners]
        kinds.append(pv.CellType.WEDGE if wedge else pv.CellType.HEXAHEDRON)
    return pv.UnstructuredGrid(np.array(cells), np.array(kinds), np.array(x, dtype=float))


def frame(x: np.ndarray, view: View, margin: float = MARGIN) -> tuple[np.ndarray, float]:
    """Centre (3) and half height [m] of a picture that holds all points."""
    flat = view.project(x)
    low, high = flat.min(axis=0), flat.max(axis=0)
    half = 0.5 * (high - low) * margin
    middle = 0.5 * (low + high)
    depth = 0.5 * np.ptp(x @ view.towards) + (x @ view.towards).min()
    centre = middle[0] * view.right + middle[1] * view.up + depth * view.towards
    return centre, max(half[1], half[0] * PIXELS[1] / PIXELS[0], 1e-9)


def render(
    grid: pv.UnstructuredGrid | pv.PolyData,
    view: View,
    paint: Paint,
    outline: pv.PolyData | None = None,
    wire: pv.PolyData | None = None,
    *,
    fixed: float | None = None,
) -> Picture:
    """Image of a body, lines of `outline` on top.

    Coloured by values on its nodes, or by 'value' on its cells where the grid has that. For films,
    `fixed` is the margin around the wire alone, so that all images show the same place.
    """
    surface = grid.extract_surface(algorithm="dataset_surface")
    points = np.vstack([surface.points, wire.points]) if wire is not None else surface.points
    if fixed:
        points = wire.points
    centre, half_height = frame(np.asarray(points, dtype=float), view, fixed or MARGIN)
    pixels = [number // 2 for number in PIXELS] if fixed else PIXELS
    plotter = pv.Plotter(off_screen=True, window_size=pixels)
    plotter.set_background("white")
    _add_body(plotter, surface, paint)
    if wire is not None:
        edges = wire.extract_feature_edges(feature_angle=40.0)
        plotter.add_mesh(edges, color="#777777", line_width=1.5)
    if outline is not None:
        _add_outline(plotter, outline, view, paint)
    plotter.enable_parallel_projection()
    plotter.enable_anti_aliasing("ssaa")
    distance = 10.0 * float(np.ptp(points, axis=0).max())
    plotter.camera_position = [centre + distance * view.towards, centre, view.up]
    plotter.camera.parallel_scale = half_height
    plotter.reset_camera_clipping_range()
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    middle = view.project(centre)
    half_width = half_height * PIXELS[0] / PIXELS[1]
    extent = (
        middle[0] - half_width,
        middle[0] + half_width,
        middle[1] - half_height,
        middle[1] + half_height,
    )
    return Picture(image, extent) if fixed else _crop(Picture(image, extent))


def render_views(
    views: dict[str, View], grid, paint: Paint, *more, **options
) -> dict[str, Picture]:
    """Images of a body from several sides, by the titles of the views."""
    return {title: render(grid, view, paint, *more, **options) for title, view in views.items()}


def _add_body(plotter, surface: pv.PolyData, paint: Paint) -> None:
    """The skin of a body with its edges."""
    look = {"ambient": 0.72, "diffuse": 0.36, "specular": 0.0, "show_edges": True}
    look |= {"edge_color": "black", "edge_opacity": 0.16, "line_width": 1.0}
    if paint.values is not None:
        surface["value"] = paint.values[surface["vtkOriginalPointIds"]]
    if "value" not in surface.array_names:
        plotter.add_mesh(surface, color="#D9D4CC", **look)
        return
    plotter.add_mesh(
        surface, scalars="value", cmap=paint.colours, clim=paint.ends, n_colors=paint.bands,
        show_scalar_bar=False, nan_color="#E6E6E6", **look,
    )  # fmt: skip
    if paint.level is not None and paint.values is not None:
        line = surface.contour([paint.level], scalars="value")
        if line.n_points:
            plotter.add_mesh(line, color=LEVEL, line_width=4.0, lighting=False)


def _add_outline(plotter, outline: pv.PolyData, view: View, paint: Paint) -> None:
    """Lines a little in front of the body: black, of their 'rgb', or coloured by their 'value'."""
    body = float(np.ptp(outline.points, axis=0).max())
    lines = outline.translate(0.004 * body * view.towards)
    if "rgb" in lines.cell_data:
        plotter.add_mesh(lines, scalars="rgb", rgb=True, line_width=9.0, lighting=False)
        return
    if "value" not in lines.point_data:
        plotter.add_mesh(lines, color="black", line_width=3.0)
        return
    plotter.add_mesh(lines, color="black", line_width=20.0)
    front = lines.translate(0.002 * body * view.towards)
    plotter.add_mesh(
        front, scalars="value", cmap=paint.colours, clim=paint.ends, n_colors=paint.bands,
        line_width=16.0, show_scalar_bar=False, lighting=False,
    )  # fmt: skip


def _crop(picture: Picture, border: int = 25) -> Picture:
    """Cut the white margins off."""
    is_drawn = (picture.image < 250).any(axis=2)
    if not is_drawn.any():
        return picture
    top, bottom = _span(is_drawn.any(axis=1), border)
    left, right = _span(is_drawn.any(axis=0), border)
    pixel = (picture.extent[3] - picture.extent[2]) / len(picture.image)
    x, y = picture.extent[0], picture.extent[3]
    extent = (x + left * pixel, x + right * pixel, y - bottom * pixel, y - top * pixel)
    return Picture(picture.image[top:bottom, left:right], extent)


def _span(is_drawn: np.ndarray, border: int) -> tuple[int, int]:
    """Where the drawn part begins and ends, with a border."""
    found = np.flatnonzero(is_drawn)
    return max(0, int(found[0]) - border), min(len(is_drawn), int(found[-1]) + border)
