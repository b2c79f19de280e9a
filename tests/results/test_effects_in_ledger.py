"""A scene pays only for the effects that it has: effects are added to a scene one by one.

An effect that a deck lacks has no line in the ledger: its kind of work is never started.
`test_absent_effects.py` counts the instructions and the memory that its procedures take all the
same. The files that every run leaves (job.h5, job.pvd, tables) are no effects.
"""

from __future__ import annotations

import pytest

MESH = """*AMPLITUDE, NAME=RAMP
0., 0., 1., 1.
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 0., 0., 1.
12, 1., 0., 1.
13, 1., 1., 1.
14, 0., 1., 1.
15, 0., 0., 2.
16, 1., 0., 2.
17, 1., 1., 2.
18, 0., 1., 2.
*ELEMENT, TYPE=C3D8, ELSET=LOWER
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UPPER
2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=BASE
1, 2, 3, 4
*NSET, NSET=TOP
15, 16, 17, 18
*SURFACE, NAME=LOWER_TOP, TYPE=ELEMENT
1, S2
*SURFACE, NAME=UPPER_BASE, TYPE=ELEMENT
2, S1
*SURFACE, NAME=FACE, TYPE=ELEMENT
1, S6
2, S6
*MATERIAL, NAME=ROCK
*DENSITY
2400.
*ELASTIC
2.e10, 0.2
*SOLID SECTION, ELSET=LOWER, MATERIAL=ROCK
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
2.e10, 0.2
*SOLID SECTION, ELSET=UPPER, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 3
*TIE, NAME=SEAM
UPPER_BASE, LOWER_TOP
*STEP, NAME=ONLY, INC=100
*DYNAMIC, DIRECT
0.01, 0.05
*END STEP
"""
CURVES = """*CONCRETE DAMAGED PLASTICITY
36., 0.1, 1.16, 0.6667
*CONCRETE COMPRESSION HARDENING
20.e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
2.5e6, 200.
"""
MOTION = "*DYNAMIC, DIRECT\n0.01, 0.05\n"
TIE = "*TIE, NAME=SEAM\nUPPER_BASE, LOWER_TOP\n"
SECTION = "*SOLID SECTION, ELSET=UPPER"
JOINT = (
    "*JOINT LAW, NAME=DRY, KN=1.e10, KT=1.e10, FRICTION=0.6\n"
    "*JOINT, NAME=JOINT, LAW=DRY\nUPPER_BASE, LOWER_TOP\n"
)
WEIGHT = "*DLOAD\n, GRAV, 9.81, 0., 0., -1.\n"
LAKE = "*RESERVOIR, NAME=LAKE, SURFACE=FACE, LEVEL=2., BED=0.\n"
AT_REST = "*STATIC\n1., 1.\n" + WEIGHT

