"""How time and memory grow with the unknowns, and with the points of joints."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cost_of_joints import write_dam
from measured_run import Program, Run
from scenes import INCREMENT, dam_of_size, write_deck

INCREMENTS = 10  # of a linear dam
JOINTED_INCREMENTS = 40
LINEAR = ("analyse [s]", "factor [s]", "solve [s]", "increment [s]", "whole [s]", "memory [MB]")
JOINTED = ("set-up [s]", "factor [s]", "solve [s]", "joints of an increment [s]", "memory [MB]")


@dataclass
class Growth:
    """Rows of measured values over a size."""

    name: str  # of the size
    heads: tuple[str, ...]
    size: list[int]
    values: list[list[float]]

    def exponents(self) -> list[float]:
        """Slopes of the values over the size, in logarithms."""
        if len(self.size) < 2:
            return []
        values = np.log(np.maximum(np.array(self.values), 1e-9))
        return np.polyfit(np.log(self.size), values, 1)[0].tolist()

    def table(self) -> str:
        lines = [f"| {self.name} | " + " | ".join(self.heads) + " |"]
        lines.append("|---" * (len(self.heads) + 1) + "|")
        rows = zip(map(str, self.size), self.values, strict=True)
        for name, values in [*rows, ("exponent", self.exponents())]:
            lines.append(f"| {name} | " + " | ".join(f"{v:.3g}" for v in values) + " |")
        return "\n".join(lines)


def mean_of(run: Run, pattern: str) -> float:
    """Seconds of a call."""
    seconds, calls = run.cost(pattern)
    return seconds / calls


def linear_row(program: Program, folder: Path, size: int) -> tuple[int, list[float]]:
    """A dam without joints: weight and water, then some increments without output."""
    mesh = dam_of_size(size)
    deck = write_deck(folder, f"scale_{size}", mesh, INCREMENTS * INCREMENT, has_envelopes=False)
    run = program.run(deck)
    once = sum(p["wall_s"] for p in run.parts if re.fullmatch(r"iterate structure", p["name"]))
    solve = mean_of(run, "solve structure")
    increment = solve + once / (INCREMENTS + 1)
    values = [mean_of(run, "analyse structure"), mean_of(run, "factor structure"), solve]
    whole, memory = run.results.find("ledger.wall_s"), run.results.find("ledger.peak_memory_mb")
    return run.unknowns, [*values, increment, whole, memory]


def jointed_row(program: Program, folder: Path, joints: int) -> tuple[int, list[float]]:
    """A dam with joints in a strong motion: what a run with it costs beyond its static step."""
    runs = [
        program.run(write_dam(folder, joints, INCREMENT * count))
        for count in (1, 1 + JOINTED_INCREMENTS)
    ]
    points = sum(joint["points"] for joint in runs[0].results.find("joints").values())
    pattern = r"(iterate|correct) JOINT\d+"
    steps = (runs[1].cost(pattern)[0] - runs[0].cost(pattern)[0]) / JOINTED_INCREMENTS
    set_up = runs[1].cost(r"condense JOINT\d+")[0] / 2.0
    solve = mean_of(runs[1], "solve (forward|backward) structure")
    memory = runs[1].results.find("ledger.peak_memory_mb")
    return points, [set_up, mean_of(runs[1], "factor structure"), solve, steps, memory]


def grow(
    name: str,
    heads: tuple[str, ...],
    sizes: list[int],
    measure: Callable[[int], tuple[int, list[float]]],
) -> Growth:
    growth = Growth(name, heads, [], [])
    for size in sizes:
        found, values = measure(size)
        growth.size.append(found)
        growth.values.append(values)
        print(f"{name} {found}: " + ", ".join(f"{v:.3g}" for v in values), flush=True)
    return growth


def measure_scale(
    program: Program, folder: Path, sizes: list[int], joints: list[int]
) -> list[Growth]:
    """Growth with the unknowns of a linear dam, and with the points of joints."""
    return [
        grow("unknowns", LINEAR, sizes, lambda size: linear_row(program, folder, size)),
        grow("points of joints", JOINTED, joints, lambda size: jointed_row(program, folder, size)),
    ]


def draw_growth(growths: list[Growth], path: Path) -> None:
    """Logarithmic pictures of all values."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(growths), figsize=(5.6 * len(growths), 4.6), squeeze=False)
    for axis, growth in zip(axes[0], growths, strict=True):
        values = np.array(growth.values)
        for column, (head, exponent) in enumerate(
            zip(growth.heads, growth.exponents(), strict=True)
        ):
            axis.loglog(
                growth.size, values[:, column], "o-", ms=4, label=f"{head}, exponent {exponent:.2f}"
            )
        axis.set_xlabel(growth.name)
        axis.grid(alpha=0.3, which="both")
        axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
