"""The dam, its mesh, its assumptions and the variants of its decks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import make_dam

from ..command import write_file
from .concrete import DAMAGE_AT_END, FRACTURE_ENERGY, STATIC_TIME, VISCOSITY, law_cards

FULL, SMALL = 100_000, 15_000  # unknowns, at least
# paper_notes.md, 15: 306.5 m, 563.77 m, at most 18.5 m and 66 m thick, which the thickening makes
# of 16 m and 57.081 m at the crown
SHAPE = (
    "--height 306.5 --crest-arc 563.77 --crest-thickness 16 --base-thickness 57.081 "
    "--abutment-thickening 1.15625 --arches parabolic --crest-angle 93 --base-radius-ratio 0.55 "
    "--bottom-width 60"
)
# Proportions alone: --unknowns scales the numbers of elements.
MESH = (
    "--arc 48 --levels 20 --bottom 6 --thick 3 --joints 6 --rock-upstream 4 --rock-downstream 4 "
    "--rock-deep 5"
)
UPPER_BLOCK = "--fine 4 --fine-above 0.55 --join auto-chain"
OUTLETS = (
    "--outlets 5 --outlet-width 7 --outlet-sill 220 --outlet-roof 236 --pier-length 18 "
    "--pier-top 258 --corbel-depth 18"
)
LOADS = (
    "--concrete 25e9 0.167 2400 --rock 18e9 0.24 --water 300 --interface-stiffness 25e9 "
    "--damping 0.05 1 5 --modes 4 --histories"
)
# Half of 0.002 s changes the largest openings by less than 1 % (docs/paper_study.md). Concrete with
# G_f cracks at once: increments are cut anyway.
INCREMENTS = {"fracture-energy": 0.01}
INCREMENT = 0.002  # of the dynamic step, all other laws [s]
# Of Table 1: the openings of the usual tolerances in less time (docs/paper_study.md)
CONTROLS = {"table1": "RESIDUAL=1.2e-5, INCREMENT=1.2e-5, PRECISION=MIXED"}
DURATION = 20.0  # of the motion of input/xingbiling [s]


@dataclass(frozen=True)
class JinpingDeck:
    """A variant of the deck."""

    law: str = "table1"
    recovery: str = "ENERGY"
    has_outlets: bool = True
    unknowns: int = FULL
    duration: float = DURATION
    increment: float | None = None  # [s]; None: that of the law
    options: tuple[str, ...] = ()  # further ones of tools/make_dam.py; the last of equal ones rules


def increment_of(law: str) -> float:
    """The increment of the dynamic step [s]."""
    return INCREMENTS.get(law, INCREMENT)


def deck_options(deck: JinpingDeck, path: Path, motion: Path) -> list[str]:
    """The command line of tools/make_dam.py; writes the cards of the law beside the deck."""
    options = ["-o", str(path), *SHAPE.split(), *MESH.split(), *LOADS.split()]
    if deck.has_outlets:
        options += [*UPPER_BLOCK.split(), *OUTLETS.split()]
    increment = deck.increment or increment_of(deck.law)
    options += ["--increment", f"{increment:g}", "--picture-every", str(round(1.0 / increment))]
    options += ["--unknowns", str(deck.unknowns), "--duration", f"{deck.duration:g}"]
    options += ["--motion", *(str(motion / f"motion_{axis}.txt") for axis in "xyz")]
    options += ["--title", title_of(deck)]
    for note in notes_of(deck):
        options += ["--note", note]
    if deck.law != "elastic":
        cards = path.with_name(f"{path.stem}_concrete.txt")
        write_file(cards, law_cards(deck.law, deck.recovery))
        options += ["--concrete-cards", str(cards)]
    if deck.law in CONTROLS:
        options += ["--controls", CONTROLS[deck.law]]
    if deck.law == "fracture-energy":
        options += ["--static-time", f"{STATIC_TIME:g}"]
    return [*options, *deck.options]


def write_deck(deck: JinpingDeck, path: Path, motion: Path) -> int:
    """Write the deck and its mesh; the exit code of tools/make_dam.py."""
    path.parent.mkdir(parents=True, exist_ok=True)
    code = make_dam.main(deck_options(deck, path, motion))
    path.with_name(f"{path.stem}_concrete.txt").unlink(missing_ok=True)
    return code


def title_of(deck: JinpingDeck) -> str:
    """The title, as in the deck."""
    title = "Jinping arch dam, 306.5 m"
    if not deck.has_outlets:
        title += ", without its outlets"
    words = {
        "table1": "concrete of Table 1",
        "fracture-energy": f"concrete with G_f = {FRACTURE_ENERGY:g} N/m",
        "elastic": "elastic concrete",
    }
    return f"{title}, {words[deck.law]}"


def notes_of(deck: JinpingDeck) -> list[str]:
    """Everything that the paper gives and all that is assumed, for the header."""
    notes = [
        "Shows: six contraction joints, cracking concrete"
        + (", outlets in a finer block between two joints" if deck.has_outlets else ""),
        "Source: the dam of section 4.2 of Xu, Chen, Li and Yue (2014) (paper_notes.md, 15): "
        "height, crest arc, largest thicknesses, six joints, water 300 m deep, E, nu, rho, q_on = "
        "0, friction 0.6, 0.269 g, diagonal Westergaard mass. Neither its geometry nor its record "
        "is published beyond this (paper_notes.md, 16)",
        "Shape (assumed): parabolic arches, the thickness between crest and base, the thickening "
        "to the abutments that makes 18.5 m and 66 m the largest thicknesses, the overhang of the "
        "crown, the V of the valley; so is the symmetry",
        "Motion (assumed): that of input/xingbiling: x and y 0.269 g, z 2/3 of it, 20 s",
        "Damping (assumed): 5 % at 1 and 5 Hz, between which the first modes are, Rayleigh on the "
        f"stiffness {'with its' if 'CURRENT' in deck.options else 'without'} damage",
        f"Increments of {deck.increment or increment_of(deck.law):g} s (assumed): the paper does "
        "not give its own",
        "Joint stiffness (paper_notes.md, 3): k_n = E / 2 cm = 1.25e12 Pa/m, "
        "k_t = k_n / (2 (1 + nu))",
    ]
    return notes + _law_notes(deck)


# Why this recovery, for the head of the deck.
REASONS = {
    "ENERGY": ": closing cracks create no energy then, and cracked concrete beside compression has "
    "no tension above f_t (docs/theory.md, 11.2)"
}


def _law_notes(deck: JinpingDeck) -> list[str]:
    """What is assumed of the concrete."""
    if deck.law == "elastic":
        return []
    notes = [
        "Concrete (paper_notes.md, 9 to 12): alpha 0.10 is f_b0/f_c0 = 1.125, gamma 3 is K_c = "
        "2/3, offset 0.01, dilation 32.5 deg, d_c = 0 as in the paper; a constant 30 MPa in "
        f"compression, w_c = 1 and RECOVERY={deck.recovery} are assumed"
        + REASONS.get(deck.recovery, "")
    ]
    if deck.law == "table1":
        notes += [
            "Table 1 (paper_notes.md, 13): a curve of stress over strain without a length, as "
            "printed. Its 767 J/m3 are 767 h N/m of a crack in elements of h metres: ten times "
            "what mass concrete has, in this mesh, and another value in another mesh"
        ]
    else:
        notes += [
            f"Fracture energy (assumed): {FRACTURE_ENERGY:g} N/m and f_t of Table 1, damage to "
            f"{DAMAGE_AT_END} where the crack is open. Elements longer than 2 E G_f / f_t^2 = 3.3 "
            "m get a lower strength, so that a crack has its energy (LONG ELEMENTS): in coarse "
            "meshes concrete cracks early",
            f"Viscosity (assumed): {VISCOSITY:g} s (docs/theory.md, 11.8), in a static step of "
            f"{STATIC_TIME:g} s. Without it the static step finds no equilibrium beyond a half of "
            "weight and water: a row of elements cracks at once",
        ]
    return notes
