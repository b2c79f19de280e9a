"""Hard cases of solids and steps: slender, thin and incompressible bodies, units, procedures."""

from __future__ import annotations

import math

import numpy as np
from brick_decks import brick_deck, elastic
from hard_case import Chapter, Recorder, off, unbalance
from joint_decks import GRAVITY, amplitude, material, static
from keyway_tools.box_mesh import box_mesh, stretched
from test_thick_cylinder import share_at_the_bore
from uplift_decks import Section, lake, weight

SOLIDS = Chapter("Solids, steps and units")
YOUNG, DENSITY = 25e9, 2400.0
ROUGH = "KN=1e10, KT=1e10, FRICTION=0.8"


def cantilever(size, counts, poisson: float, cards: str, element: str = "C3D8I") -> str:
    """A bar along x, fixed at x = 0; set TIP."""
    mesh, number = box_mesh(counts, stretched(size))
    mesh.node_sets |= {"BASE": number[0].ravel(), "TIP": number[-1].ravel()}
    law = elastic(YOUNG, poisson, DENSITY)
    return brick_deck(mesh, element, law + "*BOUNDARY\nBASE, 1, 3\n" + cards)


def tip_bending(keyway, size, counts, poisson: float, name: str):
    """Tip deflection under a force of 1 N on each of its nodes, over that of Timoshenko's beam."""
    step = static("*CLOAD\nTIP, 3, 1.\n*NODE PRINT, NSET=TIP\nU\n")
    run = keyway(cantilever(size, counts, poisson, step), name=name)
    length, width, height = size
    nodes = (counts[1] + 1) * (counts[2] + 1)
    bend = length**3 / (3.0 * YOUNG * width * height**3 / 12.0)
    shear = 1.2 * length / (YOUNG / 2.0 / (1.0 + poisson) * width * height)
    return abs(run.csv("node_TIP")["U3"].mean() / (nodes * (bend + shear)) - 1.0), run


@SOLIDS.case(
    "aspect 1:100",
    "bricks of 10 x 1 x 0.1 m in a plate 100 m long, C3D8I",
    "error of the tip deflection against the beam",
    1e-2,
)
def aspect(keyway):
    value, run = tip_bending(keyway, (100.0, 1.0, 0.1), (10, 1, 1), 0.0, "aspect")
    return value, [run]


@SOLIDS.case(
    "nu 0.4999",
    "a thick cylinder under pressure that keeps its volume, C3D8I (MacNeal & Harder 1985)",
    "error of the displacement of the bore against Lame; straight sides alone leave 1 %",
    2e-2,
)
def incompressible(keyway):
    record = Recorder(keyway)
    return abs(share_at_the_bore(record, "C3D8I", 0.4999) - 1.0), record.runs


def first_frequency(keyway, size, counts, name: str):
    step = "*STEP\n*FREQUENCY\n2\n*END STEP\n"
    run = keyway(cantilever(size, counts, 0.0, step), name=name)
    root = 1.875104068711961  # of cos x cosh x = -1
    speed = math.sqrt(YOUNG / 12.0 / DENSITY)
    exact = root**2 / (2.0 * math.pi) * size[2] * speed / size[0] ** 2
    return off([run.json["steps"][0]["frequencies"][0]["hz"]], [exact]), run


@SOLIDS.case(
    "cantilever 200:1 and plate 300 x 30 x 1",
    "round-off of the forces of elements exceeds 1e-6 of those of the mode",
    "error of the first frequency against Euler and Bernoulli",
    1e-3,
)
def slender_modes(keyway):
    beam, first = first_frequency(keyway, (200.0, 1.0, 1.0), (100, 1, 1), "beam")
    plate, second = first_frequency(keyway, (300.0, 30.0, 1.0), (60, 6, 1), "plate")
    return max(beam, plate), [first, second]


