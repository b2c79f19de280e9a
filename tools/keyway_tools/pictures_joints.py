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
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    figure, axes = new_figure(
        rows, width=2.6 * columns + 1.6, row_height=4.6, columns=columns, squeeze=False, sharey=True
    )
    shade = None
    for axis, (name, joint) in zip(axes.flat, joints.items(), strict=False):
        shade = _joint_panel(axis, joint.on_corners(results.x), joint, values[name], top)
        axis.set_title(f"{name}: {values[name].max():.3g} mm")
    for axis in axes.flat[len(joints) :]:
        axis.set_axis_off()
    bar = figure.colorbar(shade, ax=axes.ravel().tolist(), shrink=0.8, aspect=30)
    bar.set_label("largest opening [mm]")
    bar.outline.set_visible(False)
    title = f"Joint openings over step {step.name.title()}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")
    return save_figure(figure, path)


def _joint_panel(axis, x: np.ndarray, joint: JointFaces, values: np.ndarray, top: float):
    """One joint in its plane: along the joint and up; a horizontal joint in plan."""
    size = np.ptp(x, axis=0)
    if size[2] > 0.05 * size.max():
        across = np.linalg.svd(x[:, :2] - x[:, :2].mean(axis=0), full_matrices=False)[2][0]
        across = across if across[np.abs(across).argmax()] > 0.0 else -across
        along, up = x[:, :2] @ across, x[:, 2]
        along = along - along.min()
        labels = ("along the joint [m]", "height z [m]")
    else:
        along, up, labels = x[:, 0], x[:, 1], ("x [m]", "y [m]")
    levels = MaxNLocator(nbins=10, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, top)
    shade = axis.tricontourf(
        Triangulation(along, up, joint.triangles), values, levels=levels, cmap="viridis_r"
    )
    rings = [np.stack([along[ring], up[ring]], axis=-1) for ring in joint.rings]
    axis.add_collection(PolyCollection(rings, facecolors="none", edgecolors="#00000030", lw=0.6))
    margin = 0.03 * size.max()
    axis.set_aspect("equal")
    axis.set_xlim(along.min() - margin, along.max() + margin)
    axis.set_ylim(up.min() - margin, up.max() + margin)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    axis.grid(False)
    return shade
