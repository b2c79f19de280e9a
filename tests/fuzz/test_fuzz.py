"""Mutated decks: the program accepts or refuses each of them, and never crashes (fuzz.py)."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fuzz import Fuzzer, all_decks
from harness import ROOT

SEED = 20260117
NUM_MUTANTS = 600
NUM_MANY = 100_000


def workers() -> int:
    """Tests that run in parallel share the processors."""
    return max((os.cpu_count() or 1) // int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")), 1)


def try_mutants(program: Path, first: int, last: int, *, runs: bool = False) -> None:
    fuzzer = Fuzzer(program, SEED, all_decks(), runs=runs)
    outcomes = fuzzer.try_many(first, last, workers())
    assert len(outcomes) == last - first
    bad = [f"mutant {x.number}: {x.problem}" for x in outcomes if x.problem]
    assert not bad, f"seed {SEED}\n" + "\n".join(bad[:20])
    accepted = sum(x.code == 0 for x in outcomes)
    assert 0.05 * len(outcomes) < accepted < 0.95 * len(outcomes), "mutants that test both sides"


@pytest.mark.parametrize("part", range(4))
def test_mutants(program_path: Path, part: int) -> None:
    size = NUM_MUTANTS // 4
    try_mutants(program_path, part * size, (part + 1) * size)


@pytest.mark.full
def test_many_mutants(program_path: Path) -> None:
    try_mutants(program_path, NUM_MUTANTS, NUM_MANY)


@pytest.mark.full
def test_mutants_that_run(program_path: Path) -> None:
    try_mutants(program_path, NUM_MANY, NUM_MANY + NUM_MUTANTS, runs=True)


@pytest.mark.full
def test_many_mutants_with_sanitizers() -> None:
    program = ROOT / "build" / "sanitize" / "keyway"
    if not program.exists():
        pytest.skip("cmake --preset sanitize and cmake --build build/sanitize first")
    try_mutants(program, 0, NUM_MANY)
