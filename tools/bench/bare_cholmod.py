"""Solves of CHOLMOD alone with the matrix of a deck, beside which increments are measured."""

from __future__ import annotations

import os
import statistics
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from measured_run import Program, Run


@dataclass(frozen=True)
class BareSolve:
    """Seconds of a solve with one right-hand side, in two orders of elimination."""

    same_order: float  # that of the program, which keeps joints together
    own_order: float  # that of METIS


def bench_program(program: Program) -> Path:
    """The program of the bare solves, beside the program under measurement."""
    return program.path.parent / "bench/bench_bare_solve"


def missing_program(program: Program) -> str:
    """What to do where the program of the bare solves is missing."""
    path = bench_program(program)
    command = f"cmake --build {program.path.parent} --target bench_bare_solve"
    return f"{path} is missing; build it with '{command}'"


def measure_beside(
    program: Program, deck: Path, measure: Callable[[], Run]
) -> tuple[Run, BareSolve]:
    """A run, and the medians of bare solves before and after it."""
    before = _seconds(program, deck)
    run = measure()
    after = _seconds(program, deck)
    return run, BareSolve(*(statistics.median(a + b) for a, b in zip(before, after, strict=True)))


def _seconds(program: Program, deck: Path) -> list[list[float]]:
    """Seconds of each solve with the stiffness of the first step of a deck, joints closed.

    The BLAS has one thread: two are slower with one right-hand side.
    """
    path = bench_program(program)
    if not path.exists():
        raise SystemExit(f"bench: {missing_program(program)}")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run([str(path), str(deck)], capture_output=True, text=True, env=environment)
    if done.returncode:
        raise SystemExit(f"bench: {path} {deck} ended with {done.returncode}: {done.stderr}")
    lines = [[float(word) for word in line.split()] for line in done.stdout.splitlines()]
    return [line[2:] for line in lines]  # behind entries and time of the factor
