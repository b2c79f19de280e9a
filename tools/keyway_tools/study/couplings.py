"""The same bodies coupled in other ways: joints on surfaces, chains of interface elements, ties."""

from __future__ import annotations

from collections.abc import Callable

from ..deck_bytes import capitals
from .deck_cards import Card, Deck, fields_of, number_of, quoted
from .mesh_sets import element_rows, list_card, read_sets
from .refined_mesh import BRICKS, FACE_NODES, RefinementError
from .rungs import Rung

BONDED = "1e30"  # strength of a joint that never opens
STIFF_SPRINGS = 10.0  # of a tie, over Young's modulus by the length of a facet's edge
Facet = tuple[str, str, list[int]]  # element, face, nodes; the normal points into the solid


def coupling_rungs(deck: Deck) -> list[Rung]:
    """Variants of joints and ties that the deck allows; all of a kind are changed at once."""
    found = []

    def add(name: str, factor: float, is_there: bool, change: Callable[[Deck], Deck]) -> None:
        if is_there:
            found.append(Rung("coupling", name, factor, 1.0, change))

    joints, ties = list(deck.of("JOINT")), list(deck.of("TIE"))
    of_elements = [card for card in joints if "ELSET" in card.parameters]
    on_surfaces = [card for card in joints if "ELSET" not in card.parameters]
    add("joints on surfaces", 1.3, bool(of_elements), joints_on_surfaces)
    add("joints by chains of interface elements", 1.5, bool(on_surfaces), chains)
    add("slaves and masters of joints exchanged", 1.2, bool(on_surfaces), exchanged)
    add("joints with Gauss points", 3.0, any(not has_gauss(card) for card in joints), with_gauss)
    exact = [card for card in ties if "STIFFNESS" not in card.parameters]
    add("ties by springs", 1.0, bool(exact), ties_by_springs)
    add("ties by joints that stay closed", 1.5, bool(ties), ties_by_joints)
    add("exact ties", 1.0, len(exact) < len(ties), exact_ties)
    return found


def has_gauss(card: Card) -> bool:
    return card.value("INTEGRATION") == "GAUSS"


def with_gauss(deck: Deck) -> Deck:
    new = deck.copy()
    for card in new.of("JOINT"):
        card.parameters["INTEGRATION"] = "GAUSS"
    return new


def exchanged(deck: Deck) -> Deck:
    """Joints whose other side is the slave. KN by default comes from the slave's side."""
    new = deck.copy()
    for card in new.of("JOINT"):
        if card.lines:
            card.lines = [", ".join(reversed(surfaces_of(card)))]
    return new


def surfaces_of(card: Card) -> list[str]:
    return [item.strip() for item in fields_of(card.lines[0])[:2]]


def joints_on_surfaces(deck: Deck) -> Deck:
    """Joints of JOINT8 elements, also those of chains, become joints on the surfaces of solids."""
    sets, solids = read_sets(deck), solid_faces(deck)
    quads, sides = chain_ends(deck)
    rows = {number: nodes for card in deck.of("ELEMENT") for number, nodes in element_rows(card)}
    new = deck.copy()
    gone: set[int] = set()
    surfaces: list[Card] = []
    for card in list(new.of("JOINT")):
        name = card.parameters.pop("ELSET", None)
        if name is None:
            continue
        elements = sorted(sets.elements_of(name.strip('"')))
        gone.update(elements)
        pair = []
        for side, first in (("SLAVE", 4), ("MASTER", 0)):
            facets = [rows[number][first : first + 4] for number in elements]
            end = {quads[node] for facet in facets for node in facet if node in quads}
            if end:
                pair.append(sides[end.pop()])
                continue
            label = f"{side}_OF_{card.value('NAME')}"
            if any(frozenset(facet) not in solids for facet in facets):
                raise RefinementError(f"joint {card.value('NAME')} has no solids on one side")
            lines = [", ".join(solids[frozenset(facet)]) for facet in facets]
            surfaces.append(Card("SURFACE", {"NAME": label, "TYPE": "ELEMENT"}, lines))
            pair.append(label)
        card.lines = [", ".join(pair)]
    chained = {name for name in sides if name}
    gone |= {e for card in new.of("INTERFACE") if card.value("NAME") in chained
             for e in sets.elements_of(card.value("ELSET"))}  # fmt: skip
    new.without([card for card in new.of("INTERFACE") if card.value("NAME") in chained])
    remove_elements(new, gone)
    insert_before(new, "JOINT", surfaces)
    return new


