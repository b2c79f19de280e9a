#!/usr/bin/env python3
"""Write the seasonal temperature of a dam, from the air and the water at its faces.

    tools/make_temperature.py dam.inp --air 14 10 --water 16 9 6 --level 105 \
        --year 12 --times 0 1 2 3 4 5 6 7 8 9 10 11 12 -o dam_temperature.csv

The file has a row for each node and a column for each time, for *TEMPERATURE, INPUT=...; NAME.png
shows the field on four dates. The upstream face has the temperature of the water below its level
(Zhu's formula), that of the air above it; the downstream face that of the air. Between the faces
the temperature is the steady periodic solution of conduction through the thickness.
Heights are coordinates along the axis that points up: UP of *RESERVOIR in the deck, --up, else z.
docs/temperature.md has the formulas and what they leave out. Lengths are in m, temperatures in
degrees Celsius, months count from 1 January: 0.5 is the middle of January.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
import numpy as np
from keyway_tools.command import Parser, command
from keyway_tools.option_types import above_zero, count, finite
from keyway_tools.program import reason_of
from keyway_tools.temperature.climate import (
    FREEZING,
    MONTHS,
    WARMEST,
    Air,
    Climate,
    Level,
    Water,
)
from keyway_tools.temperature.dam_in_deck import (
    Dam,
    Place,
    first_layer,
    nodes_without_thickness,
    place_nodes,
    read_dam,
)
from keyway_tools.temperature.field import YEAR, Clock, seasonal_field, write_field
from keyway_tools.temperature.periodic_wall import Wall

PICTURE = ".png"
FEW, MANY = 1, 12  # harmonics for a constant level, and for one that changes


def read_options(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=Path, help="deck with the mesh; *INCLUDE files are read")
    parser.add_argument("-o", "--output", type=Path, help="file (NAME_temperature.csv)")
    parser.add_argument("--no-picture", action="store_true", help="only the file")
    add_mesh_options(parser)
    add_climate_options(parser)
    add_time_options(parser)
    return parser.parse_args(arguments)


def add_mesh_options(parser: argparse.ArgumentParser) -> None:
    """Names in the deck."""
    group = parser.add_argument_group("dam")
    group.add_argument("--dam", default="DAM", help="set of the dam's elements (DAM)")
    text = "face, a surface or a set of nodes"
    group.add_argument("--upstream", default="UPSTREAM", help=f"{text} (UPSTREAM)")
    group.add_argument("--downstream", default="DOWNSTREAM", help=f"{text} (DOWNSTREAM)")
    what = "axis that points up (UP of *RESERVOIR in the deck, else 3: z)"
    group.add_argument("--up", type=int, choices=(1, 2, 3), help=what)
    group.add_argument(
        "--diffusivity", type=above_zero, default=1.0e-6, help="of the concrete [m2/s] (1e-6)"
    )
    group.add_argument(
        "--linear", action="store_true", help="straight through the thickness: for coarse meshes"
    )
    group.add_argument(
        "--rock", type=finite, metavar="T", help="temperature of all other nodes (not written)"
    )


def add_climate_options(parser: argparse.ArgumentParser) -> None:
    """Air, sun and water."""
    group = parser.add_argument_group("air and water")
    pair = ("MEAN", "AMPLITUDE")
    group.add_argument("--air", type=finite, nargs=2, required=True, metavar=pair, help="of a year")
    group.add_argument(
        "--warmest", type=finite, default=WARMEST, metavar="MONTH", help=f"of the air ({WARMEST})"
    )
    group.add_argument(
        "--sun", type=finite, nargs=2, default=(0.0, 0.0), metavar=pair, help="of dry faces (0 0)"
    )
    group.add_argument(
        "--water", type=finite, nargs=3, metavar=("SURFACE", "AMPLITUDE", "BOTTOM"),
        help="annual mean and amplitude at the surface, mean at the bottom (no water)",
    )  # fmt: skip
    group.add_argument(
        "--level",
        nargs="+",
        metavar="Z",
        help="of the water along the axis that points up: a height, or MONTH:HEIGHT words",
    )
    group.add_argument("--bed", type=finite, help="height of the bottom (foot of the face)")


def add_time_options(parser: argparse.ArgumentParser) -> None:
    """Times of the deck."""
    group = parser.add_argument_group("times of the deck")
    group.add_argument(
        "--times", type=finite, nargs="+", metavar="T", help="of the file (each month of a year)"
    )
    group.add_argument("--start", type=finite, default=0.0, metavar="MONTH", help="at time 0 (0)")
    text = "length of a year in the deck's unit of time"
    group.add_argument("--year", type=above_zero, default=YEAR, help=f"{text} ({YEAR:.0f})")
    group.add_argument(
        "--harmonics", type=count, help=f"of a year ({FEW}; {MANY} where the level changes)"
    )


def climate_of(chosen: argparse.Namespace, dam: Dam) -> Climate:
    """Air and water from the command line. Raises ValueError."""
    air = Air(*chosen.air, chosen.warmest, *chosen.sun)
    if (chosen.water is None) != (chosen.level is None):
        raise ValueError("--water and --level belong together: expected both or none")
    if chosen.water is None:
        return Climate(air)
    level = Level.parse(chosen.level)
    foot = min(dam.x[node, 2] for face in dam.upstream for node in face)
    bed = foot if chosen.bed is None else chosen.bed
    surface, amplitude, bottom = chosen.water
    depth = max(level.heights) - bed
    return Climate(air, Water(surface, amplitude, bottom, depth, chosen.warmest), level)


def times_of(chosen: argparse.Namespace) -> np.ndarray:
    """Times of the file, growing. Raises ValueError."""
    if chosen.times is None:
        return chosen.year * np.arange(MONTHS + 1.0) / MONTHS
    times = np.array(chosen.times)
    if (np.diff(times) <= 0.0).any():
        raise ValueError("--times: expected growing times")
    return times


def warn_of_ice(water: Water | None) -> None:
    """The formula knows no ice."""
    lowest, depth = (FREEZING, 0.0) if water is None else water.coldest()
    if lowest < FREEZING:
        print(
            f"make_temperature: warning: the water falls to {lowest:.1f} deg C, {depth:.0f} m below"
            " its surface; it freezes at 0: check --water SURFACE AMPLITUDE BOTTOM",
            file=sys.stderr,
        )


def show(dam: Dam, place: Place, wall: Wall, is_linear: bool) -> None:
    """Print sizes, and whether the elements are too thick for the wave of a year."""
    low, high = place.thickness.min(), place.thickness.max()
    print(f"{len(dam.numbers)} nodes of the dam, {low:.2f} to {high:.2f} m thick")
    meeting = len(nodes_without_thickness(dam, place))
    if meeting:
        print(f"note: the faces meet at {meeting} nodes of the crest: the mean of both there")
    layer, fall = first_layer(dam, place), 1.0 / wall.wave_number(1).real
    if layer > fall and not is_linear:
        print(f"note: elements at the faces are up to {layer:.1f} m thick, the wave of a year")
        print(f"      falls by e over {fall:.1f} m: --linear keeps its mean and its moment")


@command("make_temperature")
def main(arguments: list[str] | None = None) -> int:
    """Write the field and its picture."""
    chosen = read_options(arguments)
    output = chosen.output or chosen.deck.with_name(f"{chosen.deck.stem}_temperature.csv")
    try:
        dam = read_dam(chosen.deck, chosen.dam, chosen.upstream, chosen.downstream, chosen.up)
        if output.resolve() in dam.sources:
            raise ValueError(f"{output}: the output would overwrite the deck; expected a new file")
        if output.suffix == PICTURE and not chosen.no_picture:
            raise ValueError(f"{output}: the picture has this name; expected a table as x.csv")
        climate, times = climate_of(chosen, dam), times_of(chosen)
        is_even = climate.level is None or climate.level.is_constant
        harmonics = FEW if is_even else MANY
        if chosen.harmonics is not None:
            harmonics = chosen.harmonics
        clock, place = Clock(chosen.start, chosen.year), place_nodes(dam)
        nodes_without_thickness(dam, place)
        wall = Wall(place.depth, place.thickness, chosen.diffusivity, YEAR)
        field = seasonal_field(wall, place, climate, harmonics, chosen.linear)
        values = field.at(clock.part_of_year(times))
        output.parent.mkdir(parents=True, exist_ok=True)
        write_field(output, dam, values, times, chosen.rock)
    except (OSError, ValueError) as fault:
        print(f"make_temperature: {reason_of(fault)}", file=sys.stderr)
        return 2
    warn_of_ice(climate.water)
    show(dam, place, wall, chosen.linear)
    print(f"{len(times)} times, {values.min():.2f} to {values.max():.2f} degrees; wrote {output}")
    if not chosen.no_picture:
        from keyway_tools.temperature.pictures import plot_seasons  # VTK is slow to load

        print("wrote", plot_seasons(dam, field, output.with_suffix(PICTURE)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
