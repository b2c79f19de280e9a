"""What all tests share: the program, its threads, and the cases of tests/decks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from harness import ROOT, Program


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--preset", default="release", help="build of the program (release)")
    parser.addoption("--threads", type=int, default=2, help="threads of each run (2)")


@pytest.fixture(scope="session")
def program_path(request: pytest.FixtureRequest) -> Path:
    """The built program."""
    preset = request.config.getoption("--preset")
    path = Path(os.environ.get("KEYWAY", ROOT / "build" / preset / "keyway"))
    assert path.exists(), f"{path} is not built; run tools/setup {preset}"
    return path


@pytest.fixture
def keyway(program_path: Path, tmp_path: Path, request: pytest.FixtureRequest) -> Program:
    """Runs a deck and returns its results: keyway(deck, '--option', code=0).csv('node_TIP')."""
    return Program(program_path, tmp_path, request.config.getoption("--threads"))