def chain_ends(deck: Deck) -> tuple[dict[int, str], dict[str, str]]:
    """The interface of each node of its quads, and the surface of each interface."""
    sets = read_sets(deck)
    rows = {number: nodes for card in deck.of("ELEMENT") for number, nodes in element_rows(card)}
    quads, surfaces = {}, {}
    for card in deck.of("INTERFACE"):
        surfaces[card.value("NAME")] = card.value("SURFACE")
        for element in sets.elements_of(card.value("ELSET")):
            quads.update(dict.fromkeys(rows[element], card.value("NAME")))
    return quads, surfaces


def solid_faces(deck: Deck) -> dict[frozenset[int], tuple[str, str]]:
    """Element and label of each face of the solids, by its nodes."""
    found = {}
    for card in deck.of("ELEMENT"):
        if card.value("TYPE") in BRICKS:
            for number, nodes in element_rows(card):
                for face, corners in FACE_NODES.items():
                    found[frozenset(nodes[a] for a in corners)] = (str(number), f"S{face}")
    return found


def remove_elements(deck: Deck, gone: set[int]) -> None:
    """Takes elements out of the mesh and out of all sets; sets that are empty then go as well."""
    sets = read_sets(deck)
    for card in deck.of("ELEMENT"):
        rows = [(n, nodes) for n, nodes in element_rows(card) if n not in gone]
        card.lines = [", ".join(map(str, [number, *nodes])) for number, nodes in rows]
        card.parameters.pop("ELSET", None)
    deck.without([card for card in deck.of("ELEMENT") if not card.lines])
    last = max(i for i, card in enumerate(deck.cards) if card.keyword == "ELEMENT")
    kept = [(name, sorted(members - gone)) for name, members in sets.element_sets.items()]
    deck.cards[last + 1 : last + 1] = [list_card("ELSET", name, m) for name, m in kept if m]
    deck.without([card for card in deck.of("ELSET") if not card.value("ELSET")
                  or card.value("ELSET") not in sets.element_sets])  # fmt: skip
    written = {name for name, members in kept if members}
    first = {id(card) for card in deck.cards[last + 1 : last + 1 + len(written)]}
    deck.without([card for card in deck.of("ELSET") if id(card) not in first])


def chains(deck: Deck) -> Deck:
    """Joints on surfaces become chains: the master surface, springs, interface quads that match the
    slave surface, joint elements, the slave surface (theory: different_meshes.md, 13.4)."""
    sets = read_sets(deck)
    new = deck.copy()
    node, element = max(sets.nodes) + 1, largest_element(deck) + 1
    added: list[Card] = []
    for joint in [card for card in new.of("JOINT") if card.lines]:
        slave, master = surfaces_of(joint)
        name = joint.value("NAME")
        twins: dict[int, int] = {}
        quads, pairs = [], []
        for _, _, nodes in facets_of(deck, slave):
            for old in nodes:
                if old not in twins:
                    twins[old] = node
                    node += 1
            quad = [twins[old] for old in nodes]
            quads.append(", ".join(map(str, [element, *quad])))
            pairs.append(", ".join(map(str, [element + 1, *quad, *nodes])))
            element += 2
        points = [f"{twin}, {', '.join(map(repr, sets.nodes[old]))}" for old, twin in twins.items()]
        quads_of, pairs_of, chain_of = (
            quoted(f"{m}_OF_{name}") for m in ("QUADS", "PAIRS", "CHAIN")
        )
        added += [
            Card("NODE", {}, points),
            Card("ELEMENT", {"TYPE": "IFACE4", "ELSET": quads_of}, quads),
            Card("ELEMENT", {"TYPE": "JOINT8", "ELSET": pairs_of}, pairs),
            Card("INTERFACE", {"NAME": chain_of, "ELSET": quads_of,
                               "SURFACE": master}),
        ]  # fmt: skip
        joint.lines = []
        joint.parameters["ELSET"] = pairs_of
        joint.parameters.pop("CLEARANCE", None)
    insert_before(new, "JOINT", added)
    return new


