"""Decks with *CONTACT PAIR: a block on a base of other mesh, and the same with *JOINT."""

from __future__ import annotations

from dataclasses import dataclass, field

from block_decks import Pair

PAIR = "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE, SMALL SLIDING"


@dataclass
class Contact(Pair):
    """The blocks of `Pair` with a contact pair in place of the joint."""

    counts: tuple[int, int, int] = (2, 2, 1)
    base_counts: tuple[int, int, int] = (3, 3, 1)
    contact: list[str] = field(default_factory=list)  # cards of the contact, in this order

    def deck(self, steps: str, supports: str = "") -> str:
        text = super().deck(steps, supports)
        start = text.index("*JOINT LAW")
        end = text.index("*BOUNDARY", start)
        return text[:start] + "".join(self.contact) + text[end:]


def law(behavior: str = "HARD", friction: str = "", stiffness: str = "") -> str:
    """*SURFACE INTERACTION, NAME=LAW, and the cards below it."""
    text = "*SURFACE INTERACTION, NAME=LAW\n"
    text += f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={behavior}\n"
    text += f"{stiffness}\n" if stiffness else ""
    return text + (f"*FRICTION\n{friction}\n" if friction else "")
