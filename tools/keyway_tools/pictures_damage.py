"""Damage on the faces of a body, and its damaged elements inside a transparent body.

Damage is averaged over elements: at nodes, a crack one element wide would show half its damage.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .colour_scale import FIELDS, Scales
from .dam_views import Faces
from .picture_style import Sheet
from .pictures_faces import Drawing, Mark, compose, place_of
from .render_dam import Paint, render_views, solid_grid
from .results import Step

# Energy in job.json, keyword and word of each kind of damage
DISSIPATED = {
    "DAMAGET": ("cracking", "TENSION", "cracked"),
    "DAMAGEC": ("crushing", "COMPRESSION", "been crushed"),
}
VISIBLE = 0.05  # elements of less mean damage are not drawn


def plot_mean_envelope(
    faces: Faces, step: Step, name: str, scales: Scales, sheet: Sheet
) -> list[Path]:
    """The largest mean damage of the elements over a step, on every view."""
    field = FIELDS[name]
    damage = step.means[name]
    limits = scales.limits(name, damage)
    body = faces.grid()
    body.cell_data["value"] = damage[faces.elements]
    paint = Paint(None, limits.ends, field.colours, limits.bands)
    pictures = render_views(faces.views, body, paint, faces.joint_lines())
    heading = f"{field.label} over step {step.name}\n"
    heading += worst_element(faces, damage, name)
    label = f"{field.label.lower()}, element mean"
    return compose(Drawing(pictures, limits, field.colours, label, heading), sheet)


def worst_element(faces: Faces, damage: np.ndarray, name: str) -> str:
    """The most damaged element of the drawn part in words. Concrete may crack without a damage
    variable: then the law keeps its stiffness."""
    results = faces.results
    worst = faces.elements[damage[faces.elements].argmax()]
    if damage[worst] <= 0.0:
        elsewhere = float(np.nanmax(damage, initial=0.0))
        if elsewhere > 0.0:
            return f"no damage in the part that is drawn, elsewhere up to {elsewhere:.3g}"
        what, kind, verb = DISSIPATED[name]
        summary = results.summary if results.path(".json").exists() else {}
        energy = summary.get("damage", {}).get("dissipated", {}).get(what, 0.0)
        return (
            f"0, though solids have {verb}: see *CONCRETE {kind} DAMAGE" if energy else "no damage"
        )
    where = place_of(results.x[results.connectivity[worst]].mean(axis=0), faces.size)
    return f"extreme {damage[worst]:.3g} in element {results.element_id[worst]}, centre {where}"


def plot_damaged_elements(faces: Faces, scales: Scales, sheet: Sheet) -> list[Path]:
    """Mean damage in tension of the damaged elements, at the last saved time."""
    results = faces.results
    found = results.damage("DAMAGET")
    if found is None:
        return []
    time, damage = found
    shown = np.flatnonzero(damage >= VISIBLE)
    shown = shown[np.isin(shown, results.solids)]
    if shown.size == 0:
        return []
    limits = scales.limits("DAMAGET", damage)
    colours = FIELDS["DAMAGET"].colours
    cells, wire = solid_grid(results.x, results.connectivity[shown]), faces.surface()
    cells.cell_data["value"] = damage[shown]
    paint = Paint(None, limits.ends, colours, limits.bands)
    pictures = render_views(faces.views, cells, paint, faces.joint_lines(), wire)
    heading = f"Damaged elements at t = {time:.5g} s: {shown.size} above {VISIBLE:g}\n"
    heading += worst_element(faces, damage, "DAMAGET")
    worst = results.connectivity[shown[damage[shown].argmax()]]
    centre, text = results.x[worst].mean(axis=0), f"{damage[shown].max():.3g}"
    marks = {title: Mark(view.project(centre), text) for title, view in faces.views.items()}
    label = "damage in tension, element mean"
    return compose(Drawing(pictures, limits, colours, label, heading, marks), sheet)
