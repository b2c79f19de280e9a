"""The result of a study: a table (CSV), a picture and one HTML page that needs no other file."""

from __future__ import annotations

import base64
import csv
import io
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from keyway_tools.picture_style import GREY, new_figure

from .effects import change_in_words
from .errors import TARGETS, Error, choices_of, singular_place
from .ladder import Outcome
from .measured import QUANTITIES

COLOURS = {
    "base": "#111111", "increment": "#1f5fa8", "mesh": "#b3401f", "element": "#d98a1b",
    "tolerance": "#3f8f4f", "alpha": "#7a4fa0", "stiffness": "#777777", "solver": "#159a9a",
}  # fmt: skip
NAMES = {
    "displacement": "largest displacement", "stress": "S1 exceeded in 1 % of the dam's volume",
    "opening": "largest opening", "damage": "energy of cracking", "frequency": "first frequency",
}  # fmt: skip
STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;margin:1rem 0}
td,th{padding:.25rem .7rem;border-bottom:1px solid #ccc;text-align:right}
td:first-child,th:first-child{text-align:left}img{max-width:100%}
.note{color:#555;font-size:.9em}
"""


def write_table(path: Path, outcomes: list[Outcome], errors: list[Error]) -> None:
    """All rungs with their numbers and errors."""
    base = outcomes[0].measured
    assert base
    head = ["rung", "axis", "predicted_s", "seconds", "memory_mb", "unknowns", "increments",
            "cutbacks", *QUANTITIES, "largest_S1", *[f"error_{e.quantity}" for e in errors],
            "why_not"]  # fmt: skip
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for outcome in outcomes:
            found = outcome.measured
            numbers = [""] * 5
            if found:
                numbers = [found.seconds, found.memory, found.unknowns, found.increments,
                           found.cutbacks]  # fmt: skip
            writer.writerow([
                outcome.name, outcome.rung.axis,
                "" if outcome.predicted is None else f"{outcome.predicted:.3g}", *numbers,
                *[found.values.get(q, "") if found else "" for q in QUANTITIES],
                found.peak if found else "",
                *["" if e is None else f"{e:.4g}" for e in (own_error(x, outcome) for x in errors)],
                outcome.why_not,
            ])  # fmt: skip


def own_error(error: Error, outcome: Outcome) -> float | None:
    """The total error of a rung: the other axes are those of the deck as it is."""
    base = "the deck as it is"
    axis = outcome.rung.axis
    if not outcome.measured:
        return None
    if axis in ("base", "increment"):
        return error.total(outcome.name, base)
    if axis in ("mesh", "element"):
        return error.total(base, outcome.name)
    return None


def draw(outcomes: list[Outcome], errors: list[Error]) -> bytes:
    """Error over seconds for each quantity, the efficient rungs joined by a line; PNG.

    Empty without a refined mesh: the errors of the mesh are not known then.
    """
    if not any(error.mesh for error in errors):
        return b""
    columns = min(2, len(errors))
    rows = -(-len(errors) // columns)
    figure, axes = new_figure(rows, 6.4 * columns, 4.2, columns, squeeze=False)
    for axis in axes.ravel()[len(errors) :]:
        axis.set_axis_off()
    for axis, error in zip(axes.ravel(), errors, strict=False):
        draw_one(axis, outcomes, error)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    plt.close(figure)
    return buffer.getvalue()


def draw_one(axis, outcomes: list[Outcome], error: Error) -> None:
    points = []
    for outcome in outcomes:
        total = own_error(error, outcome)
        if total is None or not outcome.measured:
            continue
        points.append((outcome.measured.seconds, max(100.0 * total, 1e-3), outcome))
    points.sort(key=lambda point: point[0])
    front, least = [], float("inf")
    for seconds, size, _ in points:
        if size < least:
            least = size
            front.append((seconds, size))
    axis.plot(*zip(*front, strict=True), color=GREY, alpha=0.4, linewidth=3, zorder=1)
    for seconds, size, outcome in points:
        axis.scatter(seconds, size, s=50, color=COLOURS[outcome.rung.axis], zorder=2)
        axis.annotate(outcome.name, (seconds, size), xytext=(5, 4), textcoords="offset points",
                      fontsize=8)  # fmt: skip
    axis.set(xscale="log", yscale="log", xlabel="seconds", ylabel="error [%]")
    axis.set_title(NAMES[error.quantity], fontsize=11)
    for line in (axis.xaxis, axis.yaxis):
        line.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        line.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        line.set_minor_formatter(NullFormatter())
    axis.margins(0.25)


def sentences(outcomes: list[Outcome], errors: list[Error]) -> list[str]:
    """What to choose, in words."""
    found = []
    for error in errors:
        base = error.total("the deck as it is", "the deck as it is")
        seconds = outcomes[0].measured.seconds  # type: ignore[union-attr]
        name = NAMES[error.quantity]
        if not error.mesh:
            found.append(
                f"{name}: the error of the mesh is not known, as no refined mesh was run. "
                f"The increment alone leaves {100 * error.time['the deck as it is']:.2g} %."
            )
            continue
        assert base is not None
        if base > 1.0:
            found.append(f"{name}: does not converge on this ladder; {error.limit:.3g} is a guess.")
            continue
        found.append(
            f"{name}: your deck has an error of about {100 * base:.2g} % (increment "
            f"{100 * error.time['the deck as it is']:.2g} %, mesh "
            f"{100 * error.mesh['the deck as it is']:.2g} %, iteration "
            f"{100 * error.iteration:.1g} %) and takes {seconds:.3g} s. The limit "
            f"{error.limit:.4g} itself is known to {100 * error.uncertainty:.2g} %."
        )
        for target, choice in zip(TARGETS, choices_of(error, outcomes), strict=True):
            if choice is None:
                found.append(f"— {100 * target:g} %: beyond this ladder.")
                continue
            parts = [
                part for part in (choice.increment, choice.mesh) if part != "the deck as it is"
            ]
            what = " with ".join(parts) if parts else "the deck as it is"
            was_run = len(parts) < 2
            found.append(
                f"— {100 * target:g} %: {what}, about {choice.seconds:.3g} s"
                f"{'' if was_run else ' (predicted)'}."
            )
    found += other_changes(outcomes)
    place = singular_place(outcomes)
    if place:
        x = ", ".join(f"{value:.4g}" for value in place[0])
        found.append(
            f"The largest S1 anywhere, at ({x}), grows by {100 * (place[1] - 1):.0f} % when the "
            "mesh is refined: a singular place, as in a re-entrant corner. No mesh gives its value."
        )
    return found


def other_changes(outcomes: list[Outcome]) -> list[str]:
    """What tolerances, ALPHA, stiffness of joints and solvers change."""
    base = outcomes[0].measured
    assert base
    found = []
    for outcome in outcomes:
        if outcome.rung.axis not in ("tolerance", "alpha", "stiffness", "solver"):
            continue
        if not outcome.measured:
            found.append(f"{outcome.name}: {outcome.why_not}.")
            continue
        parts = [
            f"{NAMES[name]} {100 * (outcome.measured.values[name] / value - 1):+.2g} %"
            for name, value in base.values.items()
            if value and name in outcome.measured.values
        ]
        time = outcome.measured.seconds / base.seconds
        found.append(f"{outcome.name} changes: {', '.join(parts)}; {time:.2g} times the time.")
    return found


def table_of_rungs(outcomes: list[Outcome], errors: list[Error]) -> str:
    """All rungs as an HTML table."""
    head = ["rung", "predicted [s]", "seconds", "unknowns", *[NAMES[e.quantity] for e in errors],
            *[f"error of {e.quantity}" for e in errors]]  # fmt: skip
    rows = []
    for outcome in outcomes:
        found = outcome.measured
        cells = [outcome.name, "" if outcome.predicted is None else f"{outcome.predicted:.3g}"]
        if found:
            cells += [f"{found.seconds:.3g}", str(found.unknowns)]
            cells += [f"{found.values.get(e.quantity, float('nan')):.4g}" for e in errors]
            own = [own_error(e, outcome) for e in errors]
            cells += ["" if e is None else f"{100 * e:.2g} %" for e in own]
        else:
            cells.append(outcome.why_not)
        rows.append(cells)
    return html_table(head, rows)


def html_table(head: list[str], rows: list[list[str]]) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])


def accuracy_page(deck: Path, version: str, outcomes: list[Outcome], errors: list[Error]) -> str:
    """The page of a ladder."""
    picture = base64.b64encode(draw(outcomes, errors)).decode()
    image = f'<img alt="errors over seconds" src="data:image/png;base64,{picture}">'
    items = "".join(f"<p>{escape(line)}</p>" for line in sentences(outcomes, errors))
    body = (
        f"<p class=note>{escape(version)}</p>{items}"
        f"{image if picture else ''}"
        "<p class=note>Seconds are wall times of whole runs without output. Errors: increments "
        "against their extrapolated limit; meshes and elements against the extrapolations of first "
        "and second order from one refinement, whichever is farther. Both are added and "
        "multiplied by 1.25 (Roache 1994).</p>" + table_of_rungs(outcomes, errors)
    )
    return page(f"What accuracy costs: {deck.name}", body)


def effects_page(deck: Path, version: str, outcomes: list[Outcome]) -> str:
    """The page of the effects."""
    items = "".join(f"<p>{escape(line)}</p>" for line in effect_sentences(outcomes))
    head = ["effects", "seconds", *[NAMES[q] for q in QUANTITIES]]
    rows = [
        [o.name, f"{o.measured.seconds:.3g}", *[f"{o.measured.values[q]:.4g}" if q in
         o.measured.values else "-" for q in QUANTITIES]]
        if o.measured else [o.name, o.why_not] for o in outcomes
    ]  # fmt: skip
    body = f"<p class=note>{escape(version)}</p>{items}{html_table(head, rows)}"
    return page(f"What each effect changes: {deck.name}", body)


def effect_sentences(outcomes: list[Outcome]) -> list[str]:
    """What each effect changes in the results, and what it costs."""
    base = outcomes[0].measured
    assert base
    lines = []
    for outcome in outcomes[1:]:
        if not outcome.measured:
            lines.append(f"{outcome.name}: {outcome.why_not}.")
            continue
        changes = {
            name: outcome.measured.values.get(name, 0.0) / value - 1.0
            for name, value in base.values.items() if value
        }  # fmt: skip
        lines.append(
            change_in_words(outcome.name, changes, 1.0 - outcome.measured.seconds / base.seconds)
        )
    return lines


def page(title: str, body: str) -> str:
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style><h1>{escape(title)}</h1>{body}</html>\n"
    )
