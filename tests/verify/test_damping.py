"""Damping by the damaged stiffness: a cracked bar against the recurrence of one degree of freedom,
and cracking dams."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from brick_decks import brick_deck
from concrete_decks import Bar, paper_concrete, pull
from keyway_tools.box_mesh import box_mesh
from scipy.spatial.transform import Rotation
from stopped_runs import stops_that_go_on
from test_concrete_motion import check_energies, shaken_monolith

YOUNG, DENSITY, LENGTH, SIDE = 25e9, 2400.0, 0.5, 0.1
STRETCH = (4e-4, 3.9e-4)  # displacements of the end [m]: the bar cracks, then unloads
RAYLEIGH = (0.4, 200.0, 600.0)  # ratio, frequencies [Hz]


def rayleigh(ratio: float, f1: float, f2: float) -> tuple[float, float]:
    """alpha and beta of theory.md, (5.1)."""
    w1, w2 = 2.0 * math.pi * f1, 2.0 * math.pi * f2
    return 2.0 * ratio * w1 * w2 / (w1 + w2), 2.0 * ratio / (w1 + w2)


def cracked_bar(keyway, dt: float, num: int, force: float, of_material: str, of_step: str):
    """One element is cracked and held by its end; the end is set free under a constant force."""
    concrete = paper_concrete(young=YOUNG, poisson=0.0, density=DENSITY)
    deck = Bar(concrete, length=LENGTH, side=SIDE).deck(
        pull(STRETCH, controls="*CONTROLS, RESIDUAL=1e-11\n")
        + f"*STEP\n*DYNAMIC, DIRECT, ALPHA=0\n{dt!r}, {num * dt!r}\n{of_step}"
        + "*BOUNDARY, OP=NEW\nLEFT, 1\nFRONT, 2\nBELOW, 3\n"
        + f"*CLOAD\nRIGHT, 1, {force / 4.0!r}\n*END STEP\n"
    )
    return keyway(deck.replace("*ELASTIC", of_material + "*ELASTIC"))


def trapezoidal(mass: float, damping: float, stiffness: float, force: float, start: float, steps):
    """Displacements from rest by Newmark's trapezoidal rule: an independent recurrence."""
    dt, num = steps
    u, v, a = start, 0.0, (force - stiffness * start) / mass
    found = []
    for _ in range(num):
        k = stiffness + 2.0 / dt * damping + 4.0 / dt**2 * mass
        x = force - stiffness * u + mass * (4.0 / dt * v + a) + damping * v
        du = x / k
        v, a, u = 2.0 / dt * du - v, 4.0 / dt**2 * du - 4.0 / dt * v - a, u + du
        found.append(u)
    return np.array(found)


@pytest.mark.parametrize("base", ["INITIAL", "CURRENT"])
@pytest.mark.parametrize("of", ["material", "step"])
def test_cracked_bar(keyway, base, of):
    """m = rho A L/3 of an element with one end held, k = (1 - d) E A/L, c = alpha m + beta k with
    the undamaged or the damaged k. It stays in tension below its largest strain: d is constant.
    1e-7 of the amplitude: tolerance 1e-11 of the forces over 60 increments, digits of the CSV."""
    alpha, beta = rayleigh(*RAYLEIGH)
    ratio, f1, f2 = RAYLEIGH
    cards = {"material": "", "step": "", of: f"ALPHA={alpha!r}, BETA={beta!r}, BASE={base}\n"}
    cards["step"] = f"RATIO={ratio}, F1={f1}, F2={f2}, BASE={base}\n" if of == "step" else ""
    cards = {name: f"*DAMPING, {text}" if text else "" for name, text in cards.items()}
    dt, num, force = 5e-5, 60, 2550.0
    run = cracked_bar(keyway, dt, num, force, cards["material"], cards["step"])
    nodes, points = run.csv("node_RIGHT"), run.csv("el_WEAK")
    first = points["step"] == 1
    damage = points["DAMAGET"][first][-1]
    assert 0.3 < damage < 0.97
    assert points["DAMAGET"][-1] == pytest.approx(damage, rel=1e-12)
    stiffness = SIDE**2 / LENGTH * YOUNG
    held = points["S11"][first][-1] * SIDE**2
    assert 0.7 * force < held < force
    plastic = STRETCH[-1] - held / ((1.0 - damage) * stiffness)
    found = nodes["U1"][nodes["step"] == 2].reshape(-1, 4)
    mass = DENSITY * SIDE**2 * LENGTH / 3.0
    damping = alpha * mass + beta * stiffness * (1.0 if base == "INITIAL" else 1.0 - damage)
    expected = plastic + trapezoidal(
        mass, damping, (1.0 - damage) * stiffness, force, STRETCH[-1] - plastic, (dt, num)
    )
    amplitude = np.ptp(expected)
    assert np.abs(found[-num:] - expected[:, None]).max() < 1e-7 * amplitude
    energy = run.csv("energy")
    assert np.diff(energy["damping"]).min() >= 0.0
    assert energy["error"].max() < 1e-9
    numerical = energy["numerical"][energy["step"] == 2]
    assert np.ptp(numerical) < 1e-6 * energy["damping"][-1]


