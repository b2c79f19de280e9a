"""Curves of concrete by the program beside published ones: what is computed, and the pictures.

`tests/points/concrete_validation.py PROGRAM` draws docs/pictures/concrete_*.png and prints the
numbers of docs/concrete_validation.md; test_concrete_validation.py holds the same numbers.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path += [str(HERE), str(HERE.parent), str(HERE.parent.parent / "tools")]

import published  # noqa: E402
from concretes import JINPING, Material  # noqa: E402
from exponential_laws import ExponentialLaw  # noqa: E402
from harness import Program  # noqa: E402
from point_decks import Curve, PointDeck  # noqa: E402
from reference import closed_forms as exact  # noqa: E402
from reference.path import Leg  # noqa: E402

PICTURES = HERE.parent.parent / "docs" / "pictures"

# Lee & Fenves' concrete, as the plastic-damage test of the blackbear suite has it: G/l [J/m3].
LEE_FENVES = {"young": 31.7e9, "poisson": 0.18, "dilation": 31.0, "offset": 0.1}
TENSION = ExponentialLaw.falling(3.48e6, 0.70, 12.3e3, 0.51)
COMPRESSION = ExponentialLaw.with_peak(18.3e6, 27.6e6, 68.89e3, 0.25)
PLASTIC = np.concatenate([np.linspace(0.0, 1e-3, 101), np.linspace(1.1e-3, 1e-2, 90)])
STEPS = np.arange(1, 51) * 1e-4  # increments of that test

# Fitted by least squares to the envelope and to the residual strains of Karsan & Jirsa, E and the
# peak given: first strength 16.3 MPa, area 82.5 kJ/m3, damage 0.395 at the peak.
KARSAN_JIRSA = ExponentialLaw.with_peak(16.3e6, 27.6e6, 82.5e3, 0.395)
KARSAN_JIRSA_PEAK = 1.75e-3  # strain at the peak of the envelope
KARSAN_JIRSA_TURNS = (0.9e-3, 1.5e-3, 2.2e-3, 3.0e-3, 3.9e-3)  # unloading from these strains

# Fitted by least squares to the uniaxial points of Kupfer alone: E 33.2 GPa, first strength
# 20.7 MPa, area 146 kJ/m3; the peak is theirs, the damage at it Lee & Fenves'.
KUPFER = ExponentialLaw.with_peak(20.7e6, 32.02e6, 146e3, 0.25)

GOPALARATNAM_SHAH_OPENINGS = np.array([0.0, 2.5, 5.0, 10.0, 20.0, 30.0, 45.0, 70.0]) * 1e-6  # [m]
GOPALARATNAM_SHAH_LENGTHS = (0.025, 0.050)  # of two points with the same curve [m]
GOPALARATNAM_SHAH_PEAK = 3.48e6  # Lee & Fenves' f_t of this experiment [Pa]


def exponential_concrete(tables_of_tension, tables_of_compression, **constants) -> Material:
    """A concrete of two pairs of tables, strength and damage."""
    return Material(
        tension=tables_of_tension[0],
        tension_damage=tables_of_tension[1],
        compression=tables_of_compression[0],
        compression_damage=tables_of_compression[1],
        **constants,
    )


@cache
def lee_fenves() -> Material:
    """The exponential laws as they are."""
    young = LEE_FENVES["young"]
    return exponential_concrete(
        TENSION.tables(young, PLASTIC), COMPRESSION.tables(young, PLASTIC), **LEE_FENVES
    )


@cache
def lee_fenves_in_steps() -> Material:
    """The exponential laws as blackbear goes through them in increments of 1e-4."""
    young = LEE_FENVES["young"]
    return exponential_concrete(
        TENSION.stepped_tables(young, STEPS), COMPRESSION.stepped_tables(young, STEPS), **LEE_FENVES
    )


@cache
def karsan_jirsa() -> Material:
    young = LEE_FENVES["young"]
    return exponential_concrete(
        TENSION.tables(young, PLASTIC), KARSAN_JIRSA.tables(young, PLASTIC), **LEE_FENVES
    )


@cache
def kupfer() -> Material:
    constants = {**LEE_FENVES, "young": 33.2e9, "poisson": 0.2, "biaxial_ratio": 1.16}
    return exponential_concrete(
        TENSION.tables(33.2e9, PLASTIC), KUPFER.tables(33.2e9, PLASTIC), **constants
    )


@cache
def gopalaratnam_shah() -> Material:
    """Eight rows of their curve over the opening.

    Theirs is a curve of the stress alone. The damage is such that half of an opening closes on
    unloading in a band of 50 mm, d/(1 - d) sigma/E l = w/2: an assumption without a part in the
    comparison.
    """
    openings = GOPALARATNAM_SHAH_OPENINGS
    stress = GOPALARATNAM_SHAH_PEAK * published.gopalaratnam_shah(openings)
    closing = 0.5 * openings * LEE_FENVES["young"] / (stress * GOPALARATNAM_SHAH_LENGTHS[1])
    return Material(
        **LEE_FENVES,
        stiffening="DISPLACEMENT",
        tension=np.stack([stress, openings], axis=1),
        tension_damage=np.stack([closing / (1.0 + closing), openings], axis=1),
    )


def uniaxial(*ends: float) -> list[Leg]:
    return [Leg.of("ESSEEE", [end, 0.0, 0.0, 0.0, 0.0, 0.0]) for end in ends]


def unloading_path() -> list[Leg]:
    """Compression with unloading to no stress at five strains, then on to 5e-3.

    Unloaded by the strain that stays, for a falling stress would as well follow the falling branch.
    """
    strain, _ = exact.uniaxial_rows(karsan_jirsa().law(), karsan_jirsa().compression_curve)
    stays = np.interp(KARSAN_JIRSA_TURNS, strain, karsan_jirsa().compression_curve.plastic)
    ends = np.ravel(np.stack([KARSAN_JIRSA_TURNS, stays], axis=1))
    return uniaxial(*-ends, -5e-3)


def curves_of(program: Program) -> dict[str, Curve]:
    """All curves of the page."""
    deck = PointDeck()
    strain, _ = exact.uniaxial_rows(JINPING.law(), JINPING.tension_curve)
    deck.add("TABLE1", JINPING, uniaxial(2e-3), 400)
    turns = np.ravel(np.stack([strain, JINPING.tension_curve.plastic], axis=1)[[1, 2, 3, 4, 5]])
    deck.add("TABLE1CYCLES", JINPING, uniaxial(*turns, 2e-3), 50)
    for name, material in (("EXACT", lee_fenves()), ("STEPS", lee_fenves_in_steps())):
        deck.add(f"{name}T", material, uniaxial(5e-3), 500)
        deck.add(f"{name}C", material, uniaxial(-5e-3), 500)
    deck.add("KARSAN", karsan_jirsa(), unloading_path(), 100)
    deck.add("KARSANENVELOPE", karsan_jirsa(), uniaxial(-5e-3), 500)
    deck.add("KARSANLEEFENVES", lee_fenves(), uniaxial(-5e-3), 500)
    deck.add("KUPFER1", kupfer(), uniaxial(-5.2e-3), 500)
    for name, ratio in (("HALF", 0.52), ("EQUAL", 1.0)):
        deck.add_kind(f"KUPFER{name}", kupfer(), f"BIAXIAL, RATIO={ratio}", [-4e-3], 400)
    for percent in range(0, 101, 10):
        kind = f"BIAXIAL, RATIO={percent / 100.0!r}"
        deck.add_kind(f"RATIO{percent}", kupfer(), kind, [-4e-3], 400)
    for length in GOPALARATNAM_SHAH_LENGTHS:
        kind = f"UNIAXIAL, LENGTH={length!r}"
        name = f"GOPALARATNAM{round(1e3 * length)}"
        deck.add_kind(name, gopalaratnam_shah(), kind, [7e-5 / length], 2000)
    curves = deck.run(program)
    return {name: curves[name] for name in deck.names}


def at(curve: Curve, strain) -> np.ndarray:
    """Size of the axial stress at sizes of axial strain [Pa], along a path that does not turn."""
    return np.interp(strain, np.abs(curve.strain[:, 0]), np.abs(curve.stress[:, 0]))


def residuals(curve: Curve) -> np.ndarray:
    """Residual strains after unloading from each strain of KARSAN_JIRSA_TURNS."""
    return np.abs(curve.at_legs(curve.plastic[:, 0], 100))[1:-1:2]


def opening(curve: Curve, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Opening of the crack [m] and stress over the peak, from the peak on."""
    stress = curve.stress[:, 0]
    first = int(np.argmax(stress))
    inelastic = curve.strain[:, 0] - stress / LEE_FENVES["young"]
    return inelastic[first:] * length, stress[first:] / GOPALARATNAM_SHAH_PEAK


def biaxial_envelope(curves: dict[str, Curve]) -> np.ndarray:
    """Rows: ratio of stresses, the larger stress at failure over the uniaxial one."""
    peaks = [np.abs(curves[f"RATIO{p}"].stress[:, 0]).max() for p in range(0, 101, 10)]
    return np.stack([np.arange(0, 101, 10) / 100.0, np.array(peaks) / peaks[0]], axis=1)


def main() -> None:
    with TemporaryDirectory() as folder:
        curves = curves_of(Program(Path(sys.argv[1]).resolve(), Path(folder), 1))
    # Here, for it imports this module, which is another one when run as a script.
    from concrete_pictures import draw_all, print_numbers

    draw_all(curves, PICTURES)
    print_numbers(curves)


if __name__ == "__main__":
    main()
