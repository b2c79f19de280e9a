"""Names of groups that meshio loses, and names that a deck does not tell from each other."""

from __future__ import annotations

import re
from pathlib import Path

_LINE = re.compile(rb'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*$')  # dimension, number, name
Physical = dict[tuple[int, int], str]


def physical_names(path: Path) -> Physical:
    """Names of the physical groups of a file of Gmsh by number and dimension.

    meshio keeps one number for each name, though a volume and a surface may have the same one. The
    section is text in binary files too.
    """
    contents = path.read_bytes()
    start = contents.find(b"$PhysicalNames")
    stop = contents.find(b"$EndPhysicalNames", start)
    if start < 0 or stop < 0:
        return {}
    found = (_LINE.match(line) for line in contents[start:stop].splitlines())
    return {
        (int(line[2]), int(line[1])): line[3].decode("utf-8", errors="replace")
        for line in found
        if line
    }


def shared_names(names: Physical) -> list[str]:
    """Notes on groups of one dimension with one name."""
    numbers: dict[tuple[str, int], list[int]] = {}
    for (number, dimension), name in names.items():
        numbers.setdefault((name, dimension), []).append(number)
    return [
        f"groups {', '.join(map(str, sorted(own)))} of dimension {dimension} have one name, "
        f"'{name}', and are one group in the deck"
        for (name, dimension), own in numbers.items()
        if len(own) > 1
    ]


def merged_names(names: dict[tuple[str, int | None], list[str]]) -> list[str]:
    """Notes on names that a deck does not tell from each other, by word and dimension."""
    notes = []
    for (word, _), own in names.items():
        if len(own) > 1:
            given = " and ".join(f"'{name}'" for name in own)
            notes.append(
                f"groups {given} are one group, {word}: a deck does not tell small letters from "
                "capitals"
            )
    return list(dict.fromkeys(notes))
