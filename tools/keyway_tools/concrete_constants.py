"""The constants of a deck's concrete in the order of umat_damage_plasticity.f90."""

from __future__ import annotations

import sys
from pathlib import Path

from .command import EXIT_USAGE, command
from .deck_bytes import read_deck_text

TABLES = (
    "CONCRETE TENSION STIFFENING",
    "CONCRETE TENSION DAMAGE",
    "CONCRETE COMPRESSION HARDENING",
    "CONCRETE COMPRESSION DAMAGE",
)
SURFACE = (None, 0.1, 1.16, 2.0 / 3.0, 0.0)  # psi has no default
KINDS = {"STRAIN": 0, "DISPLACEMENT": 1, "GFI": 2}
RECOVERIES = ("LEE-FENVES", "SIGN", "ENERGY")
NUM_STATE = 17
A_LINE = 8  # constants


class Card:
    """A keyword with its lines as written in the deck."""

    def __init__(self, line: str):
        self.lines = [line]
        words = [word.strip() for word in line.lstrip("* ").upper().split(",")]
        self.name = " ".join(words[0].split())
        pairs = [word.partition("=")[::2] for word in words[1:]]
        self.options = {key.strip(): value.strip().strip('"') for key, value in pairs}

    @property
    def rows(self) -> list[list[str]]:
        """Words of the data lines."""
        data = [line for line in self.lines[1:] if line.strip() and not line.startswith("**")]
        return [[word.strip() for word in line.split(",")] for line in data]

    @property
    def numbers(self) -> list[list[float]]:
        return [[_number(word) for word in row if word] for row in self.rows]


def _number(word: str) -> float:
    return float(word.upper().replace("D", "E"))


def cards_of(deck: str) -> list[Card]:
    """Keywords in their order; text before the first keyword is left out."""
    cards: list[Card] = []
    for line in deck.removesuffix("\n").split("\n"):
        if line.lstrip().startswith("*") and not line.lstrip().startswith("**"):
            cards.append(Card(line))
        elif cards:
            cards[-1].lines.append(line)
    return cards


def is_of_concrete(card: Card) -> bool:
    return card.name == "ELASTIC" or card.name.startswith("CONCRETE ")


def constants_of(cards: list[Card]) -> list[float]:
    """PROPS of one material, from its cards."""
    found = {card.name: card for card in cards}
    none = Card("*NONE")
    stiffening, tension, hardening, crushing = (found.get(name, none) for name in TABLES)
    plastic = found["CONCRETE DAMAGED PLASTICITY"]
    given = [*plastic.rows[0], "", "", "", "", ""]
    surface = [
        _number(word) if word else default for word, default in zip(given, SURFACE, strict=False)
    ]
    scalars = [
        *found["ELASTIC"].numbers[0][:2],
        *surface,
        float(RECOVERIES.index(plastic.options.get("RECOVERY", "LEE-FENVES"))),
        float(crushing.options.get("TENSION RECOVERY", 0)),
        float(tension.options.get("COMPRESSION RECOVERY", 1)),
        KINDS[stiffening.options.get("TYPE", "STRAIN")],
        KINDS[tension.options.get("TYPE", "STRAIN")],
        float(stiffening.options.get("LONG ELEMENTS") == "LOWER STRENGTH"),
        0.0,
    ]
    tables = [card.numbers for card in (stiffening, tension, hardening, crushing)]
    counts = [float(len(table)) for table in tables]
    return [*scalars, *counts, *(number for table in tables for row in table for number in row)]


def user_cards(constants: list[float]) -> str:
    """*USER MATERIAL and *DEPVAR."""
    lines = [
        ", ".join(repr(float(number)) for number in constants[i : i + A_LINE])
        for i in range(0, len(constants), A_LINE)
    ]
    head = f"*USER MATERIAL, CONSTANTS={len(constants)}, UNSYMM"
    return "\n".join([head, *lines, "*DEPVAR", str(NUM_STATE), ""])


def materials_of(deck: str) -> dict[str, list[float]]:
    """PROPS of each concrete of a deck, by the name of the material."""
    own: dict[str, list[Card]] = {}
    name = ""
    for card in cards_of(deck):
        if card.name == "MATERIAL":
            name = card.options["NAME"]
        elif is_of_concrete(card):
            own.setdefault(name, []).append(card)
    return {
        name: constants_of(cards)
        for name, cards in own.items()
        if any(card.name == "CONCRETE DAMAGED PLASTICITY" for card in cards)
    }


def as_user_material(deck: str) -> str:
    """The deck with the law of the program replaced by the UMAT's."""
    constants = materials_of(deck)
    name = ""
    text = []
    for card in cards_of(deck):
        if card.name == "MATERIAL":
            name = card.options["NAME"]
        if card.name == "MATERIAL" and name in constants:
            text += [*card.lines, user_cards(constants[name]).rstrip("\n")]
        elif not (is_of_concrete(card) and name in constants):
            text += card.lines
    return "\n".join([*text, ""])


@command("make_umat")
def main() -> int:
    """Prints the cards of each concrete of a deck."""
    path = Path(sys.argv[1])
    found = materials_of(read_deck_text(path))
    if not found:
        what = "no *CONCRETE DAMAGED PLASTICITY (*INCLUDE is not followed)"
        print(f"make_umat: {path}: {what}", file=sys.stderr)
        return EXIT_USAGE
    for name, constants in found.items():
        print(f"*MATERIAL, NAME={name}\n{user_cards(constants)}", end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
