"""Sets of nodes and elements, from the cards that define them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from keyway_tools.deck_bytes import capitals

from .card import Card
from .deck_file import DeckError
from .fields import Value, as_text, quoted_if_needed

# The parameter that names a set, and the keyword whose data lines begin with its members.
_MEMBERS = {"NSET": "NODE", "ELSET": "ELEMENT"}
_NODES = {"IFACE4": 4}  # of an element; 8 for all others
_A_LINE = 12


def collect(cards: Iterable[Card], kind: str) -> dict[str, set[int]]:
    """The sets by their names in capitals; `kind` is NSET or ELSET.

    Raises DeckError for members that are neither numbers nor sets above.
    """
    sets: dict[str, set[int]] = {}
    above = None
    for card in cards:
        if card.keyword and not card.is_a("INCLUDE"):
            above = card
        source = above if not card.keyword else card  # an included file of bare data lines
        name = source.parameters.get(kind) if source and source.keyword else None
        if source is None or not name:
            continue
        if source.is_a(_MEMBERS[kind]):
            sets.setdefault(capitals(name), set()).update(_first_numbers(source, card))
        elif source.is_a(kind):
            sets.setdefault(capitals(name), set()).update(_members(source, card, sets))
    return sets


def _first_numbers(source: Card, card: Card) -> Iterator[int]:
    """Numbers of nodes or elements; elements may take several lines."""
    num_fields, where = 1, card.where
    if source.is_a("ELEMENT"):
        num_fields += _NODES.get((source.parameters.get("TYPE") or "").upper(), 8)
    fields: list[str] = []
    for row in card.data:
        fields += row[:]
        if source.is_a("NODE") or len(fields) >= num_fields:
            yield _number(fields[0], where)
            fields = []


def _members(source: Card, card: Card, sets: dict[str, set[int]]) -> Iterator[int]:
    """Members of *NSET or *ELSET."""
    where = card.where
    rows = ((where, row) for row in card.data)
    return members_of(rows, "GENERATE" in source.parameters, sets, _number)


def members_of(
    rows: Iterable[tuple[str, Sequence[str]]],
    generates: bool,
    sets: Mapping[str, Iterable[int]],
    number: Callable[[str, str], int],
) -> Iterator[int]:
    """Members that data lines of *NSET or *ELSET name: numbers, sets above, ranges with GENERATE.

    `rows` are the lines, each with its place; `sets` have names in capitals; `number` reads a field
    at a place, or raises. Raises DeckError for a range that is none.
    """
    for place, row in rows:
        if generates:
            numbers = [number(text, place) for text in row]
            if len(numbers) not in (2, 3) or min(numbers) < 1 or numbers[0] > numbers[1]:
                raise DeckError(f"{place}: found '{', '.join(row)}'; expected first, last, step: "
                                "integers > 0 with first <= last")  # fmt: skip
            yield from range(numbers[0], numbers[1] + 1, *numbers[2:])
            continue
        for text in row:
            if capitals(text) in sets:
                yield from sets[capitals(text)]
            elif text:
                yield number(text, place)


def _number(text: str, where: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise DeckError(f"{where}: '{text}' is neither a number nor a set above") from None


def set_text(kind: str, name: str, members: Iterable[Value]) -> str:
    """A card *NSET or *ELSET. Raises DeckError where there are no members."""
    items = [as_text(member) for member in members]
    if not items:
        raise DeckError(f"*{kind} {name}: expected members")
    rows = [items[start : start + _A_LINE] for start in range(0, len(items), _A_LINE)]
    head = f"*{kind}, {kind}={quoted_if_needed(name)}"
    return "\n".join([head, *(", ".join(row) for row in rows)]) + "\n"
