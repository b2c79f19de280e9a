"""Temperatures of air and water over the year, and the level of the water.

Time is in months from 1 January, 0 h; one year has 12. Temperatures are in degrees Celsius, in any
other unit of the same size of degree if all of them are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MONTHS = 12.0
WARMEST = 6.5  # mid July
SAMPLES = 201  # depths at which the coldest water is looked for
FREEZING = 0.0  # of water [deg C]


def wave(month: np.ndarray, latest: np.ndarray | float) -> np.ndarray:
    """A cosine over the year that is 1 in the month `latest`."""
    return np.cos(2.0 * np.pi / MONTHS * (month - latest))


@dataclass(frozen=True)
class Air:
    """Annual mean and amplitude of the air, and what the sun adds to the dry faces."""

    mean: float
    amplitude: float
    warmest: float = WARMEST  # [month]
    sun_mean: float = 0.0
    sun_amplitude: float = 0.0

    def __post_init__(self) -> None:
        for name in ("amplitude", "sun_mean", "sun_amplitude"):
            if getattr(self, name) < 0.0:
                value = getattr(self, name)
                raise ValueError(f"{name.replace('_', ' ')} of the air: {value:g}; expected >= 0")

    def on_face(self, month: np.ndarray) -> np.ndarray:
        """Temperature of a dry face: the air's and the increment of the sun."""
        mean, amplitude = self.mean + self.sun_mean, self.amplitude + self.sun_amplitude
        return mean + amplitude * wave(month, self.warmest)


@dataclass(frozen=True)
class Water:
    """The water of a deep reservoir: Zhu's formula (Zhu 1997; Zhu 2014, chapter 3).

    With the depth y [m] below the surface, the depth H of the reservoir, the month t and the month
    of the warmest air t0

      T(y, t) = Tm(y) + A0 exp(-beta y) cos(2 pi/12 (t - t0 - lag(y))),
      Tm(y) = c + (Ts - c) exp(-alpha y),  c = (Tb - g Ts)/(1 - g),  g = exp(-alpha H),
      lag(y) = d - f exp(-gamma y).

    Tm is Ts at the surface and Tb at the bottom. alpha, beta, gamma, d, f are Zhu's means of
    measurements in reservoirs.
    """

    surface: float  # Ts, annual mean at the surface
    amplitude: float  # A0, at the surface
    bottom: float  # Tb, annual mean at the bottom
    depth: float  # H [m]
    warmest: float = WARMEST  # t0 [month]
    alpha: float = 0.040  # [1/m]
    beta: float = 0.018  # [1/m]
    gamma: float = 0.085  # [1/m]
    lag_deep: float = 2.15  # d [month]
    lag_fall: float = 1.30  # f [month]

    def __post_init__(self) -> None:
        if self.amplitude < 0.0:
            raise ValueError(f"amplitude of the water: {self.amplitude:g}; expected >= 0")
        if self.depth <= 0.0:
            raise ValueError(f"depth of the water: {self.depth:g} m; expected > 0")

    def mean_at(self, depth: np.ndarray) -> np.ndarray:
        """Annual mean at a depth [m]."""
        end = np.exp(-self.alpha * self.depth)
        deep = (self.bottom - end * self.surface) / (1.0 - end)
        return deep + (self.surface - deep) * np.exp(-self.alpha * depth)

    def amplitude_at(self, depth: np.ndarray) -> np.ndarray:
        """Annual amplitude at a depth [m]."""
        return self.amplitude * np.exp(-self.beta * depth)

    def lag_at(self, depth: np.ndarray) -> np.ndarray:
        """How much later than the air a depth [m] is warmest [month]."""
        return self.lag_deep - self.lag_fall * np.exp(-self.gamma * depth)

    def at(self, depth: np.ndarray, month: np.ndarray) -> np.ndarray:
        """Temperature at a depth [m]."""
        phase = self.warmest + self.lag_at(depth)
        return self.mean_at(depth) + self.amplitude_at(depth) * wave(month, phase)

    def coldest(self) -> tuple[float, float]:
        """The lowest temperature at any depth and time, and its depth [m]."""
        depth = np.linspace(0.0, self.depth, SAMPLES)
        lowest = self.mean_at(depth) - self.amplitude_at(depth)
        place = int(lowest.argmin())
        return float(lowest[place]), float(depth[place])


@dataclass(frozen=True)
class Level:
    """The water level over the year [m], straight between its points, the same every year."""

    months: tuple[float, ...]  # growing, 0 to 12
    heights: tuple[float, ...]  # z of the water [m]

    @staticmethod
    def parse(words: list[str]) -> Level:
        """A level from one number, or from MONTH:HEIGHT words. Raises ValueError."""
        try:
            if not all(np.isfinite(float(n)) for word in words for n in word.split(":")):
                raise ValueError
            if len(words) == 1 and ":" not in words[0]:
                return Level((0.0,), (float(words[0]),))
            pairs = sorted(tuple(map(float, word.split(":"))) for word in words)
            months, heights = zip(*pairs, strict=True)
        except ValueError:
            found = " ".join(words)
            raise ValueError(
                f"level '{found}': expected one height, or MONTH:HEIGHT words"
            ) from None
        if months[0] < 0.0 or months[-1] > MONTHS or len(set(months)) < len(months):
            raise ValueError(f"level: months {months}; expected different ones, 0 to 12")
        return Level(months, heights)

    @property
    def is_constant(self) -> bool:
        """Whether the level is the same all year."""
        return len(set(self.heights)) == 1

    def at(self, month: np.ndarray) -> np.ndarray:
        """Level in a month [m]."""
        return np.interp(month, self.months, self.heights, period=MONTHS)


@dataclass(frozen=True)
class Climate:
    """What the faces of the dam touch; no water: a dam with an empty reservoir."""

    air: Air
    water: Water | None = None
    level: Level | None = None

    def upstream(self, z: np.ndarray, month: np.ndarray) -> np.ndarray:
        """Temperature of the upstream face at heights z [m], shape (heights, months)."""
        dry = np.broadcast_to(self.air.on_face(month), (len(z), len(month)))
        if self.water is None or self.level is None:
            return dry
        depth = self.level.at(month)[None, :] - z[:, None]
        wet = self.water.at(np.maximum(depth, 0.0), month[None, :])
        return np.where(depth >= 0.0, wet, dry)

    def downstream(self, z: np.ndarray, month: np.ndarray) -> np.ndarray:
        """Temperature of the downstream face, shape (heights, months)."""
        return np.broadcast_to(self.air.on_face(month), (len(z), len(month)))
