"""The pictures of the page: both dams as the paper shows them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..colour_scale import Scales
from ..dam_views import Faces
from ..picture_style import COLOURS, Sheet, headline, new_figure
from ..pictures_damage import plot_mean_envelope
from ..pictures_faces import plot_envelope, plot_face_openings
from ..pictures_joints import plot_joint_areas
from ..render_dam import View
from ..results import Step
from ..shared_scales import shared_scales
from ..si_results import SiResults
from .facts import Facts
from .openings import plot_histories, plot_profiles

STRENGTH = 2.48  # f_t of Table 1 [MPa]
OUTLET_HEIGHTS, HALF_BLOCK = (190.0, 270.0), 45.0  # [m] around piers and corbel


def xingbiling_pictures(runs: dict[str, SiResults], folder: Path) -> dict[str, list[Path]]:
    """Figs. 8 to 10: envelopes of all joint models in the same colours; openings by height."""
    scales = shared_scales(list(runs.values()), Scales())
    found: dict[str, list[Path]] = {"fig8": [], "fig9": [], "fig10": []}
    for label, results in runs.items():
        faces = Faces(results)
        step = _last(results)
        for key, name in (("fig8", "S1"), ("fig9", "S3")):
            sheet = _sheet(results, folder, name.lower(), label)
            found[key] += plot_envelope(faces, step, name, scales, sheet)
        sheet = _sheet(results, folder, "opening", label)
        found["fig10"] += plot_face_openings(faces, step, scales, sheet)
    first = next(iter(runs.values()))
    sheet = _sheet(first, folder, "profiles", "all joint models")
    found["profiles"] = plot_profiles(runs, replace(sheet, path=folder / "xingbiling_profiles"))
    found["histories"] = plot_histories(first, _sheet(first, folder, "histories"))
    return found


def jinping_pictures(results: SiResults, folder: Path, has_outlets: bool) -> dict[str, list[Path]]:
    """Figs. 13 to 15 of one run."""
    faces, step = Faces(results), _last(results)
    scales = Scales(levels={"S1": STRENGTH})

    def on(name: str) -> Sheet:
        return _sheet(results, folder, name)

    found: dict[str, list[Path]] = {"fig13": [], "fig15": []}
    for name in ("S1", "S1_POINT", "S3", "S3_POINT"):
        if name in step.envelopes:
            found["fig13"] += plot_envelope(faces, step, name, scales, on(name.lower()))
    found["fig14"] = plot_face_openings(faces, step, scales, on("opening"))
    found["fig14"] += plot_joint_areas(results, step, scales, on("opening_joints"))
    found["fig14"] += plot_profiles({results.job: results}, on("profiles"))
    found["histories"] = plot_histories(results, on("histories"))
    if "DAMAGET" in step.means:
        found["fig15"] += plot_mean_envelope(faces, step, "DAMAGET", scales, on("damage"))
        ends = replace_views(faces, {"From above": 89.9, "From below": -89.9})
        found["fig15"] += plot_mean_envelope(ends, step, "DAMAGET", scales, on("damage_ends"))
        if has_outlets:
            near, sheet = near_outlets(faces), on("damage_outlets")
            found["fig15"] += plot_mean_envelope(near, step, "DAMAGET", scales, sheet)
    return found


def replace_views(faces: Faces, elevations: dict[str, float]) -> Faces:
    """The dam from its downstream side at other elevations [deg]."""
    changed = Faces(faces.results)
    towards = list(faces.views.values())[-1].towards
    changed.views = {
        title: View.from_direction(towards, angle) for title, angle in elevations.items()
    }
    return changed


class Part(Faces):
    """A part of the dam, without the lines of joints: they would go on beyond the part."""

    def joint_lines(self, *_: object) -> None:
        """No lines."""


def near_outlets(faces: Faces) -> Faces:
    """The part of the dam around the outlets of keyway_tools.jinping, seen from aside."""
    results, cells = faces.results, faces.cells
    centre = results.x[cells].mean(axis=1)
    low, high = OUTLET_HEIGHTS
    inside = (np.abs(centre[:, 0]) < HALF_BLOCK) & (centre[:, 2] > low) & (centre[:, 2] < high)
    part = Part(results)
    part.elements = faces.elements[inside]
    part.cells = results.connectivity[part.elements]
    part.nodes = np.unique(part.cells)
    part.views = {
        title: View.from_direction(view.towards + 0.5 * view.right, 25.0)
        for title, view in faces.views.items()
    }
    return part


def plot_factor(factor: str, cases: list[Facts], values: list[str], sheet: Sheet) -> list[Path]:
    """What one factor changes: openings, stresses at points, damaged volume."""
    stress = "at points" if cases[0].value("S1_POINT") is not None else "at nodes"
    tension, compression = ("S1_POINT", "S3_POINT") if stress == "at points" else ("S1", "S3")
    bars = {
        "largest opening [mm]": [1e3 * (one.value("OPENING") or 0.0) for one in cases],
        f"tension {stress} [MPa]": [1e-6 * one.value_or_nan(tension) for one in cases],
        f"compression {stress} [MPa]": [-1e-6 * one.value_or_nan(compression) for one in cases],
    }
    if any(one.damaged for one in cases):
        bars["damaged volume [1000 m³]"] = [1e-3 * one.damaged.get("all", 0.0) for one in cases]
    if all(one.moved is not None for one in cases):
        bars["crest moved for good [mm]"] = [1e3 * (one.moved or 0.0) for one in cases]
    figure, axes = new_figure(1, width=3.3 * len(bars), row_height=0.45 * len(cases) + 1.6,
                              columns=len(bars), sharey=True)  # fmt: skip
    for axis, (label, sizes) in zip(axes, bars.items(), strict=True):
        colours = [COLOURS[1] if value == "as it is" else COLOURS[0] for value in values]
        drawn = axis.barh(values, sizes, color=colours)
        written = ["not printed" if np.isnan(size) else f"{size:.3g}" for size in sizes]
        axis.bar_label(drawn, written, padding=2, fontsize=10)
        axis.set_xlabel(label)
        axis.margins(x=0.25)
        axis.grid(axis="y", visible=False)
    axes[0].invert_yaxis()
    headline(figure, factor.capitalize())
    return sheet.save(figure)


def _last(results: SiResults) -> Step:
    return [step for step in results.steps() if step.envelopes][-1]


def _sheet(results: SiResults, folder: Path, name: str, label: str = "") -> Sheet:
    note = " · ".join(word for word in (label, results.note) if word)
    return Sheet(folder / f"{results.job}_{name}", ("png",), note)
