"""The dam's body, the directions from which it is drawn, and what each of them shows."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import pyvista as pv

from .render_dam import View, solid_grid
from .si_results import SiResults
from .upright import axes_with_up_last

TILT = 12.0  # [deg] from above


class Faces:
    """The dam's body and the views of it: the complete dam, or what is there in a step."""

    def __init__(self, results: SiResults, step: int | None = None):
        self.results = results
        self.elements = results.dam
        self.views = _views(results, np.unique(results.connectivity[results.dam]))
        stage = results.stage(step) if step else None
        if stage is not None and stage[self.elements].any():
            self.elements = self.elements[stage[self.elements] > 0]
        self.cells = results.connectivity[self.elements]
        self.nodes = np.unique(self.cells)

    def at(self, place: str) -> Faces:
        """What is there in the step of a saved increment, '/steps/0003/increments/...'."""
        step = int(place.split("/")[2])
        return self if self.results.stage(step) is None else Faces(self.results, step)

    def grid(self, shift: np.ndarray | None = None) -> pv.UnstructuredGrid:
        """The body, displaced by `shift` on all nodes."""
        x = self.results.x if shift is None else self.results.x + shift
        return solid_grid(x, self.cells)

    def surface(self) -> pv.PolyData:
        """The skin of the body at rest."""
        return self.grid().extract_surface(algorithm="dataset_surface")

    @property
    def size(self) -> float:
        """The largest side of the body [m]."""
        return float(np.ptp(self.results.x[self.nodes], axis=0).max())

    @cached_property
    def normals(self) -> np.ndarray:
        """Outward unit normals of the skin on all nodes; zero inside."""
        skin = self.surface().compute_normals(
            cell_normals=False, split_vertices=False, consistent_normals=False
        )
        normals = np.zeros_like(self.results.x)
        normals[skin.point_data["vtkOriginalPointIds"]] = skin.point_data["Normals"]
        return normals

    def shown_on(self, title: str) -> np.ndarray:
        """The nodes of the face that a view shows, as job.json means it; else those whose side of
        the skin it shows."""
        face = {"Upstream face": "upstream", "Downstream face": "downstream"}.get(title)
        on_face = self.nodes[self.results.face_flags(face)[self.nodes]] if face else ()
        if len(on_face):
            return on_face
        facing = self.normals[self.nodes] @ self.views[title].towards
        return self.nodes[facing > 0.05]

    def with_above(self) -> dict[str, View]:
        """The views and one from above; a slice is only seen from its side."""
        views = dict(self.views)
        if len(views) > 1:
            views["From above"] = View.from_direction(
                views["Downstream face"].towards, 89.9, self.results.upward
            )
        return views

    def joint_lines(
        self, shift: np.ndarray | None = None, values: np.ndarray | None = None
    ) -> pv.PolyData | None:
        """Lines where the joints meet the faces; given values of all nodes become 'value'."""
        x = self.results.x if shift is None else self.results.x + shift
        parts = [border_of(facets, x, values) for facets in self.joint_facets().values()]
        return pv.merge(parts) if parts else None

    def joint_facets(self) -> dict[str, np.ndarray]:
        """Facets (rows of four nodes) of each joint that are there; no joints without any."""
        found = {}
        # interface quads have nodes that no solid has: they are there as the joint is
        absent = np.setdiff1d(self.results.connectivity[self.results.solids], self.nodes)
        for name in self.results.joint_names():
            joint = self.results.joint_faces(name)
            facets = joint.facets if joint is not None else np.empty((0, 4), dtype=int)
            facets = facets[~np.isin(facets, absent).any(axis=1)]
            if len(facets):
                found[name] = facets
        return found


def border_of(facets: np.ndarray, x: np.ndarray, values: np.ndarray | None = None) -> pv.PolyData:
    """The lines around facets (rows of four nodes); given values of all nodes become 'value'."""
    return surface_of(facets, x, values).extract_feature_edges(feature_edges=False)


def surface_of(facets: np.ndarray, x: np.ndarray, values: np.ndarray | None = None) -> pv.PolyData:
    """Facets (rows of four nodes); given values of all nodes become 'value'."""
    nodes, place = np.unique(facets, return_inverse=True)
    place = place.reshape(facets.shape)
    faces = np.hstack([np.full((len(place), 1), 4), place])
    part = pv.PolyData(x[nodes].astype(float), faces.ravel())
    if values is not None:
        part["value"] = values[nodes]
    return part


def _views(results: SiResults, nodes: np.ndarray) -> dict[str, View]:
    """Views from upstream and downstream if the deck has a reservoir, else one view."""
    x = results.x[nodes]
    upstream, downstream = results.face_flags("upstream"), results.face_flags("downstream")
    if not upstream.any():
        return {"": _single_view(x, results.up_axis)}
    other = results.x[downstream] if downstream.any() else x
    towards = results.x[upstream].mean(axis=0) - other.mean(axis=0)
    upward = results.upward
    view = View.from_direction(towards, TILT, upward)
    if np.ptp(x @ view.right) < 0.5 * np.ptp(x @ view.towards):  # a slice: its side shows more
        return {"": View.from_direction(view.right, 0.0, upward)}
    other_side = View.from_direction(-towards, TILT, upward)
    return {"Upstream face": view, "Downstream face": other_side}


def _single_view(x: np.ndarray, up_axis: int) -> View:
    """A slice in true view, another body from a corner and above."""
    size, axes = np.ptp(x, axis=0), np.eye(3)
    first, second, up = axes_with_up_last(up_axis)
    thin, wide = (first, second) if size[first] <= size[second] else (second, first)
    if size[thin] < 0.25 * min(size[wide], size[up]):
        return View.from_direction(-axes[thin], 0.0, axes[up])
    return View.from_direction(0.55 * axes[first] - axes[second], 18.0, axes[up])
