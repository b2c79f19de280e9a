"""Decks of Abaqus and CalculiX as meshes: nodes, elements, and their sets whole.

Sets are those of the program: a second card with a name adds members, a set may name sets above,
and GENERATE has a range a line. A set of nodes may be those of a set of elements (ELSET of *NSET).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import meshio
import numpy as np
from keyway.deck import Card, Deck, DeckError
from keyway.deck.data import is_data
from keyway.deck.sets import members_of

from ..deck_bytes import capitals
from .mesh_error import MeshError

# Types of elements, the kind of the cell and its number of nodes.
KINDS = [
    (re.compile(types, re.IGNORECASE), kind, count)
    for types, kind, count in (
        (r"C3D8[A-Z]*", "hexahedron", 8),
        (r"C3D6[A-Z]*", "wedge", 6),
        (r"C3D20[A-Z]*", "hexahedron20", 20),
        (r"C3D15[A-Z]*", "wedge15", 15),
        (r"C3D10[A-Z]*", "tetra10", 10),
        (r"C3D4[A-Z]*", "tetra", 4),
        (r"C3D5", "pyramid", 5),
        (r"(S|M3D|R3D|SFM3D|CPS|CPE|CAX)4[A-Z0-9]*", "quad", 4),
        (r"(S|M3D|R3D|SFM3D|CPS|CPE|CAX|STRI)3[A-Z]*", "triangle", 3),
        (r"(S|M3D|SFM3D|CPS|CPE|CAX)8[A-Z0-9]*", "quad8", 8),
        (r"S9R5|M3D9R?", "quad9", 9),
        (r"STRI65|(S|M3D|SFM3D|CPS|CPE|CAX)6[A-Z]*", "triangle6", 6),
        (r"T[23]D2H?|B[23][13][A-Z]*", "line", 2),
        (r"T[23]D3H?|B[23]2[A-Z]*", "line3", 3),
    )
]
SURFACE_KINDS = {"quad", "triangle"}
OWN_KINDS = {"C3D8B", "JOINT8", "IFACE4"}  # elements that other programs do not have
# Keywords that make or move nodes and elements.
MAKERS = {"ELCOPY", "ELGEN", "NCOPY", "NFILL", "NGEN", "NMAP", "SYSTEM"}
LOST = ("SURFACE", "TIE", "BOUNDARY")
OF_PARTS = {"PART", "INSTANCE", "ASSEMBLY"}
MEMBERS = {"NSET": "NODE", "ELSET": "ELEMENT"}  # keywords that add their own numbers to a set


@dataclass
class _Sets:
    """Sets of one kind; letters A to Z are equal in both cases."""

    kind: str  # NSET or ELSET
    numbers: dict[str, list[int]] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)  # as the deck writes them first

    def add(self, name: str, members: Iterable[int]) -> None:
        """Add members to a set."""
        key = capitals(name.strip())
        self.names.setdefault(key, name)
        self.numbers.setdefault(key, []).extend(members)

    def members(self, card: Card, source: Card) -> Iterator[int]:
        """The members that the lines of a card *NSET or *ELSET name. Raises MeshError."""
        generates = "GENERATE" in source.parameters
        other = "" if generates else " or the name of a set above"
        return members_of(
            _rows(card), generates, self.numbers, lambda word, place: _whole(place, word, other)
        )


class _Reader:
    """Gathers nodes, elements and sets in the order of the cards."""

    def __init__(self, path: Path):
        self.path = path
        self.x: list[list[float]] = []
        self.nodes: dict[int, int] = {}  # position by number
        self.elements: dict[int, tuple[int, int]] = {}  # block and position in it by number
        self.cells: list[tuple[str, dict[int, list[int]]]] = []  # nodes by number of element
        self.sets = {kind: _Sets(kind) for kind in MEMBERS}
        self.shells: dict[str, int] = {}  # elements that become faces, by type

    def read(self, cards: list[Card]) -> None:
        """Take all cards."""
        source = None
        for card in cards:
            if card.keyword and not card.is_a("INCLUDE"):
                source = card
            if source is None or card.is_a("INCLUDE"):
                continue
            if source.is_a("NODE"):
                own = {"NSET": self._read_nodes(card)}
            elif source.is_a("ELEMENT"):
                own = {"ELSET": self._read_elements(card, source)}
            else:
                own = {
                    kind: [*sets.members(card, source)]
                    for kind, sets in self.sets.items()
                    if source.is_a(kind)
                }
                if card.is_a("NSET") and "ELSET" in card.parameters:
                    own["NSET"] += self._nodes_of_set(card)
            for kind, members in own.items():
                name = source.parameters.get(kind)
                if name:
                    self.sets[kind].add(name, members)
                elif source.is_a(kind):
                    raise MeshError(f"{source.where}: no name; expected {kind}=name")

    def _nodes_of_set(self, card: Card) -> list[int]:
        """Numbers of the nodes of the elements that ELSET of *NSET names. Raises MeshError."""
        name = card.parameters["ELSET"] or ""
        known = self.sets["ELSET"]
        if capitals(name) not in known.numbers:
            fault = f"found '{name}'; expected the name of a set of elements above"
            raise MeshError(f"{card.where}: {fault}")
        elements = self._nodes_of_elements(known.numbers[capitals(name)], name)
        return [*dict.fromkeys(node for nodes in elements for node in nodes)]

    def _nodes_of_elements(self, numbers: list[int], name: str) -> Iterator[list[int]]:
        """Numbers of the nodes of each element of a set."""
        for number in numbers:
            block, _ = self._element(number, name)
            yield self.cells[block][1][number]

    def _element(self, number: int, name: str) -> tuple[int, int]:
        """Block of an element of a set and its position there. Raises MeshError."""
        if number not in self.elements:
            what = f"element {number} of set {name} is not there"
            raise MeshError(f"{self.path}: {what}; expected an element of the mesh")
        return self.elements[number]

    def _read_nodes(self, card: Card) -> list[int]:
        """Numbers of the nodes of a card."""
        found = []
        for place, row in _rows(card):
            number = _whole(place, row[0])
            if number in self.nodes:
                raise MeshError(f"{place}: node {number} is there twice; expected it once")
            self.nodes[number] = len(self.x)
            try:
                x = [float(re.sub("[dD]", "e", word)) if word else 0.0 for word in row[1:4]]
            except ValueError:
                raise MeshError(f"{place}: found '{', '.join(row)}'; expected numbers") from None
            if not all(map(math.isfinite, x)):
                what = f"node {number} has the coordinates {', '.join(row[1:4])}"
                raise MeshError(f"{place}: {what}; expected finite numbers")
            self.x.append(x + [0.0] * (3 - len(x)))
            found.append(number)
        return found

    def _read_elements(self, card: Card, source: Card) -> list[int]:
        """Numbers of the elements of a card, each of which may take several lines."""
        kind, count = _kind_of(source)
        block, fields = len(self.cells), []
        rows: dict[int, list[int]] = {}
        for place, row in _rows(card):
            fields += [_whole(place, word) for word in row if word]
            if len(fields) > count + 1:
                raise MeshError(f"{place}: {len(fields) - 1} nodes; expected {count} of a {kind}")
            if len(fields) == count + 1:
                number = fields[0]
                if number in self.elements:
                    raise MeshError(f"{place}: element {number} is there twice; expected it once")
                self.elements[number] = (block, len(rows))
                rows[number] = fields[1:]
                fields = []
        if fields:
            raise MeshError(f"{source.where}: element {fields[0]} has {len(fields) - 1} nodes; "
                            f"expected {count} of a {kind}")  # fmt: skip
        if rows:
            self.cells.append((kind, rows))
        if kind in SURFACE_KINDS:
            given = source.parameters["TYPE"].upper()
            self.shells[given] = self.shells.get(given, 0) + len(rows)
        return [*rows]

    def notes(self) -> list[str]:
        """Elements that become faces, and the sets without members, which are lost."""
        return [
            f"{count} elements of the type {given} are taken as faces, for surfaces and sets of "
            "nodes: the mesh has no such elements"
            for given, count in self.shells.items()
        ] + [
            f"{kind} '{sets.names[key]}' has no members; left out"
            for kind, sets in self.sets.items()
            for key, numbers in sets.numbers.items()
            if not numbers
        ]

    def mesh(self) -> meshio.Mesh:
        """The mesh. Raises MeshError for members that are not there."""
        cells = [
            (kind, np.array([self._places(row, f"element {n}") for n, row in rows.items()]))
            for kind, rows in self.cells
        ]
        of_nodes, of_elements = self.sets["NSET"], self.sets["ELSET"]
        node_sets = {
            of_nodes.names[key]: np.array(self._places(numbers, f"set {of_nodes.names[key]}"))
            for key, numbers in of_nodes.numbers.items()
        }
        cell_sets = {
            of_elements.names[key]: self._by_block(numbers, of_elements.names[key])
            for key, numbers in of_elements.numbers.items()
        }
        return meshio.Mesh(np.array(self.x), cells, point_sets=node_sets, cell_sets=cell_sets)

    def _places(self, numbers: list[int], owner: str) -> list[int]:
        """Positions of nodes."""
        try:
            return [self.nodes[number] for number in numbers]
        except KeyError as fault:
            what = f"node {fault.args[0]} of {owner} is not there"
            raise MeshError(f"{self.path}: {what}; expected a node of the mesh") from None

    def _by_block(self, numbers: list[int], name: str) -> list[np.ndarray]:
        """Positions of elements in each block."""
        found: list[list[int]] = [[] for _ in self.cells]
        for number in numbers:
            block, position = self._element(number, name)
            found[block].append(position)
        return [np.unique(np.array(own, dtype=int)) for own in found]


def read_deck_mesh(path: Path) -> tuple[meshio.Mesh, list[str]]:
    """The mesh of a deck with its sets, and what is not taken. Raises MeshError."""
    try:
        cards = Deck(path).cards
        notes = notes_of_deck(path, cards)
        reader = _Reader(path)
        reader.read(cards)
    except OSError as fault:
        raise MeshError(f"{path}: {fault.strerror}") from None
    except DeckError as fault:
        raise MeshError(str(fault)) from None
    return reader.mesh(), notes + reader.notes()


def notes_of_deck(path: Path, cards: list[Card]) -> list[str]:
    """What is lost of a deck. Error: a deck with parts, each of which numbers its nodes from 1; a
    deck with elements of Keyway; one that generates its mesh."""
    words = {card.keyword for card in cards}
    if words & OF_PARTS:
        raise MeshError(
            f"{path}: a deck with parts and instances; expected a flat mesh: keyway reads such a "
            "deck itself, with its sets, surfaces and ties"
        )
    kinds = {(c.parameters.get("TYPE") or "").upper() for c in cards if c.is_a("ELEMENT")}
    if own := sorted(kinds & OWN_KINDS):
        raise MeshError(
            f"{path}: a deck with elements of Keyway ({', '.join(own)}); expected the mesh of "
            "another program: keyway reads its own decks itself"
        )
    for card in cards:
        if card.keyword in MAKERS or (card.is_a("NODE") and "SYSTEM" in card.parameters):
            raise MeshError(
                f"{card.where} makes or moves nodes or elements; expected all of them one by one "
                "in global coordinates"
            )
    lost = [f"*{word}" for word in LOST if word in words]
    if not lost:
        return []
    return [f"{', '.join(lost)} of the deck not taken: keyway reads the deck itself, with them"]


def _kind_of(card: Card) -> tuple[str, int]:
    """Kind of the cells of a card *ELEMENT and their number of nodes."""
    given = card.parameters.get("TYPE") or ""
    for types, kind, count in KINDS:
        if types.fullmatch(given):
            return kind, count
    raise MeshError(
        f"{card.where}: elements of the type '{given}'; expected solids (C3D8, C3D6) and faces "
        "(S4, S3, M3D4, CPS4)"
    )


def _rows(card: Card) -> Iterator[tuple[str, list[str]]]:
    """Place and fields of each data line."""
    first = card.line + len(card.head)
    for number, line in enumerate(card.body, first):
        if is_data(line):
            fields = [word.strip(" \t\r\n\"'") for word in line.split(",")]
            while len(fields) > 1 and not fields[-1]:
                fields.pop()
            yield f"{card.file}:{number}", fields


def _whole(place: str, word: str, other: str = "") -> int:
    """A whole number. Raises MeshError."""
    try:
        return int(word)
    except ValueError:
        raise MeshError(f"{place}: found '{word}'; expected a whole number{other}") from None