def of_step(base: str) -> tuple[str, str]:
    """Edits of the monolith: 5 % at 2.5 and 12 Hz."""
    return ("RATIO=0.03, F1=2.5, F2=12.", f"RATIO=0.05, F1=2.5, F2=12., BASE={base}")


def test_without_cracks_the_bases_agree(keyway):
    """The same numbers, digit for digit: nothing is lost where no point is damaged."""
    runs = [
        shaken_monolith(keyway, size=0.1, edits=[of_step(base)], name=base)
        for base in ("INITIAL", "CURRENT")
    ]
    assert runs[0].json["damage"]["DAMAGET"]["value"] == 0.0
    assert np.array_equal(*(run.csv("node_CREST")["U1"] for run in runs))


def test_cracking_monolith(keyway):
    """The neck cracks through, one row of bricks with either base. Energies add up, damping never
    returns energy, and it dissipates less where open cracks do not damp (7 % less; half of that is
    asked for)."""
    runs = {
        base: shaken_monolith(keyway, size=0.8, edits=[of_step(base)], name=base)
        for base in ("INITIAL", "CURRENT")
    }
    volumes = [run.json["damage"]["damaged_volume"][-1]["volume"] for run in runs.values()]
    assert volumes[0] == volumes[1] > 0.0
    tables = {base: check_energies(run) for base, run in runs.items()}
    for table in tables.values():
        assert np.diff(table["damping"]).min() >= 0.0
    assert tables["CURRENT"]["damping"][-1] < 0.965 * tables["INITIAL"]["damping"][-1]


def test_lost_damping_is_in_the_consistent_tangent(keyway):
    """A cracked bar that unloads is linear: the second iteration of the step has the tangent. With
    this matrix the first guess of an increment is exact, so that each takes one iteration."""
    controls = "*CONTROLS, RESIDUAL=1e-8, TANGENT=CONSISTENT\n"
    damping = f"*DAMPING, RATIO=0.4, F1=200., F2=600., BASE=CURRENT\n{controls}"
    run = cracked_bar(keyway, 5e-5, 60, 2550.0, "", damping)
    assert run.json["steps"][-1]["iterations"] == 60 + 1


