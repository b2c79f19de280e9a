"""What can be varied in a deck without a change of what it describes: the rungs of its ladder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .deck_cards import Card, Deck, fields_of, number_of
from .refined_mesh import BRICKS, refine

# Extremes that every step records.
ENVELOPES = ("S1", "S3", "OPENING", "U")
REQUESTS = (
    "NODE FILE", "EL FILE", "OUTPUT", "NODE OUTPUT", "ELEMENT OUTPUT", "NODE PRINT", "EL PRINT",
    "JOINT PRINT", "RESTART",
)  # fmt: skip
JOINTS = ("JOINT", "CONTACT PAIR")
INELASTIC = ("CONCRETE DAMAGED PLASTICITY", "PLASTIC", "USER MATERIAL")
SIZES = (0, 2, 3)  # fields of *DYNAMIC: first, smallest and largest increment
# Names of rungs
BASE, ONCE, TWICE = "the deck as it is", "mesh refined", "mesh refined twice"
ELEMENT_CHECK = "element check"  # an axis
FINEST_INCREMENT = 0.125  # of the check of a ladder
# A reduced model with its estimates over the full one: 2.1, 2.1, 1.1 and 0.6 in docs/accuracy.md,
# less with more unknowns
# A factor in each iteration: 13 times the time in gmsh_arch, some 70 times in xingbiling_matching.
FULL_COST = 50.0
REDUCED_COST = 1.3
SLOWEST = 1.35  # exponent of the time of an increment over unknowns, three-dimensional meshes


@dataclass(frozen=True)
class Rung:
    """A variant of the deck: its axis, its place on the axis, and how its deck is made."""

    axis: str  # "increment", "mesh", "element", "tolerance", "coupling", "alpha", ..
    name: str
    factor: float  # of the time of the deck as it is, predicted
    size: float  # of what the error depends on: increment, element; 1: as in the deck
    change: Callable[[Deck], Deck]


def as_it_is(deck: Deck) -> Deck:
    return deck


def base_deck(deck: Deck) -> Deck:
    """The deck without output but the extremes of every step with displacements."""
    base = deck.copy()
    base.without(base.of(*REQUESTS, "ENVELOPE"))
    has_joints = any(base.has(keyword) for keyword in JOINTS)
    for step in base.steps():
        if any(card.keyword in ("STATIC", "DYNAMIC") for card in step):
            fields = [name for name in ENVELOPES if has_joints or name != "OPENING"]
            base.insert_before_end(step, Card("ENVELOPE", {}, [", ".join(fields)]))
    return base


def list_rungs(deck: Deck, refines_twice: bool = True) -> list[Rung]:
    """All rungs of a deck, the deck as it is first."""
    found = [Rung("base", BASE, 1.0, 1.0, as_it_is)]
    if deck.has("DYNAMIC"):
        found += [
            Rung("increment", f"increment x {factor:g}", 1.0 / factor, factor, scaled(factor))
            for factor in (2.0, 0.5, 0.25)
        ]
    found += element_rungs(deck)
    found.append(Rung("mesh", ONCE, 8.0**SLOWEST, 0.5, refine))
    found += tolerance_rungs(deck)
    if any(is_hht(card) for card in deck.of("DYNAMIC")):
        found += [alpha_rung(alpha) for alpha in (0.0, -0.1)]
    if deck.has("JOINT LAW"):
        found += [stiffness_rung(factor) for factor in (0.1, 10.0)]
    found += solver_rungs(deck)
    if refines_twice:
        found.append(Rung("mesh", TWICE, 64.0**SLOWEST, 0.25, refined_twice))
    return found


def refined_twice(deck: Deck) -> Deck:
    return refine(refine(deck))


def scaled(factor: float) -> Callable[[Deck], Deck]:
    """Increments of dynamic steps times a factor, with the smallest and the largest."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of("DYNAMIC"):
            items = fields_of(card.lines[0])
            for place in SIZES:
                if place < len(items) and items[place].strip():
                    items[place] = repr(number_of(items[place]) * factor)
            card.lines[0] = ", ".join(item.strip() for item in items)
        for card in new.of("STEP"):
            if "INC" in card.parameters and factor < 1.0:
                card.parameters["INC"] = str(int(int(card.parameters["INC"] or 1) / factor) + 1)
        return new

    return change


def shortened(deck: Deck, duration: float) -> Deck:
    """Dynamic steps that end after this time [s], where they are longer."""
    new = deck.copy()
    for card in new.of("DYNAMIC"):
        items = fields_of(card.lines[0])
        if len(items) > 1 and number_of(items[1]) > duration:
            items[1] = repr(duration)
        card.lines[0] = ", ".join(item.strip() for item in items)
    return new


