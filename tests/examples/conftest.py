"""Builds the program with the addition of a worked example (see CMakeLists.txt here)."""

from __future__ import annotations

import fcntl
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from harness import ROOT, Program

Builder = Callable[[str], Program]


@pytest.fixture(scope="session")
def build_example(request: pytest.FixtureRequest) -> Callable[[str], Path]:
    """Builds keyway_<name> beside the program; one process at a time works in the build."""
    build = ROOT / "build" / request.config.getoption("--preset")

    def make(name: str) -> Path:
        with (build / "examples.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            command = ["cmake", "--build", str(build), "--target", f"keyway_{name}"]
            done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
        return build / "examples" / f"keyway_{name}"

    return make


@pytest.fixture
def example(
    build_example: Callable[[str], Path], make_program: Callable[[Path], Program]
) -> Builder:
    """example('softening_joint') is the program with that example; it runs decks as `keyway`."""
    return lambda name: make_program(build_example(name))
