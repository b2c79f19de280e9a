"""Options of tools/make_dam.py on construction and temperature."""

from __future__ import annotations

import argparse

from ..option_types import above_zero, count, finite, from_zero
from .heat import Temperatures
from .lifts import Construction


def add_construction_options(parser: argparse.ArgumentParser) -> None:
    """Options that become a Construction."""
    group = parser.add_argument_group("construction")
    group.add_argument("--lifts", type=count, help="build the dam in so many lifts (at once)")
    text = "grout the joints after these lifts (never: they have their law from the start)"
    group.add_argument("--grouting", type=count, nargs="+", default=[], metavar="LIFT", help=text)
    group.add_argument("--grout-pressure", type=from_zero, default=0.0, help="[Pa] (0)")
    group.add_argument(
        "--temperatures", type=finite, nargs=3, metavar=("ALPHA", "PLACING", "CLOSURE"),
        help="expansion [1/K], temperatures of fresh concrete and at grouting [deg C]",
    )  # fmt: skip
    text = "file of make_temperature.py beside the deck, then the duration in its unit of time and "
    text += "the increment, after the water"
    three = ("FILE", "DURATION", "INCREMENT")
    group.add_argument("--seasons", nargs=3, metavar=three, help=text)


def construction_of(chosen: argparse.Namespace) -> Construction | None:
    """Construction from the command line; None for a dam that is there at once."""
    if chosen.lifts is None:
        if chosen.grouting or chosen.grout_pressure:
            raise ValueError("--grouting and --grout-pressure need --lifts")
        return None
    if chosen.grout_pressure and not chosen.grouting:
        raise ValueError("--grout-pressure needs --grouting")
    return Construction(chosen.lifts, tuple(chosen.grouting), chosen.grout_pressure)


def temperatures_of(chosen: argparse.Namespace) -> Temperatures | None:
    """Temperatures from the command line; None for a dam without."""
    if chosen.temperatures is None:
        if chosen.seasons:
            raise ValueError("--seasons needs --temperatures")
        return None
    if not chosen.grouting:
        raise ValueError("--temperatures needs --lifts and --grouting")
    if chosen.seasons is None:
        return Temperatures(*chosen.temperatures)
    file, *times = chosen.seasons
    try:
        duration, increment = map(above_zero, times)
    except argparse.ArgumentTypeError:
        raise ValueError(
            f"--seasons {' '.join(chosen.seasons)}: expected a file and two numbers above 0"
        ) from None
    return Temperatures(*chosen.temperatures, file, duration, increment)
