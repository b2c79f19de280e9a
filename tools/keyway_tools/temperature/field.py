"""The temperature field of a dam over the year, and its file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .climate import MONTHS, Climate
from .dam_in_deck import Dam, Place
from .periodic_wall import SAMPLES, Wall, Waves, inside_wall, linear_inside_wall, waves_of

DAY = 86400.0  # [s]
YEAR = 365.25 * DAY  # [s]


@dataclass(frozen=True)
class Clock:
    """What the times of the deck mean: month `start` of the year is time 0."""

    start: float = 0.0  # [month]
    year: float = YEAR  # length of a year in the deck's unit of time

    def __post_init__(self) -> None:
        if self.year <= 0.0:
            raise ValueError(f"length of a year: {self.year:g}; expected > 0")

    def part_of_year(self, time: np.ndarray) -> np.ndarray:
        """Times of the deck as parts of the year."""
        return self.start / MONTHS + np.asarray(time) / self.year


def seasonal_field(
    wall: Wall, place: Place, climate: Climate, harmonics: int, is_linear: bool = False
) -> Waves:
    """Temperatures of the dam's nodes over the year; `is_linear`: straight through the thickness.

    The conduction is that of a real year, whatever the deck's unit of time.
    """
    month = MONTHS * np.arange(SAMPLES) / SAMPLES
    upstream = waves_of(climate.upstream(place.z_upstream, month), harmonics)
    downstream = waves_of(climate.downstream(place.z_downstream, month), harmonics)
    return (linear_inside_wall if is_linear else inside_wall)(wall, upstream, downstream)


def write_field(
    path: Path, dam: Dam, temperature: np.ndarray, times: np.ndarray, rock: float | None = None
) -> None:
    """A row for each node in the order of its number, a column for each time.

    `temperature` has shape (nodes, times). Nodes outside of the dam have the value `rock`, no row
    where it is None. A file of one time has no time: *TEMPERATURE then takes the values alone.
    """
    others = dam.others if rock is not None else dam.others[:0]
    numbers = np.concatenate([dam.numbers, others])
    outside = np.full((len(others), len(times)), rock or 0.0)
    values = np.concatenate([temperature, outside])
    heads = [f"{time:.12g}" for time in times] if len(times) > 1 else ["temperature"]
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(["node", *heads]) + "\n")
        for row in np.argsort(numbers, kind="stable"):
            file.write(f"{numbers[row]}," + ",".join(f"{v:.6g}" for v in values[row]) + "\n")
