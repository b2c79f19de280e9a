#!/usr/bin/env python3
"""Make a three-component ground motion that fits a design spectrum, or take a recorded one.

Writes PREFIX_x.txt, PREFIX_y.txt, PREFIX_z.txt (accelerations in m/s2 for *AMPLITUDE, INPUT=...),
PREFIX.json (options and misfits), PREFIX_spectra.png and PREFIX_records.png. The same seed gives
the same record. Default target: the spectrum of the Chinese standard for hydraulic structures
(NB 35047-2015, GB 51247-2018) for arch dams on hard rock: beta = 1 at T = 0, 2.5 from 0.1 s to
T_g = 0.2 s, then 2.5 (T_g / T)^0.6, not below 0.5; vertical 2/3 of the horizontal acceleration.

With --record FILE... the motion is that of files, turned into m/s2, cut, resampled and scaled:

    make_motion.py --record RSN1_A.AT2 RSN1_B.AT2 RSN1_UP.AT2 --pga 0.3 --baseline -o quake
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
import numpy as np
from keyway_tools.command import Parser, command
from keyway_tools.design_spectrum import VERTICAL_SHARE, DesignSpectrum
from keyway_tools.ground_motion import Motion, MotionOptions, final_motion, fit_motion
from keyway_tools.motion_files import plot_spectra, write_amplitude, write_summary
from keyway_tools.motion_pictures import Accelerogram, plot_accelerograms
from keyway_tools.option_types import above_zero, count_from_zero, from_zero
from keyway_tools.records.command import add_options, make_from_records
from keyway_tools.response_spectrum import GRAVITY

DEFAULT_PGA = 0.269  # [g]
FEWEST, MOST = 50.0, 1e6  # times dt in a duration


def read_options(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    spectrum, times = DesignSpectrum(), MotionOptions()
    parser.add_argument("-o", "--output", type=Path, default=Path("motion"), help="PREFIX (motion)")
    parser.add_argument("--seed", type=count_from_zero, default=1, help="of the random phases (1)")
    parser.add_argument("--pga", type=above_zero, help="horizontal peak [g] (0.269)")
    parser.add_argument("--vertical", type=from_zero, default=VERTICAL_SHARE, help="share (2/3)")
    parser.add_argument(
        "--plateau", type=above_zero, default=spectrum.plateau, help="beta_max (2.5)"
    )
    parser.add_argument("--tg", type=above_zero, default=spectrum.corner, help="T_g [s] (0.2)")
    parser.add_argument("--decay", type=from_zero, default=spectrum.decay, help="exponent (0.6)")
    parser.add_argument("--duration", type=above_zero, default=times.duration, help="[s] (10)")
    parser.add_argument(
        "--dt", type=above_zero, help="[s] (0.01); of --record: in files of one column"
    )
    parser.add_argument(
        "--rise", type=above_zero, help="end of the envelope's rise [s] (0.1 duration)"
    )
    parser.add_argument(
        "--strong", type=above_zero, help="end of its level part [s] (0.6 duration)"
    )
    parser.add_argument("--format", choices=("VALUES", "PAIRS"), default="VALUES", dest="layout")
    parser.add_argument("--no-pictures", action="store_true")
    add_options(parser)
    return parser.parse_args(arguments)


def refuse_record_options(chosen: argparse.Namespace) -> None:
    """Options that have an effect with --record alone."""
    for name in ("unit", "axes", "cut", "resample", "fit", "factor", "baseline"):
        if getattr(chosen, name):
            raise ValueError(f"--{name} has no effect without --record FILE")


def times_of(chosen: argparse.Namespace) -> MotionOptions:
    """MotionOptions from the command line."""
    steps = chosen.duration / chosen.dt
    if not FEWEST <= steps <= MOST:
        raise ValueError(
            f"--duration {chosen.duration:g} with --dt {chosen.dt:g}: expected {FEWEST:g} to "
            f"{MOST:g} times dt"
        )
    rise = 0.1 * chosen.duration if chosen.rise is None else chosen.rise
    strong = 0.6 * chosen.duration if chosen.strong is None else chosen.strong
    if not 0.0 < rise <= strong < chosen.duration:
        raise ValueError("0 < rise <= strong < duration must hold")
    return MotionOptions(
        duration=chosen.duration,
        dt=chosen.dt,
        rise=rise,
        strong=strong,
        taper=0.04 * chosen.duration,
        shortest_period=max(0.04, 4.0 * chosen.dt),
    )


def print_facts(name: str, motion, peak: float, options: MotionOptions) -> None:
    """One line a component: misfits, peaks, rest at the end."""
    ends = peak * final_motion(motion.acceleration, options.dt)
    velocity = peak * options.dt * np.abs(np.cumsum(motion.acceleration)).max()
    print(
        f"{name}: mean misfit {100.0 * motion.mean_misfit:.2f} %, largest "
        f"{100.0 * np.abs(motion.misfit).max():.2f} %; peak {peak / GRAVITY:.4f} g, "
        f"{velocity:.3f} m/s; at the end {ends[0]:.1e} m/s, {ends[1]:.1e} m"
    )


def draw(prefix: Path, motions: dict[str, Motion], peaks: dict[str, float], dt: float) -> None:
    """Pictures of the spectra and of the components in time."""
    spectra = prefix.with_name(f"{prefix.name}_spectra.png")
    records = prefix.with_name(f"{prefix.name}_records.png")
    components = [
        Accelerogram(f"Component {name}", peaks[name] * motion.acceleration, dt)
        for name, motion in motions.items()
    ]
    print("wrote", plot_spectra(spectra, motions, peaks))
    print("wrote", plot_accelerograms(records, components))


@command("make_motion")
def main(arguments: list[str] | None = None) -> int:
    """Fit the three components and write them."""
    chosen = read_options(arguments)
    try:
        if chosen.record:
            make_from_records(chosen, DEFAULT_PGA)
            return 0
        refuse_record_options(chosen)
        chosen.pga = DEFAULT_PGA if chosen.pga is None else chosen.pga
        chosen.dt = MotionOptions().dt if chosen.dt is None else chosen.dt
        options = times_of(chosen)
    except ValueError as fault:
        print(f"make_motion: {fault}", file=sys.stderr)
        return 2
    spectrum = DesignSpectrum(chosen.plateau, chosen.tg, chosen.decay)
    horizontal = chosen.pga * GRAVITY
    peaks = {"x": horizontal, "y": horizontal, "z": chosen.vertical * horizontal}
    motions = {
        name: fit_motion(spectrum, [chosen.seed, k], options) for k, name in enumerate(peaks)
    }
    chosen.output.parent.mkdir(parents=True, exist_ok=True)
    prefix = chosen.output
    for name, motion in motions.items():
        file = prefix.with_name(f"{prefix.name}_{name}.txt")
        write_amplitude(file, peaks[name] * motion.acceleration, options.dt, chosen.layout)
        print_facts(name, motion, peaks[name], options)
    correlation = np.corrcoef([motion.acceleration for motion in motions.values()])
    print(f"largest correlation of two components {np.abs(correlation - np.eye(3)).max():.2f}")
    facts = {"seed": chosen.seed, "pga_g": chosen.pga, "format": chosen.layout}
    facts |= {"spectrum": asdict(spectrum), "record": asdict(options)}
    write_summary(prefix.with_name(f"{prefix.name}.json"), motions, facts)
    if not chosen.no_pictures:
        draw(prefix, motions, peaks, options.dt)
    return 0


if __name__ == "__main__":
    sys.exit(main())
