"""The numbers of a run that the page compares, in SI units."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from ..mesh_data import BrickMesh
from ..mesh_quality import volumes
from ..result_files import Table
from ..si_results import SiResults
from .runner import Outcome

FACES = ("upstream", "downstream")
DAMAGED = 0.1  # mean of an element
UPPER = 0.6  # of the height
IN_PLANE = 1e-6  # of the largest displacement


@dataclass
class Facts:
    """Numbers of one case; extremes are those of the last step."""

    name: str
    title: str
    status: str
    wall_s: float | None = None
    processor_s: float | None = None
    unknowns: int = 0
    increments: int = 0
    cutbacks: int = 0
    energy_error: float = 0.0
    # by field and place (anywhere, upstream, downstream): value, time, x
    extremes: dict[str, dict[str, Any]] = field(default_factory=dict)
    openings: dict[str, dict[str, float]] = field(default_factory=dict)  # by joint and face [m]
    places: dict[str, list[float]] = field(default_factory=dict)  # of the largest, by joint [m]
    hz: list[float] = field(default_factory=list)
    # [m3]: all damaged, of it above UPPER of the height, and downstream of the middle surface
    damaged: dict[str, float] = field(default_factory=dict)
    slips: dict[str, float] = field(default_factory=dict)  # largest of each joint [m]
    moved: float | None = None  # of the crest, by the motion, see `_moved` [m]
    dissipated: float = 0.0  # by cracking [J]
    created: float = 0.0  # by the recovery of stiffness [J]
    height: float = 0.0  # of the dam [m]
    # Until when the first printed node moves across the valley (x) by less than 1e-6 of what it
    # moves at all [s]; None where no node is printed
    in_plane_until: float | None = None
    largest_fall: float = 0.0  # of the dissipation in one increment, over its last value
    reduced_error: float | None = None  # that the reduced model estimates

    def value(self, name: str, place: str = "anywhere") -> float | None:
        """An extreme, None where there is none."""
        return self.extremes.get(name, {}).get(place, {}).get("value")

    def value_or_nan(self, name: str) -> float:
        """An extreme anywhere, NaN where there is none."""
        value = self.value(name)
        return float("nan") if value is None else value

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def facts_of(outcome: Outcome) -> Facts:
    """The numbers of a case; of one that has not finished only how it went."""
    case, record = outcome.case, outcome.record
    facts = Facts(case.name, case.title, record.status, record.wall_s, record.processor_s)
    if not outcome.is_finished:
        facts.status += f": {record.message}" if record.message else ""
        return facts
    results = SiResults(outcome.folder, case.name)
    summary = results.si_summary
    facts.unknowns = summary["model"]["unknowns"]
    facts.increments = sum(step["increments"] for step in summary["steps"])
    facts.cutbacks = sum(step["cutbacks"] for step in summary["steps"])
    facts.energy_error = max(abs(step["energy"]["error"]) for step in summary["steps"])
    facts.hz = [mode["hz"] for step in summary["steps"] for mode in step.get("frequencies", [])]
    _add_extremes(facts, results)
    nodes = np.unique(results.connectivity[results.dam])
    facts.height = float(np.ptp(results.x[nodes, 2]))
    damage = summary.get("damage") or {}
    facts.dissipated = (damage.get("dissipated") or {}).get("cracking", 0.0)
    facts.created = damage.get("created") or 0.0
    facts.damaged = _damaged(results)
    facts.largest_fall = _largest_fall(results)
    node = _printed_node(results)
    if node is not None:
        facts.moved, facts.in_plane_until = _moved(node), _in_plane_until(node)
    reduced = summary["accuracy"].get("reduced") or {}
    errors = [one["estimated_error"] for one in reduced.values()]
    facts.reduced_error = max(errors) if errors else None
    return facts


def _add_extremes(facts: Facts, results: SiResults) -> None:
    """Extremes of the envelopes; openings and slips of each joint."""
    summary = results.si_summary
    facts.extremes = {
        name: _without_round_off(results, one) if name == "OPENING" else one
        for name, one in summary["envelopes"].items()
    }
    for name, joint in summary["joints"].items():
        opening = _without_round_off(results, joint["opening"])
        slip = _without_round_off(results, joint.get("slip", {}))
        facts.openings[name] = {face: opening.get(face, {}).get("value", 0.0) for face in FACES}
        facts.places[name] = opening["anywhere"].get("x", [])
        facts.slips[name] = slip.get("anywhere", {}).get("value", 0.0)


def _without_round_off(results: SiResults, extremes: dict[str, Any]) -> dict[str, Any]:
    """The largest openings or slips by place as they are, round-off as 0."""
    return {
        place: one | {"value": float(results.without_round_off(one["value"]))}
        for place, one in extremes.items()
    }


def _largest_fall(results: SiResults) -> float:
    """Largest fall of the dissipated energy (cracks, joints) over its last value; 0 for none."""
    energy = results.table("energy")
    spent = energy["fracture"] + energy["friction"]
    if len(spent) < 2 or spent[-1] <= 0.0:
        return 0.0
    return float(max(0.0, -np.diff(spent).min()) / spent[-1])


def _moved(table: Table) -> float:
    """How far the last step moves a node: the mean of its last tenth, beside the end of the step
    before [m]."""
    step, u = table["step"], _displacement(table)
    before = u[step < step[-1]][-1:].sum(axis=0)
    motion = u[step == step[-1]]
    end = motion[-max(1, len(motion) // 10) :].mean(axis=0)
    return float(np.linalg.norm(end - before))


def _in_plane_until(table: Table) -> float:
    """Until when a node moves across the valley by less than IN_PLANE of all its motion [s]."""
    u = _displacement(table)
    leaves = np.abs(u[:, 0]) > IN_PLANE * np.abs(u).max()
    return float(table["time"][np.argmax(leaves) if leaves.any() else -1])


def _displacement(table: Table) -> np.ndarray:
    return np.stack([table[f"U{i}"] for i in (1, 2, 3)], axis=1)


def _printed_node(results: SiResults) -> Table | None:
    """The history of the first printed node; None where no node is printed."""
    for name in results.tables():
        if name.startswith("node_"):
            table = results.table(name)
            of_node = table["node"] == table["node"][0]
            return {column: values[of_node] for column, values in table.items()}
    return None


def _damaged(results: SiResults) -> dict[str, float]:
    """Damaged volumes [m3] by the largest mean damage of elements over the last step."""
    means = [
        (step.procedure, step.means["DAMAGET"])
        for step in results.steps()
        if "DAMAGET" in step.means
    ]
    if not means:
        return {}
    dam = results.dam
    cells = results.connectivity[dam]
    mesh = BrickMesh(results.x, cells, np.zeros((0, 8), dtype=int))
    whole = volumes(mesh)
    volume = whole * (np.nan_to_num(means[-1][1][dam]) >= DAMAGED)
    static = [damage for procedure, damage in means if procedure == "static"]
    at_rest = np.nan_to_num(static[-1][dam]) >= DAMAGED if static else np.zeros(len(dam), bool)
    centre = results.x[cells].mean(axis=1)
    low, high = centre[:, 2].min(), centre[:, 2].max()
    is_upper = centre[:, 2] > low + UPPER * (high - low)
    down, up = (_distance(centre, results.x[results.face_flags(f)]) for f in FACES[::-1])
    is_down = down < up
    return {
        "all": float(volume.sum()),
        "upper": float(volume[is_upper].sum()),
        "upper downstream": float(volume[is_upper & is_down].sum()),
        "lower": float(volume[~is_upper].sum()),
        "lower, before the motion": float(whole[~is_upper & at_rest].sum()),
        "volume of the dam": float(whole.sum()),
    }


def _distance(points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Distance of points from the nearest node of a face [m]."""
    from scipy.spatial import cKDTree

    return cKDTree(face).query(points)[0] if len(face) else np.full(len(points), np.inf)
