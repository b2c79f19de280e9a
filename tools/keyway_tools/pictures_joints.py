"""Maps of joints on the polygons in job.h5: largest opening, slip and state at a time."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch
from matplotlib.tri import Triangulation
from scipy.spatial import cKDTree

from .colour_scale import FIELDS, Scales
from .joint_faces import JointFaces
from .picture_style import Sheet, headline, new_figure
from .results import Step
from .si_results import SiResults, saved_increments
from .upright import Z, axes_with_up_last

NOT_GROUTED, NOT_THERE = -3, -2  # drawn beside the states of job.h5
STATES = {
    NOT_GROUTED: "not grouted yet", NOT_THERE: "not there", -1: "shared node",
    0: "open", 1: "stick", 2: "slip", 3: "bonded",
}  # fmt: skip
SHOWN_IN_PLAN = 0.3  # of the area
WIDEST = 13.0  # [inches]
STATE_COLOURS = ("#B5B5B5", "#EEEEEE", "#FFFFFF", "#D55E00", "#C9DAE6", "#E69F00", "#0072B2")


class JointView:
    """Corners of a joint in its plane: along the joint and up, or in plan.

    A joint is drawn in plan where that shows its area: a horizontal joint, and a perimetral one,
    whose two sides would hide each other in an elevation.
    """

    def __init__(self, x: np.ndarray, triangles: np.ndarray | None = None, up_axis: int = Z):
        order = axes_with_up_last(up_axis)
        x, names = x[:, order], ["xyz"[axis] for axis in order]
        size = np.ptp(x, axis=0)
        self.is_upright = size[2] > 0.05 * size.max()
        if triangles is not None and len(triangles):
            self.is_upright = _part_in_plan(x, triangles) < SHOWN_IN_PLAN
        self.margin = 0.03 * size.max()
        if self.is_upright:
            across = np.linalg.svd(x[:, :2] - x[:, :2].mean(axis=0), full_matrices=False)[2][0]
            across = across if across[np.abs(across).argmax()] > 0.0 else -across
            along, self.up = x[:, :2] @ across, x[:, 2]
            self.along = along - along.min()
            self.labels = ("along [m]", f"height {names[2]} [m]")
        else:
            self.along, self.up = x[:, 0], x[:, 1]
            self.labels = (f"{names[0]} [m]", f"{names[1]} [m]")


def _part_in_plan(x: np.ndarray, triangles: np.ndarray) -> float:
    """The part of the area that is seen from above."""
    a, b, c = (x[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return float(np.abs(normals[:, 2]).sum() / max(np.linalg.norm(normals, axis=1).sum(), 1e-300))


def ranges_of(
    view: JointView, views: list[JointView]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ranges of both axes [m]: one for all upright joints, so that all have one scale."""
    same = [other for other in views if other.is_upright] if view.is_upright else [view]
    margin = max(other.margin for other in same)

    def around(values: list[np.ndarray]) -> tuple[float, float]:
        return min(v.min() for v in values) - margin, max(v.max() for v in values) + margin

    return around([v.along for v in same]), around([v.up for v in same])


def _never_below_zero(values: np.ndarray) -> np.ndarray:
    """Round-off below zero would leave holes in a map whose colours begin at zero."""
    return np.maximum(values, 0.0)


