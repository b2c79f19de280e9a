"""A dynamic step in parts: the motion goes on as in one step."""

from __future__ import annotations

import re

import brick_on_rock
import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from keyway_tools.box_mesh import box_mesh, stretched

COLUMNS = ("U1", "U2", "U3", "V1", "V2", "V3", "A1", "A2", "A3")
PRINTS = "*NODE PRINT, NSET=CREST\nU, V, A\n*NODE PRINT, NSET=BASE\nRF\n"


def deck(parts: list[float], cards: str, light: float, tied: bool, reduced: str = "") -> str:
    """A brick on rock that is shaken for 0.4 s in steps of these lengths."""
    motion = f"{brick_on_rock.SHAKEN}{PRINTS}{cards}"
    steps = "".join(brick_on_rock.shaken(t, f"{reduced}, DIRECT", motion) for t in parts)
    return brick_on_rock.deck(steps, light, tied)


def motion_of(run) -> np.ndarray:
    """(increments of the motion, columns)."""
    table = run.csv("node_CREST")
    now = (table["step"] > 1) & (table["increment"] > 0)
    return np.stack([table[name][now] for name in COLUMNS], axis=1)


@pytest.mark.parametrize("tied", [False, True], ids=["joint", "tie"])
@pytest.mark.parametrize("light", [0.0, 1.0, 2600.0])
@pytest.mark.parametrize(
    "cards", ["", "*DAMPING, RATIO=0.05, F1=5., F2=50.\n", "*CONTROLS, JOINT FORCES=HHT\n"]
)
def test_a_step_in_parts(keyway, cards, light, tied):
    """The acceleration of HHT does not balance the forces of one instant: found anew at each step
    it was off by up to 100 times, and the motion of rock of 1 kg/m3 grew without end."""
    whole, parts = (
        motion_of(keyway(deck(lengths, cards, light, tied), name=name))
        for name, lengths in (("whole", [0.4]), ("parts", [0.1, 0.02, 0.08, 0.2]))
    )
    # Round-off in sums of times, and of forces over the mass of light rock.
    assert parts == pytest.approx(whole, abs=1e-7 * np.abs(whole).max(axis=0).max())
    for k in range(len(COLUMNS)):
        size = np.abs(whole[:, k]).max()
        if size > 1e-9 * np.abs(whole[:, k - k % 3 : k - k % 3 + 3]).max():
            assert parts[:, k] == pytest.approx(whole[:, k], abs=1e-6 * size)


@pytest.mark.parametrize("tied", [False, True], ids=["joint", "tie"])
@pytest.mark.parametrize("light", [0.0, 1e-6, 1.0, 2600.0])
@pytest.mark.parametrize("cards", ["", "*DAMPING, RATIO=0.05, F1=5., F2=50.\n"])
def test_a_support_that_holds_nothing(keyway, cards, light, tied):
    """Nodes in the plane of symmetry are held across this plane in every second step. The motion of
    rock of 1e-6 kg/m3 grew without end, massless rock changed V by 14 %."""
    motion = f"{brick_on_rock.SHAKEN}{PRINTS}{cards}*CONTROLS, RESIDUAL=1e-9\n"
    held = ["", "*BOUNDARY\nTOP, 2, 2\n", "*BOUNDARY, OP=NEW\nBASE, 1, 3\n"]
    several = "".join(
        brick_on_rock.shaken(t, ", DIRECT", card + motion)
        for t, card in zip([0.1, 0.1, 0.2], held, strict=True)
    )
    decks = (("whole", brick_on_rock.shaken(0.4, ", DIRECT", motion)), ("parts", several))
    whole, parts = (
        motion_of(keyway(brick_on_rock.deck(steps, light, tied, (0.0, 1.0, 2.0)), name=name))
        for name, steps in decks
    )
    # Round-off over the mass of the lightest rock leaves a motion across the plane, 1e-6 of the
    # largest, which the support stops.
    share = 1e-4 if light == 1e-6 else 1e-6
    for k in range(0, len(COLUMNS), 3):
        size = np.abs(whole[:, k : k + 3]).max()
        assert parts[:, k : k + 3] == pytest.approx(whole[:, k : k + 3], abs=share * size)


def test_a_support_that_goes(keyway):
    """A block under a force in balance with its supports is free along x from the second step on:
    its mean velocity is F t/m from the first increment on."""
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["LOW"] = number[:, :, 0].ravel()
    mesh.node_sets["HIGH"] = number[:, :, 1].ravel()
    cards = elastic(1e9, 0.2, 2400.0)
    printed = "*NODE PRINT, NSET=ALL\nV, A\n*END STEP\n"
    cards += "*BOUNDARY\nALL, 2, 3\nLOW, 1\n"
    cards += "*STEP\n*STATIC\n1., 1.\n*CLOAD\nHIGH, 1, 60.\n*END STEP\n"
    cards += f"*STEP\n*DYNAMIC, DIRECT\n0.001, 0.01\n{printed}"
    cards += f"*STEP\n*DYNAMIC, DIRECT\n0.001, 0.02\n*BOUNDARY, OP=NEW\nALL, 2, 3\n{printed}"
    table = keyway(brick_deck(mesh, "C3D8", cards)).csv("node_ALL")
    now = table["step"] == 3
    times = np.unique(table["time"][now])
    mean = np.array([table["V1"][now][table["time"][now] == t].mean() for t in times])
    assert mean == pytest.approx(4 * 60.0 / 2400.0 * (times - 1.01), rel=1e-6)


def test_a_force_that_comes_with_a_step(keyway):
    """It accelerates a free block by F/m at once: v = F t/m from the first increment on."""
    mesh, number = box_mesh((1, 1, 1), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    cards = elastic(1e10, 0.0, 2400.0) + "*BOUNDARY\nALL, 2, 3\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*NODE PRINT, NSET=ALL\nV, A\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*CLOAD\nALL, 1, 30.\n*END STEP\n"
    table = keyway(brick_deck(mesh, "C3D8", cards)).csv("node_ALL")
    rate = 8 * 30.0 / 2400.0
    now = table["step"] == 2
    assert table["V1"][now] == pytest.approx(rate * (table["time"][now] - 0.1), rel=1e-9)
    assert table["A1"][now] == pytest.approx(rate, rel=1e-9)
    assert np.all(table["V1"][~now] == 0.0)


def test_a_reduced_model_goes_on(keyway):
    """A reduced step after a full one starts from the forces that the joint has passed on."""
    runs = []
    for name, second in (("full", ""), ("reduced", ", REDUCED, MODES=40")):
        steps = brick_on_rock.shaken(0.2, ", DIRECT", brick_on_rock.SHAKEN + PRINTS)
        steps += brick_on_rock.shaken(0.2, f"{second}, DIRECT", brick_on_rock.SHAKEN)
        text = re.sub(r"KN=1e11", "KN=1e10", brick_on_rock.deck(steps, 2600.0))
        runs.append(motion_of(keyway(text, name=name)))
    size = np.abs(runs[0][:, :3]).max()
    assert runs[1][:, :3] == pytest.approx(runs[0][:, :3], abs=0.02 * size)
