"""Decks that are built in stages: columns of lifts, and two blocks with a joint."""

from __future__ import annotations

from tied_blocks import Blocks, node_set, ties

YOUNG, DENSITY, GRAVITY = 20e9, 2400.0, 10.0  # [Pa], [kg/m3], [m/s2]
WEIGHT = DENSITY * GRAVITY  # of a cubic metre [N]
STONE = f"*DENSITY\n{DENSITY!r}\n*ELASTIC\n{YOUNG!r}, 0.\n"
LOAD = f"*DLOAD\nBODY, GRAV, {GRAVITY!r}, 0, 0, -1\n"
OUTPUT = "*NODE PRINT, NSET=EVERY\nU\n*EL PRINT, ELSET=BODY\nS, E\n"


def lifts(number: int, law: str = STONE, tied: bool = False, element: str = "C3D8") -> str:
    """Model of a column of lifts of 1 m, L1 at the bottom; tied lifts have meshes that differ."""
    blocks = Blocks()
    for i in range(1, number + 1):
        n = 2 if tied and i % 2 == 0 else 1
        blocks.add(f"L{i}", (n, 0, 1), (n, 0, 1), (1, i - 1, i))
        if i > 1 and not tied:
            blocks.share(f"L{i - 1}", f"L{i}")
    cards = node_set("EVERY", range(len(blocks.x))) + node_set("BASE", blocks.side("L1", "Z0"))
    if tied:
        cards += ties(*[(f"L{i + 1}_Z0", f"L{i}_Z1") for i in range(1, number)])
    deck = blocks.deck({"": law}, cards + "*BOUNDARY\nBASE, 1, 3\n")
    return deck.replace("TYPE=C3D8", f"TYPE={element}")


def remove(*sets: str) -> str:
    """Elements that leave."""
    return f"*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n{', '.join(sets)}\n"


def add(*sets: str) -> str:
    """Elements that appear without stress."""
    return f"*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE\n{', '.join(sets)}\n"


def step(cards: str = "", name: str = "STAGE", data: str = "") -> str:
    """A static step."""
    return f"*STEP, NAME={name}\n*STATIC\n{data}{cards}*END STEP\n"


def build(number: int) -> str:
    """Steps that build a column lift by lift under its weight."""
    later = [f"L{i}" for i in range(2, number + 1)]
    first = step(remove(*later) + LOAD + OUTPUT)
    return first + "".join(step(add(lift)) for lift in later)
