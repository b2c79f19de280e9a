"""Runs solve_joint_problems and reads its lines."""

from __future__ import annotations

import lzma
import subprocess
from dataclasses import dataclass
from pathlib import Path

import h5py

SAVED = Path(__file__).resolve().parent / "saved"
METHODS = ("policy", "newton", "sweeps", "passes")
# Of stages, and of water that follows openings: the problems were saved before.
ABSENT = {"is_pressed", "lets_water_in", "origin", "part_origin", "phase"}


@dataclass(frozen=True)
class Solved:
    """What a method has done with a problem."""

    file: str
    problem: int
    points: int
    converged: bool
    is_loose: bool  # a block leaves its joints or slides without end: no equilibrium
    iterations: int
    sweeps: int
    passes: int
    seconds: float
    residual: float


def solve(solver: Path, method: str, files: list[Path], limit: float = 600.0) -> list[Solved]:
    """Solves all problems of some files."""
    command = [str(solver), method, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=True)
    return [read_line(line) for line in done.stdout.splitlines()]


def read_line(line: str) -> Solved:
    file, *rest = (word.strip() for word in line.split(","))
    problem, points, converged, loose, iterations, sweeps, passes, seconds, residual = rest
    counts = (int(word) for word in (iterations, sweeps, passes))
    states = (word == "T" for word in (converged, loose))
    numbers = (float(seconds), float(residual))
    return Solved(file, int(problem), int(points), *states, *counts, *numbers)


def unpack(folder: Path, files: list[Path]) -> list[Path]:
    """Compressed problems as HDF5 files in a folder."""
    paths = [folder / path.stem for path in files]
    for path, source in zip(paths, files, strict=True):
        path.write_bytes(lzma.decompress(source.read_bytes()))
        add_absent(path)
    return paths


def add_absent(path: Path) -> None:
    """Adds what histories of joints lack: vectors without values."""
    with h5py.File(path, "r+") as file:
        for problem in (file[name] for name in file if name.startswith("problem_")):
            for joint in (problem[name] for name in problem if name.startswith("joint_")):
                for name in ABSENT - set(joint):
                    joint[name] = h5py.Empty("i4")
