"""Picture of the spectra of records."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..picture_style import GREY, new_figure, save_figure
from ..response_spectrum import GRAVITY, response_spectrum
from .record import Record

PERIODS = np.geomspace(0.03, 5.0, 160)  # [s]


def plot_spectra(
    path: Path,
    records: dict[str, Record],
    target: Callable[[np.ndarray], np.ndarray] | None,
) -> Path:
    """5 % spectra of all components, and the target [g] where there is one."""
    figure, axis = new_figure(1, width=6.5, row_height=3.6)
    axis = np.atleast_1d(axis)[0]
    if target:
        axis.plot(PERIODS, target(PERIODS), color=GREY, lw=2.2, label="design spectrum")
    for name, record in records.items():
        spectrum = response_spectrum(record.acceleration, record.dt, PERIODS) / GRAVITY
        axis.plot(PERIODS, spectrum, label=f"{name}: {record.name}")
    axis.set_xscale("log")
    ticks = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_xlabel("period [s]")
    axis.set_ylabel("spectral acceleration, 5 % [g]")
    axis.set_ylim(bottom=0.0)
    axis.legend()
    return save_figure(figure, path)
