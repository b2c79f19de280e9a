"""Modal damping: a bar in its modes, against the recurrence of one degree of freedom; joints and
concrete that cracks."""

from __future__ import annotations

import math

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from joint_decks import Block, amplitude, dynamic, static, weight
from keyway_tools.box_mesh import box_mesh, stretched
from test_concrete_motion import check_energies, shaken_monolith
from test_vibration import DENSITY, LENGTH, MODULUS, discrete_hz

COUNT, RATIO = 8, 0.05
DT, NUM = 1e-3, 200  # a fiftieth of the period of the first mode [s], four periods


def mode_shape(k: int) -> np.ndarray:
    """Mode k of a bar of linear elements: a sine, at the sections from the foot to the tip."""
    return np.sin((2 * k + 1) * math.pi * np.arange(COUNT + 1) / (2 * COUNT))


def thrown_bar(keyway, speeds, damping: str, alpha: float = 0.0, name: str = "job", material=""):
    """A bar thrown with modes 0, 1, .. times `speeds` [m/s]; displacements of tip and middle."""
    mesh, number = box_mesh((1, 1, COUNT), stretched((1.0, 1.0, LENGTH)))
    mesh.node_sets |= {"ALL": number.ravel(), "BASE": number[:, :, 0].ravel()}
    mesh.node_sets |= {"TIP": number[:1, 0, COUNT], "MIDDLE": number[:1, 0, COUNT // 2]}
    start = sum(speed * mode_shape(k) for k, speed in enumerate(speeds))
    cards = elastic(MODULUS, 0.0, DENSITY).replace("*ELASTIC", f"{material}*ELASTIC")
    cards += "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n*INITIAL CONDITIONS, TYPE=VELOCITY\n"
    for layer in range(1, COUNT + 1):
        cards += "".join(f"{n + 1}, 3, {float(start[layer])!r}\n" for n in number[..., layer].flat)
    prints = "*NODE PRINT, NSET=TIP\nU\n*NODE PRINT, NSET=MIDDLE\nU\n"
    cards += dynamic(damping + prints, DT, NUM * DT, alpha)
    run = keyway(brick_deck(mesh, "C3D8", cards), name=name)
    # increment 0 is the start
    found = [run.csv(f"node_{place}")["U3"][-NUM:] for place in ("TIP", "MIDDLE")]
    return run, np.stack(found, axis=1)


def hht(omega: float, ratio: float, speed: float, alpha: float) -> np.ndarray:
    """Displacements of u'' + 2 ratio omega u' + omega^2 u = 0 from u' = speed, by HHT's equations
    (Hilber, Hughes & Taylor 1977)."""
    beta, gamma = 0.25 * (1.0 - alpha) ** 2, 0.5 - alpha
    forces = np.array([omega**2, 2.0 * ratio * omega])
    state = np.array([0.0, speed, -2.0 * ratio * omega * speed])
    matrix = [
        [(1.0 + alpha) * forces[0], (1.0 + alpha) * forces[1], 1.0],
        [1.0, 0.0, -beta * DT**2],
        [0.0, 1.0, -gamma * DT],
    ]
    found = []
    for _ in range(NUM):
        u, v, a = state
        known = [
            alpha * (forces @ state[:2]),
            u + DT * v + DT**2 * (0.5 - beta) * a,
            v + DT * (1.0 - gamma) * a,
        ]
        state = np.linalg.solve(matrix, known)
        found.append(state[0])
    return np.array(found)


def expected_bar(speeds, ratios, alpha: float) -> np.ndarray:
    """The sum of the modes at tip and middle."""
    sums = np.zeros((NUM, 2))
    for k, (speed, ratio) in enumerate(zip(speeds, ratios, strict=True)):
        u = hht(2.0 * math.pi * discrete_hz(k, COUNT), ratio, speed, alpha)
        sums += np.outer(u, mode_shape(k)[[COUNT, COUNT // 2]])
    return sums


MIDWAY = 0.5 * (discrete_hz(1, COUNT) + discrete_hz(2, COUNT))  # [Hz]


@pytest.mark.parametrize("alpha", [0.0, -0.05])
@pytest.mark.parametrize("modes", ["MODES=2", f"HIGHEST={MIDWAY}"])
def test_modes_decay_alone(keyway, modes, alpha):
    """Modes 1 and 2 have the ratio, mode 3 has none. 1e-9: modes and digits of the CSV."""
    speeds = (1.0, 0.5, 0.4)
    damping = f"*DAMPING, MODAL, RATIO={RATIO}, {modes}\n"
    run, found = thrown_bar(keyway, speeds, damping, alpha)
    expected = expected_bar(speeds, (RATIO, RATIO, 0.0), alpha)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    energy = run.csv("energy")
    assert np.diff(energy["damping"]).min() >= 0.0
    assert energy["error"].max() < 1e-9


def test_one_mode_is_as_with_rayleigh_damping(keyway):
    """Rayleigh's ratio holds at F1, the frequency of the only mode that moves."""
    hz = discrete_hz(0, COUNT)
    cards = {
        "rayleigh": f"*DAMPING, RATIO={RATIO}, F1={hz!r}, F2={3.0 * hz!r}\n",
        "modal": f"*DAMPING, MODAL, RATIO={RATIO}, MODES=3\n",
    }
    found = [thrown_bar(keyway, (1.0,), card, name=name)[1] for name, card in cards.items()]
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()


def test_modal_and_rayleigh_damping_add_up(keyway):
    """A material with ALPHA = 2 RATIO omega gives mode 1 the ratio a second time; a step that sets
    RATIO=0 ends modal damping."""
    omega = 2.0 * math.pi * discrete_hz(0, COUNT)
    material = f"*DAMPING, ALPHA={2.0 * RATIO * omega!r}\n"
    for ratio, total in ((RATIO, 2.0 * RATIO), (0.0, RATIO)):
        card = f"*DAMPING, MODAL, RATIO={RATIO}, MODES=1\n*DAMPING, MODAL, RATIO={ratio}, MODES=1\n"
        _, found = thrown_bar(keyway, (1.0,), card, name=f"job{total}", material=material)
        expected = expected_bar((1.0,), (total,), 0.0)
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_highest_below_all_modes_is_an_error(keyway):
    """The message names the lowest frequency."""
    mesh, number = box_mesh((1, 1, COUNT), stretched((1.0, 1.0, LENGTH)))
    mesh.node_sets |= {"ALL": number.ravel(), "BASE": number[:, :, 0].ravel()}
    cards = elastic(MODULUS, 0.0, DENSITY) + "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n"
    cards += dynamic("*DAMPING, MODAL, RATIO=0.05, HIGHEST=1.\n", DT, 2 * DT)
    run = keyway(brick_deck(mesh, "C3D8", cards), code=1)
    assert "no mode up to HIGHEST=1 Hz; the lowest has 80.8" in run.stderr


@pytest.mark.parametrize("meshes", [None, (3, 2)], ids=["matching", "different"])
def test_solvers_of_joints_agree(keyway, meshes):
    """A block that rocks and slides on its joint, by both solvers: U U^T is in every matrix, of
    sliding joints too. 1e-6: the tolerance of the forces; the energies add up."""
    time = np.linspace(0.0, 1.0, 201)
    block = Block(
        (1.0, 1.0, 2.0),
        (2, 2, 4),
        young=1e8,
        law="KN=1e9, KT=1e9, FRICTION=0.4",
        meshes=meshes,
        cards=amplitude("SINE", time, 6.0 * np.sin(4.0 * np.pi * time)),
    )
    crests = []
    for solver in ("CONDENSED", "FULL"):
        steps = static(weight()) + dynamic(
            f"*CONTROLS, RESIDUAL=1e-9, JOINT SOLVER={solver}\n"
            "*DAMPING, MODAL, RATIO=0.1, MODES=5\n*BASE MOTION, DOF=1, AMPLITUDE=SINE\n"
            "*NODE PRINT, NSET=TOP\nU\n*JOINT PRINT, JOINT=BED\n",
            0.005,
            1.0,
        )
        run = keyway(block.deck(steps), name=solver)
        energy = run.csv("energy")
        assert energy["error"].max() < 1e-7
        assert energy["damping"][-1] > 0.01 * energy["external"].max()
        joint = run.csv("joint_BED")
        assert joint["opening"].max() > 1e-4
        crests.append(run.csv("node_TOP")["U1"])
    assert np.abs(crests[0] - crests[1]).max() < 1e-6 * np.abs(crests[0]).max()


@pytest.mark.parametrize("tangent", ["AUTO", pytest.param("CONSISTENT", marks=pytest.mark.full)])
def test_cracking_monolith(keyway, tangent):
    """Concrete that cracks under modal damping: energies add up."""
    damping = f"*DAMPING, MODAL, RATIO=0.05, MODES=10\n*CONTROLS, TANGENT={tangent}"
    old = "*DAMPING, RATIO=0.03, F1=2.5, F2=12."
    run = shaken_monolith(keyway, size=0.8, edits=[(old, damping)])
    table = check_energies(run)
    assert run.json["damage"]["DAMAGET"]["value"] > 0.1
    assert np.diff(table["damping"]).min() >= 0.0


def test_modes_of_one_frequency_are_damped_together(keyway):
    """A square column bends in both directions with one frequency. MODES=1 would damp a direction
    that nothing but the eigensolver chooses: thrown along the diagonal, the column left it."""
    mesh, number = box_mesh((1, 1, 4), stretched((1.0, 1.0, 8.0)))
    mesh.node_sets = {"BASE": number[:, :, 0].ravel(), "EDGE": number[1, 1, 1:]}
    cards = elastic(MODULUS, 0.2, DENSITY) + "*BOUNDARY\nBASE, 1, 3\n"
    cards += "*INITIAL CONDITIONS, TYPE=VELOCITY\n"
    for layer in range(1, 5):
        for node in number[..., layer].flat:
            cards += "".join(f"{node + 1}, {axis}, {0.1 * layer**2!r}\n" for axis in (1, 2))
    prints = "*NODE PRINT, NSET=EDGE\nU\n"
    text = cards + dynamic(f"*DAMPING, MODAL, RATIO={RATIO}, MODES=1\n{prints}", 1e-3, 0.2, 0.0)
    run = keyway(brick_deck(mesh, "C3D8I", text))
    table = run.csv("node_EDGE")
    # Modes are found to 1e-9 or so; with one mode alone the motions differed by 1.7e-3.
    assert np.abs(table["U1"] - table["U2"]).max() < 1e-6 * np.abs(table["U1"]).max()
    log = (run.folder / "job.log").read_text()
    assert "2 modes are damped in place of 1: the last ones have one frequency" in log
