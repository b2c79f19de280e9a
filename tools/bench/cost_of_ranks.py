"""What a linear dam costs on several processes, beside the plain program with two threads."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from keyway_tools.results import Results
from measured_run import Program, Run
from scenes import INCREMENT, dam_of_size, write_deck

INCREMENTS = 20
RANKS = (1, 2, 4)
HEAD = (
    "| unknowns | program | analyse and factor [s] | solve [s] | whole [s] | for an unknown [ms] "
    "| memory [MB] |\n"
    "|---|---|---|---|---|---|---|"
)
# Reports the largest process of a run, all ranks included; ru_maxrss is in kB.
MEASURE = (
    "import resource, subprocess, sys\n"
    "code = subprocess.run(sys.argv[1:], stdout=-3, stderr=-3).returncode\n"
    "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)\n"
    "sys.exit(code)\n"
)


@dataclass(frozen=True)
class RankRun:
    """A run on some ranks."""

    name: str
    run: Run
    memory: float  # of the largest process [MB]

    def row(self) -> str:
        """A line of the table: mean times of both steps together."""
        set_up = sum(self.run.cost(f"{part} structure")[0] for part in ("analyse", "factor"))
        wall, unknowns = self.run.wall, self.run.unknowns
        values = [
            set_up,
            self.run.mean("solve structure"),
            wall,
            1e3 * wall / unknowns,
            self.memory,
        ]
        texts = [f"{unknowns}", self.name, *(f"{v:.3g}" for v in values)]
        return "| " + " | ".join(texts) + " |"


def measured(name: str, words: list[str], out: Path, job: str) -> RankRun | None:
    """Runs a command; None where it fails."""
    start = time.monotonic()
    yielding = {**os.environ, "OMPI_MCA_mpi_yield_when_idle": "1"}
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, *words], capture_output=True, text=True, env=yielding
    )
    if done.returncode:
        print(f"{name}: ended with {done.returncode}", flush=True)
        return None
    wall = time.monotonic() - start
    return RankRun(name, Run(wall, 0.0, Results(out, job)), int(done.stdout) / 1024.0)


def measure_ranks(plain: Program, ranks_program: Path, folder: Path, sizes: list[int]) -> str:
    """Weight and water, then twenty increments of motion; a row for each program and solver."""
    lines = [HEAD]
    for size in sizes:
        deck = write_deck(
            folder,
            f"ranks_{size}",
            dam_of_size(size),
            INCREMENTS * INCREMENT,
            has_envelopes=False,
        )
        out = folder / f"results_{deck.stem}"
        tail = ["-q", "-o", str(out), str(deck)]
        runs = [("plain, 2 threads", [str(plain.path), "-j", "2", *tail])]
        for solver in ("DIRECT", "ITERATIVE"):
            for ranks in RANKS:
                launch = ["mpiexec", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)]
                words = [*launch, str(ranks_program), "-j", "1", "--solver", solver, *tail]
                runs.append((f"{solver}, {ranks} ranks", words))
        for name, words in runs:
            if done := measured(name, words, out, deck.stem):
                lines.append(done.row())
                print(lines[-1], flush=True)
    return "\n".join(lines)
