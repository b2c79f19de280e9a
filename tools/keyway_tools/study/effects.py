"""The effects of a deck, switched off one at a time: what each changes and what it costs."""

from __future__ import annotations

from collections.abc import Callable

from .deck_cards import Card, Deck, fields_of, number_of
from .mesh_sets import support_of
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
# Effects that are cards of their own
CARDS = {
    CONCRETE: "cracking of the concrete",
    ("PLASTIC",): "yielding of the metal",
    ("FRICTION",): "friction of the contact",
    ("DAMPING",): "damping",
    ("TEMPERATURE",): "changes of temperature",
    ("MODEL CHANGE",): "construction in stages",
    ("GROUT",): "grouting of the joints",
    ("CLOAD",): "the point forces",
}
AXES = {"1": "x", "2": "y", "3": "z"}


def list_effects(deck: Deck) -> list[Rung]:
    """The deck as it is, and one variant without each of its effects."""
    found = [Rung("base", "all effects", 1.0, 1.0, as_it_is)]

    def add(name: str, is_there: bool, change: Callable[[Deck], Deck]) -> None:
        if is_there:
            found.append(Rung("effect", f"without {name}", 1.0, 1.0, change))

    laws, reservoirs = list(deck.of("JOINT LAW")), list(deck.of("RESERVOIR"))
    for dof in sorted(AXES):
        add(f"the motion along {AXES[dof]}", is_moved(deck, dof), without_motion(dof))
    add("the water", bool(reservoirs), without_water)
    has_mass = any(card.value("ADDED MASS") not in ("", "NONE") for card in reservoirs)
    add("the added mass of the water", has_mass, dropped("RESERVOIR", "ADDED MASS", "DIRECTION"))
    add("uplift in the joints", any(card.value("UPLIFT") for card in laws),
        dropped("JOINT LAW", *UPLIFT))  # fmt: skip
    add("opening and sliding of the joints", deck.has("JOINT"), bonded)
    for name, words in LAW_EFFECTS.items():
        add(words, any(is_positive(card, name) for card in laws), without_value(name))
    for keywords, words in CARDS.items():
        add(words, any(True for _ in deck.of(*keywords)), without_cards(keywords))
    lines = [line for card in deck.of("DLOAD") for line in card.lines]
    add("weight", any(map(is_weight, lines)), without_weight)
    add("the pressures on faces", deck.has("DSLOAD") or any(map(is_pressure, lines)),
        without_pressures)  # fmt: skip
    return found


def is_positive(card: Card, name: str) -> bool:
    value = card.value(name)
    return bool(value) and number_of(value) > 0.0


def label_of(line: str) -> str:
    """What a line of *DLOAD does: GRAV, P3, HP6, .."""
    return [*fields_of(line), ""][1].strip().upper()


def is_weight(line: str) -> bool:
    return label_of(line) == "GRAV"


def is_pressure(line: str) -> bool:
    return label_of(line).removeprefix("H").startswith("P")


def without_cards(keywords: tuple[str, ...]) -> Callable[[Deck], Deck]:
    def change(deck: Deck) -> Deck:
        new = deck.copy()
        new.without(new.of(*keywords))
        return new

    return change


def accelerated(deck: Deck) -> list[Card]:
    """Supports whose acceleration is the motion of the base."""
    return [card for card in deck.of("BOUNDARY") if card.value("TYPE") == "ACCELERATION"]


def is_moved(deck: Deck, dof: str) -> bool:
    lines = [line for card in accelerated(deck) for line in card.lines]
    return any(card.value("DOF") == dof for card in deck.of("BASE MOTION")) or any(
        int(dof) in support_of(line)[1] for line in lines
    )


def without_motion(dof: str) -> Callable[[Deck], Deck]:
    """Without base motions along an axis; supports that were accelerated are held."""

    def change(deck: Deck) -> Deck:
        new = deck.copy()
        new.without([card for card in new.of("BASE MOTION") if card.value("DOF") == dof])
        for card in accelerated(new):
            held = [line for line in card.lines if int(dof) in support_of(line)[1]]
            lines = [line for line in card.lines if line not in held]
            for line in held:
                label, _, _, value = [*fields_of(line), "", "", ""][:4]
                lines += [f"{label}, {k}, {k}, {value}" for k in support_of(line)[1]
                          if k != int(dof)]  # fmt: skip
            kept = {name: text for name, text in card.parameters.items() if name == "OP"}
            still = Card("BOUNDARY", kept, [f"{fields_of(line)[0]}, {dof}, {dof}" for line in held])
            place = next(i for i, other in enumerate(new.cards) if other is card)
            card.lines = lines
            new.cards[place : place + 1] = [c for c in (still, card) if c.lines]
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
    """Joints with a strength that nothing exceeds. A gap would be an error with it. Joints that are
    grouted in a step would open before, as contact: without *GROUT they are bonded from the start.
    """
    new = deck.copy()
    new.without(list(new.of("GROUT")))
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
    return without_loads(deck, is_weight)


def without_pressures(deck: Deck) -> Deck:
    new = without_loads(deck, is_pressure)
    new.without(list(new.of("DSLOAD")))
    return new


def without_loads(deck: Deck, is_unwanted: Callable[[str], bool]) -> Deck:
    """Without some lines of *DLOAD, and without cards that have no line left."""
    new = deck.copy()
    for card in new.of("DLOAD"):
        had_lines = bool(card.lines)
        card.lines = [line for line in card.lines if not is_unwanted(line)]
        if had_lines and not card.lines:
            new.without([card])
    return new


def change_in_words(effect: str, changes: dict[str, float], saved: float) -> str:
    """'Without damping the opening is 80 % larger; the run takes 3 % less time.'"""
    parts = [
        f"the {name} is {size_in_words(change)}"
        for name, change in changes.items()
        if abs(change) >= 5e-5
    ]
    what = ", ".join(parts) if parts else "nothing changes by more than 0.005 %"
    time = f"the run takes {abs(saved) * 100:.0f} % {'less' if saved > 0 else 'more'} time"
    return f"{effect[0].upper()}{effect[1:]} {what}; {time}."


def size_in_words(change: float) -> str:
    """'12 % smaller', '80 % larger', '4.6 times as large'."""
    if change >= 1.0:
        return f"{1.0 + change:.3g} times as large"
    return f"{percent(change)} {'larger' if change > 0 else 'smaller'}"


def percent(change: float) -> str:
    """Two significant digits, all digits of whole numbers."""
    size = abs(change) * 100
    return f"{size:.0f} %" if size >= 10.0 else f"{size:.2g} %"
