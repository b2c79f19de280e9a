"""How time and memory grow with the unknowns, and with the points of joints."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from cost_of_joints import write_dam
from kept_rows import KeptRows, Row
from measured_run import Program, Run
from scenes import INCREMENT, dam_of_size, write_deck

INCREMENTS = 10  # of a linear dam
JOINTED_INCREMENTS = {25: 30, 50: 15}  # in strong motion; 40 with fewer joints
LARGE_ROCK = {25: ["--rock-upstream", "11", "--rock-downstream", "11", "--rock-deep", "11"]}
LINEAR = ("analyse [s]", "factor [s]", "solve [s]", "increment [s]", "whole [s]", "memory [MB]")
JOINTED = (
    "set-up, in factors",
    "factor [s]",
    "solve [s]",
    "joints and solve, in solves",
    "increment, in solves",
    "whole [s]",
    "memory [MB]",
)
MEMORY_EXPONENT = 1.4  # of a linear dam over its unknowns, from above: 4/3 in the limit


@dataclass
class Growth:
    """Rows of measured values over a size."""

    name: str  # of the size
    heads: tuple[str, ...]
    size: list[int] = field(default_factory=list)
    values: list[list[float]] = field(default_factory=list)

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


@dataclass(frozen=True)
class ScaleOptions:
    """What is measured, and what it may take."""

    sizes: list[int]  # unknowns of linear dams
    joints: list[int]  # joints of dams in a strong motion
    memory: float | None = None  # that a run may take [MB]; None: what is free now
    keep: Path | None = None  # file of the rows that are measured


def free_memory() -> float:
    """Memory that is free now [MB]."""
    found = re.search(r"MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text())
    return int(found[1]) / 1024.0 if found else float("inf")


def forecast_memory(program: Program, deck: Path) -> float | None:
    """Memory of a run as --check says [MB]; None for models that are too large for a forecast."""
    command = [str(program.path), "-j", str(program.threads), "--check", str(deck)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = re.search(r"memory +about (\S+) MB", text)
    return float(found[1]) if found else None


class ScaleBench:
    """Measures rows, or takes those that are kept; leaves out what finds no memory."""

    def __init__(self, program: Program, folder: Path, options: ScaleOptions):
        self.program, self.folder, self.options = program, folder, options
        self.kept = KeptRows.of(options.keep, program)

    def grow(
        self,
        growth: Growth,
        names: list[int],
        measure: Callable[[int, Growth], Row | None],
    ) -> Growth:
        """One row for each name that finds memory."""
        for name in names:
            key = f"{growth.name}, {name}"
            row = self.kept.rows.get(key) or measure(name, growth)
            if row is None:
                continue
            self.kept.put(key, row)
            growth.size.append(row.size)
            growth.values.append(row.values)
            line = ", ".join(f"{v:.3g}" for v in row.values)
            print(f"{growth.name} {row.size}: {line}", flush=True)
        return growth

    def fits(self, what: str, needed: float | None) -> bool:
        """Whether a run finds memory; says so if not."""
        limit = self.options.memory or free_memory()
        if needed is None or needed <= limit:
            return True
        print(f"{what}: left out, needs about {needed:.0f} MB, {limit:.0f} MB may be taken")
        return False

    def linear_row(self, size: int, growth: Growth) -> Row | None:
        """A dam without joints: weight and water, then some increments without output."""
        if growth.size:
            last = growth.values[-1][LINEAR.index("memory [MB]")]
            needed = last * max(1.0, size / growth.size[-1]) ** MEMORY_EXPONENT
            if not self.fits(f"{size} unknowns", needed):
                return None
        mesh = dam_of_size(size)
        duration = INCREMENTS * INCREMENT
        deck = write_deck(self.folder, f"scale_{size}", mesh, duration, has_envelopes=False)
        run = self.program.run(deck)
        once = run.cost("iterate structure")[0]
        solve = run.mean("solve structure")
        increment = solve + once / (INCREMENTS + 1)
        values = [run.mean("analyse structure"), run.mean("factor structure"), solve]
        whole, memory = run.results.find("ledger.wall_s"), run.results.find("ledger.peak_memory_mb")
        return Row(run.unknowns, [*values, increment, whole, memory])

    def jointed_row(self, joints: int, growth: Growth) -> Row | None:
        """A dam with joints in a strong motion: increments without the set-up of their step."""
        count = JOINTED_INCREMENTS.get(joints, 40)
        more = LARGE_ROCK.get(joints, [])
        deck = write_dam(self.folder, joints, INCREMENT * (1 + count), more)
        if not self.fits(f"{joints} joints", forecast_memory(self.program, deck)):
            return None
        early, run = self.program.watch(deck, step=2)
        if early is None or 2 * increments_of(early) > increments_of(run):  # seen too late
            apart = self.folder / "first_increment"  # its results lie beside those of the run
            apart.mkdir(exist_ok=True)
            early = self.program.run(write_dam(apart, joints, INCREMENT, more))
        points = sum(joint["points"] for joint in run.results.find("joints").values())
        done = increments_of(run) - increments_of(early)
        solve = run.mean(SOLVES)
        solving, iterating, whole = (
            spent(run, early, pattern) / done / solve
            for pattern in (SOLVES, ITERATIONS, IN_INCREMENTS)
        )
        set_up = run.cost(r"condense JOINT\d+")[0] / run.cost("factor structure")[0]
        memory = run.results.find("ledger.peak_memory_mb")
        values = [set_up, run.mean("factor structure"), solve, solving + iterating, whole]
        return Row(points, [*values, run.results.find("ledger.wall_s"), memory])


SOLVES = r"solve( forward| backward)? structure"
ITERATIONS = r"(iterate|correct) JOINT\d+"
# All parts but those that occur once in a step.
IN_INCREMENTS = (
    r"(?!start program|read deck|open results|assemble |analyse |factor |condense |"
    r"solve initial acceleration).*"
)


def increments_of(run: Run) -> int:
    """Converged increments of the second step."""
    return run.results.find("steps")[1]["increments"]


def spent(run: Run, early: Run, pattern: str) -> float:
    """Seconds of some parts between two summaries."""
    return run.cost(pattern)[0] - early.cost(pattern)[0]


def measure_scale(program: Program, folder: Path, options: ScaleOptions) -> list[Growth]:
    """Growth with the unknowns of a linear dam, and with the points of joints."""
    bench = ScaleBench(program, folder, options)
    return [
        bench.grow(Growth("unknowns", LINEAR), options.sizes, bench.linear_row),
        bench.grow(Growth("points of joints", JOINTED), options.joints, bench.jointed_row),
    ]


def draw_growth(growths: list[Growth], path: Path) -> None:
    """Logarithmic pictures of all values."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(growths), figsize=(5.6 * len(growths), 5.0), squeeze=False)
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
