"""Openings over the area of joints, on the polygons in job.h5."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from .joint_faces import JointFaces
from .picture_style import new_figure, save_figure
from .results import Results, Step


def plot_joint_areas(results: Results, step: Step, path: Path) -> Path | None:
    """Largest opening over the area of every joint, in a view normal to the joint."""
    joints = {name: results.joint_faces(name) for name in results.joint_names()}
    joints = {name: joint for name, joint in joints.items() if joint is not None}
    opening = np.nan_to_num(1000.0 * step.envelopes["OPENING"])
    values = {name: joint.on_corners(opening) for name, joint in joints.items()}
    top = max((openings.max() for openings in values.values()), default=0.0)
    if top <= 0.0:
        return None
    views = {name: JointView(joint.on_corners(results.x)) for name, joint in joints.items()}
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    figure, axes = new_figure(
        rows, width=2.6 * columns + 1.6, row_height=4.6, columns=columns, squeeze=False
    )
    shade = None
    for axis, (name, joint) in zip(axes.flat, joints.items(), strict=False):
        shade = _joint_panel(axis, views[name], joint, values[name], top)
        axis.set_ylim(range_of(views[name], list(views.values())))
        axis.set_title(f"{name}: {values[name].max():.3g} mm")
    for axis in axes.flat[len(joints) :]:
        axis.set_axis_off()
    bar = figure.colorbar(shade, ax=axes.ravel().tolist(), shrink=0.8, aspect=30)
    bar.set_label("largest opening [mm]")
    bar.outline.set_visible(False)
    title = f"Joint openings over step {step.name.title()}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")
    return save_figure(figure, path)


class JointView:
    """Corners of a joint in its plane: along the joint and up; a horizontal joint in plan."""

    def __init__(self, x: np.ndarray):
        size = np.ptp(x, axis=0)
        self.is_upright = size[2] > 0.05 * size.max()
        self.margin = 0.03 * size.max()
        if self.is_upright:
            across = np.linalg.svd(x[:, :2] - x[:, :2].mean(axis=0), full_matrices=False)[2][0]
            across = across if across[np.abs(across).argmax()] > 0.0 else -across
            along, self.up = x[:, :2] @ across, x[:, 2]
            self.along = along - along.min()
            self.labels = ("along the joint [m]", "height z [m]")
        else:
            self.along, self.up, self.labels = x[:, 0], x[:, 1], ("x [m]", "y [m]")


def range_of(view: JointView, views: list[JointView]) -> tuple[float, float]:
    """Range of the vertical axis [m]: one for all upright joints, so that heights compare."""
    same = [other for other in views if other.is_upright] if view.is_upright else [view]
    margin = max(other.margin for other in same)
    return min(v.up.min() for v in same) - margin, max(v.up.max() for v in same) + margin


def _joint_panel(axis, view: JointView, joint: JointFaces, values: np.ndarray, top: float):
    """One joint in its plane."""
    along, up = view.along, view.up
    levels = MaxNLocator(nbins=10, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, top)
    shade = axis.tricontourf(
        Triangulation(along, up, joint.triangles), values, levels=levels, cmap="viridis_r"
    )
    rings = [np.stack([along[ring], up[ring]], axis=-1) for ring in joint.rings]
    axis.add_collection(PolyCollection(rings, facecolors="none", edgecolors="#00000030", lw=0.6))
    axis.set_aspect("equal")
    axis.set_xlim(along.min() - view.margin, along.max() + view.margin)
    axis.set_xlabel(view.labels[0])
    axis.set_ylabel(view.labels[1])
    axis.grid(False)
    return shade
