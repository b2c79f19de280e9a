"""Writes the files of a deck where it is, or elsewhere."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

from keyway_tools.deck_bytes import place_of

from .card import Card
from .deck_file import DeckError, DeckFile, included_file


def write_files(main: DeckFile, files: dict[Path, DeckFile], path: Path | None) -> list[Path]:
    """Write the deck as `path`, or in its place; return the paths of the files written.

    Raises OSError, and DeckError where a file that the deck reads would be lost.
    """
    target = main.path if path is None else path.resolve()
    if target == main.path:
        changed = [file for file in files.values() if file.is_changed or not file.path.exists()]
        for file in changed:
            file.write(file.path, file.text())
        return [file.path for file in changed]
    targets = _targets(main, files, target)
    for file, place in targets.items():
        others = files.keys() | {f for f in map(included_file, file.cards) if f}
        if place in others:
            raise DeckError(f"{place}: the deck {main.path} reads this file; expected a new name")
        file.write(place, file.text(partial(_elsewhere, place=place, files=files, targets=targets)))
    return [*targets.values()]


def _targets(main: DeckFile, files: dict[Path, DeckFile], target: Path) -> dict[DeckFile, Path]:
    """Where the files go: the deck, what is changed, and what names a file that goes elsewhere."""
    found = {main: target}
    size = 0
    while len(found) > size:
        size = len(found)
        for file in files.values():
            names_moved = any(
                card.is_a("INCLUDE") and files.get(included_file(card) or Path()) in found
                for card in file.cards
            )
            if file not in found and (file.is_changed or names_moved):
                found[file] = _new_name(file, target, set(found.values()))
    return found


def _new_name(file: DeckFile, target: Path, taken: set[Path]) -> Path:
    name = f"{target.stem}_{file.path.name}"
    number = 1
    while target.parent / name in taken:
        number += 1
        name = f"{target.stem}_{number}_{file.path.name}"
    return target.parent / name


def _elsewhere(card: Card, place: Path, files: dict[Path, DeckFile],
               targets: dict[DeckFile, Path]) -> Card:  # fmt: skip
    """The card in a file at `place`: the name of another file is relative to that place."""
    named = included_file(card)
    if named is None:
        return card
    moved = targets.get(files[named], named) if named in files else named
    if moved == place_of(place.parent, card.parameters["INPUT"] or ""):
        return card
    return card.with_file("/".join(map(_in_text, Path(os.path.relpath(moved, place.parent)).parts)))


def _in_text(name: str) -> str:
    """The name of a file or folder as a deck has it: one in Latin-1 on the disk is text again."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return os.fsencode(name).decode("latin-1")
    return name