def finer_rung(deck: Deck) -> Rung:
    """Finer than all rungs of the ladder: to check what the ladder promises."""
    factor = 64.0**SLOWEST

    def change(deck: Deck) -> Deck:
        return scaled(FINEST_INCREMENT)(refined_twice(deck))

    name = TWICE
    if deck.has("DYNAMIC"):
        name += f", increment x {FINEST_INCREMENT:g}"
        factor /= FINEST_INCREMENT
    return Rung("finer", name, factor, 0.25, change)


def is_hht(card: Card) -> bool:
    return "REDUCED" not in card.parameters and "SCHEME" not in card.parameters


def element_rungs(deck: Deck) -> list[Rung]:
    """The other kinds of bricks."""
    used = {card.value("TYPE") for card in deck.of("ELEMENT")} & set(BRICKS)
    if len(used) != 1:
        return []
    return [Rung("element", kind, 1.1, 1.0, element_kind(kind)) for kind in BRICKS
            if kind not in used]  # fmt: skip


def element_kind(kind: str) -> Callable[[Deck], Deck]:
    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of("ELEMENT"):
            if card.value("TYPE") in BRICKS:
                card.parameters["TYPE"] = kind
        return new

    return change


def element_check(kind: str) -> Rung:
    """Another kind of brick on the refined mesh: where it agrees by chance, this one does not."""
    change = element_kind(kind)
    name = f"{kind}, {ONCE}"
    return Rung(ELEMENT_CHECK, name, 8.0**SLOWEST, 0.5, lambda deck: refine(change(deck)))


def tolerance_rungs(deck: Deck) -> list[Rung]:
    """Tolerances of the iteration, where there is one."""
    if not any(deck.has(keyword) for keyword in (*JOINTS, *INELASTIC)):
        return []
    return [
        Rung(
            "tolerance", f"residual {value:g}", factor, value, controls({"RESIDUAL": f"{value:g}"})
        )
        for value, factor in ((1e-4, 0.8), (1e-8, 1.3))
    ]


def controls(changes: dict[str, str]) -> Callable[[Deck], Deck]:
    """Parameters of *CONTROLS in the first step, from which they hold."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for number, step in enumerate(new.steps()):
            found = [card for card in step if card.keyword == "CONTROLS"]
            for card in found:
                card.parameters.update(changes)
            if not found and number == 0:
                place = next(i for i, card in enumerate(new.cards) if card is step[1])
                new.cards.insert(place + 1, Card("CONTROLS", dict(changes)))
        return new

    return change


def alpha_rung(alpha: float) -> Rung:
    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of("DYNAMIC"):
            if is_hht(card):
                card.parameters["ALPHA"] = f"{alpha:g}"
        return new

    return Rung("alpha", f"ALPHA {alpha:g}", 1.0, 1.0, change)


def stiffness_rung(factor: float) -> Rung:
    """KN and KT of all joints times a factor; without KN the thickness that gives both."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of("JOINT LAW"):
            for name in ("KN", "KT"):
                if name in card.parameters:
                    card.parameters[name] = repr(number_of(card.parameters[name] or "0") * factor)
            if "KN" not in card.parameters:
                thickness = number_of(card.parameters.get("THICKNESS") or "0.02")
                card.parameters["THICKNESS"] = repr(thickness / factor)
        return new

    return Rung("stiffness", f"joint stiffness x {factor:g}", 1.0, 1.0, change)


def solver_rungs(deck: Deck) -> list[Rung]:
    """Solvers: they cost time, and may change the results within the tolerances only."""
    found = []
    is_elastic = not any(deck.has(keyword) for keyword in INELASTIC)
    if deck.has("DYNAMIC") and is_elastic:
        single = controls({"PRECISION": "SINGLE"})
        found.append(Rung("solver", "PRECISION=SINGLE", 1.0, 1.0, single))
    has_joints = any(deck.has(keyword) for keyword in JOINTS)
    if has_joints:
        found.append(
            Rung("solver", "JOINT SOLVER=FULL", FULL_COST, 1.0, controls({"JOINT SOLVER": "FULL"}))
        )
    if (
        deck.has("DYNAMIC")
        and has_joints
        and is_elastic
        and all(is_hht(card) for card in deck.of("DYNAMIC"))
    ):
        found.append(Rung("solver", "REDUCED", REDUCED_COST, 1.0, reduced))
    return found


def reduced(deck: Deck) -> Deck:
    """Dynamic steps with the reduced model and envelopes of openings: stresses take solves."""
    new = deck.copy()
    for step in new.steps():
        dynamic = [card for card in step if card.keyword == "DYNAMIC"]
        for card in dynamic:
            card.parameters["REDUCED"] = None
        for card in step:
            if dynamic and card.keyword == "ENVELOPE":
                card.lines = ["OPENING"]
    return new