def cracking_cube(axes: np.ndarray, layers: int = 1, parts: tuple[float, ...] = (3e-3,)) -> str:
    """A cube of concrete in other axes; its top is moved askew, in steps of these lengths."""
    mesh, number = box_mesh((1, 1, layers), lambda *x: 0.2 * np.stack(x, axis=-1) @ axes.T)
    mesh.node_sets = {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    mesh.node_sets["INSIDE"] = number[:, :, 1].ravel()
    law = "*DENSITY\n2400.\n*ELASTIC\n30e9, 0.2\n"
    law += "*CONCRETE DAMAGED PLASTICITY, RECOVERY=ENERGY\n32.5, 0.1, 1.16, 0.6667, 0.\n"
    law += "*CONCRETE COMPRESSION HARDENING\n20e6, 0.\n30e6, 1e-3\n"
    law += "*CONCRETE TENSION STIFFENING, TYPE=GFI\n2.5e6, 100.\n"
    law += "*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT, COMPRESSION RECOVERY=1\n"
    law += "0., 0.\n0.9, 8e-5\n"
    cards = f"*MATERIAL, NAME=M\n{law}*SOLID SECTION, ELSET=BODY, MATERIAL=M\n"
    cards += "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 1e-3, 1., 2e-3, 0.2, 3e-3, 2.\n"
    cards += "*BOUNDARY\nBASE, 1, 3\n"
    for length in parts:
        cards += f"*STEP\n*DYNAMIC, DIRECT, ALPHA=0.\n1e-5, {length!r}\n"
        cards += "*CONTROLS, RESIDUAL=1e-11, ITERATIONS=50\n"
        cards += "*DAMPING, RATIO=0.2, F1=500., F2=2000., BASE=CURRENT\n*BOUNDARY, AMPLITUDE=A\n"
        for axis, value in enumerate(axes @ np.array([2e-5, 3e-5, 6e-5]), 1):
            cards += f"TOP, {axis}, {axis}, {float(value)!r}\n"
        cards += "*NODE PRINT, NSET=INSIDE\nA\n*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


def test_lost_damping_in_other_axes(keyway):
    """Shear stresses stand twice in a stress tensor: counted once, the energy that damping takes
    depended on the axes by 1.5 %. The iteration ends at 1e-11 of the forces, 300 times."""
    turn = Rotation.from_euler("xyz", [40.0, -35.0, 60.0], degrees=True).as_matrix()
    found = []
    for axes in (np.eye(3), turn):
        run = keyway(cracking_cube(axes), name=f"cube{len(found)}")
        assert run.json["damage"]["DAMAGET"]["value"] > 0.5
        found.append(run.json["steps"][-1]["energy"]["damping"])
    assert found[1] == pytest.approx(found[0], rel=1e-8)


def test_lost_damping_of_a_step_in_parts(keyway):
    """Cracks lose more damping in the last increment of a step. Counted at once in the next step,
    that changed the acceleration there, on massless rock by 14 times the largest one."""
    tables = [
        keyway(cracking_cube(np.eye(3), 2, parts), name=f"parts{len(parts)}").csv("node_INSIDE")
        for parts in ((3e-3,), (5e-4, 2e-4, 5e-4, 1.8e-3))
    ]
    for component in ("A1", "A2", "A3"):
        whole, parts = (t[component][t["increment"] > 0] for t in tables)
        # Iterations end at 1e-11 of the forces, 300 times.
        assert parts == pytest.approx(whole, abs=1e-8 * np.abs(whole).max())


def test_lost_damping_of_a_run_that_goes_on(program_path, tmp_path):
    """The first step is dynamic and its supports are at rest: a checkpoint within the step has the
    motion of the step itself, and there is no step before."""
    start, end = "*BOUNDARY, AMPLITUDE=A\n", "*NODE PRINT"
    text = cracking_cube(np.eye(3), 2)
    held = text.index(start)
    text = text[:held] + "*CLOAD, AMPLITUDE=A\nTOP, 3, 2e4\n" + text[text.index(end, held) :]
    deck = tmp_path / "job.inp"
    deck.write_text(text)

    assert stops_that_go_on(program_path, tmp_path, deck, (60, 200)) >= 1
    assert json.loads((tmp_path / "whole/job.json").read_text())["damage"]["DAMAGET"]["value"] > 0.1


def damped_column(element: str, shares: tuple[tuple[float, int], ...]) -> str:
    """Five bricks above each other, shaken sideways: BETA of each material, and its bricks from the
    base on."""
    mesh, number = box_mesh((1, 1, 5), lambda *x: np.stack(x, axis=-1))
    mesh.node_sets = {"BASE": number[:, :, 0].ravel(), "TOP": number[:, :, -1].ravel()}
    cards, first = "", 1
    for k, (beta, count) in enumerate(shares):
        bricks = ", ".join(str(e) for e in range(first, first + count))
        cards += f"*ELSET, ELSET=PART{k}\n{bricks}\n*MATERIAL, NAME=M{k}\n*DENSITY\n{DENSITY}\n"
        cards += f"*DAMPING, BETA={beta}\n*ELASTIC\n1e8, 0.2\n"
        cards += f"*SOLID SECTION, ELSET=PART{k}, MATERIAL=M{k}\n"
        first += count
    cards += "*AMPLITUDE, NAME=A\n0., 0., 0.1, 3., 0.2, -3., 0.3, 0.\n*BOUNDARY\nBASE, 1, 3\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.5\n*BASE MOTION, DOF=1, AMPLITUDE=A\n"
    return brick_deck(mesh, element, cards + "*NODE PRINT, NSET=TOP\nU\n*END STEP\n")


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_materials_with_less_damping_than_most_elements(keyway, element):
    """C is a multiple of K and what differs from it, which is negative in these two bricks. One
    material under two names takes another multiple: the motion is the same to round-off.

    With C3D8I the run ended: its modes were sought with a negative stiffness."""
    weak, strong = 1e-3, 1e-2
    most_damp = keyway(damped_column(element, ((weak, 2), (strong, 3))), name="more")
    few_damp = keyway(damped_column(element, ((weak, 2), (strong, 2), (strong, 1))), name="less")
    u = [run.csv("node_TOP")["U1"] for run in (most_damp, few_damp)]
    assert np.abs(u[1] - u[0]).max() < 1e-10 * np.abs(u[0]).max() > 0.0
