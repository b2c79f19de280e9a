"""The estimated errors of the largest displacement: of the mesh in a linear static step, of the
increments in a dynamic one, against much finer meshes and increments."""

import math

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from keyway_tools.box_mesh import box_mesh, stretched
from test_mesh_error import BORE, MODULUS, OUTSIDE, POISSON, cantilever, cook, cylinder

GRID = 0.04  # s, between the corners of the load
DURATION = 24.0
FREQUENCY = 1.0  # Hz


def of_displacement(run) -> dict[str, float]:
    return run.json["accuracy"]["estimates"]["displacement"]


# The displacement of the bore (Lame).
LAME = (1.0 + POISSON) * BORE**2 / (MODULUS * (OUTSIDE**2 - BORE**2))
LAME *= (1.0 - 2.0 * POISSON) * BORE + OUTSIDE**2 / BORE
ELEMENTS = ("C3D8", "C3D8B", "C3D8I")


@pytest.mark.parametrize("element", ELEMENTS)
def test_mesh_in_a_cylinder(keyway, documented, element):
    """Exact: Lame. The element's largest displacement is at the bore."""
    for count in (8, 16):
        found = of_displacement(keyway(cylinder(count, element)[0]))
        effectivity = found["mesh"] / abs(LAME - found["value"])
        assert 0.5 < effectivity < 2.0
        documented("error of a displacement", ("cylinder", element), str(count), effectivity)


@pytest.mark.parametrize(("make", "name"), [(cook, "membrane"), (cantilever, "cantilever")])
def test_mesh_in_bending(keyway, documented, make, name):
    counts, fine = ((8, 16), 64) if make is cook else ((2, 4), 8)
    limit = keyway(make(fine, "C3D8I")).json["displacement"]["anywhere"]["value"]
    for element in (*ELEMENTS, "C3D8R"):
        for count, column in zip(counts, ("8", "16"), strict=True):
            found = of_displacement(keyway(make(count, element)))
            effectivity = found["mesh"] / abs(limit - found["value"])
            if (element, name, count) == ("C3D8R", "membrane", 16):
                continue  # the error passes through zero between two signs
            assert 0.5 < effectivity < 2.0
            documented("error of a displacement", (name, element), column, effectivity)


def test_one_point_in_a_cylinder(keyway):
    """C3D8R is exact to 0.2 % and less here; the estimate does not see this, but is no smaller."""
    for count in (8, 16):
        found = of_displacement(keyway(cylinder(count, "C3D8R")[0]))
        assert abs(LAME - found["value"]) < found["mesh"] < 0.03 * LAME


def test_switched_off(keyway):
    """ERROR ESTIMATE=OFF leaves no estimate and nothing in the ledger."""
    off = "*CONTROLS, ERROR ESTIMATE=OFF\n"
    static = cook(8, "C3D8").replace("*STATIC\n", f"*STATIC\n{off}")
    moving = shaken(1, GRID, -0.05).replace("*DLOAD", f"{off}*DLOAD")
    for deck in (static, moving):
        assert off in deck
        run = keyway(deck)
        assert run.json["accuracy"]["estimates"] == {}
        assert not any(p["name"].startswith("estimate") for p in run.json["ledger"]["parts"])


def shaken(bricks: int, dt: float, alpha: float) -> str:
    """An upright column, held sideways, whose weight changes; its lowest frequency is 1 Hz."""
    mesh, number = box_mesh((1, 1, bricks), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:1, :1, -1].ravel()
    omega = 2.0 * math.pi * FREQUENCY
    # One brick: k = E, m = rho/3. Many: omega = (pi/2) sqrt(E/rho).
    density = 3.0 if bricks == 1 else (0.5 * math.pi) ** 2
    law = elastic(omega**2, 0.0, density)
    law = law.replace(
        "*ELASTIC", f"*DAMPING, ALPHA={0.06 * omega!r}, BETA={0.04 / omega!r}\n*ELASTIC"
    )
    times = np.arange(0.0, DURATION + GRID, GRID)
    load = np.sin(1.7 * times) + np.sin(6.0 * times) + 0.7 * np.sin(11.0 * times + 1.0)
    pairs = "".join(f"{t:.10g}, {f:.10g}\n" for t, f in zip(times, load, strict=True))
    cards = f"*AMPLITUDE, NAME=LOAD\n{pairs}{law}*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n"
    cards += f"*STEP, INC=1000000\n*DYNAMIC, DIRECT, ALPHA={alpha}\n{dt!r}, {DURATION}\n"
    cards += "*DLOAD, AMPLITUDE=LOAD\nBODY, GRAV, 1., 0., 0., -1.\n"
    return brick_deck(mesh, "C3D8", cards + "*NODE PRINT, NSET=TOP\nU\n*END STEP\n")


@pytest.mark.parametrize("alpha", [0.0, -0.05, -0.3])
@pytest.mark.parametrize(("bricks", "name"), [(1, "oscillator"), (8, "column")])
def test_increments(keyway, documented, bricks, name, alpha):
    """The truth: an eighth of the increment. Errors of histories at the top."""
    run = keyway(shaken(bricks, GRID, alpha))
    found, u = of_displacement(run), run.csv("node_TOP")["U3"]
    true = keyway(shaken(bricks, GRID / 8, alpha)).csv("node_TOP")["U3"][::8]
    at = np.argmax(np.abs(u))
    largest = abs(u[at] - true[at])
    history = np.abs(u - true).max() / np.abs(u).max()
    assert 0.5 < found["time"] / largest < 2.0
    assert 0.5 < found["history"] / history < 2.0
    documented("error of increments", (name, f"{alpha}"), "at the largest", found["time"] / largest)
    documented("error of increments", (name, f"{alpha}"), "history", found["history"] / history)


def moved(dt: float) -> str:
    """The column on a base that *BOUNDARY moves smoothly."""
    times = np.arange(0.0, DURATION + GRID / 8, GRID / 8)
    move = 0.02 * np.minimum(times / 2.0, 1.0) ** 3
    move *= np.sin(4.0 * times) + 0.6 * np.sin(7.5 * times + 1.0)
    pairs = "".join(f"{t:.10g}, {u:.12g}\n" for t, u in zip(times, move, strict=True))
    deck = shaken(8, dt, -0.05).replace(
        "*DLOAD, AMPLITUDE=LOAD\nBODY, GRAV, 1.,",
        "*BOUNDARY, AMPLITUDE=MOVE\nBASE, 3, 3, 1.\n*DLOAD, AMPLITUDE=LOAD\nBODY, GRAV, 0.1,",
    )
    return deck.replace(
        "*AMPLITUDE, NAME=LOAD\n", f"*AMPLITUDE, NAME=MOVE\n{pairs}*AMPLITUDE, NAME=LOAD\n"
    )


def test_moving_supports(keyway):
    """The truth: an eighth of the increment, with the same motion of the base."""
    run = keyway(moved(GRID))
    found, u = of_displacement(run), run.csv("node_TOP")["U3"]
    true = keyway(moved(GRID / 8)).csv("node_TOP")["U3"][::8]
    at = np.argmax(np.abs(u))
    assert 0.5 < found["time"] / abs(u[at] - true[at]) < 2.0
