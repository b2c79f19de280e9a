"""How the reading of a deck grows with the deck: valgrind counts instructions of its procedures.

Decks of n, 2 n and 4 n cards of each kind are checked. From 2 n to 4 n cards a procedure takes
twice as many more instructions as from n to 2 n if its work is in proportion to the deck, and four
times as many if it compares each card with each other.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from valgrind import NEEDS_VALGRIND, SOURCES, instructions, watch

ROOMS = ("deck", "keywords", "base/lists", "base/report", "base/text")
# 45, 90 and 180, and their small multiples, are far from the powers of two at which lists and
# tables double: both intervals have as many doublings for each card.
FEWEST = 45
# Between 2 (n log n of sorting gives 2.2 here) and 4
LARGEST_RATIO = 2.6
# Procedures that take fewer more instructions for a card are no matter: a comparison of all pairs
# takes more of them from 90 to 180 cards.
FEWEST_FOR_A_CARD = 150
# Few instructions for each pair: reservoirs and loads, reservoirs or motions and materials, and
# requests of histories and initial values, which are moved when a card adds one.
PAIRS = {
    *("check_water", "check_magnitudes", "check_units"),
    *("keywords_print", "finish_step", "keywords_initial"),
}

pytestmark = NEEDS_VALGRIND

LAW_AND_BASE = [
    *("*MATERIAL, NAME=M", "*DENSITY", "2400.", "*ELASTIC", "2e10, 0.2"),
    *("*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*BOUNDARY", "1, 1, 3", "2, 1, 3", "3, 1, 3"),
]


def row_of_bricks(n: int) -> list[str]:
    """Bricks 1 to n in a row along x; brick i has the set Ei."""
    corners = [(y, z) for z in (0, 1) for y in (0, 1)]
    nodes = [
        f"{4 * i + k}, {i}, {y}, {z}" for i in range(n + 1) for k, (y, z) in enumerate(corners, 1)
    ]
    order = (1, 5, 6, 2, 3, 7, 8, 4)
    bricks = [f"{i + 1}, " + ", ".join(str(4 * i + k) for k in order) for i in range(n)]
    sets = [f"*ELSET, ELSET=E{i}\n{i}" for i in range(1, n + 1)]
    return ["*NODE", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=ALL", *bricks, *sets]


def cards(n: int, text: str) -> list[str]:
    """A text for each i from 1 to n: i and 4 i stand for # and @."""
    return [text.replace("#", str(i)).replace("@", str(4 * i)) for i in range(1, n + 1)]


def step(*lines: list[str], procedure: str = "*STATIC") -> list[str]:
    return ["*STEP", procedure, *(line for part in lines for line in part), "*END STEP"]


def sets_and_loads(n: int) -> str:
    """n cards or lines of most keywords, in three steps, with many of the warnings."""
    water = "SURFACE=G#, LEVEL=1., BED=0., ADDED MASS=NONE"
    return "\n".join([
        *row_of_bricks(n),
        *cards(n, "*SURFACE, NAME=F#\n#, S2"),
        *cards(n, "*SURFACE, NAME=G#\n#, S5"),
        *cards(n, "*NSET, NSET=N#\n@"),
        "*BOUNDARY\n1, 1, 3",
        *cards(n, "N#, 1, 3"),
        *cards(n, "*NSET, NSET=N#\n1"),
        *cards(n, "*AMPLITUDE, NAME=A#\n0., 0., 1., 1."),
        *cards(n, "*MATERIAL, NAME=M#\n*DENSITY\n2400.\n*ELASTIC\n2e10, 0.2"),
        *cards(n, "*SOLID SECTION, ELSET=E#, MATERIAL=M#"),
        *cards(n, "*INITIAL CONDITIONS, TYPE=VELOCITY\n@, 1, 0.1"),
        *step(
            ["*DLOAD"], cards(n, "#, P2, 1."), cards(n, "#, P6, 1."),
            cards(n, "#, GRAV, 9.81, 0., 0., -1."),
            cards(n, "*CLOAD, AMPLITUDE=A#\n@, 2, 1."),
            cards(n, f"*RESERVOIR, NAME=R#, {water}"),
            cards(n, "*NODE PRINT, NSET=N#\nU"), cards(n, "*EL PRINT, ELSET=E#\nS"),
            cards(n, "*CONTROLS, ITERATIONS=20"), cards(n, "*RESTART, WRITE, FREQUENCY=1"),
            cards(n, "*ENVELOPE\nU"),
        ),
        *step(
            ["*DLOAD"], cards(n, "E#, P2, 1."), cards(n, "#, GRAV, 9.81, 0., -1., 0."),
            ["*DSLOAD"], cards(n, "F#, P, 1."),
            cards(n, f"*RESERVOIR, NAME=Q#, {water}"),
        ),
        *step(cards(n, "*BASE MOTION, DOF=1, AMPLITUDE=A#"), procedure="*DYNAMIC\n0.01, 1."),
    ])  # fmt: skip


