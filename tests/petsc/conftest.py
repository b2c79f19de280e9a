"""The program for several processes, in any number of them."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from harness import ROOT, Program
from rank_decks import LAUNCH


class RankProgram(Program):
    """The program under mpiexec."""

    ranks = 1

    def call(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        launcher = ["mpiexec", "-q", "--oversubscribe", "-n", str(self.ranks)]
        return subprocess.run(
            [*(launcher if self.ranks else []), str(self.path), *arguments],
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            cwd=self.folder,
            timeout=self.limit,
            env={**os.environ, **LAUNCH},
        )


@pytest.fixture(scope="session")
def petsc_path() -> Path:
    """The program of the preset petsc."""
    path = Path(os.environ.get("KEYWAY_PETSC", ROOT / "build/petsc/keyway"))
    if not path.exists() or shutil.which("mpiexec") is None:
        pytest.skip("no program for several processes: tools/test --with petsc builds and tests it")
    return path


@pytest.fixture
def on_ranks(petsc_path: Path, tmp_path: Path) -> Callable[..., Program]:
    """Programs on some ranks; 0 ranks: without mpiexec."""

    def make(ranks: int) -> Program:
        folder = tmp_path / f"on_{ranks}"
        folder.mkdir(exist_ok=True)
        # Ends a deadlock alone. On a busy machine each message of MUMPS waits for a turn of the
        # processor: runs of a second have taken two minutes.
        program = RankProgram(petsc_path, folder, 1, 600.0)
        program.ranks = ranks
        return program

    return make
