"""Upright sections through the dam at its extreme stresses, in true view."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista as pv

from .colour_scale import FIELDS, Scales
from .dam_views import Faces, surface_of
from .picture_style import Sheet
from .pictures_faces import Drawing, Mark, compose, place_of
from .render_dam import Paint, View, render
from .results import Step
from .upright import axes_with_up_last, horizontal

SIDES = ("upstream", "downstream")  # to the left and to the right of a section


def plot_section(faces: Faces, step: Step, name: str, scales: Scales, sheet: Sheet) -> list[Path]:
    """A stress on the section from face to face through its extreme."""
    if len(faces.views) < 2:
        return []  # a slice is drawn in true view already
    shown = FIELDS[name]
    values = step.envelopes[name]
    known = faces.nodes[np.isfinite(values[faces.nodes])]
    if known.size == 0:
        return []
    place = int(known[(shown.sign * values[known]).argmax()])
    body = faces.grid()
    body.point_data["value"] = np.nan_to_num(shown.scale * values)
    view = _view_of_section(faces, place)
    cut = _cut(body, view, faces.results.x[place], faces.size)
    if cut is None:
        return []
    limits = scales.limits(name, values[faces.nodes])
    paint = Paint(cut.point_data["value"], limits.ends, shown.colours, limits.bands)
    joints = _joints_on(faces, cut, view)
    lines = pv.merge(list(joints.values())) if joints else None
    picture = render(cut, view, paint, lines)
    number = shown.with_unit(shown.scale * values[place])
    heading = f"{shown.label}: upright section\n"
    heading += f"{_plane_in_words(faces, cut, view, place)}\nextreme {number} at "
    heading += f"{place_of(faces.results.x[place], faces.size)}, step {step.name}"
    if joints:
        heading += f"\nblack: {', '.join(joints)}, between blocks with stresses of their own"
    marks = {"": Mark(view.project(faces.results.x[place]), number)}
    label = f"{shown.label.lower()} [{shown.unit}]"
    drawing = Drawing({"": picture}, limits, shown.colours, label, heading, marks, SIDES)
    return compose(drawing, sheet)


def _plane_in_words(faces: Faces, cut: pv.PolyData, view: View, place: int) -> str:
    """Where the section begins, upstream, and ends in plan."""
    x, size = faces.results.x[place], faces.size
    first, second, _ = axes_with_up_last(faces.results.up_axis)
    along = cut.points @ view.right
    ends = (x + (end - x @ view.right) * view.right for end in (along.min(), along.max()))
    words = [place_of(end[[first, second]], size) for end in ends]
    axes = f"({'xyz'[first]}, {'xyz'[second]})"
    return f"from {axes} = {words[0].removesuffix(' m')} to {words[1]}, face to face"


def _joints_on(faces: Faces, cut: pv.PolyData, view: View) -> dict[str, pv.PolyData]:
    """The lines in which joints meet the section."""
    found, along = {}, cut.points @ view.right
    for name, facets in faces.joint_facets().items():
        plane = {"normal": view.towards, "origin": cut.points[0]}
        line = surface_of(facets, faces.results.x).slice(**plane)
        if line.n_cells:
            at = line.cell_centers().points @ view.right
            line = line.extract_cells((at > along.min()) & (at < along.max()))
            line = line.extract_surface(algorithm="dataset_surface")
        if line.n_cells:
            found[name] = line
    return found


def _cut(body: pv.UnstructuredGrid, view: View, x: np.ndarray, size: float) -> pv.PolyData | None:
    """The body's section at x; a little beside, as a plane on faces of elements cuts nothing.

    At an end of the dam this is a sliver of a corner: then the section lies further inside.
    Blocks between joints are separate parts. What is further away than the dam is high is another
    place of a curved dam.
    """
    found = []
    for aside in (1e-4 * size, -1e-4 * size, 0.02 * size, -0.02 * size):
        cut = body.slice(normal=view.towards, origin=x + aside * view.towards)
        if cut.n_cells:
            height = np.ptp(body.points @ view.up)
            near = np.abs((cut.cell_centers().points - x) @ view.right) < height
            if not near.any():
                continue
            cut = cut.extract_cells(near).extract_surface(algorithm="dataset_surface")
            found.append((float(np.linalg.norm(cut.points - x, axis=1).min()), cut))
    whole = max((cut.area for _, cut in found), default=0.0)
    enough = [pair for pair in found if pair[1].area >= 0.5 * whole]
    return min(enough, key=lambda pair: pair[0])[1] if enough else None


def _view_of_section(faces: Faces, place: int) -> View:
    """True view of the upright plane across the dam at a node, upstream on the left."""
    results = faces.results
    downstream = faces.views["Downstream face"].towards
    near = np.flatnonzero(results.face_flags("upstream"))
    far = np.linalg.norm(results.x[near] - results.x[place], axis=1)
    normals = faces.normals[near[np.argsort(far)[:9]]]
    across = horizontal(-normals.sum(axis=0), results.upward)
    if np.linalg.norm(across) < 1e-9:
        across = horizontal(downstream, results.upward)
    return View.from_direction(np.cross(across, results.upward), 0.0, results.upward)
