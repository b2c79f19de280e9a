"""Duvaut and Lions' viscosity: plastic strain and damage lag behind the inviscid values.

Plastic strain and both damages lag; the share r of tension is that of the lagging effective stress,
so that a crack closes at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .concrete import Concrete
from .path import History


@dataclass(frozen=True)
class Lagging:
    """Lagging plastic strain and damage, and their stress [Pa]."""

    plastic: np.ndarray
    damage: np.ndarray  # d_t, d_c (rows, 2)
    stress: np.ndarray


def lag(values: np.ndarray, times: np.ndarray, viscosity: float) -> np.ndarray:
    """Solves viscosity * y' = values - y from rest, exactly for values linear between times."""
    late = np.zeros_like(values)
    for row in range(1, len(times)):
        step = times[row] - times[row - 1]
        slope = (values[row] - values[row - 1]) / step
        fade = np.exp(-step / viscosity)
        steady = values[row] - viscosity * slope
        late[row] = steady + fade * (late[row - 1] - values[row - 1] + viscosity * slope)
    return late


def relax(law: Concrete, history: History, times: np.ndarray, viscosity: float) -> Lagging:
    """A strain-driven history with viscosity [s]; its rows must be close together in time."""
    plastic = lag(history.plastic, times, viscosity)
    damage = lag(history.damage, times, viscosity)
    effective = (history.strain - plastic) @ law.stiffness
    stress = [law.nominal(s, *d) for s, d in zip(effective, damage, strict=True)]
    return Lagging(plastic, damage, np.array(stress))
