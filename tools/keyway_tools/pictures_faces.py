"""Envelopes on the dam's two faces."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import MaxNLocator

from .picture_style import GREY, new_figure, plt, save_figure
from .render_dam import View, render, solid_grid
from .results import Results, Step


@dataclass(frozen=True)
class Field:
    """How a field is shown."""

    label: str
    unit: str
    scale: float  # from SI to the unit
    colours: str  # perceptually even, dark where it matters, safe for the colour-blind
    sign: float = 1.0  # -1: the extreme is the smallest value
    top: float | None = None  # end of the scale, where it is not the extreme


FIELDS = {
    "S1": Field("Largest principal tension", "MPa", 1.0e-6, "magma_r"),
    "S3": Field("Largest principal compression", "MPa", 1.0e-6, "cividis", -1.0),
    "OPENING": Field("Largest joint opening", "mm", 1.0e3, "viridis_r"),
    "U": Field("Largest displacement", "mm", 1.0e3, "viridis_r"),
    "DAMAGET": Field("Largest damage in tension", "", 1.0, "magma_r", top=1.0),
    "DAMAGEC": Field("Largest damage in compression", "", 1.0, "cividis_r", top=1.0),
}


class Faces:
    """The dam's body and the views of it."""

    def __init__(self, results: Results):
        self.results = results
        self.cells = results.connectivity[results.dam]
        self.nodes = np.unique(self.cells)
        self.views = _views(results, self.nodes)

    def grid(self, shift: np.ndarray | None = None) -> pv.UnstructuredGrid:
        """The body, displaced by `shift` on all nodes."""
        x = self.results.x if shift is None else self.results.x + shift
        return solid_grid(x, self.cells)

    def surface(self) -> pv.PolyData:
        """The skin of the body at rest."""
        return self.grid().extract_surface(algorithm="dataset_surface")

    def joint_lines(
        self, shift: np.ndarray | None = None, values: np.ndarray | None = None
    ) -> pv.PolyData | None:
        """Lines where the joints meet the faces; given values of all nodes become 'value'."""
        x = self.results.x if shift is None else self.results.x + shift
        parts = []
        for name in self.results.joint_names():
            joint = self.results.joint_faces(name)
            if joint is None or len(joint.facets) == 0:
                continue
            nodes, place = np.unique(joint.facets, return_inverse=True)
            place = place.reshape(joint.facets.shape)
            faces = np.hstack([np.full((len(place), 1), 4), place])
            part = pv.PolyData(x[nodes].astype(float), faces.ravel())
            if values is not None:
                part["value"] = values[nodes]
            parts.append(part.extract_feature_edges(feature_edges=False))
        return pv.merge(parts) if parts else None


def _views(results: Results, nodes: np.ndarray) -> dict[str, View]:
    """Views from upstream and downstream if the deck has a reservoir, else one view."""
    x = results.x[nodes]
    upstream, downstream = results.face_flags("upstream"), results.face_flags("downstream")
    if not upstream.any():
        flat = np.ptp(x, axis=0)
        sideways = 0.55 if flat[1] > 0.2 * flat[0] else 0.12
        return {"": View.from_direction(np.array([sideways, -1.0, 0.0]), 18.0)}
    other = results.x[downstream] if downstream.any() else x
    towards = results.x[upstream].mean(axis=0) - other.mean(axis=0)
    view = View.from_direction(towards, 12.0)
    if np.ptp(x @ view.right) < 0.5 * np.ptp(x @ view.towards):  # a slice: its side shows more
        return {
            "": View.from_direction(view.right + 0.12 * towards / np.linalg.norm(towards), 12.0)
        }
    return {"Upstream face": view, "Downstream face": View.from_direction(-towards, 12.0)}


def nice_limits(values: np.ndarray, field: Field) -> np.ndarray:
    """Round borders of the colour bands from zero to beyond the extreme."""
    extreme = field.top or np.nanmax(field.sign * values)
    extreme = extreme if extreme > 0.0 else 1.0
    ticks = MaxNLocator(nbins=12, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, extreme)
    step = ticks[1] - ticks[0]
    ticks = ticks[(ticks > -0.5 * step) & (ticks < extreme * (1.0 - 1e-9) + step)]
    return ticks if field.sign > 0.0 else -ticks[::-1]