# Effects by the name of their part, in the order in which a scene in motion gets them: what they
# replace, and by what.
IN_MOTION = {
    "gravity ALL SOLIDS": (MOTION, MOTION + WEIGHT),
    "pressure 2 P2": (MOTION, MOTION + "*DLOAD\n2, P2, 1.e4\n"),
    "point forces": (MOTION, MOTION + "*CLOAD\nTOP, 1, 1.e3\n"),
    "reservoir LAKE": (MOTION, MOTION + LAKE),
    "damping": (MOTION, MOTION + "*DAMPING, RATIO=0.05, F1=2., F2=10.\n"),
    "modes": (MOTION, MOTION + "*DAMPING, MODAL, RATIO=0.05, MODES=2\n"),
    "base motion 1": (MOTION, MOTION + "*BASE MOTION, DOF=1, AMPLITUDE=RAMP\n"),
    "envelopes": (MOTION, MOTION + "*ENVELOPE\nS1, U\n"),
    "checkpoint": (MOTION, MOTION + "*RESTART, WRITE, FREQUENCY=2\n"),
    "temperature": (MOTION, MOTION + "*TEMPERATURE\nTOP, 5.\n"),
    "CONCRETE": (SECTION, CURVES + SECTION),
    "JOINT": (TIE, JOINT),
}
# Further effects, each added to the scene at rest or in motion alone.
ALONE = {
    "SEAM": {TIE: "*TIE, NAME=SEAM, STIFFNESS=1.e12\nUPPER_BASE, LOWER_TOP\n"},
    "pressure FACE": {MOTION: AT_REST + "*DSLOAD\nFACE, P, 1.e3\n"},
    "stages": {MOTION: AT_REST + "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nUPPER\n"},
    "water of LAKE in joint JOINT (LINEAR)": {
        TIE: JOINT.replace("FRICTION", "UPLIFT=LAKE, FRICTION"), MOTION: AT_REST + LAKE,
    },
    "modes": {MOTION: "*FREQUENCY\n2\n"},
    "CONCRETE": {SECTION: "*PLASTIC\n1.e6, 0.\n" + SECTION, MOTION: AT_REST},
    "reduced model": {TIE: JOINT, MOTION: MOTION.replace("DIRECT", "DIRECT, REDUCED") + WEIGHT},
    "increments": {MOTION: MOTION.replace(", DIRECT", "") + "*CONTROLS, ACCURACY=0.02\n" + WEIGHT},
}  # fmt: skip


def parts_of(run) -> dict[str, dict]:
    return {part["name"]: part for part in run.json["ledger"]["parts"]}


def named(parts: dict[str, dict], effect: str) -> list[str]:
    """Parts with the name of an effect, or of its kind."""
    return [name for name, part in parts.items() if effect in (part["kind"], part["effect"])]


def changed(deck: str, changes: dict[str, str]) -> str:
    """The deck with some texts in place of others."""
    for old, new in changes.items():
        assert deck.count(old) == 1
        deck = deck.replace(old, new)
    return deck


def expanding(deck: str) -> str:
    """The deck with solids that expand, which costs nothing without temperatures."""
    return deck.replace("0.2\n", "0.2\n*EXPANSION\n1.e-5\n")


def test_effects_have_no_part_before_they_are_added(keyway):
    deck = expanding(MESH)
    before = parts_of(keyway(deck, name="scene_0"))
    for number, (name, (old, new)) in enumerate(IN_MOTION.items(), start=1):
        assert not named(before, name), f"{name} has a part without being there"
        deck = changed(deck, {old: new})
        after = parts_of(keyway(deck, name=f"scene_{number}"))
        assert named(after, name), f"{name} has no part"
        before = after


@pytest.mark.parametrize("name", ALONE)
def test_an_effect_alone_brings_its_part(keyway, name):
    changes = ALONE[name]
    at_rest = {MOTION: AT_REST} if AT_REST in changes.get(MOTION, "") else {}
    assert not named(parts_of(keyway(changed(MESH, at_rest), name="without")), name)
    assert named(parts_of(keyway(changed(MESH, changes), name="with")), name)


def test_estimates_that_are_off_have_no_part(keyway):
    """Neither those of the mesh, nor those of the increments in the law."""
    deck = changed(MESH, {SECTION: CURVES + SECTION, MOTION: MOTION + "*CONTROLS\n" + WEIGHT})
    off = deck.replace("*CONTROLS", "*CONTROLS, ERROR ESTIMATE=OFF")
    found = [
        {name for name in parts_of(keyway(text, name=job)) if name.startswith("estimate")}
        for job, text in (("on", deck), ("off", off))
    ]
    assert found == [{"estimate mesh", "estimate law"}, set()]


def test_the_plain_scene_has_the_structure_alone(keyway):
    """Without effects: files, one matrix, one factor, one solve an increment; the tie."""
    parts = parts_of(keyway(MESH, name="plain"))
    assert {part["kind"] for part in parts.values()} <= {"deck", "output", "run", "solver"}
    calls = {name: part["calls"] for name, part in parts.items()}
    assert calls["factor structure"] == 1
    assert calls["solve structure"] <= 6  # five increments and the start
