"""Lifts of a dam and the steps that build it: sets of the mesh, cards of the deck."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..mesh_data import BrickMesh


@dataclass(frozen=True)
class Construction:
    """How a dam is built: equal lifts, and the lifts after which the joints are grouted."""

    num_lifts: int
    grouted_after: tuple[int, ...] = ()  # growing; empty: the joints have their law from the start
    pressure: float = 0.0  # of the grout [Pa]

    def __post_init__(self) -> None:
        if self.num_lifts < 1:
            raise ValueError(f"lifts: {self.num_lifts}; expected at least 1")
        after = self.grouted_after
        is_growing = all(a < b for a, b in pairwise(after))
        if not is_growing or (after and not 1 <= after[0] <= after[-1] <= self.num_lifts):
            found = " ".join(map(str, after))
            raise ValueError(
                f"grouting after the lifts {found}; expected growing numbers, 1 to {self.num_lifts}"
            )
        if self.pressure < 0.0:
            raise ValueError(f"pressure of the grout: {self.pressure:g} Pa; expected >= 0")


def name_lifts(mesh: BrickMesh, num_levels: int, num_lifts: int) -> None:
    """Sets LIFT1 (at the foot), LIFT2, .. of the dam's bricks; a lift has whole levels of bricks.

    `num_levels` levels of equal height reach from the foot to the crest. Raises ValueError.
    """
    if num_lifts > num_levels:
        raise ValueError(f"{num_lifts} lifts; expected at most one for each of {num_levels} levels")
    bricks = mesh.brick_sets["DAM"]
    z = mesh.x[:, 2][mesh.bricks[bricks]]
    low, high = z.min(), z.max()
    level = ((z.mean(axis=1) - low) / (high - low) * num_levels).astype(int)
    lift_of_level = np.arange(num_levels) * num_lifts // num_levels
    for lift in range(num_lifts):
        members = bricks[lift_of_level[np.minimum(level, num_levels - 1)] == lift]
        if not len(members):
            raise ValueError(
                f"lift {lift + 1} of {num_lifts} has no elements; expected fewer lifts"
            )
        mesh.element_sets[f"LIFT{lift + 1}"] = members


def joints_there(mesh: BrickMesh, lift: int) -> list[str]:
    """Names of the joints that have an element, or faces, between blocks of the lifts so far."""
    bricks = np.concatenate([mesh.element_sets[f"LIFT{k}"] for k in range(1, lift + 1)])
    nodes = np.unique(mesh.bricks[bricks])

    def is_there(name: str) -> bool:
        if name in mesh.joint_sets:
            return bool(np.isin(mesh.joints[mesh.joint_sets[name]], nodes).all(axis=1).any())
        sides = (mesh.surfaces[side] for side in mesh.surface_joints[name])
        return all(np.isin([brick for brick, _ in faces], bricks).any() for faces in sides)

    return [name for name in mesh.joint_names if is_there(name)]


def construction_steps(
    building: Construction,
    joints: list[list[str]],
    requests: list[str],
    cooling: Callable[[int], list[str]] | None = None,
) -> list[str]:
    """Cards of the steps from the first lift to the last grouting; the weight stays in all others.

    `joints` are those that each campaign of grouting reaches; `requests` are cards of output that
    the first step opens for all; `cooling` gives the cards of the step before a campaign.
    """
    later = [f"LIFT{k}" for k in range(2, building.num_lifts + 1)]
    first = ["*DLOAD", "DAM, GRAV, 9.81, 0., 0., -1.", *requests]
    if later:
        first = ["*MODEL CHANGE, TYPE=ELEMENT, REMOVE", *_rows(later), *first]
    parts = ["**", "** Lift by lift: joints that are grouted later are in contact until then"]
    for lift in range(1, building.num_lifts + 1):
        added = ["*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE", f"LIFT{lift}"]
        parts += static_step(f"LIFT{lift}", first if lift == 1 else added)
        if lift in building.grouted_after:
            number = building.grouted_after.index(lift) + 1
            parts += cooling(number) if cooling else []
            pressure = f", PRESSURE={building.pressure:g}" if building.pressure else ""
            cards = [f"*GROUT, JOINT={name}{pressure}" for name in joints[number - 1]]
            parts += static_step(f"GROUT{number}", cards)
    return parts


def static_step(name: str, cards: list[str], times: str = "1., 1.") -> list[str]:
    """A static step."""
    return [f"*STEP, NAME={name}", "*STATIC", times, *cards, "*END STEP"]


def _rows(names: list[str]) -> list[str]:
    """Names, eight to a line."""
    return [", ".join(names[i : i + 8]) for i in range(0, len(names), 8)]


def construction_in_words(building: Construction) -> str:
    """The assumptions for the header of a deck."""
    text = f"acts lift by lift, {building.num_lifts} lifts that appear without stress, all blocks "
    text += "of a lift at once"
    if not building.grouted_after:
        return text + "; no grouting (assumed)"
    after = ", ".join(map(str, building.grouted_after))
    text += f"; the joints are in contact with friction until they are grouted, after lift {after}"
    if building.pressure:
        text += f", at {building.pressure:g} Pa"
    return text + " (assumed)"
