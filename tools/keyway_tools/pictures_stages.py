"""The construction of a dam: what is there in each stage, and which joints are grouted."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import fill

import numpy as np
import pyvista as pv
from matplotlib.colors import BoundaryNorm
from matplotlib.lines import Line2D
from scipy.spatial import cKDTree

from .dam_views import Faces, border_of
from .picture_style import Sheet, headline, hide_frame, new_figure, plt
from .render_dam import Paint, Picture, render
from .results import Results

MOST_PANELS = 12
COLUMNS = 4
COLOURS = "YlGnBu"
BAR = 0.9  # [inches] of the colour bar below the panels, with its label
TITLE_LETTERS = 38  # of a line above a panel
GROUT = re.compile(r"^\*GROUT, JOINT=(.*?),\s+PRESSURE=(\S+)$", re.M)  # as the log writes it
OPEN, GROUTED = (20, 20, 20), (213, 94, 0)  # lines of joints, red green blue


def plot_stages(faces: Faces, sheet: Sheet) -> list[Path]:
    """A panel for each step that adds or removes elements, or grouts a joint.

    Elements have the colour of the step in which they were added; absent ones are not drawn.
    """
    steps = changing_steps(faces.results)
    if not steps:
        return []
    steps = [steps[k] for k in np.unique(np.linspace(0, len(steps) - 1, MOST_PANELS).astype(int))]
    colours = plt.get_cmap(COLOURS, steps[-1])
    has_grouts = _has_grouts(faces.results)
    pictures = [_stage(faces, step, (0.5, steps[-1] + 0.5), has_grouts) for step in steps]
    columns = min(COLUMNS, len(steps))
    shape = max(p.image.shape[0] / p.image.shape[1] for p in pictures)
    figure, axes = new_figure(
        -(-len(steps) // columns), width=max(3.6 * columns, 7.0), row_height=3.6 * shape + 0.5,
        columns=columns, squeeze=False,
    )  # fmt: skip
    figure.set_figheight(figure.get_figheight() + BAR)
    for axis in axes.flat:
        hide_frame(axis)
    for axis, step, picture in zip(axes.flat, steps, pictures, strict=False):
        axis.imshow(picture.image, extent=picture.extent)
        title = f"step {step}: {faces.results.step_name(step)}"
        axis.set_title(fill(title, TITLE_LETTERS), fontsize=11)
    norm = BoundaryNorm(np.arange(0.5, steps[-1] + 1.0), steps[-1])
    shades = plt.cm.ScalarMappable(norm, colours)
    bar = figure.colorbar(
        shades, ax=axes.ravel().tolist(), location="bottom", shrink=0.7, aspect=40
    )
    bar.set_ticks(np.unique(np.linspace(1, steps[-1], min(steps[-1], 12)).astype(int)))
    bar.set_label("step in which an element was added")
    if has_grouts:
        lines = {"joint, not grouted": OPEN, "joint, grouted": GROUTED}
        handles = [
            Line2D([], [], color=np.array(rgb) / 255.0, lw=2.5, label=label)
            for label, rgb in lines.items()
        ]
        figure.legend(handles=handles, loc="outside lower left", ncols=2)
    headline(figure, "Stages of construction")
    return sheet.save(figure)


def changing_steps(results: Results) -> list[int]:
    """Numbers of the steps whose elements, or grouted points of joints, are new; the first too."""
    found, before = [], None
    for key in sorted(results.file["steps"]):
        step = int(key)
        now = (results.stage(step), *_grouted_points(results, step).values())
        if all(part is None for part in now):
            continue
        if before is None or any(
            a is not None and b is not None and (a > 0).tolist() != (b > 0).tolist()
            for a, b in zip(now, before, strict=True)
        ):
            found.append(step)
        before = now
    return found if len(found) > 1 else []


NOT_GROUTED, BONDED = 1, 2  # states of a point; without *GROUT it is bonded when it appears


def _states(results: Results, step: int) -> dict[str, np.ndarray | None]:
    """States of the points of each joint at the end of a step; None where not saved."""
    saved = results.file[f"steps/{step:04d}"].get("increments", {})
    saved = [group for _, group in sorted(saved.items()) if "joints" in group]
    found: dict[str, np.ndarray | None] = {}
    for name in results.joint_names():
        path = f"joints/{name}/grouted"
        known = saved and path in saved[-1]
        found[name] = saved[-1][path][:] if known else None
    return found


def _grouted_points(results: Results, step: int) -> dict[str, np.ndarray | None]:
    """1 for the points of each joint that are grouted at the end of a step, 0 for the others.

    Grout without pressure hardens at the start of its step: job.h5 shows it there. Grout with
    pressure hardens after the last increment: job.h5 shows it in the next step.
    """
    pressed = _pressed_joints(results, step)
    found: dict[str, np.ndarray | None] = {}
    for name, state in _states(results, step).items():
        if state is None:
            found[name] = None
            continue
        least = NOT_GROUTED if name.upper() in pressed else BONDED
        found[name] = (state >= least).astype(int)
    return found


def _pressed_joints(results: Results, step: int) -> set[str]:
    """Names, in capitals, of the joints that have *GROUT with PRESSURE in a step.

    The log has the deck with all defaults. Without a log there is no such joint: then grout with
    pressure is shown in the step after its own.
    """
    try:
        text = results.path(".log").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return set()
    steps = re.split(r"^\*STEP\b", re.split(r"^step ", text, maxsplit=1, flags=re.M)[0], flags=re.M)
    cards = GROUT.findall(steps[step]) if step < len(steps) else []
    return {joint.strip('"').upper() for joint, pressure in cards if float(pressure) > 0.0}


def _has_grouts(results: Results) -> bool:
    """Whether some joint waits for its grout in some step."""
    for key in results.file["steps"]:
        states = _states(results, int(key)).values()
        if any(state is not None and (state == NOT_GROUTED).any() for state in states):
            return True
    return False


def _stage(faces: Faces, step: int, ends: tuple[float, float], has_grouts: bool) -> Picture:
    """What is there in a step, inside the outline of the complete dam."""
    now = Faces(faces.results, step)
    body = now.grid()
    stage = faces.results.stage(step)
    values = np.ones(len(now.elements)) if stage is None else stage[now.elements]
    body.cell_data["value"] = values.astype(float)
    view = list(now.views.values())[-1]
    paint = Paint(None, ends, COLOURS, round(ends[1] - ends[0]))
    return render(body, view, paint, _lines(now, step, has_grouts), faces.surface())


def _lines(faces: Faces, step: int, has_grouts: bool) -> pv.PolyData | None:
    """Lines of the joints: those around grouted facets have a colour of their own."""
    parts = []
    for name, grouted in _grouted_points(faces.results, step).items():
        joint = faces.results.joint_faces(name)
        if joint is None:
            continue
        facets = joint.facets[np.isin(joint.facets, faces.nodes).all(axis=1)]
        done = np.zeros(len(facets), dtype=bool)
        if has_grouts and grouted is not None and len(facets):
            points = faces.results.units.length * faces.results.file[f"joints/{name}/x"][:]
            near = cKDTree(points).query(faces.results.x[facets].reshape(-1, 3))[1]
            done = grouted[near].reshape(-1, 4).all(axis=1)
        for chosen, rgb in ((facets[~done], OPEN), (facets[done], GROUTED)):
            if len(chosen):
                part = border_of(chosen, faces.results.x)
                part.cell_data["rgb"] = np.tile(np.array(rgb, dtype=np.uint8), (part.n_cells, 1))
                parts.append(part)
    return pv.merge(parts) if parts else None
