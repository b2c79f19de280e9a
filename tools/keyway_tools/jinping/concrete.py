"""Laws of the concrete of the Jinping dam as cards that follow *ELASTIC."""

from __future__ import annotations

# Table 1 of the paper: tensile strength [MPa], inelastic strain [1e-3], tensile damage.
TABLE_1 = (
    (2.480, 0.000, 0.000),
    (0.858, 0.175, 0.359),
    (0.545, 0.324, 0.620),
    (0.415, 0.469, 0.756),
    (0.294, 0.757, 0.876),
    (0.234, 1.044, 0.924),
    (0.198, 1.330, 0.949),
    (0.169, 1.664, 0.964),
)
FRACTURE_ENERGY = 400.0  # G_f [N/m]: mass concrete (assumed)
VISCOSITY = 0.001  # [s] with the fracture energy; cracks in large elements are brittle
STATIC_TIME = 0.1  # [s] of the static step then, in which the viscosity smooths the jumps of cracks
DAMAGE_AT_END = 0.964  # of the last row of Table 1, where the crack carries nothing any more
LAWS = ("table1", "fracture-energy", "elastic")
RECOVERIES = ("LEE-FENVES", "SIGN", "ENERGY")


def law_cards(law: str, recovery: str) -> str:
    """Cards of a law; none for linear elastic concrete. Raises ValueError for an unknown name."""
    if law not in LAWS or recovery not in RECOVERIES:
        raise ValueError(
            f"expected a law of {', '.join(LAWS)} and a recovery of {', '.join(RECOVERIES)}, "
            f"found '{law}' and '{recovery}'"
        )
    if law == "elastic":
        return ""
    viscosity = f", {VISCOSITY:g}" if law == "fracture-energy" else ""
    cards = [
        f"*CONCRETE DAMAGED PLASTICITY, RECOVERY={recovery}",
        f"32.5, 0.01, 1.125, 0.6666666666666667{viscosity}",
        "*CONCRETE COMPRESSION HARDENING",
        "30e6, 0.",
    ]
    return "\n".join([*cards, *(_table() if law == "table1" else _fracture_energy())]) + "\n"


def _table() -> list[str]:
    """Strength and damage over inelastic strain, as printed."""
    cards = ["*CONCRETE TENSION STIFFENING, TYPE=STRAIN"]
    cards += [f"{strength:.3f}e6, {strain:.3f}e-3" for strength, strain, _ in TABLE_1]
    cards += ["*CONCRETE TENSION DAMAGE, TYPE=STRAIN, COMPRESSION RECOVERY=1."]
    return cards + [f"{damage:.3f}, {strain:.3f}e-3" for _, strain, damage in TABLE_1]


def _fracture_energy() -> list[str]:
    """The same strength with an energy of the crack that no mesh changes."""
    strength = 1e6 * TABLE_1[0][0]
    opened = 2.0 * FRACTURE_ENERGY / strength
    return [
        "*CONCRETE TENSION STIFFENING, TYPE=GFI, LONG ELEMENTS=LOWER STRENGTH",
        f"{strength:g}, {FRACTURE_ENERGY:g}",
        "*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT, COMPRESSION RECOVERY=1.",
        "0., 0.",
        f"{DAMAGE_AT_END}, {opened:.6g}",
    ]