def steps(n: int) -> str:
    """n steps, each of which gives one load again and asks for output."""
    each = "*STEP, NAME=S#\n*STATIC\n*DLOAD\nALL, P2, #.\n*NODE PRINT, NSET=TOP\nU\n*END STEP"
    return "\n".join([*row_of_bricks(1), "*NSET, NSET=TOP\n8", *LAW_AND_BASE, *cards(n, each)])


def missing_names(n: int) -> str:
    """n names of each kind, and as many that are not among them."""
    return "\n".join([
        *row_of_bricks(n),
        *cards(n, "*NSET, NSET=N#\n@"),
        *cards(n, "*SURFACE, NAME=F#\n#, S2"),
        *cards(n, "*AMPLITUDE, NAME=A#\n0., 0., 1., 1."),
        "*BOUNDARY",
        *cards(n, "N#X, 1, 3"),
        *step(
            ["*DLOAD"], cards(n, "E#X, P2, 1."), ["*DSLOAD"], cards(n, "F#X, P, 1."),
            cards(n, "*CLOAD, AMPLITUDE=A#X\n@, 2, 1."),
            cards(n, "*CLOAD\n@X, 7, 1."),
        ),
    ])  # fmt: skip


def long_line(n: int) -> str:
    """A history of one line in a file."""
    lines = [*row_of_bricks(1), *LAW_AND_BASE, "*AMPLITUDE, NAME=A, INPUT=values.txt"]
    return "\n".join([*lines, *step(["*CLOAD, AMPLITUDE=A", "8, 3, 1."])])


@pytest.mark.parametrize("deck", [sets_and_loads, steps, missing_names, long_line])
def test_reading_takes_time_in_proportion_to_the_deck(program_path, tmp_path, deck):
    counts = [counted(program_path.resolve(), tmp_path, deck, k * FEWEST) for k in (1, 2, 4)]
    grown = {}
    for module in set().union(*counts) - PAIRS:
        few, more, most = (count[module] for count in counts)
        if most - more < 2 * FEWEST * FEWEST_FOR_A_CARD:
            continue
        ratio = (most - more) / max(more - few, 1)
        if ratio > LARGEST_RATIO:
            grown[module] = (round(ratio, 2), few, more, most)
    assert not grown


def counted(program: Path, folder: Path, deck, n: int) -> Counter:
    """Instructions of the modules that read decks."""
    folder = folder / str(n)
    folder.mkdir()
    (folder / "job.inp").write_text(deck(n) + "\n")
    (folder / "values.txt").write_text(", ".join(str(time) for time in range(100 * n)))
    found = instructions(watch(program, folder, "callgrind", ["--check", str(folder / "job.inp")]))
    return Counter({name: found[name] for name in found if room_of(name).startswith(ROOMS)})


def room_of(module: str) -> str:
    return str(SOURCES.get(module, ""))
