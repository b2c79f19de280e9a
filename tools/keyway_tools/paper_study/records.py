"""The largest opening under many records: its distribution, and what the reduced model says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..picture_style import COLOURS, Sheet, headline, new_figure
from .facts import FACES, Facts

FRACTILES = (0.16, 0.50, 0.84)


def openings_of(cases: list[Facts]) -> dict[str, np.ndarray]:
    """Sorted largest openings of the finished records, by face [mm]."""
    found = {}
    for face in FACES:
        largest = [max(joint[face] for joint in one.openings.values()) for one in cases]
        found[face] = 1e3 * np.sort(largest)
    return found


def plot_fractiles(cases: list[Facts], sheet: Sheet) -> list[Path]:
    """Share of the records whose largest opening is at most that of the axis."""
    figure, axis = new_figure(1, width=9.0, row_height=4.5)
    share = (np.arange(len(cases)) + 0.5) / len(cases)
    for (face, values), colour in zip(openings_of(cases).items(), COLOURS, strict=False):
        axis.step(values, share, where="post", color=colour, label=f"{face} face")
        for fractile in FRACTILES:
            value = np.quantile(values, fractile)
            axis.plot(value, fractile, "o", color=colour)
            axis.annotate(f"{value:.3g} mm", (value, fractile), xytext=(8, -12),
                          textcoords="offset points", color=colour)  # fmt: skip
    for fractile in FRACTILES:
        axis.axhline(fractile, color="0.7", lw=0.8, zorder=0)
    axis.set_xlabel("largest opening of any joint [mm]")
    axis.set_ylabel("share of the records")
    axis.set_ylim(0.0, 1.0)
    axis.legend(loc="lower right")
    headline(figure, f"Largest joint opening under {len(cases)} records of one spectrum")
    return sheet.save(figure)


def sentences(cases: list[Facts]) -> list[str]:
    """What the records say, from the numbers."""
    found = []
    for face, values in openings_of(cases).items():
        low, middle, high = (float(np.quantile(values, one)) for one in FRACTILES)
        found.append(
            f"{face.capitalize()} face: half of the records open joints by less than {middle:.3g} "
            f"mm; the fractiles of 16 % and 84 % are {low:.3g} and {high:.3g} mm, the largest of "
            f"{len(cases)} is {values[-1]:.3g} mm."
        )
    errors = [one.reduced_error for one in cases if one.reduced_error is not None]
    if errors:
        found.append(
            f"The reduced model estimates its error of openings as at most "
            f"{100.0 * max(errors):.2g} % of the largest, {100.0 * float(np.median(errors)):.2g} % "
            "in half of the records."
        )
    seconds = [one.wall_s for one in cases if one.wall_s]
    if seconds:
        found.append(f"A record takes {float(np.median(seconds)):.3g} s (median).")
    return found
