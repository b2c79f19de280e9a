#!/usr/bin/env python3
"""Saves joint problems: runs decks of tests/hard with other frictions, meshes and motions, keeps
the increments that need many iterations, and writes them to tests/joint_problems/saved.

Increments with the same operator share a file; the hardest of them are kept, some with another
friction as well. With --full larger models are run too; give them a folder of their own with --out.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import lzma
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("tests/hard", "tests/verify", "tests", "tools")]

from problem_runs import RunIsOver, Saver, runs  # noqa: E402
from solved import SAVED, solve  # noqa: E402

OPERATOR = ("weight", "first_point", "area", "compliance")
MOST_OF_AN_OPERATOR = 14  # increments in a file
NUM_VARIED = 5  # of them with other frictions as well
FACTORS = (0.6, 1.6)  # of friction


def operator_of(path: Path) -> str:
    """A key of the operator of a file."""
    with h5py.File(path) as file:
        values = b"".join(np.asarray(file["operator"][name]).tobytes() for name in OPERATOR)
    return hashlib.sha256(values).hexdigest()


def copy_group(source: h5py.Group, target: h5py.Group) -> None:
    """Copies datasets and groups."""
    for name, item in source.items():
        if isinstance(item, h5py.Group):
            copy_group(item, target.create_group(name))
        else:
            source.copy(name, target)


def write_problems(path: Path, sources: list[Path], num_varied: int) -> None:
    """One compressed file with the operator and the problems of some files."""
    plain = path.with_suffix(".h5")
    with h5py.File(plain, "w", libver="latest") as file:
        number = 0
        for k, source in enumerate(sources):
            with h5py.File(source) as single:
                if k == 0:
                    copy_group(single["operator"], file.create_group("operator"))
                    single.copy("keyway_archive", file)
                for factor in (1.0, *(FACTORS if k < num_varied else ())):
                    number += 1
                    group = file.create_group(f"problem_{number}")
                    copy_group(single["problem_1"], group)
                    scale_friction(group, factor)
        file["num_problems"] = np.int32(number)
    path.write_bytes(lzma.compress(plain.read_bytes(), preset=9))
    plain.unlink()


def scale_friction(problem: h5py.Group, factor: float) -> None:
    """Changes the friction of all joints of a problem."""
    for name, joint in problem.items():
        if name.startswith("joint_"):
            joint["friction"][()] = factor * joint["friction"][()]


def hardest(solver: Path, sources: list[Path]) -> list[Path]:
    """The increments with the most iterations by the policy. Of a run that finds no equilibrium
    only one attempt: the smaller ones repeat it."""
    found = solve(solver, "policy", sources)
    order = sorted(range(len(sources)), key=lambda k: -found[k].iterations)
    lost = [k for k in order if not found[k].converged]
    first = {sources[k].parent: k for k in reversed(lost)}
    kept = [k for k in order if found[k].converged or first[sources[k].parent] == k]
    return [sources[k] for k in kept[:MOST_OF_AN_OPERATOR]]


def collect(options, folder: Path) -> dict[str, dict[str, list[Path]]]:
    """Files of single problems by the name of their decks and by their operator."""
    found: dict[str, dict[str, list[Path]]] = {}
    for number, (name, iterations, run) in enumerate(runs(options.full)):
        if options.case and not any(word in name for word in options.case):
            continue
        place = folder / str(number)
        (place / "out").mkdir(parents=True)
        with contextlib.suppress(RunIsOver):
            run(Saver(options.program.resolve(), place, iterations))
        files = sorted((place / "out").glob("*_joints_*.h5"))
        sys.stdout.write(f"{name}: {len(files)} increments\n")
        for path in files:
            found.setdefault(name, {}).setdefault(operator_of(path), []).append(path)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/keyway")
    parser.add_argument("--solver", type=Path)
    parser.add_argument("--out", type=Path, default=SAVED)
    parser.add_argument("--full", action="store_true", help="larger models as well")
    parser.add_argument("--case", action="append", help="only files with this in their names")
    options = parser.parse_args()
    build = options.program.resolve().parent
    solver = options.solver or build / "tests/joint_problems/solve_joint_problems"
    options.out.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, by_operator in collect(options, Path(folder)).items():
            for k, sources in enumerate(by_operator.values(), 1):
                path = options.out / f"{name}_{k}.h5.xz"
                write_problems(path, hardest(solver, sources), NUM_VARIED)


if __name__ == "__main__":
    main()