class JointPage:
    """A figure with one panel a joint, each joint in its plane."""

    def __init__(self, results: SiResults, joints: dict[str, JointFaces]):
        self.joints = joints
        self.views = {
            name: JointView(joint.on_corners(results.x), joint.triangles, results.up_axis)
            for name, joint in joints.items()
        }
        tallest = max(self._shape(name) for name in joints)
        height = float(np.clip(3.5 * tallest, 2.4, 5.5))
        width = float(np.clip(height / tallest + 0.8, 1.9, 9.0))
        columns = max(1, min(len(joints), int(WIDEST / width)))
        rows = -(-len(joints) // columns)
        columns = -(-len(joints) // rows)  # six joints in rows of three, not of five and one
        self.figure, axes = new_figure(
            rows, width=max(width * columns + 1.8, 8.0), row_height=height + 1.5, columns=columns,
            squeeze=False,
        )  # fmt: skip
        # Panels of a fixed aspect are smaller than their cells: titles and legends follow them.
        self.figure.set_layout_engine("compressed")
        self.axes = dict(zip(joints, axes.flat, strict=False))
        for axis in axes.flat[len(joints) :]:
            axis.set_axis_off()

    def _shape(self, name: str) -> float:
        along, up = ranges_of(self.views[name], list(self.views.values()))
        return (up[1] - up[0]) / max(along[1] - along[0], 1e-12)

    def frame(self, name: str, title: str) -> None:
        """Title, labels and range of the panel of a joint."""
        axis, view = self.axes[name], self.views[name]
        axis.set_aspect("equal")
        along, up = ranges_of(view, list(self.views.values()))
        axis.set_xlim(along)
        axis.set_ylim(up)
        axis.set_title(title, fontsize=12)
        axis.set_xlabel(view.labels[0])
        if axis is next(iter(self.axes.values())) or not view.is_upright:
            axis.set_ylabel(view.labels[1])
        axis.grid(False)

    def rings(self, name: str) -> list[np.ndarray]:
        """Polygons of a joint in its plane."""
        view = self.views[name]
        return [
            np.stack([view.along[ring], view.up[ring]], axis=-1) for ring in self.joints[name].rings
        ]

    def fill(self, name: str, values: np.ndarray, borders: np.ndarray, colours: str):
        """Values of the corners in bands of colour, and the largest one marked."""
        axis, view = self.axes[name], self.views[name]
        extend = "max" if values.max() > borders[-1] else "neither"
        triangles = Triangulation(view.along, view.up, self.joints[name].triangles)
        shade = axis.tricontourf(triangles, values, levels=borders, cmap=colours, extend=extend)
        edges = {"facecolors": "none", "edgecolors": "#00000030", "lw": 0.6}
        axis.add_collection(PolyCollection(self.rings(name), **edges))
        if values.max() > 0.0:
            most = values.argmax()
            axis.plot(
                view.along[most], view.up[most], "o", ms=11, mfc="none", mec="#0091B2", mew=2.0,
                clip_on=False,
            )  # fmt: skip
        return shade

    def bar(self, shade, label: str) -> None:
        """One bar of colours for all joints."""
        bar = self.figure.colorbar(shade, ax=list(self.axes.values()), shrink=0.8, aspect=30)
        bar.set_label(label)
        bar.outline.set_visible(False)


def joints_with_faces(results: SiResults) -> dict[str, JointFaces]:
    """The joints that can be drawn."""
    joints = {name: results.joint_faces(name) for name in results.joint_names()}
    return {name: joint for name, joint in joints.items() if joint is not None}


def plot_joint_areas(results: SiResults, step: Step, scales: Scales, sheet: Sheet) -> list[Path]:
    """Largest opening over the area of every joint, in a view normal to the joint."""
    joints = joints_with_faces(results)
    opening = np.nan_to_num(step.envelopes["OPENING"])
    values = {
        name: 1e3 * _never_below_zero(joint.on_corners(opening)) for name, joint in joints.items()
    }
    if max((openings.max() for openings in values.values()), default=0.0) <= 0.0:
        return []
    page = JointPage(results, joints)
    borders = scales.limits("OPENING", opening).borders
    for name in joints:
        shade = page.fill(name, values[name], borders, FIELDS["OPENING"].colours)
        page.frame(name, f"{name}\n{values[name].max():.3g} mm")
    page.bar(shade, "largest opening [mm]")
    headline(page.figure, f"Joint openings over step {step.name}")
    return sheet.save(page.figure)


def _saved_joints(results: SiResults) -> list[tuple[object, float]]:
    """Groups of increments that hold the state of joints, and their times."""
    saved = saved_increments(results)
    return [(group["joints"], time) for group, time in saved if "joints" in group]


def last_slips(results: SiResults) -> tuple[dict[str, np.ndarray], float]:
    """Irrecoverable sliding [m] of the corners of every joint at the last saved time; the time."""
    saved, joints = _saved_joints(results), joints_with_faces(results)
    if not saved or not joints:
        return {}, 0.0
    group, time = saved[-1]
    slips = {}
    for name, joint in joints.items():
        size = results.units.length * np.linalg.norm(group[name]["slip"][:], axis=1)
        size = results.without_round_off(size)
        slips[name] = size[_point_of_corner(results, name, joint)]
    return slips, time


def plot_joint_slips(results: SiResults, scales: Scales, sheet: Sheet) -> list[Path]:
    """Irrecoverable sliding of every joint at the last saved time."""
    slips, time = last_slips(results)
    everything = np.concatenate([np.zeros(1), *slips.values()])
    if not everything.any():
        return []
    page = JointPage(results, joints_with_faces(results))
    borders = scales.limits("SLIP", everything).borders
    for name, values in slips.items():
        shade = page.fill(name, 1e3 * values, borders, FIELDS["SLIP"].colours)
        page.frame(name, f"{name}\n{1e3 * values.max():.3g} mm")
    page.bar(shade, "irrecoverable sliding [mm]")
    headline(page.figure, f"Slip of joints at t = {time:.5g} s")
    return sheet.save(page.figure)


def plot_joint_states(results: SiResults, sheet: Sheet) -> list[Path]:
    """State of every joint at the saved time at which most of the joints' area is open.

    Where joints open in a motion, this is a time of a motion.
    """
    saved, joints = _saved_joints(results), joints_with_faces(results)
    if not saved or not joints:
        return []
    areas = {name: results.file[f"joints/{name}/area"][:] for name in joints}
    opened = [sum(a[_states(g[n]) == 0].sum() for n, a in areas.items()) for g, _ in saved]
    motions = {step.number for step in results.steps() if "DYNAMIC" in step.procedure}
    shaken = [a if _step_of(g) in motions else 0.0 for a, (g, _) in zip(opened, saved, strict=True)]
    group, time = saved[int(np.argmax(shaken if max(shaken) > 0.0 else opened))]
    page = JointPage(results, joints)
    colours = ListedColormap(STATE_COLOURS)
    norm = BoundaryNorm(np.arange(-3.5, 4.0), colours.N)
    seen: set[int] = set()
    for name, joint in joints.items():
        states = _states(group[name])
        corners = states[_point_of_corner(results, name, joint)]
        seen |= set(corners.tolist())
        _fill_by_corner(page, name, corners, colours, norm)
        there = areas[name][states > NOT_THERE].sum()
        share = areas[name][states == 0].sum() / max(there, 1e-300)
        page.frame(name, f"{name}\n{100.0 * share:.3g} % open")
    handles = [
        Patch(fc=colours(norm(value)), ec="black", lw=0.5, label=text)
        for value, text in STATES.items()
        if value in seen
    ]
    page.figure.legend(handles=handles, loc="outside right center")
    most = ", with most area open" if max(opened) > 0.0 else ", no joint is open at a saved time"
    most += " in a motion" if 0.0 < max(shaken) < max(opened) else ""
    headline(page.figure, f"State of joints at t = {time:.5g} s{most}")
    return sheet.save(page.figure)


def _states(joint: h5py.Group) -> np.ndarray:
    """States of the points of a joint; below zero where an element behind the point is absent, or
    the point waits for its grout."""
    state = joint["state"][:].astype(int)
    if "grouted" in joint:
        grouted = joint["grouted"][:].ravel()
        state[grouted == 0] = NOT_THERE
        state[grouted == 1] = NOT_GROUTED
    return state


def _step_of(joints: h5py.Group) -> int:
    """The step of the joints of an increment, /steps/0002/increments/000010/joints."""
    return int(joints.name.split("/")[2])


def _fill_by_corner(page: JointPage, name: str, state: np.ndarray, colours, norm) -> None:
    """The part of each polygon that is next to a corner has the colour of that corner."""
    parts, values = [], []
    for ring, corners in zip(page.rings(name), page.joints[name].rings, strict=True):
        centre, count = ring.mean(axis=0), len(ring)
        for k in range(count):
            before, after = 0.5 * (ring[k] + ring[k - 1]), 0.5 * (ring[k] + ring[(k + 1) % count])
            parts.append(np.array([ring[k], after, centre, before]))
            values.append(state[corners[k]])
    look = {"cmap": colours, "norm": norm, "edgecolors": "face", "lw": 0.3}
    page.axes[name].add_collection(PolyCollection(parts, array=np.array(values), **look))
    outline = PolyCollection(page.rings(name), facecolors="none", edgecolors="#00000040", lw=0.5)
    page.axes[name].add_collection(outline)


def _point_of_corner(results: SiResults, name: str, joint: JointFaces) -> np.ndarray:
    """The point of a joint that is next to each corner of its polygons."""
    points = results.units.length * results.file[f"joints/{name}/x"][:]
    return cKDTree(points).query(joint.on_corners(results.x))[1]
