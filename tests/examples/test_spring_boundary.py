"""The worked example of a guest: springs and dashpots between a surface and the ground."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from scipy.optimize import brentq

LENGTH, NUMBER = 10.0, 40  # of a bar along z with a cross-section of 1 m x 1 m [m], its elements
DENSITY, YOUNG = 2000.0, 2e10
WAVE = float(np.sqrt(YOUNG / DENSITY))  # speed of waves along the bar [m/s]


def bar(constants: str, steps: str, young: float = YOUNG) -> str:
    """A bar of NUMBER elements that stands on the boundary, without any *BOUNDARY."""
    lines = ["*NODE"]
    for layer in range(NUMBER + 1):
        for corner, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)], start=1):
            lines.append(f"{4 * layer + corner}, {x}., {y}., {layer * LENGTH / NUMBER!r}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=BAR")
    for e in range(NUMBER):
        nodes = range(4 * e + 1, 4 * e + 9)
        lines.append(f"{e + 1}, {', '.join(map(str, nodes))}")
    last = 4 * NUMBER
    lines += [
        "*NSET, NSET=FOOT\n1, 2, 3, 4",
        f"*NSET, NSET=TOP\n{last + 1}, {last + 2}, {last + 3}, {last + 4}",
        f"*NSET, NSET=ALL, GENERATE\n1, {last + 4}, 1",
        "*SURFACE, NAME=BASE, TYPE=ELEMENT\n1, S1",
        f"*MATERIAL, NAME=M\n*ELASTIC\n{young}, 0.\n*DENSITY\n{DENSITY}",
        "*SOLID SECTION, ELSET=BAR, MATERIAL=M",
        f"*SPRING BOUNDARY, NAME=GROUND, SURFACE=BASE\n{constants}",
        steps,
    ]
    return "\n".join(lines) + "\n"


def test_weight_on_springs(example):
    """The foot settles by rho g L/k_n; the springs support the bar without any *BOUNDARY."""
    steps = (
        "*STEP\n*STATIC\n*DLOAD\nBAR, GRAV, 9.81, 0., 0., -1.\n*NODE PRINT, NSET=FOOT\nU\n*END STEP"
    )
    run = example("spring_boundary")(bar("1e8, 5e7", steps))
    settlement = DENSITY * 9.81 * LENGTH / 1e8
    # Round-off: the condition of this matrix is some 1e6.
    assert run.csv("node_FOOT")["U3"] == pytest.approx(-settlement, rel=1e-9)
    assert {"name": "GROUND", "kind": "spring boundary"} in run.json["effects"]
    parts = {part["name"] for part in run.json["ledger"]["parts"]}
    assert "assemble GROUND" in parts


def test_bar_on_a_spring(example):
    """The mode along a bar on a spring: k_n A = E A beta tan(beta L), omega = beta c."""
    steps = "*STEP\n*FREQUENCY\n6\n*END STEP"
    run = example("spring_boundary")(bar("1e8, 1e8", steps))
    found = np.array([mode["hz"] for mode in run.json["steps"][0]["frequencies"]])
    beta = brentq(lambda b: YOUNG * b * np.tan(b * LENGTH) - 1e8, 1e-9, 1.5 / LENGTH)
    # Elements of consistent mass raise it by (beta h)^2/24 = 1e-6, h = 0.25 m.
    assert min(abs(2 * np.pi * found / (beta * WAVE) - 1)) < 3e-6


def test_surface_slides(example):
    """A rigid bar is pushed past the strength of its springs and returns with a slip.

    Its foot of 1 m2 carries k_t u up to tau = 3e4 Pa: pushed by 1 mm it slides by
    u - tau/k_t = 0.4 mm, which dissipates tau times the slip; pushed back to 0 the springs carry
    -k_t times the slip.
    """
    k_t, strength, push = 5e7, 3e4, 1e-3
    slip = push - strength / k_t
    steps = "".join(
        f"*STEP\n*STATIC\n0.125, 1.\n*BOUNDARY\nALL, 1, 1, {u}\nALL, 2, 3, 0.\n"
        "*NODE PRINT, NSET=ALL\nRF\n*NODE FILE\nU\n*END STEP\n"
        for u in (push, 0.0)
    )
    run = example("spring_boundary")(bar(f"1e8, {k_t}, 0., 0., {strength}", steps))
    table = run.csv("node_ALL")
    last = [np.flatnonzero(table["step"] == step)[-4 * (NUMBER + 1) :] for step in (1, 2)]
    # Round-off of sums over 164 nodes.
    assert sum(table["RF1"][last[0]]) == pytest.approx(strength, rel=1e-9)
    assert sum(table["RF1"][last[1]]) == pytest.approx(-k_t * slip, rel=1e-9)
    energy = run.json["steps"][0]["energy"]
    assert energy["friction"] == pytest.approx(strength * slip, rel=1e-9)
    assert energy["strain"] == pytest.approx(0.5 * strength**2 / k_t, rel=1e-9)
    # The trapezoidal rule misses at most k_t du^2/8 in the increment du with the kink of the law.
    assert energy["external"] == pytest.approx(strength * (push - 0.5 * strength / k_t), rel=0.02)
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file["steps/0002/increments"]
        last = increments[max(increments)]["GROUND_SLIP"]
        assert np.allclose(last[:4], [slip, 0.0, 0.0], rtol=1e-9, atol=1e-15)
        assert not np.any(last[4:])


def test_dashpots_absorb_a_wave(example):
    """A bar with a uniform velocity comes to rest: half travels down, half up and then down.

    d'Alembert: the top moves on with v until t = L/c and rests afterwards; at 2 L/c the dashpots
    rho c have taken all energy.
    """
    duration = 2.4 * LENGTH / WAVE
    increment = 0.25 * LENGTH / NUMBER / WAVE
    steps = (
        f"*INITIAL CONDITIONS, TYPE=VELOCITY\nALL, 3, 1.\n*STEP\n*DYNAMIC, DIRECT, ALPHA=0.\n"
        f"{increment!r}, {duration!r}\n*NODE PRINT, NSET=TOP\nV\n*END STEP"
    )
    run = example("spring_boundary")(bar(f"0., 0., {DENSITY * WAVE!r}, 1e6", steps))
    energy = run.json["steps"][0]["energy"]
    start = 0.5 * DENSITY * LENGTH
    # Dispersion of the mesh leaves ripples behind the front: below 1 % of the energy with 40
    # elements; measured 0.2 %.
    assert energy["damping"] == pytest.approx(start, rel=1e-2)
    assert energy["kinetic"] + energy["strain"] < 1e-2 * start
    top = run.csv("node_TOP")
    node = top["node"] == top["node"][0]
    time, v = top["time"][node], top["V3"][node]
    # The shortest waves of the mesh run faster than c.
    assert v[time < 0.5 * LENGTH / WAVE] == pytest.approx(1.0, abs=1e-3)
    assert np.mean(v[time > 1.1 * LENGTH / WAVE]) == pytest.approx(0.0, abs=1e-2)


def test_messages_and_help_name_the_keyword(example):
    program = example("spring_boundary")
    text = program.call("--keywords", "SPRING BOUNDARY").stdout
    assert "springs along the normal" in text
    run = program(bar("1e8", "").replace("SURFACE=BASE\n1e8", "SURFACE=BASIS\n1e8"), code=2)
    assert "there is no surface 'BASIS' above this line" in run.stderr
    run = program(bar("-1e8", ""), code=2)
    assert "found '-1e8'; expected springs along the normal, a number >= 0" in run.stderr