def shaken_section(length: float, mass: float) -> str:
    """A slice of a dam on its joint with water and a motion, 1 m as `length` and 1 kg as `mass`."""
    stress, time = mass / length, np.linspace(0.0, 0.3, 61)
    section = Section(
        base=8.0 * length,
        crest=3.0 * length,
        height=10.0 * length,
        counts=(6, 5),
        young=3e10 * stress,
        density=DENSITY * mass / length**3,
        law=f"KN={1e10 * stress / length!r}, KT={1e10 * stress / length!r}, FRICTION=0.6, "
        f"TENSILE STRENGTH={1e5 * stress!r}, COHESION={1e5 * stress!r}",
        depth=(length, 1),
    )
    gravity = GRAVITY * length
    wave = amplitude("SHAKE", time, 0.5 * gravity * np.sin(20.0 * np.pi * time))
    wave_card = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, TYPE=ACCELERATION\n"
    water = lake(9.0 * length, f", DENSITY={1000.0 * mass / length**3!r}, GRAVITY={gravity!r}")
    loads = f"*DLOAD\nDAM, GRAV, {gravity!r}, 0., 0., -1.\n" + water
    thick = section.deck("")
    if length != 1.0:  # the slice is 1 m thick
        thick = scaled_y(thick, length)
    shake = (
        f"*STEP, INC=1000\n*DYNAMIC\n0.005, 0.3\n{wave_card}*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    )
    return thick + wave + static(loads) + shake


def scaled_y(deck: str, length: float) -> str:
    """The deck with the y of its nodes in other units."""
    head, nodes, rest = deck.partition("*NODE\n")
    lines = rest.splitlines(keepends=True)
    for k, line in enumerate(lines):
        if line.startswith("*"):
            break
        number, x, y, z = line.split(",")
        lines[k] = f"{number}, {x}, {float(y) * length!r}, {z.strip()}\n"
    return head + nodes + "".join(lines)


@SOLIDS.case(
    "units",
    "one jointed dam slice with water and a motion in m-kg, mm-t and km-kg",
    "difference of displacements between the units",
    1e-6,
)
def units(keyway):
    runs, motions = [], []
    for name, length, mass in (("si", 1.0, 1.0), ("mm", 1e3, 1e-3), ("km", 1e-3, 1.0)):
        runs.append(keyway(shaken_section(length, mass), name=name))
        table = runs[-1].csv("node_ALL")
        motions.append(np.stack([table["U1"], table["U3"]]) / length)
    return max(off(motion, motions[0]) for motion in motions[1:]), runs


@SOLIDS.case(
    "levels at the bed, at the crest and above",
    "a lake 1 mm deep, one to the crest and one 2 m above it",
    "error of the push on the base against rho g (h^2 - (h - 10 m)^2)/2, over that to the crest",
    1e-9,
)
def levels(keyway):
    runs, worst = [], 0.0
    for level in (0.001, 10.0, 12.0):
        law = "KN=1e10, KT=1e10, TENSILE STRENGTH=1e9, COHESION=1e9"
        section = Section(counts=(4, 7), young=3e10, law=law)
        deck = section.deck(static(lake(level) + "*NODE PRINT, NSET=SKIN\nRF\n"))
        runs.append(keyway(deck, name=f"level_{level:.0f}"))
        found = -runs[-1].csv("node_SKIN")["RF1"].sum()
        exact = 1000.0 * GRAVITY * (0.5 * level**2 - 0.5 * max(level - 10.0, 0.0) ** 2)
        worst = max(worst, off([found], [exact], scale=1000.0 * GRAVITY * 50.0))
    return worst, runs


@SOLIDS.case(
    "closing under water",
    "a heel that opens and closes under the full head of the open part, shaken by 0.3 g",
    "error of the energy balance",
    1e-6,
)
def closing_under_water(keyway):
    time = np.linspace(0.0, 1.0, 201)
    wave = amplitude("SHAKE", time, 0.3 * GRAVITY * np.sin(6.0 * np.pi * time))
    section = Section(
        base=7.0,
        crest=3.0,
        counts=(12, 5),
        young=3e10,
        law="KN=1e10, KT=1e10, FRICTION=1., UPLIFT=LAKE, PROFILE=OPEN",
    )
    shake = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, TYPE=ACCELERATION\n*ENVELOPE\nOPENING\n"
    step = f"*STEP, INC=10000\n*DYNAMIC\n0.005, 1.\n{shake}*END STEP\n"
    run = keyway(section.deck(wave + static(weight() + lake(9.0)) + step))
    assert run.json["envelopes"]["OPENING"]["anywhere"]["value"] > 1e-5
    return unbalance(run), [run]


@SOLIDS.case(
    "procedures in a row",
    "static, frequency, dynamic, static: the loads leave and return",
    "difference of the static displacements before and after",
    1e-6,
)
def procedures(keyway):
    section = Section(base=8.0, crest=3.0, counts=(6, 5), young=3e10, law=ROUGH)
    step = static(weight() + "*NODE PRINT, NSET=ALL\nU\n")
    modes = "*STEP\n*FREQUENCY\n3\n*END STEP\n"
    free = "*STEP, INC=1000\n*DYNAMIC\n0.01, 0.5\n*DAMPING, RATIO=0.05, F1=10, F2=50\n*END STEP\n"
    run = keyway(section.deck(step + modes + free + static("*NODE PRINT, NSET=ALL\nU\n")))
    table = run.csv("node_ALL")
    first = table["step"] == table["step"][0]
    last = (table["step"] == table["step"][-1]) & (table["time"] == table["time"][-1])
    return off(table["U3"][last], table["U3"][first][-last.sum() :]), [run]


@SOLIDS.case(
    "60 s record",
    "6000 increments of a slice on its joint that slides and lifts",
    "error of the energy balance",
    1e-6,
)
def long_record(keyway):
    time = np.linspace(0.0, 60.0, 6001)
    lot = np.random.default_rng(1)
    noise = np.convolve(lot.standard_normal(6001), np.hanning(12), mode="same")
    wave = amplitude("SHAKE", time, 4.0 * noise / np.abs(noise).max() * np.sin(np.pi * time / 60.0))
    section = Section(base=6.0, crest=3.0, counts=(3, 3), young=3e10, law=ROUGH)
    shake = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, TYPE=ACCELERATION\n"
    step = f"*STEP, INC=100000\n*DYNAMIC\n0.01, 60.\n{shake}*END STEP\n"
    run = keyway(section.deck(wave + static(weight() + lake(9.0)) + step))
    return unbalance(run), [run]


@SOLIDS.case(
    "support that jumps",
    "a support moves by 1 mm within one increment of a dynamic step, undamped",
    "error of the energy balance",
    1e-6,
)
def jumping_support(keyway):
    mesh, number = box_mesh((10, 1, 1), stretched((10.0, 1.0, 1.0)))
    mesh.node_sets |= {"BASE": number[0].ravel(), "ALL": number.ravel()}
    jump = amplitude("JUMP", np.array([0.0, 0.001, 1.0]), np.array([0.0, 1.0, 1.0]))
    step = "*BOUNDARY, AMPLITUDE=JUMP\nBASE, 1, 1, 1e-3\n"
    cards = material("M", YOUNG, 0.0, DENSITY) + "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n"
    cards += "*BOUNDARY\nALL, 2, 3\nBASE, 1\n" + jump
    run = keyway(
        brick_deck(
            mesh, "C3D8", cards + f"*STEP, INC=1000\n*DYNAMIC\n0.001, 0.1\n{step}*END STEP\n"
        )
    )
    return unbalance(run), [run]
