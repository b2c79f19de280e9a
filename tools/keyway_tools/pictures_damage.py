"""Damage on the faces of a body, and its damaged elements inside a transparent body.

Damage is averaged over elements: at nodes, a crack one element wide would show half its damage.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .pictures_faces import FIELDS, Faces, compose, nice_limits
from .render_dam import render, solid_grid
from .results import Step

VISIBLE = 0.05  # elements of less mean damage are not drawn


def plot_mean_envelope(faces: Faces, step: Step, name: str, path: Path) -> Path:
    """The largest mean damage of the elements over a step, on every view."""
    field, results = FIELDS[name], faces.results
    damage = step.means[name]
    limits = nice_limits(damage, field)
    body = faces.grid()
    body.cell_data["value"] = damage[results.dam]
    pictures = {
        title: render(
            body, view, None, (limits[0], limits[-1]), field.colours, faces.joint_lines(),
            bands=len(limits) - 1,
        )
        for title, view in faces.views.items()
    }  # fmt: skip
    heading = f"{field.label} over step {step.name.title()}: {damage[results.dam].max():.3g}"
    label = f"{field.label.lower()}, element mean"
    return compose(pictures, limits, field.colours, label, heading, {}, path)


def plot_damaged_elements(faces: Faces, path: Path) -> Path | None:
    """Mean damage in tension of the damaged elements, at the last saved time."""
    results = faces.results
    found = results.damage("DAMAGET")
    if found is None:
        return None
    time, damage = found
    shown = np.flatnonzero(damage >= VISIBLE)
    shown = shown[np.isin(shown, results.solids)]
    if shown.size == 0:
        return None
    limits = nice_limits(damage, FIELDS["DAMAGET"])
    colours = FIELDS["DAMAGET"].colours
    cells, wire = solid_grid(results.x, results.connectivity[shown]), faces.surface()
    cells.cell_data["value"] = damage[shown]
    pictures = {
        title: render(
            cells, view, None, (limits[0], limits[-1]), colours, faces.joint_lines(), wire,
            bands=len(limits) - 1,
        )
        for title, view in faces.views.items()
    }  # fmt: skip
    heading = f"Damaged elements at t = {time:.2f} s: {shown.size} above {VISIBLE:g}"
    return compose(pictures, limits, colours, "damage in tension, element mean", heading, {}, path)
