"""Petersson's notched beam: two published points, and the whole curve against a cohesive crack.

The points are those of code_aster's test SSNP166 with its tolerance, 5 %: 774 N at 0.365 mm and
598 N at 0.607 mm. The deflection is that of the notch's tip, which goes a little further than the
load.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from cohesive_beam import BeamCurve, cohesive_beam, piecewise
from concrete_decks import force_of
from keyway_tools.deck_petersson import (
    COMPRESSION,
    DEFLECTION,
    FRACTURE,
    STRENGTH,
    BeamMesh,
    bilinear_curve,
    concrete_cards,
    exponential_curve,
    petersson_deck,
)

COARSE = BeamMesh()
FINE = BeamMesh(column=0.01, ligament=20, below=10, arm=18, growth=1.2)
MESHES = pytest.mark.parametrize("mesh", [COARSE, FINE], ids=["coarse", "fine"])
PUBLISHED = ((0.365e-3, 774.0), (0.607e-3, 598.0))  # [m], [N]
LINEAR = np.array([(STRENGTH, 0.0, 0.0), (0.0, 2.0 * FRACTURE / STRENGTH, 0.0)])
CURVES = {"exponential": exponential_curve(), "bilinear": bilinear_curve(), "linear": LINEAR}


@cache
def reference(name: str) -> BeamCurve:
    """The cohesive beam with a curve."""
    return cohesive_beam(piecewise(CURVES[name]), DEFLECTION)


def cards_of(name: str, compression: float) -> str:
    """Cards of the concrete; linear softening by its fracture energy."""
    cards = concrete_cards(CURVES[name], compression=compression)
    if name != "linear":
        return cards
    rows = f"TYPE=DISPLACEMENT\n{STRENGTH:.6e}, 0.000000e+00\n"
    rows += f"0.000000e+00, {2.0 * FRACTURE / STRENGTH:.6e}\n"
    assert rows in cards
    return cards.replace(rows, f"TYPE=GFI\n{STRENGTH!r}, {FRACTURE!r}\n")


def beam_curve(
    keyway, name: str, mesh: BeamMesh, element: str, compression: float = COMPRESSION
) -> BeamCurve:
    """The program's beam with a curve."""
    run = keyway(petersson_deck(mesh, cards_of(name, compression), element))
    load_point, load = force_of(run, "LOADED", 3)
    table = run.csv("node_TIP")
    tip = table["U3"][table["node"] == table["node"][0]]
    return BeamCurve(-load_point, -tip, -load)


@MESHES
@pytest.mark.parametrize("element", ["C3D8", "C3D8R"])
def test_published_points(keyway, mesh, element):
    """Both points within 5 % on two meshes, with Petersson's bilinear softening."""
    beam = beam_curve(keyway, "bilinear", mesh, element)
    found = [beam.at_tip(deflection) for deflection, _ in PUBLISHED]
    for load, (_, expected) in zip(found, PUBLISHED, strict=True):
        assert load == pytest.approx(expected, rel=0.05)


@MESHES
@pytest.mark.parametrize("name", list(CURVES))
def test_cohesive_crack(keyway, name, mesh):
    """The whole curve within 3 % of the largest load of a cohesive crack with the same softening.

    With ten times the strength in compression: concrete in a crack between undamaged elements
    cracks in all directions at once; there the strength by Eq. 19 is higher, here by 10 % with 33
    MPa and by 1 % with 330 MPa (theory.md, 11.2). A crack band of bricks of 1 cm, a tenth of the
    ligament, stands for a line.
    """
    beam = beam_curve(keyway, name, mesh, "C3D8I", 10.0 * COMPRESSION)
    wanted = reference(name)
    apart = np.interp(beam.tip, wanted.tip, wanted.load) - beam.load
    worst = np.abs(apart).max() / wanted.load.max()
    assert worst < 0.03


@pytest.mark.parametrize("recovery", ["LEE-FENVES", pytest.param("SIGN", marks=pytest.mark.full)])
def test_crack_opens_and_closes(keyway, recovery):
    """Pressed, lifted until the crack closes, three times over: at most one cutback in a row; the
    largest load of each cycle is on the first curve.
    """
    path = (0.0, -0.45e-3, 0.1e-3, -0.6e-3, 0.1e-3, -0.8e-3)
    ramp = "".join(f"{float(t)}, {u!r}\n" for t, u in enumerate(path))
    cards = concrete_cards(exponential_curve())
    cards = cards.replace("PLASTICITY\n", f"PLASTICITY, RECOVERY={recovery}\n")
    deck = petersson_deck(COARSE, cards, "C3D8")
    for old, new in (
        ("*STEP, NAME=BENDING", f"*AMPLITUDE, NAME=WAYS\n{ramp}*STEP, NAME=BENDING"),
        ("0.01, 1., 1.e-6, 0.02", "0.02, 5., 1.e-6, 0.02"),
        (
            f"*BOUNDARY\nLOADED, 3, 3, {-DEFLECTION!r}",
            "*BOUNDARY, AMPLITUDE=WAYS\nLOADED, 3, 3, 1.",
        ),
    ):
        assert old in deck
        deck = deck.replace(old, new)
    run = keyway(deck, name="ways")
    place, load = force_of(run, "LOADED", 3)
    once = keyway(petersson_deck(COARSE, concrete_cards(exponential_curve()), "C3D8"), name="once")
    first_place, first_load = force_of(once, "LOADED", 3)
    envelope = np.interp(-place, -first_place, -first_load)
    step = run.json["steps"][0]
    assert step["cutbacks"] <= 1
    assert step["energy"]["error"] < 1e-3
    assert np.max(-load - envelope) < 0.01 * np.max(-first_load)
