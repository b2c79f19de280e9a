"""Runs the same dam in all programs that are there, and tables their time, memory and answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scenes import dam_of_size, shaking, unknowns_of

from .calculix_peer import run_calculix
from .keyway_peer import run_keyway
from .opensees_peer import run_opensees
from .peer_case import INCREMENT, PeerCase, PeerRun


@dataclass(frozen=True)
class PeerOptions:
    """What to compare, and where the programs are."""

    keyway: Path
    calculix: str | None  # the command; None: not there
    opensees_python: str | None  # a Python with openseespy; None: not there
    threads: int = 2
    unknowns: int = 20_000
    increments: int = 100  # of the linear history
    jointed_increments: int = 20
    limit: float = 200.0  # of a run [s]


def motion_of(increments: int) -> np.ndarray:
    """The acceleration at each increment, twice that of the other scenes: joints open [m/s2]."""
    every = round(INCREMENT / 1.0e-3)
    return 2.0 * shaking((increments + 1) * INCREMENT)[::every][: increments + 1]


def make_cases(options: PeerOptions) -> list[PeerCase]:
    """Weight, a linear history, and a history with two joints that open and slide."""
    plain, jointed = dam_of_size(options.unknowns), dam_of_size(options.unknowns, 2)
    return [
        PeerCase("weight", plain, np.zeros(0)),
        PeerCase("linear history", plain, motion_of(options.increments)),
        PeerCase("history with two joints", jointed, motion_of(options.jointed_increments)),
    ]


def compare_peers(options: PeerOptions, folder: Path) -> None:
    """Prints the table in Markdown, each row as soon as it is known."""
    heads = ("case", "program", "time [s]", "per increment [s]", "memory [MB]")
    heads += ("largest displacement [mm]", "difference [%]", "")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    for case in make_cases(options):
        reference = None
        for run in run_all(case, options, folder / case.name.replace(" ", "_")):
            reference = reference or run
            print(row_of(case, run, reference), flush=True)


def run_all(case: PeerCase, options: PeerOptions, folder: Path) -> Iterator[PeerRun]:
    """Keyway first, then the others that are there."""
    runners: list[tuple[Callable[..., PeerRun], object]] = [
        (run_keyway, options.keyway),
        (run_calculix, options.calculix),
        (run_opensees, options.opensees_python),
    ]
    for run, program in runners:
        if program is None:
            continue
        place = folder / run.__name__
        place.mkdir(parents=True)
        yield run(case, place, program, options.threads, options.limit)


def row_of(case: PeerCase, run: PeerRun, reference: PeerRun) -> str:
    """A line of the table; differences are those of whole histories, over the largest value."""
    count = max(case.num_increments, 1)
    name = f"{case.name}, {unknowns_of(case.mesh)} unknowns, {count} increments"
    if case.mesh.joints.size:
        name += f", {len(case.pairs.area)} points"
    answer, difference = "", ""
    done = len(run.displacement) if run.failure else count
    each = f"{run.wall / done:.3g}" if done else ""
    if not run.failure:
        answer = f"{1e3 * run.largest:.4g}"
        apart = np.abs(run.displacement - reference.displacement).max(initial=0.0)
        difference = f"{100.0 * apart / reference.largest:.2g}"
    return (
        f"| {name} | {run.program} | {run.wall:.1f} | {each} |"
        f" {run.memory:.0f} | {answer} | {difference} | {run.failure} |"
    )
