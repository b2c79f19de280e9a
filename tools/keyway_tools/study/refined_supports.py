"""Supports of the new nodes of a refined mesh.

A new node of the surface is held between nodes of one set, and between nodes that one card names by
their numbers. It is held, too, on a face of a brick whose nodes are held by several sets, lines or
cards. Bricks whose nodes are all held are the exception: their faces may lie between two supports.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from .deck_cards import Card, fields_of, quoted
from .mesh_sets import MeshSets, support_of
from .refined_values import Key, mean

Face = tuple[frozenset[int], frozenset[int]]  # nodes of a face and of its brick


@dataclass
class Named:
    """The nodes that a card holds in one direction, as it names them."""

    values: dict[int, float] = field(default_factory=dict)
    sets: list[set[int]] = field(default_factory=list)
    single: set[int] = field(default_factory=set)


@dataclass
class Supports:
    """The cards *BOUNDARY of a deck, in their order."""

    sets: MeshSets
    surface_nodes: list[tuple[Key, int]]  # parents and numbers of new nodes
    faces: dict[Key, list[Face]]  # of the surface, by the parents of their new nodes
    still: dict[int, set[int]] = field(default_factory=dict)  # nodes at zero, by direction

    def lines_of(self, card: Card) -> list[str]:
        """Lines on nodes and sets with new nodes; those of single new nodes have means."""
        if card.value("OP") == "NEW":
            self.still = {}
        lines = []
        named: dict[int, Named] = defaultdict(Named)
        for line in card.lines:
            label, directions, value = support_of(line)
            nodes = self.sets.nodes_of(label)
            for direction in directions:
                named[direction].values.update(dict.fromkeys(nodes, value))
                if label.isdigit():
                    named[direction].single |= nodes
                else:
                    named[direction].sets.append(nodes)
            name = label if label.isdigit() else quoted(grown_name(label))
            lines.append(",".join([name, *fields_of(line)[1:]]))
        for direction, one in named.items():
            still = self.still.setdefault(direction, set())
            if card.value("TYPE") == "ACCELERATION":
                still = set()
            lines += self.lines_between(direction, one, still)
        return lines

    def lines_between(self, direction: int, named: Named, still: set[int]) -> list[str]:
        """Lines of new nodes that no set of the card holds. `still` gets what is zero now."""
        known = dict.fromkeys(still, 0.0) | named.values
        still.difference_update(named.values)
        still.update(node for node, value in named.values.items() if value == 0.0)
        lines = []
        for key, number in self.surface_nodes:
            parents = {node for node, _ in key}
            if not parents <= known.keys():
                continue
            value = mean(key, {node: (known[node],) for node in parents})[0]
            is_in_set = any(parents <= nodes for nodes in named.sets)
            if is_in_set or parents <= named.single or self.is_on_held_face(key, known):
                if not is_in_set and not (value == 0.0 and number in still):
                    lines.append(line_of(number, direction, value))
                still.discard(number)
                if value == 0.0:
                    still.add(number)
        return lines

    def is_on_held_face(self, key: Key, known: dict[int, float]) -> bool:
        """Whether it is on a face that is held, of a brick that is not held as a whole."""
        return any(
            face <= known.keys() and not brick <= known.keys()
            for face, brick in self.faces.get(key, [])
        )


def line_of(node: int, direction: int, value: float) -> str:
    """A line of *BOUNDARY."""
    return f"{node}, {direction}, {direction}" + (f", {value!r}" if value else "")


def grown_name(name: str) -> str:
    """The set with the new nodes, of a set by its name."""
    return f"{name}_AND_NEW"
