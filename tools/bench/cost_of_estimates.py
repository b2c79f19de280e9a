"""What the estimates of errors cost: processor time of runs with and without them, and the parts
of the ledger."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from pathlib import Path

from measured_run import Program, Run

LIMIT = 0.05  # of the time of a run
PATIENCE = 60.0  # s, for the pairs of one deck
FEWEST, MOST = 3, 25  # pairs of runs: the least time of each kind counts
HEAD = (
    "| deck | unknowns | increments | run [s] | estimates | [ms] | mesh | time | law | |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)
NOT_ALONE = ("material", "umat", "meshes")  # folders of parts, and of decks with a UMAT
KINDS = {"mesh": ("mesh",), "time": ("time", "increments"), "law": ("law",)}  # of the ledger


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
    seconds: float  # of the processor, with estimates
    bare: float  # without
    parts: dict[str, float]  # shares of the ledger

    @property
    def more(self) -> float:
        """The share of the estimates in the run."""
        return self.seconds / self.bare - 1.0

    @property
    def row(self) -> str:
        parts = " | ".join(f"{100.0 * self.parts[kind]:.1f} %" for kind in KINDS)
        mark = "" if self.more <= LIMIT else "above 5 %"
        return (
            f"| {self.deck} | {self.unknowns} | {self.increments} | {self.seconds:.3g} "
            f"| {100.0 * self.more:+.1f} % | {1e3 * (self.seconds - self.bare):.1f} "
            f"| {parts} | {mark} |"
        )


def measure_estimates(program: Program, decks: list[Path], folder: Path) -> list[Share]:
    """Runs each deck and its twin without estimates in turn, and prints its row."""
    found = []
    for deck in decks:
        twin = write_twin(deck, folder / "without" / deck.stem)
        try:
            found.append(measure_pairs(program, deck, twin, folder))
        except SystemExit as why:
            print(f"{deck.name} left out: {why}")
            continue
        print(found[-1].row, flush=True)
    return found


def write_twin(deck: Path, folder: Path) -> Path:
    """The deck without estimates, beside links to what is in its folder and in the one above: decks
    name records as ../other/record.txt."""
    home = deck.resolve().parent
    twin = folder / home.name / deck.name
    twin.parent.mkdir(parents=True)
    for place, kept in ((home, deck.name), (home.parent, home.name)):
        for path in place.iterdir():
            if path.name != kept:
                (folder / path.relative_to(home.parent)).symlink_to(path)
    text, changes = re.subn(
        r"(?m)^(\*(STATIC|DYNAMIC|FREQUENCY)\b)",
        r"*CONTROLS, ERROR ESTIMATE=OFF\n\1",
        deck.read_text(),
        count=1,
    )
    if not changes:
        raise SystemExit(f"bench: {deck.name} has no step")
    twin.write_text(text)
    return twin


def measure_pairs(program: Program, deck: Path, twin: Path, folder: Path) -> Share:
    """Pairs of runs until the least times have settled, or PATIENCE is over."""
    start, runs, bare = time.monotonic(), [], []
    while len(runs) < FEWEST or (len(runs) < MOST and time.monotonic() - start < PATIENCE):
        runs.append(program.run(deck, folder / deck.stem))
        bare.append(program.run(twin, folder / "without" / "results"))
    best = min(runs, key=lambda run: run.processor)
    return Share(
        deck=deck.stem,
        unknowns=best.unknowns,
        increments=sum(step["increments"] for step in best.results.find("steps")),
        seconds=best.processor,
        bare=min(run.processor for run in bare),
        parts={kind: share_of(best, effects) for kind, effects in KINDS.items()},
    )


def share_of(run: Run, effects: tuple[str, ...]) -> float:
    """The share of the work `estimate` on some effects in the ledger."""
    names = [f"estimate {effect}" for effect in effects]
    wall = run.results.find("ledger.wall_s")
    return sum(part["wall_s"] for part in run.parts if part["name"] in names) / wall
