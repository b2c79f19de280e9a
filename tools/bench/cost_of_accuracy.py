"""Time against accuracy: a small arch dam with finer meshes, other elements, smaller steps."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from keyway_tools.results import Results
from measured_run import Program
from scenes import refined_dam, write_deck

ELEMENTS = ("C3D8", "C3D8I", "C3D8B", "C3D8R")
FACTORS = (1, 2, 3)  # of the meshes
FINEST = 5  # factor of the reference mesh, with C3D8I
INCREMENTS = (0.02, 0.01, 0.005)  # [s]
FINEST_INCREMENT = 0.00125  # [s] of the reference run
DURATION = 2.0  # of the motion [s]


@dataclass
class Row:
    """One run: its time, its results and their errors relative to the finest run."""

    study: str  # 'mesh' or 'increment'
    name: str  # element, or size of the increment
    unknowns: int
    seconds: float  # of the processor
    found: dict[str, float]
    errors: dict[str, float]  # relative


def measure_accuracy(program: Program, folder: Path) -> list[Row]:
    return measure_meshes(program, folder) + measure_increments(program, folder)


def measure_meshes(program: Program, folder: Path) -> list[Row]:
    """Weight, water and the first frequency, for every mesh and element."""
    scenes = [(element, factor) for element in ELEMENTS for factor in FACTORS]
    rows = []
    for element, factor in [*scenes, ("C3D8I", FINEST)]:
        mesh = refined_dam(factor)
        deck = write_deck(folder, f"mesh_{element}_{factor}", mesh, 0.0, element_type=element)
        add_frequency(deck)
        run = program.run(deck)
        rows.append(Row("mesh", element, run.unknowns, run.processor, statics(run.results), {}))
    return with_errors(rows)


def add_frequency(deck: Path) -> None:
    """Adds a step for the first frequency to a static deck."""
    deck.write_text(deck.read_text() + "*STEP, NAME=MODES\n*FREQUENCY\n1\n*END STEP\n")


def statics(results: Results) -> dict[str, float]:
    return {
        "crest displacement": crest_displacement(results)[-1],
        "max S1": results.find("envelopes.S1.anywhere.value"),
        "crest stress": crest_stress(results),
        "frequency": results.find("steps.1.frequencies.0.hz"),
    }


def crest_stress(results: Results) -> float:
    """The arch stress (S3) of the static step at the crest of the crown [Pa]."""
    node = results.node_position[int(results.file["sets/nodes/CROWN_CREST"][0])]
    increments = results.file["steps/0001/increments"]
    return float(increments[sorted(increments)[-1]]["SP"][node, 2])


def crest_displacement(results: Results) -> np.ndarray:
    """Displacement along the valley at the crest of the crown, for every row of the table [m]."""
    table = results.table("node_CROWN_CREST")
    return table["U2"][table["node"] == table["node"][0]]


def measure_increments(program: Program, folder: Path) -> list[Row]:
    """The dam with two joints in a motion, with smaller increments."""
    mesh = refined_dam(2, num_joints=2)
    rows = []
    for increment in (*INCREMENTS, FINEST_INCREMENT):
        name = f"increment_{increment * 1e6:.0f}"
        run = program.run(write_deck(folder, name, mesh, DURATION, increment))
        found = dynamics(run.results)
        rows.append(Row("increment", f"{increment:g} s", run.unknowns, run.processor, found, {}))
    return with_errors(rows)


def dynamics(results: Results) -> dict[str, float]:
    return {
        "crest displacement": float(np.abs(crest_displacement(results)).max()),
        "max S1": results.find("envelopes.S1.anywhere.value"),
        "opening": results.find("envelopes.OPENING.anywhere.value"),
    }


def with_errors(rows: list[Row]) -> list[Row]:
    """Adds errors relative to the last row, which stays in the table as the reference."""
    for row in rows:
        row.errors = {key: abs(row.found[key] / best - 1.0) for key, best in rows[-1].found.items()}
    return rows


def tables(rows: list[Row]) -> str:
    """Both studies as tables in Markdown."""
    texts = []
    for study in ("mesh", "increment"):
        some = [row for row in rows if row.study == study]
        keys = list(some[-1].found)
        texts.append("| " + " | ".join([study, "unknowns", "processor [s]", *keys]) + " |")
        texts.append("|---" * (3 + len(keys)) + "|")
        for row in some[:-1]:
            errors = " | ".join(f"{100.0 * row.errors[key]:.2g} %" for key in keys)
            texts.append(f"| {row.name} | {row.unknowns} | {row.seconds:.2f} | {errors} |")
        best = " | ".join(f"{some[-1].found[key]:.5g}" for key in keys)
        texts += [f"| finest: {some[-1].name} | {some[-1].unknowns} | {some[-1].seconds:.2f} | "
                  f"{best} |", ""]  # fmt: skip
    return "\n".join(texts)


def draw(rows: list[Row], path: Path) -> None:
    """Errors over processor time: meshes and elements in two panels, increments in the third."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(13.0, 4.6), sharey=True, layout="constrained")
    mesh = [row for row in rows if row.study == "mesh"][:-1]
    draw_meshes(axes[0], mesh, {"crest displacement": "o-", "frequency": "^--"})
    draw_meshes(axes[1], mesh, {"crest stress": "v-", "max S1": "s--"})
    steps = [row for row in rows if row.study == "increment"][:-1]
    for key, style in zip(steps[0].found, ("o-", "s--", "D-."), strict=True):
        axes[2].plot(*curve(steps, key), style, color="black", label=key)
    axes[2].set_title("two joints, increments 0.02, 0.01, 0.005 s")
    for axis in axes:
        axis.set(xscale="log", yscale="log", xlabel="processor time of the run [s]")
        axis.grid(alpha=0.4, which="both")
        axis.legend(fontsize="small")
    axes[0].set_ylabel("error, relative to the finest")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_meshes(axis, rows: list[Row], styles: dict[str, str]) -> None:
    """One line for every element and quantity over the three meshes."""
    for element, colour in zip(ELEMENTS, ("C0", "C3", "C2", "C1"), strict=True):
        some = [row for row in rows if row.name == element]
        for key, style in styles.items():
            label = f"{element} {key}" if element == ELEMENTS[0] else element
            is_named = element == ELEMENTS[0] or (style.endswith("-") and "--" not in style)
            axis.plot(*curve(some, key), style, color=colour, label=label if is_named else None)
    axis.set_title("three meshes: " + " and ".join(styles))


def curve(rows: list[Row], key: str) -> tuple[list[float], list[float]]:
    return [row.seconds for row in rows], [row.errors[key] for row in rows]
