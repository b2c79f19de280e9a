"""Temperatures and initial values of the new nodes of a refined mesh.

Between the nodes of an element values are those of its shape functions: a new node has the mean of
its parents. Lines of the deck keep their nodes; cards with the new nodes follow.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ..deck_bytes import read_deck_text
from .deck_cards import Card, Deck, fields_of, number_of
from .mesh_sets import MeshSets, RefinementError

Key = tuple[tuple[int, int], ...]  # parents of a node and how often each counts


def add_values(deck: Deck, sets: MeshSets, new_nodes: dict[Key, int]) -> None:
    """Adds the cards of new nodes to a deck that has the refined mesh; `sets` are the old ones."""
    initial = initial_values(deck, sets)
    model = [card for name, values in initial.items() for card in
             initial_cards(name, values, new_nodes)]  # fmt: skip
    heat = Temperatures(sets, new_nodes, initial.get(("TEMPERATURE", ""), {}))
    cards: list[Card] = []
    now: list[Card] = []
    for card in deck.cards:
        if card.keyword == "STEP":
            cards += model
            model, now = [], []
        elif card.keyword == "TEMPERATURE":
            now.append(card)
        elif card.keyword == "END STEP":
            cards += heat.cards_of_step(deck, now)
        cards.append(card)
    deck.cards = cards


def initial_values(deck: Deck, sets: MeshSets) -> dict[tuple[str, str], dict[int, float]]:
    """Values by node of each kind of *INITIAL CONDITIONS and direction ('' of temperatures)."""
    found: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
    for card in deck.of("INITIAL CONDITIONS"):
        kind = card.value("TYPE")
        for line in card.lines:
            label, *rest = (item.strip() for item in fields_of(line))
            direction = "" if kind == "TEMPERATURE" else rest.pop(0)
            value = number_of(rest[0]) if rest and rest[0] else 0.0
            found[kind, direction].update(dict.fromkeys(sets.nodes_of(label), value))
    return found


def initial_cards(
    name: tuple[str, str], values: dict[int, float], new_nodes: dict[Key, int]
) -> Iterator[Card]:
    """The card of the new nodes; nodes that a deck does not name start at zero."""
    kind, direction = name
    lines = []
    for key, number in new_nodes.items():
        value = mean(key, {node: (values.get(node, 0.0),) for node, _ in key})[0]
        if value:
            lines.append(", ".join(filter(None, [str(number), direction, repr(value)])))
    if lines:
        yield Card("INITIAL CONDITIONS", {"TYPE": kind}, lines)


def mean(key: Key, values: dict[int, tuple[float, ...]]) -> tuple[float, ...]:
    """The mean of the parents of a node, column by column."""
    total = sum(count for _, count in key)
    columns = zip(*[[count * value for value in values[node]] for node, count in key], strict=True)
    return tuple(sum(column) / total for column in columns)


@dataclass(frozen=True)
class History:
    """What values of nodes are multiplied with or follow: an amplitude, the times of a file."""

    amplitude: str = ""
    times: tuple[str, ...] = ()
    clock: str = ""

    @property
    def is_constant(self) -> bool:
        return not (self.amplitude or self.times)


@dataclass
class Temperatures:
    """Temperatures of the new nodes, step by step."""

    sets: MeshSets
    new_nodes: dict[Key, int]
    initial: dict[int, float]
    now: dict[int, float | None] = field(default_factory=dict)  # None: as a history has left it

    def cards_of_step(self, deck: Deck, cards: list[Card]) -> list[Card]:
        """The cards of the new nodes of a step; what it prescribes is known to the next step."""
        named = dict(self.values_of(deck, cards))
        if any(card.value("OP") == "NEW" for card in cards):
            self.now = {}
        rows: dict[History, list[str]] = defaultdict(list)
        for key, number in self.new_nodes.items():
            if any(node in named for node, _ in key):
                history, values = self.value_between(key, named)
                rows[history].append(", ".join([str(number), *map(repr, values)]))
        for node, (history, values) in named.items():
            self.now[node] = values[0] if history.is_constant else None
        return [self.card_of(deck, history, lines) for history, lines in rows.items()]

    def values_of(
        self, deck: Deck, cards: Iterable[Card]
    ) -> Iterator[tuple[int, tuple[History, tuple[float, ...]]]]:
        """What the cards of a step say of each node, in their order."""
        for card in cards:
            amplitude = History(card.parameters.get("AMPLITUDE") or "")
            for times, label, values in rows_of(deck, card):
                history = History(times=times, clock=card.value("TIME")) if times else amplitude
                for node in self.sets.nodes_of(label):
                    yield node, (history, values)

    def value_between(self, key: Key, named: dict) -> tuple[History, tuple[float, ...]]:
        """History and values of a new node. A parent that the step does not name keeps its
        temperature, which has to be known."""
        histories = {named[node][0] for node, _ in key if node in named}
        history = next(iter(histories))
        width = max(1, len(history.times))
        values = {}
        for node, _ in key:
            kept = self.now.get(node, self.initial.get(node, 0.0))
            is_odd = kept is None or (kept and history.amplitude)
            if len(histories) > 1 or (node not in named and is_odd):
                raise RefinementError(
                    f"temperatures with different histories meet in an element at node {node}"
                )
            values[node] = named[node][1] if node in named else (kept,) * width
        return history, mean(key, values)

    def card_of(self, deck: Deck, history: History, lines: list[str]) -> Card:
        """The card of the rows of one history; a file, where they have times."""
        if not history.times:
            amplitude = {"AMPLITUDE": history.amplitude} if history.amplitude else {}
            return Card("TEMPERATURE", dict(amplitude), lines)
        name = f"temperatures_{len(deck.files) + 1}.csv"
        head = ", ".join(["node", *history.times])
        deck.files[name] = "\n".join([head, *lines]) + "\n"
        clock = {"TIME": history.clock} if history.clock else {}
        return Card("TEMPERATURE", {"INPUT": f'"{name}"', **clock})


def rows_of(
    deck: Deck, card: Card
) -> Iterator[tuple[tuple[str, ...], str, tuple[float, ...]]]:  # fmt: skip
    """Times of the columns, node or set, and values: rows of a file, then data lines."""
    if name := (card.parameters.get("INPUT") or "").strip('"'):
        text = deck.files.get(name) or read_deck_text(Path(name))
        times: tuple[str, ...] = ()
        for line in map(str.strip, text.split("\n")):
            if not line or line[0] in "*#":
                continue
            label, *items = (item.strip() for item in fields_of(line))
            if label.upper() == "NODE":
                times = tuple(items) if len(items) > 1 else ()
                continue
            yield times, label, tuple(map(number_of, items))
    for line in card.lines:
        label, value = fields_of(line)[:2]
        yield (), label.strip(), (number_of(value),)
