"""What all tests share: the program, its threads, and the cases of tests/decks."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from documented import Documented
from harness import ROOT, Program

LIMIT_OF_LONG_TESTS = 3600  # [s]
# Folders, and messages of decks: directions and free parts in them are computed.
NUMERICAL = {"compatibility", "decks", "points", "results", "verify", "test_errors.py"}
# They compare runs with each other, or look at files: one kind of kernels is enough.
NOT_NUMERICAL = {
    "test_absent_effects.py", "test_changed_deck.py", "test_dropped_increment.py",
    "test_full_disks.py", "test_input_decks.py", "test_interrupted_run.py",
    "test_little_memory.py", "test_lock_is_given_back.py", "test_moved_and_paused.py",
    "test_starts_together.py",
}  # fmt: skip


# A shell that starts the tests in the background has them ignore SIGINT, and so would the programs
# that they start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--preset", default="release", help="build of the program (release)")
    parser.addoption("--threads", type=int, help="threads of each run (processors / workers)")
    text = "write the numbers of the tests to the tables of docs/verification.md (without -n)"
    parser.addoption("--update-tables", action="store_true", help=text)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks numerical tests, and gives long tests a time limit; pyproject.toml has the usual one.

    The hook runs before options such as -m choose from the tests.
    """
    for item in items:
        folder = item.path.relative_to(ROOT / "tests").parts[0]
        is_picture = item.name.startswith("test_picture")
        if folder in NUMERICAL and item.path.name not in NOT_NUMERICAL and not is_picture:
            item.add_marker(pytest.mark.numerical)
        if item.get_closest_marker("full") and not item.get_closest_marker("timeout"):
            item.add_marker(pytest.mark.timeout(LIMIT_OF_LONG_TESTS))


def threads_of_a_run(config: pytest.Config) -> int:
    """Two where one test runs at a time; parallel tests share the processors."""
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    alone = 2 if workers == 1 else max((os.cpu_count() or 1) // workers, 1)
    return config.getoption("--threads") or alone


def limit_of(request: pytest.FixtureRequest) -> float:
    """Time limit of a run [s]: below that of its test, so that the run is named."""
    marker = request.node.get_closest_marker("timeout")
    usual = request.config.getoption("timeout") or request.config.getini("timeout")
    return 0.9 * float(marker.args[0] if marker else usual)


@pytest.fixture(scope="session")
def program_path(request: pytest.FixtureRequest) -> Path:
    """The built program."""
    preset = request.config.getoption("--preset")
    path = Path(os.environ.get("KEYWAY", ROOT / "build" / preset / "keyway"))
    assert path.exists(), f"{path} is not built; run tools/setup {preset}"
    return path


@pytest.fixture
def make_program(tmp_path: Path, request: pytest.FixtureRequest) -> Callable[[Path], Program]:
    """Programs at a path, with the folder of the test, its threads and its time limit."""
    threads, limit = threads_of_a_run(request.config), limit_of(request)
    return lambda path: Program(path, tmp_path, threads, limit)


@pytest.fixture
def keyway(program_path: Path, make_program: Callable[[Path], Program]) -> Program:
    """Runs a deck and returns its results: keyway(deck, '--option', code=0).csv('node_TIP')."""
    return make_program(program_path)


@pytest.fixture
def documented(request: pytest.FixtureRequest) -> Documented:
    """Compares numbers with a table: documented('cook', 'C3D8I', '8', 23.67)."""
    update = request.config.getoption("--update-tables")
    assert not (update and "PYTEST_XDIST_WORKER" in os.environ), "--update-tables needs one process"
    return Documented(ROOT / "docs/verification.md", update)
