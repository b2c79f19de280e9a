"""Runs with little memory end with code 3 and the part that asked for it, with and without a UMAT.

The limits lie where a run of the deck just fails: libraries such as HDF5 have no message of their
own there. Which part fails depends on the machine and on chance, so no part is expected.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from memory_limits import run_with
from restart_case import deck

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
ELASTIC = "*ELASTIC\n20e9, 0.2\n"


@pytest.fixture(scope="module")
def umat(program_path: Path, tmp_path_factory) -> Path:
    library = tmp_path_factory.mktemp("umat") / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    return library


def least_memory(program: Path, path: Path, options: list[str]) -> int:
    """Megabytes in which the deck about runs, by bisection: addresses of a process vary."""
    low, high = 100, 1000
    while high - low > 2:
        middle = (low + high) // 2
        end = run_with(program, path, options, middle)
        assert end.is_good, f"{middle} MB: {end}"
        low, high = (low, middle) if end.code == 0 else (middle, high)
    return high


@pytest.mark.parametrize("has_umat", [False, True])
def test_just_too_little_memory(program_path, umat, tmp_path, has_umat):
    path = tmp_path / "job.inp"
    user = deck()[deck().index("*USER MATERIAL") : deck().index("*MATERIAL, NAME=ROCK")]
    path.write_text(deck() if has_umat else deck().replace(user, ELASTIC))
    options = ["-j", "1", *(["--umat", str(umat)] if has_umat else [])]
    enough = least_memory(program_path, path, options)
    for megabytes in range(enough - 24, enough + 8, 4):
        end = run_with(program_path, path, options, megabytes)
        assert end.is_good, f"{megabytes} MB: {end}"
