"""How large the dams of the study are and how long they shake."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Size:
    """Meshes and times of all cases."""

    xingbiling: str  # options of tools/make_dam.py: cells, and elements in them
    jinping: int  # unknowns
    sensitivity: int
    duration: float  # [s]
    frequency: int  # increments between two saved states
    built: str  # options of tools/make_dam.py: Xingbiling in lifts, through a season
    record: str  # and under many motions
    num_records: int


ROCK = "--rock-upstream 5 --rock-downstream 5 --rock-deep 6"
SIZES = {
    "full": Size(
        f"--arc 40 --levels 16 --bottom 8 --thick 4 {ROCK} --refine 2 --fine-refine 3 "
        "--fine-thick 6",
        100_000, 10_000, 20.0, 50,
        f"--arc 78 --levels 32 --bottom 14 --thick 4 {ROCK}",
        f"--arc 34 --levels 14 --bottom 6 --thick 3 {ROCK}", 100,
    ),
    "small": Size(
        "--arc 16 --levels 7 --bottom 2 --thick 2 --refine 2 --fine-refine 3 --fine-thick 3",
        15_000, 15_000, 3.0, 50,
        f"--arc 34 --levels 14 --bottom 6 --thick 3 {ROCK}",
        "--arc 20 --levels 8 --bottom 4 --thick 2", 20,
    ),
    "tiny": Size(
        "--arc 14 --levels 6 --bottom 2 --thick 1 --refine 1 --fine-refine 2 --fine-thick 2",
        6_000, 6_000, 0.05, 1,
        "--arc 14 --levels 6 --bottom 2 --thick 1",
        "--arc 14 --levels 6 --bottom 2 --thick 1", 3,
    ),
}  # fmt: skip
