"""Which colours stand for which values: fields, round limits, and what sets their end.

At a re-entrant corner the stress of an elastic dam has no limit: it grows with every finer mesh.
One such node would leave the rest of the dam in one colour. The scale of a stress therefore ends at
a percentile of its nodes, and the picture says so.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from matplotlib.ticker import MaxNLocator

PERCENTILE = 99.0
MEAN = "mean of the points around a node"
SINGULAR = 1.25  # an extreme so much beyond the percentile does not set the scale


@dataclass(frozen=True)
class Field:
    """How a field is shown."""

    label: str
    unit: str
    scale: float  # from SI to the unit
    colours: str  # perceptually even, dark where it matters, safe for the colour-blind
    sign: float = 1.0  # -1: the extreme is the smallest value
    top: float | None = None  # end of the scale, where it is not the extreme
    may_be_singular: bool = False
    on_nodes: str = ""  # what stands on nodes, where it is not the field itself

    def with_unit(self, value: float) -> str:
        """A value in words, as in '3.35 MPa'."""
        return f"{value:.3g} {self.unit}".rstrip()

    def largest(self, values: np.ndarray) -> float:
        """The extreme of values, in the unit and without sign."""
        known = self.sign * self.scale * values[np.isfinite(values)]
        return float(known.max()) if known.size else 0.0


FIELDS = {
    "S1": Field("Largest principal tension", "MPa", 1.0e-6, "magma_r", may_be_singular=True),
    "S3": Field(
        "Largest principal compression", "MPa", 1.0e-6, "cividis", -1.0, may_be_singular=True
    ),
    "S1_POINT": Field(
        "Largest tension at integration points", "MPa", 1.0e-6, "magma_r", on_nodes=MEAN
    ),
    "S3_POINT": Field(
        "Largest compression at integration points", "MPa", 1.0e-6, "cividis", -1.0, on_nodes=MEAN
    ),
    "OPENING": Field("Largest joint opening", "mm", 1.0e3, "viridis_r"),
    "SLIP": Field("Slip", "mm", 1.0e3, "cividis_r"),
    "U": Field("Largest displacement", "mm", 1.0e3, "viridis_r"),
    "DAMAGET": Field("Largest damage in tension", "", 1.0, "magma_r", top=1.0),
    "DAMAGEC": Field("Largest damage in compression", "", 1.0, "cividis_r", top=1.0),
}


@dataclass(frozen=True)
class Limits:
    """Borders of the bands of colour in the unit of the field, and what limits them."""

    borders: np.ndarray
    remark: str = ""  # why the scale ends before the extreme

    @property
    def ends(self) -> tuple[float, float]:
        """Where the scale begins and ends."""
        return float(self.borders[0]), float(self.borders[-1])

    @property
    def bands(self) -> int:
        """Number of colours."""
        return len(self.borders) - 1


@dataclass(frozen=True)
class Scales:
    """The ends of the scales: those that are given, else from the values."""

    given: dict[str, float] = field(default_factory=dict)  # by field, in its unit, without sign
    is_full: bool = False  # to the extreme, whatever it is
    shared: dict[str, float] = field(default_factory=dict)  # of all runs, as `given`
    levels: dict[str, float] = field(default_factory=dict)  # lines of equal values, by field

    def limits(self, name: str, values: np.ndarray) -> Limits:
        """Bands for values in SI units."""
        shown = FIELDS[name]
        extreme = shown.largest(values)
        if name in self.given or name in self.shared:
            end = (self.shared | self.given)[name]
            remark = "range as given" if name in self.given else "range shared by all runs"
            remark = remark if extreme > end * (1.0 + 1e-9) else ""
        else:
            end = self.end(name, values)
            remark = f"colours end at {PERCENTILE:g} % of the nodes"
            remark = remark if 0.0 < end < extreme and not shown.top else ""
        borders = round_borders(end)
        return Limits(borders if shown.sign > 0.0 else 0.0 - borders[::-1], remark)

    def end(self, name: str, values: np.ndarray) -> float:
        """Where the scale of a field ends by its values, in the unit of the field."""
        shown = FIELDS[name]
        if shown.top:
            return shown.top
        extreme = shown.largest(values)
        if self.is_full or not shown.may_be_singular or extreme <= 0.0:
            return extreme
        known = np.maximum(shown.sign * shown.scale * values[np.isfinite(values)], 0.0)
        usual = float(np.percentile(known, PERCENTILE))
        return usual if 0.0 < SINGULAR * usual < extreme else extreme


def round_borders(end: float) -> np.ndarray:
    """Round borders of bands from zero to `end` or a little beyond."""
    end = end if end > 0.0 else 1.0
    ticks = MaxNLocator(nbins=10, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, end)
    step = ticks[1] - ticks[0]
    return ticks[(ticks > -0.5 * step) & (ticks < end * (1.0 - 1e-9) + step)]


def parse_ranges(words: Iterable[str]) -> tuple[Scales, bool]:
    """Scales from words such as 'full', 'S1=3'; and whether all runs are to share them."""
    given: dict[str, float] = {}
    is_full = is_shared = False
    for word in words:
        name, equals, end = word.partition("=")
        if word == "full":
            is_full = True
        elif word == "shared":
            is_shared = True
        elif equals and name.upper() in FIELDS:
            given[name.upper()] = _positive(end, word)
        else:
            what = f"'full', 'shared' or FIELD=END with one of {', '.join(FIELDS)}"
            raise ValueError(f"range '{word}': expected {what}")
    return Scales(given, is_full), is_shared


def parse_levels(words: Iterable[str]) -> dict[str, float]:
    """Values of lines from words such as 'S1=2.48', in the units of the fields."""
    found = {}
    for word in words:
        name, _, value = word.partition("=")
        if name.upper() not in FIELDS:
            raise ValueError(f"line '{word}': expected FIELD=VALUE with one of {', '.join(FIELDS)}")
        shown = FIELDS[name.upper()]
        found[name.upper()] = shown.sign * _positive(value, word)
    return found


def _positive(text: str, word: str) -> float:
    try:
        value = abs(float(text))
    except ValueError:
        value = 0.0
    if not 0.0 < value < np.inf:
        raise ValueError(f"'{word}': expected a number other than zero behind '='")
    return value
