"""The effects of a deck, switched off one at a time: what each changes and what it costs."""

from __future__ import annotations

from collections.abc import Callable

from .deck_cards import Card, Deck, number_of
from .rungs import Rung, as_it_is

CONCRETE = (
    "CONCRETE DAMAGED PLASTICITY", "CONCRETE COMPRESSION HARDENING", "CONCRETE TENSION STIFFENING",
    "CONCRETE COMPRESSION DAMAGE", "CONCRETE TENSION DAMAGE",
)  # fmt: skip
BONDED = "1e30"  # strength of a joint that never opens [Pa]
UPLIFT = ("UPLIFT", "PROFILE", "TAIL WATER")
# Parameters of a joint law that are effects of their own
LAW_EFFECTS = {
    "FRICTION": "friction in the joints",
    "COHESION": "cohesion of the joints",
    "TENSILE STRENGTH": "tensile strength of the joints",
    "GAP": "the gaps of the joints",
}
AXES = {"1": "x", "2": "y", "3": "z"}


def list_effects(deck: Deck) -> list[Rung]:
    """The deck as it is, and one variant without each of its effects."""
    found = [Rung("base", "all effects", 1.0, 1.0, as_it_is)]

    def add(name: str, is_there: bool, change: Callable[[Deck], Deck]) -> None:
        if is_there:
            found.append(Rung("effect", f"without {name}", 1.0, 1.0, change))

    laws, reservoirs = list(deck.of("JOINT LAW")), list(deck.of("RESERVOIR"))
    for dof in sorted({card.value("DOF") for card in deck.of("BASE MOTION")}):
        add(f"the motion along {AXES.get(dof, dof)}", True, without_motion(dof))
    add("the water", bool(reservoirs), without_water)
    has_mass = any(card.value("ADDED MASS") not in ("", "NONE") for card in reservoirs)
    add("the added mass of the water", has_mass, dropped("RESERVOIR", "ADDED MASS", "DIRECTION"))
    add("uplift in the joints", any(card.value("UPLIFT") for card in laws),
        dropped("JOINT LAW", *UPLIFT))  # fmt: skip
    add("opening and sliding of the joints", deck.has("JOINT"), bonded)
    for name, words in LAW_EFFECTS.items():
        add(words, any(is_positive(card, name) for card in laws), without_value(name))
    add("cracking of the concrete", deck.has(CONCRETE[0]), without_cards(CONCRETE))
    add("damping", deck.has("DAMPING"), without_cards(("DAMPING",)))
    weights = [card for card in deck.of("DLOAD") if any(is_weight(line) for line in card.lines)]
    add("weight", bool(weights), without_weight)
    return found


def is_positive(card: Card, name: str) -> bool:
    value = card.value(name)
    return bool(value) and number_of(value) > 0.0


def is_weight(line: str) -> bool:
    return len(line.split(",")) > 1 and line.split(",")[1].strip().upper() == "GRAV"


def without_cards(keywords: tuple[str, ...]) -> Callable[[Deck], Deck]:
    def change(deck: Deck) -> Deck:
        new = deck.copy()
        new.without(new.of(*keywords))
        return new

    return change


def without_motion(dof: str) -> Callable[[Deck], Deck]:
    def change(deck: Deck) -> Deck:
        new = deck.copy()
        new.without([card for card in new.of("BASE MOTION") if card.value("DOF") == dof])
        return new

    return change


def dropped(keyword: str, *names: str) -> Callable[[Deck], Deck]:
    """Without some parameters of a keyword."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of(keyword):
            for name in names:
                card.parameters.pop(name, None)
        return new

    return change


def bonded(deck: Deck) -> Deck:
    """Joints with a strength that nothing exceeds. A gap would be an error with it."""
    new = deck.copy()
    for card in new.of("JOINT LAW"):
        card.parameters["TENSILE STRENGTH"] = BONDED
        card.parameters.pop("GAP", None)
    return new


def without_value(name: str) -> Callable[[Deck], Deck]:
    """With a parameter of joint laws at zero."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        for card in new.of("JOINT LAW"):
            if name in card.parameters:
                card.parameters[name] = "0"
        return new

    return change


def without_water(deck: Deck) -> Deck:
    """Without reservoirs, and without the uplift that they feed."""
    new = dropped("JOINT LAW", *UPLIFT)(deck)
    new.without(list(new.of("RESERVOIR")))
    return new


def without_weight(deck: Deck) -> Deck:
    new = deck.copy()
    for card in new.of("DLOAD"):
        card.lines = [line for line in card.lines if not is_weight(line)]
    new.without([card for card in new.of("DLOAD") if not card.lines])
    return new


def change_in_words(effect: str, changes: dict[str, float], saved: float) -> str:
    """'Without damping the opening is 80 % larger; the run takes 3 % less time.'"""
    parts = [
        f"the {name} is {percent(change)} {'larger' if change > 0 else 'smaller'}"
        for name, change in changes.items() if abs(change) >= 5e-5
    ]  # fmt: skip
    what = ", ".join(parts) if parts else "nothing changes by more than 0.005 %"
    time = f"the run takes {abs(saved) * 100:.0f} % {'less' if saved > 0 else 'more'} time"
    return f"{effect[0].upper()}{effect[1:]} {what}; {time}."


def percent(change: float) -> str:
    """Two significant digits, all digits of whole numbers."""
    size = abs(change) * 100
    return f"{size:.0f} %" if size >= 10.0 else f"{size:.2g} %"
