"""What the estimates of errors cost: their share in the time of runs, from the ledger."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from measured_run import Program

LIMIT = 0.05  # of the time of a run
PATIENCE = 600.0  # s
HEAD = "| deck | unknowns | increments | run [s] | mesh | time | |\n|---|---|---|---|---|---|---|"
NOT_ALONE = ("material", "umat", "meshes")  # folders of parts, and of decks with a UMAT


def decks_of_input(folder: Path) -> list[Path]:
    """The decks of dams and small examples that run by themselves."""
    found = sorted(folder.rglob("*.inp"))
    return [
        path
        for path in found
        if not path.stem.endswith("_mesh") and path.parent.name not in NOT_ALONE
    ]


@dataclass(frozen=True)
class Share:
    """One deck."""

    deck: str
    unknowns: int
    increments: int
    seconds: float
    mesh: float  # share of the run
    time: float

    @property
    def row(self) -> str:
        parts = f"{100.0 * self.mesh:.1f} % | {100.0 * self.time:.1f} %"
        mark = "" if self.mesh + self.time <= LIMIT else "above 5 %"
        return (
            f"| {self.deck} | {self.unknowns} | {self.increments} | {self.seconds:.2f} | {parts}"
            f" | {mark} |"
        )


def measure_estimates(program: Program, decks: list[Path], folder: Path) -> list[Share]:
    """Runs each deck and prints its row; one that takes too long is left out."""
    found = []
    for deck in decks:
        out = folder / deck.stem
        call = [program.path, "-q", "-j", str(program.threads), "-o", out, deck]
        try:
            subprocess.run(call, check=True, timeout=PATIENCE, capture_output=True)
        except (subprocess.TimeoutExpired, subprocess.CalledProcessError) as why:
            print(f"{deck.name} left out: {type(why).__name__}")
            continue
        found.append(share_of(deck, json.loads((out / f"{deck.stem}.json").read_text())))
        print(found[-1].row, flush=True)
    return found


def share_of(deck: Path, run: dict) -> Share:
    """The share of the work `estimate` of a run."""
    parts = run["ledger"]["parts"]
    wall = run["ledger"]["wall_s"]

    def share(name: str) -> float:
        return sum(part["wall_s"] for part in parts if part["name"] == name) / wall

    return Share(
        deck=deck.stem,
        unknowns=run["model"]["unknowns"],
        increments=sum(step["increments"] for step in run["steps"]),
        seconds=wall,
        mesh=share("estimate mesh"),
        time=share("estimate time"),
    )
