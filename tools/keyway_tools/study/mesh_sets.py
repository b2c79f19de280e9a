"""Nodes, sets of nodes and sets of elements of a deck."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from .deck_cards import Card, Deck, fields_of, number_of, plain_name, quoted

NUM_NODES = {"JOINT8": 8, "IFACE4": 4}


class RefinementError(ValueError):
    """A deck whose mesh these modules do not change, with the reason."""


@dataclass
class MeshSets:
    """Coordinates by number; sets by name in capitals."""

    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    node_sets: dict[str, set[int]] = field(default_factory=dict)
    element_sets: dict[str, set[int]] = field(default_factory=dict)

    def elements_of(self, label: str) -> set[int]:
        """Elements of a number or the name of a set."""
        return {int(label)} if label.isdigit() else self.element_sets[plain_name(label)]

    def nodes_of(self, label: str) -> set[int]:
        """Nodes of a number or the name of a set."""
        return {int(label)} if label.isdigit() else self.node_sets[plain_name(label)]


def read_sets(deck: Deck) -> MeshSets:
    """All nodes and sets, in the order of the deck."""
    if deck.has("PART") or deck.has("INSTANCE"):
        raise RefinementError("the mesh has parts and instances (*PART), which are not refined")
    sets = MeshSets()
    for card in deck.cards:
        if card.keyword == "NODE":
            numbers = read_nodes(card, sets)
            add(sets.node_sets, card.value("NSET"), numbers)
        elif card.keyword == "ELEMENT":
            add(sets.element_sets, card.value("ELSET"), [n for n, _ in element_rows(card)])
        elif card.keyword in ("NSET", "ELSET"):
            kept = sets.node_sets if card.keyword == "NSET" else sets.element_sets
            add(kept, card.value(card.keyword), members(card, kept))
    return sets


def read_nodes(card: Card, sets: MeshSets) -> list[int]:
    """Adds the nodes of a card; their numbers."""
    numbers = []
    for line in card.lines:
        number, *rest = fields_of(line)
        x = [number_of(item) if item.strip() else 0.0 for item in rest[:3]]
        x += [0.0] * (3 - len(x))
        sets.nodes[int(number)] = (x[0], x[1], x[2])
        numbers.append(int(number))
    return numbers


def element_rows(card: Card) -> Iterator[tuple[int, list[int]]]:
    """Number and nodes of each element; a line with too few nodes goes on in the next."""
    kind = card.value("TYPE")
    wanted = 8 if kind.startswith("C3D8") else NUM_NODES.get(kind, 0)
    row: list[int] = []
    for line in card.lines:
        row += [int(item) for item in fields_of(line) if item.strip()]
        if len(row) <= wanted or (not wanted and line.rstrip().endswith(",")):
            continue
        yield row[0], row[1:]
        row = []


def members(card: Card, sets: dict[str, set[int]]) -> set[int]:
    """Numbers of a card of a set: numbers, ranges (GENERATE), names of other sets."""
    found: set[int] = set()
    for line in card.lines:
        items = [item.strip() for item in fields_of(line) if item.strip()]
        if "GENERATE" in card.parameters:
            first, last, *step = map(int, items)
            found.update(range(first, last + 1, *step))
            continue
        for item in items:
            found |= {int(item)} if item.isdigit() else sets[plain_name(item)]
    return found


def add(sets: dict[str, set[int]], name: str, numbers) -> None:
    if name:
        sets.setdefault(name, set()).update(numbers)


def list_card(keyword: str, name: str, numbers: list[int]) -> Card:
    """A set of numbers, eight to a line."""
    rows = [numbers[i : i + 8] for i in range(0, len(numbers), 8)]
    return Card(keyword, {keyword: quoted(name)}, [", ".join(map(str, row)) for row in rows])


SUPPORTS = {"ENCASTRE": (1, 2, 3), "PINNED": (1, 2, 3), "XSYMM": (1,), "YSYMM": (2,),
            "ZSYMM": (3,), "XASYMM": (2, 3), "YASYMM": (1, 3), "ZASYMM": (1, 2)}  # fmt: skip


def back_of_slice(deck: Deck, sets: MeshSets) -> set[int]:
    """The back of a slice: one brick thick between two planes, held across on one of them.

    Empty for any other body: a plate that bends needs bricks through its thickness.
    """
    for axis in range(3):
        values = {x[axis] for x in sets.nodes.values()}
        if len(values) != 2:
            continue
        held = held_nodes(deck, sets, axis + 1)
        for value in values:
            plane = {node for node, x in sets.nodes.items() if x[axis] == value}
            if plane <= held:
                return plane
    return set()


def held_nodes(deck: Deck, sets: MeshSets, dof: int) -> set[int]:
    """Nodes whose motion along one axis is prescribed."""
    found: set[int] = set()
    for card in deck.of("BOUNDARY"):
        for line in card.lines:
            label, directions, _ = support_of(line)
            if dof in directions:
                found |= sets.nodes_of(label)
    return found


def support_of(line: str) -> tuple[str, Sequence[int], float]:
    """Node or set, directions and value of a line of *BOUNDARY."""
    label, first, last, value = (plain_name(item) for item in [*fields_of(line), "", ""][:4])
    directions = SUPPORTS.get(first) or range(int(first), int(last or first) + 1)
    return label, directions, number_of(value) if value else 0.0
