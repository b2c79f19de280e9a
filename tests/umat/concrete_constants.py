"""The constants of a deck's concrete as umat_damage_plasticity.f90 wants them."""

from __future__ import annotations

import re

CARDS = ("TENSION STIFFENING", "TENSION DAMAGE", "COMPRESSION HARDENING", "COMPRESSION DAMAGE")
KINDS = {"STRAIN": 0, "DISPLACEMENT": 1, "GFI": 2}


def _card(deck: str, name: str) -> tuple[dict[str, str], list[list[float]]]:
    """Parameters and rows of a keyword."""
    found = re.search(rf"^\*{name} *(,[^\n]*)?\n((?:[^*\n][^\n]*\n|\*\*[^\n]*\n)*)", deck, re.M)
    if not found:
        return {}, []
    pairs = [p.split("=") for p in (found[1] or "").split(",") if "=" in p]
    lines = [line for line in found[2].splitlines() if not line.startswith("**")]
    rows = [[float(word) for word in line.split(",") if word.strip()] for line in lines]
    return {key.strip(): value.strip() for key, value in pairs}, rows


def constants_of(deck: str) -> list[float]:
    """The list PROPS for the first concrete material of a deck."""
    _, elastic = _card(deck, "ELASTIC")
    options, plastic = _card(deck, "CONCRETE DAMAGED PLASTICITY")
    psi, offset, ratio, meridian = plastic[0][:4]
    viscosity = plastic[0][4] if len(plastic[0]) > 4 else 0.0
    stiffening, _ = _card(deck, "CONCRETE TENSION STIFFENING")
    tension, _ = _card(deck, "CONCRETE TENSION DAMAGE")
    compression, _ = _card(deck, "CONCRETE COMPRESSION DAMAGE")
    tables = [_card(deck, f"CONCRETE {name}")[1] for name in CARDS]
    scalars = [
        *elastic[0], psi, offset, ratio, meridian, viscosity,
        float(options.get("RECOVERY") == "SIGN"),
        float(compression.get("TENSION RECOVERY", 0)),
        float(tension.get("COMPRESSION RECOVERY", 1)),
        KINDS[stiffening.get("TYPE", "STRAIN")], KINDS[tension.get("TYPE", "STRAIN")],
        float(stiffening.get("LONG ELEMENTS") == "LOWER STRENGTH"), 0.0,
        *(len(table) for table in tables),
    ]  # fmt: skip
    return scalars + [number for table in tables for row in table for number in row]


def as_user_material(deck: str) -> str:
    """The deck with the law of the program replaced by the UMAT's."""
    constants = constants_of(deck)
    lines = [
        ", ".join(repr(float(number)) for number in constants[i : i + 8])
        for i in range(0, len(constants), 8)
    ]
    card = f"*USER MATERIAL, CONSTANTS={len(constants)}, UNSYMM\n" + "\n".join(lines)
    cards = r"^\*(CONCRETE|ELASTIC)[^\n]*\n(?:[^*\n][^\n]*\n|\*\*[^\n]*\n)*"
    bare = re.sub(cards, "", deck, flags=re.M)
    return re.sub(
        r"^(\*MATERIAL, NAME=[^\n]*\n)", rf"\1{card}\n*DEPVAR\n17\n", bare, count=1, flags=re.M
    )
