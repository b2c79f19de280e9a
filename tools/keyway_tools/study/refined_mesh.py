"""The mesh of any deck, refined: each brick becomes eight, each quadrilateral of a joint four.

A slice is refined in its plane alone.

New nodes lie on straight edges and flat middles: the shape of the dam stays that of the coarse
mesh. Sets of elements and surfaces follow their elements. Supports hold new nodes between old ones
on the surface; temperatures and initial values of new nodes are means; forces (*CLOAD) and prints
keep the old nodes.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from functools import reduce
from itertools import product
from math import gcd

from .deck_cards import Card, Deck, fields_of
from .mesh_sets import (
    MeshSets,
    RefinementError,
    back_of_slice,
    element_rows,
    list_card,
    read_sets,
)
from .refined_supports import Face, Supports, grown_name
from .refined_values import Key, add_values

BRICKS = ("C3D8", "C3D8I", "C3D8B", "C3D8R")
# Corners of a brick on a lattice of 3 x 3 x 3 points, in the order of its nodes.
CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
SQUARE = ((0, 0), (2, 0), (2, 2), (0, 2))
# Faces of a brick as nodes, and the children on them: axis of the lattice and side.
FACE_NODES = {
    "1": (0, 1, 2, 3), "2": (4, 7, 6, 5), "3": (0, 4, 5, 1), "4": (1, 5, 6, 2),
    "5": (2, 6, 7, 3), "6": (3, 7, 4, 0),
}  # fmt: skip
FACE_SIDES = {"1": (2, 0), "2": (2, 1), "3": (1, 0), "4": (0, 1), "5": (1, 1), "6": (0, 0)}

Corners = tuple[tuple[int, ...], ...]
Side = tuple[int | None, ...]
# Cards that name single nodes, for which new nodes have no counterpart
RELATIONS = ("EQUATION", "MPC")


def refine(deck: Deck) -> Deck:
    """The deck with all solids, joints and interfaces split once."""
    return Refinement(deck).deck()


class Refinement:
    """One refinement of a mesh."""

    def __init__(self, deck: Deck):
        self.old = deck
        self.sets: MeshSets = read_sets(deck)
        self.next_node = max(self.sets.nodes) + 1
        self.new_nodes: dict[Key, int] = {}
        self.children: dict[int, list[tuple[int, Side]]] = {}  # number and side
        self.surface_nodes: list[tuple[Key, int]] = []  # parents and numbers
        self.faces: dict[Key, list[Face]] = defaultdict(list)  # of bricks, by parents
        self.next_element = 1
        self.doubled: dict[frozenset[int], int] = {}  # corner that counts twice in a triangle
        self.back = back_of_slice(deck, self.sets)  # nodes of one of the planes of a slice

    def deck(self) -> Deck:
        """The refined deck."""
        if relation := next(self.old.of(*RELATIONS), None):
            raise RefinementError(f"*{relation.keyword} names nodes: new nodes would lack it")
        elements = [self.refine_elements(card) for card in self.old.of("ELEMENT")]
        self.find_surface()
        self.supports = Supports(self.sets, self.surface_nodes, self.faces)
        mesh = [self.node_card(), *elements, *self.set_cards()]
        rest = [self.follow(card) for card in self.old.cards if card.keyword not in
                ("NODE", "ELEMENT", "NSET", "ELSET", "INCLUDE")]  # fmt: skip
        heading = [card for card in rest if card.keyword == "HEADING"]
        others = [card for card in rest if card.keyword != "HEADING"]
        new = Deck([*heading, *mesh, *others], dict(self.old.files))
        add_values(new, self.sets, self.new_nodes)
        return new

    def node_card(self) -> Card:
        """Old and new nodes."""
        lines = [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in self.sets.nodes.items()]
        for key, number in self.new_nodes.items():
            total = sum(count for _, count in key)
            x = [sum(self.sets.nodes[n][i] * count for n, count in key) / total for i in range(3)]
            lines.append(f"{number}, {x[0]!r}, {x[1]!r}, {x[2]!r}")
        return Card("NODE", {}, lines)

    def refine_elements(self, card: Card) -> Card:
        """The children of the elements of a card."""
        kind = card.value("TYPE")
        lines = []
        for number, nodes in element_rows(card):
            if kind in BRICKS:
                rows = self.split_brick(nodes)
            elif kind == "JOINT8":
                lower, upper = self.split_square(nodes[:4]), self.split_square(nodes[4:])
                rows = [(side, [*lower[side], *upper[side]]) for side in lower]
            elif kind == "IFACE4":
                rows = list(self.split_square(nodes).items())
            else:
                raise RefinementError(f"elements of type {kind} cannot be refined")
            self.children[number] = []
            for side, found in rows:
                self.children[number].append((self.next_element, side))
                lines.append(", ".join(map(str, [self.next_element, *found])))
                self.next_element += 1
        parameters = {name: text for name, text in card.parameters.items() if name != "ELSET"}
        return Card("ELEMENT", parameters, lines)

    def split_brick(self, nodes: list[int]) -> list[tuple[Side, list[int]]]:
        """Eight bricks, or four in a slice, each with its side of the three axes."""
        self.check_triangles(nodes)
        return self.split(nodes, CORNERS)

    def split_square(self, nodes: list[int]) -> dict[Side, list[int]]:
        """Four quadrilaterals, or two in a slice, by their sides of the two axes."""
        return dict(self.split(nodes, SQUARE))

    def split(self, nodes: list[int], corners: Corners) -> list[tuple[Side, list[int]]]:
        """The children of an element, each with its side of every axis; None: it has both sides."""
        whole = self.whole_axis(nodes, corners)
        axes = range(len(corners[0]))
        found = []
        for side in product(*[(None,) if i == whole else (0, 1) for i in axes]):
            places = [
                tuple(c if s is None else s + c // 2 for s, c in zip(side, corner, strict=True))
                for corner in corners
            ]
            found.append((side, [self.node_at(corners_at(p, corners, nodes)) for p in places]))
        return found

    def whole_axis(self, nodes: list[int], corners: Corners) -> int | None:
        """The axis of an element across the slice, along which it is not split."""
        back = [node in self.back for node in nodes]
        if not any(back) or all(back):
            return None
        for i in range(len(corners[0])):
            sides = {(corner[i], is_back) for corner, is_back in zip(corners, back, strict=True)}
            if len(sides) == 2:
                return i
        return None

    def node_at(self, parents: list[int]) -> int:
        """The node in the middle of its parents."""
        key = key_of(parents)
        if len(key) == 1:
            return key[0][0]
        if key not in self.new_nodes:
            self.new_nodes[key] = self.next_node
            self.next_node += 1
        return self.new_nodes[key]

    def check_triangles(self, nodes: list[int]) -> None:
        """Wedges that share a triangle must double the same corner: else their middles differ."""
        for face in FACE_NODES.values():
            counts = Counter(nodes[a] for a in face)
            if len(counts) != 3:
                continue
            corner = max(counts, key=lambda node: counts[node])
            if self.doubled.setdefault(frozenset(counts), corner) != corner:
                raise RefinementError(
                    "two wedges share a triangle and double different corners of it"
                )

    def find_surface(self) -> None:
        """Middles of edges and faces that belong to one brick alone, or to a joint."""
        bricks: dict[frozenset[int], list[tuple[list[int], list[int]]]] = defaultdict(list)
        found: set[Key] = set()
        for card in self.old.of("ELEMENT"):
            for _, nodes in element_rows(card):
                if card.value("TYPE") not in BRICKS:
                    found |= {key for face in (nodes[:4], nodes[4:]) for key in middles_of(face)}
                    continue
                for corners in FACE_NODES.values():
                    face = [nodes[a] for a in corners]
                    if len(set(face)) > 2:
                        bricks[frozenset(face)].append((face, nodes))
        for corners, same in bricks.items():
            if len(same) == 1:
                face, nodes = same[0]
                for key in middles_of(face):
                    self.faces[key].append((corners, frozenset(nodes)))
        found |= self.faces.keys()
        self.surface_nodes = [item for item in self.new_nodes.items() if item[0] in found]

    def grown(self, nodes: set[int]) -> list[tuple[Key, int]]:
        """Parents and numbers of new nodes of the surface between nodes of a set."""
        return [
            (key, number) for key, number in self.surface_nodes
            if all(parent in nodes for parent, _ in key)
        ]  # fmt: skip

    def set_cards(self) -> list[Card]:
        """Sets of nodes, the same sets with new nodes, and sets of elements."""
        cards = []
        for name, nodes in self.sets.node_sets.items():
            cards.append(list_card("NSET", name, sorted(nodes)))
            grown = [*sorted(nodes), *(number for _, number in self.grown(nodes))]
            cards.append(list_card("NSET", grown_name(name), grown))
        for name, elements in self.sets.element_sets.items():
            children = [child for e in sorted(elements) for child, _ in self.children[e]]
            cards.append(list_card("ELSET", name, children))
        return cards

    def follow(self, card: Card) -> Card:
        """A card that names nodes or elements, for the refined mesh."""
        if card.keyword == "BOUNDARY":
            return Card("BOUNDARY", card.parameters, self.supports.lines_of(card))
        if card.keyword == "SURFACE" and card.value("TYPE") in ("NODE", "NODES"):
            return Card("SURFACE", card.parameters, self.node_lines(card))
        if card.keyword == "SURFACE":
            return Card("SURFACE", card.parameters, self.surface_lines(card))
        if card.keyword == "DLOAD":
            return Card("DLOAD", card.parameters, self.load_lines(card))
        if card.keyword == "MODEL CHANGE":
            return Card("MODEL CHANGE", card.parameters, self.stage_lines(card))
        return card

    def surface_lines(self, card: Card) -> list[str]:
        """Faces of children on the faces of a surface."""
        lines = []
        for line in card.lines:
            label, face = (item.strip() for item in fields_of(line)[:2])
            lines += [f"{child}, {face}" for child in self.children_on(label, face[1:])]
        return lines

    def children_on(self, label: str, face: str) -> list[int]:
        """Children of an element or a set on a face of their parents."""
        if face not in FACE_SIDES:
            raise RefinementError(f"the face '{face}' of {label} is not one of a brick")
        axis, side = FACE_SIDES[face]
        elements = self.sets.elements_of(label)
        return [child for e in sorted(elements) for child, at in self.children[e]
                if at[axis] in (side, None)]  # fmt: skip

    def node_lines(self, card: Card) -> list[str]:
        """Lines of a surface of nodes, with the new nodes between all of them."""
        labels = [fields_of(line)[0].strip() for line in card.lines]
        nodes = set().union(*map(self.sets.nodes_of, labels))
        return [*card.lines, *(str(number) for _, number in self.grown(nodes))]

    def load_lines(self, card: Card) -> list[str]:
        """Weight acts on all children; a pressure (P1 to P6, HP1 to HP6) on those at the face."""
        lines = []
        for line in card.lines:
            label, kind, *rest = (item.strip() for item in fields_of(line))
            if pressure := re.fullmatch("H?P([1-6])", kind.upper()):
                found = self.children_on(label, pressure[1])
            elif label.isdigit():
                found = [child for child, _ in self.children[int(label)]]
            else:
                lines.append(line)
                continue
            lines += [", ".join([str(child), kind, *rest]) for child in found]
        return lines

    def stage_lines(self, card: Card) -> list[str]:
        """The children of single elements; sets have them already."""
        lines = []
        for item in (item.strip() for line in card.lines for item in fields_of(line)):
            if item.isdigit():
                lines += [str(child) for child, _ in self.children[int(item)]]
            elif item:
                lines.append(item)
        return lines


def corners_at(place: tuple[int, ...], corners, nodes: list[int]) -> list[int]:
    """Nodes of the corners around a point of the lattice."""
    return [
        node for corner, node in zip(corners, nodes, strict=True)
        if all(at in (1, c) for at, c in zip(place, corner, strict=True))
    ]  # fmt: skip


def middles_of(face: list[int]) -> set[Key]:
    """Parents of the middles of a face and of its edges."""
    if not face:
        return set()
    return {key_of(face), *(key_of([face[i - 1], face[i]]) for i in range(4))}


def key_of(parents: list[int]) -> Key:
    """Parents with the shares that they have, in lowest terms."""
    counts = Counter(parents)
    common = reduce(gcd, counts.values())
    return tuple(sorted((node, count // common) for node, count in counts.items()))
