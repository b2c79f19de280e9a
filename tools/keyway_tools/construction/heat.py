"""Temperatures of a dam: at placing, at the closure of its joints, through the years after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..mesh_data import BrickMesh
from .lifts import Construction, static_step


@dataclass(frozen=True)
class Temperatures:
    """Fresh concrete is cooled before its joints are grouted; then the seasons act."""

    expansion: float  # [1/K]
    placing: float  # of fresh concrete [deg C]
    closure: float  # at which joints are grouted [deg C]
    seasons: str = ""  # file for *TEMPERATURE, INPUT; '' for none
    duration: float = 12.0  # of the seasons, in the time of the file
    increment: float = 0.5

    def __post_init__(self) -> None:
        if self.expansion <= 0.0:
            raise ValueError(f"expansion: {self.expansion:g} 1/K; expected > 0")
        if self.seasons and not 0.0 < self.increment <= self.duration:
            raise ValueError(
                f"seasons: increment {self.increment:g}, duration {self.duration:g}; "
                "expected 0 < increment <= duration"
            )

    def material_cards(self) -> list[str]:
        """The card of the concrete."""
        return ["*EXPANSION", f"{self.expansion:g}"]

    def initial_cards(self) -> list[str]:
        """All nodes of the dam have the temperature of fresh concrete, or that of the closure."""
        return ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"UP_TO_CREST, {self.placing:g}"]

    def cooling_step(self, campaign: int) -> list[str]:
        """The step before a campaign of grouting."""
        cards = ["*TEMPERATURE", f"UP_TO_GROUT{campaign}, {self.closure:g}"]
        return static_step(f"COOL{campaign}", cards, "0.25, 1., , 0.25")

    def season_step(self) -> list[str]:
        """The step of the seasons, whose times are those of the file."""
        if not self.seasons:
            return []
        cards = [f"*TEMPERATURE, INPUT={self.seasons}, TIME=STEP TIME"]
        cards += ["*NODE FILE, FREQUENCY=1", "U, OPENING, TEMP"]
        times = f"{self.increment:g}, {self.duration:g}, , {self.increment:g}"
        return ["**", "** The seasons", *static_step("SEASONS", cards, times)]


def name_campaigns(mesh: BrickMesh, building: Construction) -> None:
    """Node sets UP_TO_GROUT1, .. of the lifts below each campaign, and UP_TO_CREST of the dam."""
    parts = {f"UP_TO_GROUT{k}": last for k, last in enumerate(building.grouted_after, start=1)}
    for name, last in (parts | {"UP_TO_CREST": building.num_lifts}).items():
        lifts = [mesh.element_sets[f"LIFT{lift}"] for lift in range(1, last + 1)]
        mesh.node_sets[name] = np.unique(mesh.bricks[np.concatenate(lifts)])


def temperatures_in_words(heat: Temperatures) -> str:
    """The assumptions for the header of a deck."""
    text = f"expansion {heat.expansion:g} 1/K; concrete is placed at {heat.placing:g} degrees and "
    text += f"cooled to {heat.closure:g} before its joints are grouted; "
    if heat.seasons:
        return text + f"then {heat.seasons} for {heat.duration:g} of its units of time (assumed)"
    return text + "no seasons (assumed)"
