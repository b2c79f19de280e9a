"""Writing ground motions: files for *AMPLITUDE, a summary, a picture of spectra."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .ground_motion import Motion
from .picture_style import GREY, new_figure, save_figure
from .response_spectrum import GRAVITY


def write_amplitude(path: Path, acceleration: np.ndarray, dt: float, layout: str) -> None:
    """Acceleration [m/s2] for *AMPLITUDE, FORMAT=VALUES (one a line) or PAIRS (time, value)."""
    with path.open("w") as file:
        for n, value in enumerate(acceleration):
            start = f"{n * dt:.10g}, " if layout == "PAIRS" else ""
            file.write(f"{start}{value:.12e}\n")


def write_summary(path: Path, motions: dict[str, Motion], facts: dict) -> None:
    """Seed, options and misfits as JSON."""
    misfits = {
        name: {
            "mean_misfit": round(motion.mean_misfit, 6),
            "largest_misfit": round(float(np.abs(motion.misfit).max()), 6),
        }
        for name, motion in motions.items()
    }
    path.write_text(json.dumps({**facts, "components": misfits}, indent=2) + "\n")


def plot_spectra(path: Path, motions: dict[str, Motion], peaks: dict[str, float]) -> Path:
    """5 % spectra against their targets, one panel a component."""
    figure, axes = new_figure(1, width=10.0, row_height=3.0, columns=len(motions), sharey=True)
    for axis, (name, motion) in zip(np.atleast_1d(axes), motions.items(), strict=True):
        scale = peaks[name] / GRAVITY
        axis.plot(motion.period, scale * motion.target, color=GREY, lw=2.2, label="target")
        axis.plot(motion.period, scale * motion.spectrum, label="record")
        worst = 100.0 * np.abs(motion.misfit).max()
        axis.set_title(f"Component {name}")
        axis.text(
            0.97,
            0.97,
            f"misfit: mean {100.0 * motion.mean_misfit:.1f} %, largest {worst:.1f} %",
            transform=axis.transAxes,
            ha="right",
            va="top",
            fontsize=8.5,
        )
        axis.set_xscale("log")
        axis.set_xticks([0.05, 0.1, 0.2, 0.5, 1.0, 2.0], ["0.05", "0.1", "0.2", "0.5", "1", "2"])
        axis.set_xlabel("period [s]")
        axis.legend(loc="lower left")
    axes = np.atleast_1d(axes)
    axes[0].set_ylabel("spectral acceleration, 5 % [g]")
    axes[0].set_ylim(bottom=0.0, top=1.15 * axes[0].get_ylim()[1])
    return save_figure(figure, path)
