"""Records of files, treated and written for *AMPLITUDE (tools/make_motion.py --record)."""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path

import numpy as np

from ..design_spectrum import DesignSpectrum
from ..ground_motion import final_motion
from ..motion_files import write_amplitude
from ..motion_pictures import Accelerogram, plot_accelerograms
from ..option_types import above_zero, finite
from ..response_spectrum import GRAVITY
from .columns import refuse_dt
from .pictures import plot_spectra
from .read_record import read_record
from .record import AXES, FACTORS, Record, RecordError
from .treatment import (
    cut,
    factor_to_peak,
    factor_to_spectrum,
    same_times,
    settle,
    strong_duration,
)

# Names of vertical components: 'vertical(up-down)', 'UP', 'UD', 'V', 'RSN1_PEL-UP'.
VERTICAL = re.compile(r"vert|(?<![a-z])(?:up|ud|v|dwn|down)(?![a-z])", re.IGNORECASE)


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options that go with --record."""
    group = parser.add_argument_group("recorded motions")
    group.add_argument(
        "--record",
        nargs="+",
        type=Path,
        metavar="FILE",
        help="files of recorded acceleration in place of a made one: PEER AT2, COSMOS and CSMIP "
        "volume 2, K-NET and KiK-net, columns of time and values",
    )
    group.add_argument(
        "--unit", type=str.upper, choices=tuple(FACTORS), help="where files name none"
    )
    group.add_argument(
        "--axes", nargs="+", choices=AXES, help="axis of each component in order (x y z)"
    )
    group.add_argument("--cut", nargs=2, type=finite, metavar=("START", "END"), help="part [s]")
    group.add_argument("--resample", type=above_zero, metavar="DT", help="time between values [s]")
    group.add_argument(
        "--fit",
        nargs=2,
        type=above_zero,
        metavar=("T1", "T2"),
        help="scale all components by one factor, so that the horizontal spectra fit the design "
        "spectrum over these periods [s]; without --fit, --pga scales to that peak",
    )
    group.add_argument("--factor", type=finite, help="multiply all components")
    group.add_argument("--baseline", action="store_true", help="correct the base line")


def collect(chosen: argparse.Namespace) -> dict[str, Record]:
    """Components of all files, by axis."""
    records = [r for file in chosen.record for r in read_record(file, chosen.unit, chosen.dt)]
    if chosen.dt is not None:
        refuse_dt(records, "--dt")
    axes = chosen.axes or AXES[: len(records)]
    if len(axes) != len(records) or len(set(axes)) != len(axes):
        names = ", ".join(record.name for record in records)
        raise RecordError(
            f"{len(records)} components ({names}) for the axes {' '.join(axes)}; expected --axes "
            "with another axis for each component, at most three"
        )
    found = dict(sorted(zip(axes, records, strict=True)))
    if chosen.axes is None and len(found) > 1:
        print(f"make_motion: {note_on_axes(found)}", file=sys.stderr)
    return found


def note_on_axes(records: dict[str, Record]) -> str:
    """Which component each axis has got by the order of the files."""
    given = ", ".join(f"{axis} is '{record.name}'" for axis, record in records.items())
    note = f"{given}: the order of the files; --axes gives another one, as in --axes y z x"
    upright = [(axis, r.name) for axis, r in records.items() if VERTICAL.search(r.name)]
    wrong = [f"'{name}' has become {axis}, not z" for axis, name in upright if axis != "z"]
    return "; ".join([note, *wrong])


def scale_of(records: dict[str, Record], chosen: argparse.Namespace, peak: float) -> float:
    """The factor of all components."""
    horizontal = [r for axis, r in records.items() if axis != "z"] or list(records.values())
    if min(record.peak for record in horizontal) <= 0.0:
        raise RecordError("a horizontal component is zero at all times")
    if chosen.fit:
        if not 0.0 < chosen.fit[0] < chosen.fit[1]:
            raise RecordError("--fit: expected two periods T1 < T2, above zero")
        spectrum = DesignSpectrum(chosen.plateau, chosen.tg, chosen.decay)
        return factor_to_spectrum(horizontal, spectrum, peak, tuple(chosen.fit))
    if chosen.pga is not None:
        return factor_to_peak(horizontal, peak)
    return 1.0 if chosen.factor is None else chosen.factor


def check_options(chosen: argparse.Namespace) -> None:
    """Options that exclude each other."""
    if chosen.factor is not None and (chosen.pga is not None or chosen.fit):
        raise RecordError("--factor together with --pga or --fit; expected one way to scale")


def make_from_records(chosen: argparse.Namespace, default_pga: float) -> None:
    """Reads, treats and writes the records; says what they are."""
    check_options(chosen)
    records = collect(chosen)
    if chosen.cut:
        records = {axis: cut(record, *chosen.cut) for axis, record in records.items()}
    records = same_times(records, chosen.resample)
    if chosen.baseline:
        records = {axis: settle(record) for axis, record in records.items()}
    peak = default_pga if chosen.pga is None else chosen.pga
    factor = scale_of(records, chosen, peak)
    records = {a: r.with_values(factor * r.acceleration) for a, r in records.items()}
    write_all(records, factor, peak, chosen)


def write_all(
    records: dict[str, Record], factor: float, peak: float, chosen: argparse.Namespace
) -> None:
    """Files for *AMPLITUDE, a summary, pictures, and a line a component."""
    prefix = chosen.output
    prefix.parent.mkdir(parents=True, exist_ok=True)
    facts = {"factor": factor, "format": chosen.layout, "components": {}}
    for axis, record in records.items():
        file = prefix.with_name(f"{prefix.name}_{axis}.txt")
        write_amplitude(file, record.acceleration, record.dt, chosen.layout)
        facts["components"][axis] = facts_of(record)
        print(line_of(file, record))
    print(f"factor of all components {factor:.4g}")
    prefix.with_name(f"{prefix.name}.json").write_text(json.dumps(facts, indent=2) + "\n")
    step = next(iter(records.values())).dt
    axis = next(iter(records))
    layout = f"FORMAT=VALUES, DT={step:g}" if chosen.layout == "VALUES" else "FORMAT=PAIRS"
    card = f"*AMPLITUDE, NAME=MOTION_{axis.upper()}, INPUT={prefix.name}_{axis}.txt"
    print(f"in a deck: {card}, {layout}")
    if chosen.no_pictures:
        return
    target = None
    if chosen.fit:
        spectrum = DesignSpectrum(chosen.plateau, chosen.tg, chosen.decay)
        target = lambda period: peak * spectrum(period)  # noqa: E731
    print("wrote", plot_spectra(prefix.with_name(f"{prefix.name}_spectra.png"), records, target))
    motions = [
        Accelerogram(f"{axis}: {record.name}", record.acceleration, record.dt)
        for axis, record in records.items()
    ]
    print("wrote", plot_accelerograms(prefix.with_name(f"{prefix.name}_records.png"), motions))


def facts_of(record: Record) -> dict:
    """What the summary says of a component."""
    ends = final_motion(record.acceleration, record.dt)
    return {
        "source": record.source.name,
        "component": record.name,
        "file_kind": record.layout,
        "unit_of_the_file": record.unit,
        "dt_s": record.dt,
        "values": int(record.acceleration.size),
        "peak_g": record.peak / GRAVITY,
        "strong_duration_s": strong_duration(record),
        "velocity_at_the_end_m_s": float(ends[0]),
        "displacement_at_the_end_m": float(ends[1]),
    }


def line_of(file: Path, record: Record) -> str:
    """One line for people."""
    ends = final_motion(record.acceleration, record.dt)
    velocity = record.dt * float(np.abs(np.cumsum(record.acceleration)).max())
    peak = record.peak / GRAVITY
    return (
        f"{file.name}: {record.name} of {record.source.name} ({record.layout}, {record.unit}); "
        f"{record.acceleration.size} values every {record.dt:g} s; peak {peak:.4f} g "
        f"= {record.peak:.4g} m/s2, {velocity:.3g} m/s; strong part "
        f"{strong_duration(record):.3g} s; at the end {ends[0]:.1e} m/s, {ends[1]:.1e} m"
    )