def plot_envelope(faces: Faces, step: Step, name: str, path: Path) -> Path:
    """One field's envelope over a step, on every view."""
    field = FIELDS[name]
    values = field.scale * step.envelopes[name]
    limits = nice_limits(values[faces.nodes], field)
    place = faces.nodes[np.nanargmax(field.sign * values[faces.nodes])]
    when = faces.results.envelope_time(step, name)[place]
    heading = f"{field.label} over step {step.name.title()}"
    extreme = f"extreme {values[place]:.3g} {field.unit}".rstrip() + f" at t = {when:.2f} s"
    lines = faces.joint_lines()
    pictures = {
        title: render(
            faces.grid(), view, values, (limits[0], limits[-1]), field.colours, lines,
            bands=len(limits) - 1,
        )
        for title, view in faces.views.items()
    }  # fmt: skip
    mark = {title: view.project(faces.results.x[place]) for title, view in faces.views.items()}
    visible = _visible_on(faces, place)
    mark = {title: at for title, at in mark.items() if not title or title in visible}
    label = field.label.lower() + (f" [{field.unit}]" if field.unit else "")
    return compose(pictures, limits, field.colours, label, f"{heading}: {extreme}", mark, path)


def _visible_on(faces: Faces, node: int) -> set[str]:
    """The views that show a node."""
    shown = set()
    for title, flag in (("Upstream face", "upstream"), ("Downstream face", "downstream")):
        if faces.results.face_flags(flag)[node]:
            shown.add(title)
    return shown


def compose(pictures, limits, colours, label, heading, mark, path: Path) -> Path:
    """Images side by side with one colour bar and a bar for the length."""
    count = len(pictures)
    shape = max(p.image.shape[0] / p.image.shape[1] for p in pictures.values())
    width = 6.2 if count > 1 else 8.0
    figure, axes = new_figure(
        1, width=width * count, row_height=width * shape + 0.9, columns=count, squeeze=False
    )
    for axis, (title, picture) in zip(axes[0], pictures.items(), strict=True):
        axis.imshow(picture.image, extent=picture.extent, interpolation="antialiased")
        axis.set_axis_off()
        axis.set_title(title)
        _scale_bar(axis, picture.extent)
        if title in mark:
            axis.plot(*mark[title], marker="o", ms=11, mfc="none", mec="#00A0C0", mew=2.0)
    norm = BoundaryNorm(limits, plt.get_cmap(colours).N)
    bar = figure.colorbar(
        ScalarMappable(norm, colours), ax=axes[0].tolist(), location="bottom",
        shrink=0.6 / max(1.0, 0.5 * count), aspect=45, ticks=limits, spacing="proportional",
    )  # fmt: skip
    bar.set_label(label)
    bar.outline.set_visible(False)
    figure.suptitle(heading, x=0.01, ha="left", fontsize=12, fontweight="bold")
    return save_figure(figure, path)


def _scale_bar(axis, extent) -> None:
    """A bar of a round length in the lower left corner."""
    width = extent[1] - extent[0]
    length = MaxNLocator(nbins=1, steps=[1, 2, 5, 10]).tick_values(0.0, 0.15 * width)[1]
    left, bottom = extent[0] + 0.03 * width, extent[2] + 0.02 * width
    axis.plot([left, left + length], [bottom, bottom], color=GREY, lw=3.0, solid_capstyle="butt")
    text = f"{length:g} m"
    axis.text(
        left + length / 2.0, bottom + 0.012 * width, text, color=GREY, ha="center", va="bottom"
    )


def plot_face_openings(faces: Faces, step: Step, path: Path) -> Path | None:
    """Largest opening along the lines where the joints meet the faces."""
    field = FIELDS["OPENING"]
    values = np.nan_to_num(field.scale * step.envelopes["OPENING"])
    lines = faces.joint_lines(values=values)
    if lines is None or values.max() <= 0.0:
        return None
    limits = nice_limits(values, field)
    pictures = {
        title: render(
            faces.grid(), view, None, (limits[0], limits[-1]), field.colours, lines,
            bands=len(limits) - 1,
        )
        for title, view in faces.views.items()
    }  # fmt: skip
    place = int(values.argmax())
    mark = {
        title: view.project(faces.results.x[place])
        for title, view in faces.views.items()
        if not title or title in _visible_on(faces, place)
    }
    when = faces.results.envelope_time(step, "OPENING")[place]
    heading = f"{field.label} over step {step.name.title()}: "
    heading += f"extreme {values[place]:.3g} mm at t = {when:.2f} s"
    return compose(pictures, limits, field.colours, "largest opening [mm]", heading, mark, path)
