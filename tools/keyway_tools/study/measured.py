"""What a study compares: a few numbers of a run, each with its name in sentences."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

import numpy as np

from keyway_tools.mesh_data import BrickMesh
from keyway_tools.mesh_quality import volumes
from keyway_tools.results import Results

# Share of the dam's volume in which the stress is larger than the number that is compared: a
# singular corner takes less.
SHARE = 0.01
QUANTITIES = ("displacement", "stress", "opening", "damage", "frequency")


@dataclass
class Measured:
    """Numbers of one run."""

    seconds: float  # of the run
    memory: float  # [MB]
    unknowns: int
    increments: int
    cutbacks: int
    values: dict[str, float] = field(default_factory=dict)  # of QUANTITIES
    peak: float = 0.0  # largest S1 anywhere
    peak_place: list[float] = field(default_factory=list)
    processor: float = 0.0  # seconds of all threads; 0: not known

    def as_dict(self) -> dict:
        return asdict(self)


def measure(results: Results) -> Measured:
    """Reads the numbers of a finished run."""
    summary = results.summary
    steps = summary["steps"]
    found = Measured(
        summary["ledger"]["wall_s"],
        summary["ledger"]["peak_memory_mb"],
        summary["model"]["unknowns"],
        sum(step["increments"] for step in steps),
        sum(step["cutbacks"] for step in steps),
    )
    values = found.values
    moved = (summary.get("displacement") or {}).get("anywhere")
    if moved:
        values["displacement"] = moved["value"]
    peak = (summary["envelopes"].get("S1") or {}).get("anywhere")
    if peak:
        found.peak, found.peak_place = peak["value"], peak["x"]
        values["stress"] = exceeded_stress(results)
    if "reduced" in summary["accuracy"]:  # has them for printed nodes alone
        values.pop("displacement", None)
        values.pop("stress", None)
    openings = [
        joint["opening"]["anywhere"]["value"] for joint in summary["joints"].values()
        if "anywhere" in joint["opening"]
    ]  # fmt: skip
    if openings and max(openings) > 0.0:
        values["opening"] = max(openings)
    if "damage" in summary and summary["damage"]["dissipated"]["cracking"] > 0.0:
        values["damage"] = summary["damage"]["dissipated"]["cracking"]
    modes = [mode for step in steps for mode in step["frequencies"]]
    if modes:
        values["frequency"] = modes[0]["hz"]
    return found


def exceeded_stress(results: Results) -> float:
    """The S1 that the extremes exceed in SHARE of the volume of the dam."""
    stress = np.full(len(results.x), -np.inf)
    for step in results.steps():
        if "S1" in step.envelopes:
            there = nodes_there(results, step.number)
            stress[there] = np.fmax(stress[there], step.envelopes["S1"][there])
    weights = node_volumes(results)
    weights[~np.isfinite(stress)] = 0.0
    order = np.argsort(-stress)
    passed = np.cumsum(weights[order])
    return float(stress[order[np.searchsorted(passed, SHARE * passed[-1])]])


def nodes_there(results: Results, step: int) -> np.ndarray:
    """The nodes of the solids that are there in a step (positions)."""
    solids, stage = results.solids, results.stage(step)
    if stage is not None:
        solids = solids[stage[solids] > 0]
    return np.unique(results.connectivity[solids])


def node_volumes(results: Results) -> np.ndarray:
    """An eighth of the volume of each brick of the dam at each of its nodes, (nodes)."""
    corners = results.connectivity[results.dam]
    dam = BrickMesh(results.x, corners, np.zeros((0, 8), dtype=int))
    total = np.zeros(len(results.x))
    np.add.at(total, corners.ravel(), np.repeat(volumes(dam) / 8.0, 8))
    return total


def time_in_words(seconds: float) -> str:
    """'23 s', '12 min', '3.1 h', '4 days'."""
    for unit, size in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            number = seconds / size
            return f"{number:.0f} {unit}" if number >= 9.95 else f"{number:.2g} {unit}"
    return f"{seconds:.3g} s"
