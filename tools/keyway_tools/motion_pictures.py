"""Picture of accelerograms: acceleration, velocity and displacement in time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid

from .picture_style import new_figure, save_figure
from .response_spectrum import GRAVITY


@dataclass(frozen=True)
class Accelerogram:
    """A component of a motion."""

    title: str
    acceleration: np.ndarray  # [m/s2]
    dt: float  # [s]

    def curves(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Acceleration [g], velocity [m/s], displacement [m]."""
        velocity = cumulative_trapezoid(self.acceleration, dx=self.dt, initial=0.0)
        displacement = cumulative_trapezoid(velocity, dx=self.dt, initial=0.0)
        return self.acceleration / GRAVITY, velocity, displacement


def plot_accelerograms(path: Path, motions: list[Accelerogram]) -> Path:
    """A column for each component."""
    figure, axes = new_figure(3, width=10.0, row_height=2.2, columns=len(motions), sharex=True)
    axes = np.asarray(axes).reshape(3, -1)
    for column, motion in enumerate(motions):
        time = motion.dt * np.arange(motion.acceleration.size)
        for axis, curve in zip(axes[:, column], motion.curves(), strict=True):
            axis.plot(time, curve, lw=0.9)
        axes[0, column].set_title(motion.title)
        axes[-1, column].set_xlabel("time [s]")
    labels = ("acceleration [g]", "velocity [m/s]", "displacement [m]")
    for axis, label in zip(axes[:, 0], labels, strict=True):
        axis.set_ylabel(label)
    figure.align_ylabels()
    return save_figure(figure, path)
