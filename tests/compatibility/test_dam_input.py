"""Input for dams as Abaqus/CAE writes it: equal to own keywords, right by statics."""

import numpy as np
from flat_twin import Block, element_lines, id_lines, last_field, node_lines

BLOCK = Block((2, 2, 4), (3.0, 5.0, 8.0))
WATER, GRAVITY, LEVEL = 1000.0, 9.81, 7.0
UPSTREAM = [e + 1 for e in range(len(BLOCK.solids)) if e % 2 == 0]
MODEL = f"""\
*NODE
{node_lines(BLOCK.nodes)}
*ELEMENT, TYPE=C3D8I, ELSET=DAM
{element_lines(BLOCK.solids)}
*ELSET, ELSET=UP
{id_lines(UPSTREAM)}
*SURFACE, NAME=UPSTREAM
UP, S6
*NSET, NSET=BASE
{id_lines(BLOCK.nodes_at(2, 0.0))}
*NSET, NSET=TOP
{id_lines(BLOCK.nodes_at(2, 8.0))}
*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.,
*ELASTIC
2e10, 0.2
*AMPLITUDE, NAME=QUAKE, DEFINITION=TABULAR
0., 0., 0.1, 1., 0.25, -2., 0.4, 0.
*BOUNDARY
BASE, 1, 3
"""


def test_hydrostatic_pressure_on_a_surface(keyway):
    pressure = WATER * GRAVITY * LEVEL
    step = "*STEP\n*STATIC\n{}*NODE FILE\nU, RF\n*END STEP\n"
    of_surface = keyway(
        MODEL + step.format(f"*DSLOAD\nUPSTREAM, HP, {pressure}, {LEVEL}, 0.\n"), name="surface"
    )
    of_faces = keyway(
        MODEL + step.format(f"*DLOAD\nUP, HP6, {pressure}, {LEVEL}, 0.\n"), name="faces"
    )
    assert np.array_equal(last_field(of_surface, "U"), last_field(of_faces, "U"))
    thrust = 0.5 * WATER * GRAVITY * LEVEL**2 * BLOCK.size[1]
    force = last_field(of_surface, "RF").sum(axis=0)
    # Statics: rho g h^2 b/2; the pressure is integrated exactly up to the water level.
    assert np.allclose(force, [-thrust, 0, 0], rtol=1e-9, atol=1e-9 * thrust)


def test_acceleration_of_all_supports_is_base_motion(keyway):
    step = "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.5\n{}*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    own = keyway(MODEL + step.format("*BASE MOTION, DOF=1, AMPLITUDE=QUAKE, SCALE=2.5\n"), name="o")
    motion = "*BOUNDARY, TYPE=ACCELERATION, AMPLITUDE=QUAKE\nBASE, 1, 1, 2.5\n"
    cae = keyway(MODEL + step.format(motion), name="c")
    a, b = own.csv("node_TOP"), cae.csv("node_TOP")
    assert np.abs(a["U1"]).max() > 0
    assert all(np.array_equal(a[name], b[name]) for name in ("U1", "U2", "U3"))


def test_one_temperature_changes_nothing(keyway):
    concrete = """\
*CONCRETE DAMAGED PLASTICITY
36., 0.1, 1.16, 0.667, 0.{at6}
*CONCRETE COMPRESSION HARDENING
2e7, 0.{at4}
3e7, 1e-3{at4}
*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT
2e5, 0.{at4}
2e3, 2e-4{at4}
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT, COMPRESSION RECOVERY=1.
0., 0.{at3}
0.9, 2e-4{at3}
"""
    step = "*STEP\n*STATIC\n0.1, 1.\n*DSLOAD\nUPSTREAM, HP, 6e4, 7., 0.\n*NODE FILE\nU\n*END STEP\n"
    fields = []
    for name, words in (
        ("plain", {"at3": "", "at4": "", "at6": ""}),
        ("warm", {"at3": ", 20.", "at4": ", , 20.", "at6": ", 20."}),
    ):
        text = MODEL.replace("*AMPLITUDE", concrete.format(**words) + "*AMPLITUDE")
        fields.append(last_field(keyway(text + step, name=name), "U"))
    assert np.array_equal(*fields)


def test_a_record_that_is_equally_spaced(keyway):
    """Values every 0.05 s from 0.1 s on are the pairs of the same numbers."""
    values = [0.3, -1.2, 2.0, 0.7, -0.4, 0.0]
    pairs = ", ".join(f"{0.1 + 0.05 * k}, {v}" for k, v in enumerate(values))
    spaced = "DEFINITION=EQUALLY SPACED, FIXED INTERVAL=0.05, BEGIN=0.1\n"
    spaced += ", ".join(map(str, values[:4])) + "\n" + ", ".join(map(str, values[4:]))
    quake = "DEFINITION=TABULAR\n0., 0., 0.1, 1., 0.25, -2., 0.4, 0."
    step = "*STEP\n*DYNAMIC, DIRECT, INITIAL=NO, APPLICATION=TRANSIENT FIDELITY\n0.01, 0.5\n"
    step += "*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    one, other = (
        keyway(MODEL.replace(quake, new) + step, name=name).csv("node_TOP")["U1"]
        for name, new in (("pairs", "DEFINITION=TABULAR\n" + pairs), ("spaced", spaced))
    )
    assert np.abs(one).max() > 0
    assert np.allclose(one, other, rtol=0, atol=1e-12 * np.abs(one).max())  # round-off of times


def test_reference_length_of_concrete_is_noted(keyway):
    """Abaqus converts openings of the damage with it, Keyway with the length of the element."""
    concrete = """\
*CONCRETE DAMAGED PLASTICITY{}
36., 0.1, 1.16, 0.667, 0.
*CONCRETE COMPRESSION HARDENING
2e7, 0.
3e7, 1e-3
*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT
2e5, 0.
2e3, 2e-4
"""
    step = "*STEP\n*STATIC\n0.1, 1.\n*DSLOAD\nUPSTREAM, HP, 6e4, 7., 0.\n*NODE FILE\nU\n*END STEP\n"
    plain, noted = (
        keyway(MODEL.replace("*AMPLITUDE", concrete.format(words) + "*AMPLITUDE") + step, name=name)
        for name, words in (("plain", ""), ("noted", ", REF LENGTH=0.2"))
    )
    assert np.array_equal(last_field(plain, "U"), last_field(noted, "U"))
    assert [note["why"] for note in noted.json["ignored_input"]] == [
        "REF LENGTH has no effect: the length of each element turns an opening into a strain, "
        "also for the damage"
    ]
