"""What `keyway --check` forecasts for the decks of input/, against what their runs took."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from measured_run import Program

MATERIALS = ("material", "meshes")  # folders of input/ without decks that take a run
UMAT_SOURCES = (".for", ".f90")


@dataclass(frozen=True)
class Forecast:
    """A forecast and what was measured: time [s], memory [MB], files [MB]."""

    deck: str
    forecast: tuple[float, float, float]
    measured: tuple[float, float, float]

    def row(self) -> str:
        """A line of a table in Markdown: forecast, measured, their ratio."""
        cells = [
            f"{said:.3g} | {found:.3g} | {found / said:.2f}"
            for said, found in zip(self.forecast, self.measured, strict=True)
        ]
        return f"| {self.deck} | {' | '.join(cells)} |"


def decks_of(folder: Path) -> list[Path]:
    """All decks with steps below a folder."""
    found = [path for path in sorted(folder.rglob("*.inp")) if path.parent.name not in MATERIALS]
    return [path for path in found if re.search(r"(?im)^\*STEP", path.read_text())]


def umat_of(deck: Path) -> list[str]:
    """The option that names the UMAT beside a deck, if there is one."""
    found = [deck.with_suffix(end) for end in UMAT_SOURCES if deck.with_suffix(end).exists()]
    return ["--umat", str(found[0])] if found else []


def read_forecast(text: str) -> tuple[float, float, float]:
    """Time, memory and files of the output of --check."""
    section = text.partition("Cost on this machine")[2]
    found = [re.search(rf"{name} +about (\S+)", section) for name in ("time", "memory", "files")]
    if not all(found):
        raise SystemExit("bench: --check gives no forecast")
    return tuple(float(one[1]) for one in found if one)  # type: ignore[return-value]


def measure_forecast(program: Program, folder: Path, deck: Path) -> Forecast:
    """One deck: the forecast, then the run."""
    options = ["-j", str(program.threads), *umat_of(deck)]
    command = [str(program.path), *options, "--check", str(deck)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    run = program.run(deck, folder / deck.stem, umat_of(deck))
    files = sum(path.stat().st_size for path in (folder / deck.stem).rglob("*") if path.is_file())
    ledger = run.results.find("ledger")
    measured = (ledger["wall_s"], ledger["peak_memory_mb"], files / 1e6)
    return Forecast(deck.stem, read_forecast(text), measured)


def measure_forecasts(program: Program, folder: Path, decks: list[Path]) -> str:
    """The table of all decks."""
    head = ["deck", *(f"{name} | measured | ratio" for name in ("time [s]", "memory [MB]",
                                                                 "files [MB]"))]  # fmt: skip
    lines = [f"| {' | '.join(head)} |", "|---" * 10 + "|"]
    return "\n".join([*lines, *(measure_forecast(program, folder, one).row() for one in decks)])