def largest_element(deck: Deck) -> int:
    return max(number for card in deck.of("ELEMENT") for number, _ in element_rows(card))


def facets_of(deck: Deck, surface: str) -> list[Facet]:
    """The facets of a surface of solids."""
    sets = read_sets(deck)
    rows = {number: nodes for card in deck.of("ELEMENT") for number, nodes in element_rows(card)}
    found = []
    for card in deck.of("SURFACE"):
        if card.value("NAME") != capitals(surface.strip('"')):
            continue
        for line in card.lines:
            label, face = (item.strip() for item in fields_of(line)[:2])
            for number in sorted(sets.elements_of(label)):
                nodes = [rows[number][a] for a in FACE_NODES[face[1:]]]
                found.append((str(number), face, nodes))
    return found


def ties_by_springs(deck: Deck) -> Deck:
    """Springs ten times as stiff as a layer of solid as deep as the facets are wide."""
    new = deck.copy()
    for card in new.of("TIE"):
        if "STIFFNESS" not in card.parameters:
            card.parameters["STIFFNESS"] = f"{stiffness_of(deck, surfaces_of(card)[0]):.4g}"
            card.parameters.pop("ADJUST", None)
    return new


def exact_ties(deck: Deck) -> Deck:
    new = deck.copy()
    for card in new.of("TIE"):
        card.parameters.pop("STIFFNESS", None)
    return new


def ties_by_joints(deck: Deck) -> Deck:
    """Ties become joints with a strength that nothing exceeds."""
    new = deck.copy()
    for k, card in enumerate(new.of("TIE")):
        value = card.parameters.get("STIFFNESS")
        stiff = f"{number_of(value) if value else stiffness_of(deck, surfaces_of(card)[0]):.4g}"
        law = f"CLOSED_{k + 1}"
        strong = {"NAME": law, "KN": stiff, "KT": stiff, "TENSILE STRENGTH": BONDED}
        joint = {"NAME": card.parameters["NAME"], "LAW": law}
        place = next(i for i, other in enumerate(new.cards) if other is card)
        new.cards[place : place + 1] = [
            Card("JOINT LAW", strong), Card("JOINT", joint, card.lines)
        ]  # fmt: skip
    return new


def stiffness_of(deck: Deck, surface: str) -> float:
    """STIFF_SPRINGS times the largest Young's modulus over the mean edge of a surface."""
    x = read_sets(deck).nodes
    edges = [
        sum((a - b) ** 2 for a, b in zip(x[nodes[i]], x[nodes[i - 1]], strict=True)) ** 0.5
        for _, _, nodes in facets_of(deck, surface) for i in range(4) if nodes[i] != nodes[i - 1]
    ]  # fmt: skip
    modulus = max(number_of(fields_of(card.lines[0])[0]) for card in deck.of("ELASTIC"))
    return STIFF_SPRINGS * modulus * len(edges) / sum(edges)


def insert_before(deck: Deck, keyword: str, cards: list[Card]) -> None:
    """Puts cards before the first one with a keyword."""
    place = next(i for i, card in enumerate(deck.cards) if card.keyword == keyword)
    deck.cards[place:place] = cards
