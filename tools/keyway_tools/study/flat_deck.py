"""A deck of parts and instances as a deck without them, as the program reads it (deck.md).

Sets and surfaces of an instance are called INSTANCE.NAME. Numbers of each instance get a round
number of its own, so that none occurs twice.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

from ..deck_bytes import capitals, read_deck_text
from .deck_cards import Card, Deck, fields_of, number_of
from .mesh_sets import element_rows

FRAME = ("PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE")
LISTS = ("NSET", "ELSET", "MODEL CHANGE")  # all fields of a line are numbers or names
OF_ELEMENTS = ("ELSET", "DLOAD", "MODEL CHANGE", "SURFACE")  # numbers are those of elements
Vector = tuple[float, float, float]


@dataclass
class Instance:
    """A part in its place; '' is what stands outside the instances."""

    name: str = ""
    cards: list[Card] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)  # of *INSTANCE: translation, rotation
    offset: int = 0  # added to its numbers

    def placed(self, x: Vector) -> Vector:
        """A point of the part, moved and then rotated."""
        rows = [[number_of(item) for item in fields_of(line)] for line in self.lines]
        if rows and len(rows[0]) <= 3:
            moved = [a + b for a, b in zip(x, [*rows.pop(0), 0.0, 0.0], strict=False)]
            x = (moved[0], moved[1], moved[2])
        return rotated(x, rows[0]) if rows else x


def rotated(x: Vector, row: list[float]) -> Vector:
    """A point after a rotation about the axis through two points, by an angle in degrees."""
    a, b, angle = row[:3], row[3:6], math.radians(row[6])
    length = math.dist(a, b)
    k = [(q - p) / length for p, q in zip(a, b, strict=True)]
    r = [p - q for p, q in zip(x, a, strict=True)]
    cross = [k[i - 2] * r[i - 1] - k[i - 1] * r[i - 2] for i in range(3)]
    along = sum(p * q for p, q in zip(k, r, strict=True)) * (1.0 - math.cos(angle))
    turned = [a[i] + r[i] * math.cos(angle) + cross[i] * math.sin(angle) + k[i] * along
              for i in range(3)]  # fmt: skip
    return turned[0], turned[1], turned[2]


def flat(deck: Deck, keeps_c3d8: bool = False) -> Deck:
    """The flat deck; C3D8 of parts is the element of Abaqus, C3D8B, unless it is to be kept."""
    if not (deck.has("PART") or deck.has("INSTANCE")):
        return deck
    order = [*assembled(deck)]
    outside = Instance()
    instances = {one.name: one for one in order if isinstance(one, Instance)}
    size = 10 ** len(str(max(numbers_in(deck), default=0)))
    for k, instance in enumerate(instances.values(), 1):
        instance.offset = k * size
    cards: list[Card] = []
    for one in order:
        if isinstance(one, Instance):
            cards += [rewritten(card, one, instances) for card in one.cards]
        else:
            cards.append(rewritten(one, outside, instances))
    for card in cards:
        if card.keyword == "ELEMENT" and card.value("TYPE") == "C3D8" and not keeps_c3d8:
            card.parameters["TYPE"] = "C3D8B"
        if card.keyword == "TIE" and not {"ADJUST", "STIFFNESS"} & card.parameters.keys():
            card.parameters["ADJUST"] = "YES"
    new = Deck(cards, dict(deck.files))
    for k, card in enumerate(new.of("TEMPERATURE"), 1):
        if name := (card.parameters.get("INPUT") or "").strip("\"'"):
            text = deck.files.get(name) or read_deck_text(Path(name))
            new.files[f"flat_temperatures_{k}.csv"] = rows_rewritten(text, instances)
            card.parameters["INPUT"] = f'"flat_temperatures_{k}.csv"'
    return new


def rows_rewritten(text: str, instances: dict[str, Instance]) -> str:
    """The rows of a file of temperatures, with the names and numbers of the flat model."""
    rows = []
    for line in text.removesuffix("\n").split("\n"):
        name, comma, rest = line.partition(",")
        found = in_instance(name.strip(), instances)
        rows.append((label(found[1], instances[found[0]]) if found else name) + comma + rest)
    return "\n".join(rows) + "\n"


def assembled(deck: Deck) -> Iterator[Card | Instance]:
    """The cards outside the parts, and each instance with the cards of its part and its own."""
    parts: dict[str, list[Card]] = {}
    inside: list[Card] | None = None
    instance: Instance | None = None
    for card in deck.cards:
        if card.keyword == "PART":
            inside = parts.setdefault(card.value("NAME"), [])
        elif card.keyword == "INSTANCE":
            instance = Instance(
                card.value("NAME"), [*parts.get(card.value("PART"), [])], card.lines
            )
            inside = instance.cards
        elif card.keyword in FRAME:
            if card.keyword == "END INSTANCE" and instance:
                yield instance
            inside = None
        elif inside is not None:
            inside.append(card)
        else:
            yield card


def numbers_in(deck: Deck) -> Iterator[int]:
    """Numbers of all nodes and elements."""
    for card in deck.of("NODE"):
        yield from (int(fields_of(line)[0]) for line in card.lines)
    for card in deck.of("ELEMENT"):
        yield from (number for number, _ in element_rows(card))


def rewritten(card: Card, owner: Instance, instances: dict[str, Instance]) -> Card:
    """A card with the names and numbers of the flat model."""
    new = deepcopy(card)
    if owner.name:
        for name in ("NSET", "ELSET", *(["NAME"] if card.keyword == "SURFACE" else [])):
            if card.value(name):
                new.parameters[name] = plain(f"{owner.name}.{card.value(name)}")
    else:
        for name in new.parameters.keys() - {"INPUT"}:
            if found := in_instance(card.value(name), instances):
                new.parameters[name] = plain(".".join(found))
    scope = instances.get(capitals((new.parameters.pop("INSTANCE", "") or "").strip('"')), owner)
    if card.keyword == "NODE":
        new.lines = [node_line(line, owner) for line in card.lines]
    elif card.keyword == "ELEMENT":
        new.lines = [", ".join(str(number + owner.offset) for number in [first, *nodes])
                     for first, nodes in element_rows(card)]  # fmt: skip
    elif card.keyword not in ("HEADING", "SOLID SECTION"):
        new.lines = [", ".join(items(card, line, scope, instances)) for line in card.lines]
    return new


def node_line(line: str, owner: Instance) -> str:
    number, *rest = fields_of(line)
    x = [number_of(item) if item.strip() else 0.0 for item in rest] + [0.0] * 3
    place = owner.placed((x[0], x[1], x[2]))
    return ", ".join([str(int(number) + owner.offset), *map(repr, place)])


def items(card: Card, line: str, scope: Instance, instances: dict[str, Instance]) -> Iterator[str]:
    """The fields of a line: references in the first one, in all of a list, INSTANCE.X anywhere."""
    for k, item in enumerate(item.strip() for item in fields_of(line)):
        is_step = "GENERATE" in card.parameters and k == 2
        if found := in_instance(item, instances):
            yield label(found[1], instances[found[0]])
        elif item and (k == 0 or card.keyword in LISTS) and not is_step:
            yield label(item, scope)
        else:
            yield item


def in_instance(item: str, instances: dict[str, Instance]) -> tuple[str, str] | None:
    """The instance and the name of INSTANCE.X, in capitals; None for other words."""
    found = re.fullmatch(r'"?([^".]+)"?\.("?[^"]+"?)', capitals(item))
    return (found[1], found[2].strip('"')) if found and found[1] in instances else None


def label(item: str, owner: Instance) -> str:
    """A number or a name of an instance in the flat model."""
    if item.isdigit():
        return str(int(item) + owner.offset)
    return plain(f"{owner.name}.{capitals(item)}") if owner.name else item


def plain(name: str) -> str:
    """A name without blanks and quotes."""
    return re.sub(r"[^A-Z0-9_.-]", "_", name.replace('"', ""))
