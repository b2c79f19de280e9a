"""The start of *DYNAMIC where parts have no mass: a block on a joint on a massless column.

The column of two elements stands on a fixed base and moves vertically only; the block on it is the
slave of the joint. What has no mass is in static balance at all times, hence the force of the
column k_c u_top is that of the joint k_j (u_block - u_top), and the middle of the column moves by
half its top. The same holds for accelerations, from the first instant on (theory.md, 7.1).
"""

from __future__ import annotations

import brick_on_rock
import numpy as np
import pytest
from joint_decks import GRAVITY, material, node_sets
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh

YOUNG, KN, HEIGHT = 1e8, 3e8, 2.0  # column [Pa], joint [Pa/m], column [m]
OF_TOP = KN / (YOUNG / HEIGHT + KN)  # motion of the top of the column over that of the block


def above(*s: np.ndarray) -> np.ndarray:
    return np.stack(s, axis=-1) + np.array([0.0, 0.0, HEIGHT])


def column_deck(facets: tuple[int, int], steps: str, gap: float = 0.0) -> str:
    """Facets of column and block along each side of 1 m; all but vertical motion is held."""
    low, n = box_mesh((facets[0], facets[0], 2), lambda *s: np.stack(s, axis=-1) * [1, 1, HEIGHT])
    high, m = box_mesh((facets[1], facets[1], 1), above)
    of_low = np.arange(len(low.bricks)).reshape(facets[0], facets[0], 2)
    of_high = len(low.bricks) + np.arange(len(high.bricks))
    m = m + len(low.x)
    mesh = BrickMesh(
        np.concatenate((low.x, high.x)),
        np.concatenate((low.bricks, high.bricks + len(low.x))),
        np.zeros((0, 8), dtype=int),
    )
    mesh.brick_sets = {"COLUMN": of_low.ravel(), "BLOCK": of_high}
    mesh.surfaces = {
        "MASTER": [(int(e), 2) for e in of_low[:, :, 1].ravel()],
        "SLAVE": [(int(e), 1) for e in of_high],
    }
    sets = {
        "BASE": n[:, :, 0].ravel(),
        "ALL": np.arange(len(mesh.x)),
        "MIDDLE": n[:1, 0, 1],
        "TOP": n[:1, 0, 2],
        "BOTTOM": m[:1, 0, 0],
    }
    return (
        mesh_deck(mesh, dict.fromkeys(mesh.brick_sets, "C3D8"), "")
        + node_sets(sets)
        + material("SOFT", YOUNG, 0.0, 0.0)
        + material("STUFF", 1e10, 0.0, 2400.0)
        + "*SOLID SECTION, ELSET=COLUMN, MATERIAL=SOFT\n"
        + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
        + f"*JOINT LAW, NAME=LAW, KN={KN!r}, KT=1e8, GAP={gap!r}\n"
        + "*JOINT, NAME=BED, LAW=LAW\nSLAVE, MASTER\n"
        + "*BOUNDARY\nALL, 1, 2\nBASE, 3\n"
        + steps
    )


def print_all(name: str) -> str:
    return f"*NODE PRINT, NSET={name}\nU, A\n"


def sudden_weight(alpha: float, gravity: float = GRAVITY) -> str:
    return (
        f"*STEP, INC=1000\n*DYNAMIC, ALPHA={alpha!r}, DIRECT\n0.002, 0.1\n"
        + "*CONTROLS, JOINT FORCES=HHT\n"  # weighted as the forces of the column
        + f"*DLOAD\nBLOCK, GRAV, {gravity!r}, 0., 0., -1.\n"
        + "".join(print_all(name) for name in ("MIDDLE", "TOP", "BOTTOM"))
        + "*END STEP\n"
    )


# The slave side has as many facets, more, and fewer than the column: M is singular in each case in
# another way.
@pytest.mark.parametrize("facets", [(2, 2), (2, 3), (3, 2), (1, 5), (5, 1)])
def test_massless_column_follows_its_block(keyway, facets):
    run = keyway(column_deck(facets, sudden_weight(0.0)))
    middle, top, bottom = (run.csv(f"node_{name}") for name in ("MIDDLE", "TOP", "BOTTOM"))
    # Free fall is the exact start: the joint carries nothing yet. Round-off of M + eps K: 1e-9.
    assert bottom["A3"][0] == pytest.approx(-GRAVITY, rel=1e-9)
    largest = abs(bottom["A3"]).max()
    assert len(top["A3"]) == 51  # the start and 50 increments
    # The residual may be 1e-6 of the forces; the trapezoidal rule keeps what the start has wrong.
    for of_block, of_top in ((bottom, top), (top, middle)):
        share = OF_TOP if of_top is top else 0.5
        assert np.allclose(of_top["A3"], share * of_block["A3"], rtol=0, atol=1e-5 * largest)


def test_static_start_is_at_rest(keyway):
    """After its weight has come on in a static step, nothing moves in the dynamic one."""
    weight = f"*STEP\n*STATIC\n*DLOAD\nBLOCK, GRAV, {GRAVITY!r}, 0., 0., -1.\n*END STEP\n"
    still = "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n" + print_all("BOTTOM") + "*END STEP\n"
    run = keyway(column_deck((2, 3), weight + still))
    # The static residual may be 1e-6 of the weight.
    assert np.abs(run.csv("node_BOTTOM")["A3"]).max() < 1e-6 * GRAVITY


@pytest.mark.parametrize(("change", "starts_at_rest"), [(1e-5, False), (1e-7, True)])
def test_change_of_the_loads_at_the_start(keyway, change, starts_at_rest):
    """A weight that changes by less than *CONTROLS, RESIDUAL (1e-6) starts from rest. The first
    increment balances the change all the same: (1 + x) a_1 = a - x a_0 by the trapezoidal rule,
    with x = w^2 dt^2/4, and a_0 = a or 0."""
    weight = f"*STEP\n*STATIC\n*DLOAD\nBLOCK, GRAV, {GRAVITY!r}, 0., 0., -1.\n*END STEP\n"
    steps = weight + sudden_weight(0.0, (1 + change) * GRAVITY)
    a3 = keyway(column_deck((2, 3), steps)).csv("node_BOTTOM")["A3"]
    x = (YOUNG / HEIGHT) * OF_TOP / 2400.0 * 0.002**2 / 4  # springs in series; 2400 kg
    first = (1 if starts_at_rest else 1 - x) / (1 + x)
    # The block, 200 times as stiff as the column, makes 0.2 %.
    assert a3[0] == pytest.approx(-first * change * GRAVITY, rel=3e-3)
    assert np.abs(a3).max() == pytest.approx(change * GRAVITY, rel=0.02)


def test_joint_that_is_open_at_the_start(keyway):
    """The column stays at rest below a gap while its block falls."""
    run = keyway(column_deck((2, 3), sudden_weight(0.0), gap=0.1))
    top, bottom = run.csv("node_TOP"), run.csv("node_BOTTOM")
    flight = bottom["time"] < np.sqrt(2 * 0.1 / GRAVITY)
    assert flight.sum() > 40
    assert bottom["A3"][flight] == pytest.approx(-GRAVITY, rel=1e-6)
    assert np.abs(top["A3"][flight]).max() < 1e-6 * GRAVITY


def test_steps_in_a_row(keyway):
    """Four steps under one motion move a dam on massless rock as one step does. A new step starts
    with static forces on the rock, 1e5 times as large in the displacements as the motion; the
    acceleration of the rock begins anew there, which leaves a difference of second order."""
    short = ", DIRECT, ALPHA=0."  # with ALPHA the last acceleration is not that of a new start
    once = keyway(brick_on_rock.deck(fine(0.4, short)), name="once")
    later = 3 * fine(0.1, short, motion="")
    often = keyway(brick_on_rock.deck(fine(0.1, short) + later), name="often")
    whole, parts = (run.csv("node_CREST") for run in (once, often))
    size = np.abs(whole["U1"]).max()
    for name in ("U1", "U2", "U3"):
        assert parts[name] == pytest.approx(whole[name], abs=1e-3 * size)


PARTLY = """*HEADING
two bricks of rock without mass, tied to two of a dam that ends a little beyond the first
*NODE
{nodes}*ELEMENT, TYPE=C3D8I, ELSET=ROCK
1, 1, 2, 5, 4, 7, 8, 11, 10
2, 2, 3, 6, 5, 8, 9, 12, 11
*ELEMENT, TYPE=C3D8I, ELSET=DAM
3, 13, 14, 17, 16, 19, 20, 23, 22
4, 14, 15, 18, 17, 20, 21, 24, 23
*MATERIAL, NAME=STONE
*DAMPING, BETA=1e-3
*ELASTIC
30e9, 0.2
*SOLID SECTION, ELSET=ROCK, MATERIAL=STONE
*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
25e9, 0.2
*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*SURFACE, NAME=SOLE
DAM, S1
*SURFACE, NAME=GROUND
ROCK, S2
*TIE, NAME=FOOT
SOLE, GROUND
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
5, 1, 3
6, 1, 3
*NSET, NSET=EDGE
9, 12
"""


def partly_covered(cover: float) -> str:
    levels = [(-1.0, [0.0, 1.0, 2.0]), (0.0, [0.0, 1.0, 2.0])]
    levels += [(z, [0.0, 0.5 * (1.0 + cover), 1.0 + cover]) for z in (0.0, 1.0)]
    places = [(x, y, z) for z, row in levels for y in (0.0, 1.0) for x in row]
    return PARTLY.format(
        nodes="".join(f"{i}, {x!r}, {y!r}, {z!r}\n" for i, (x, y, z) in enumerate(places, start=1))
    )


@pytest.mark.parametrize("cover", [0.0, 0.02, 0.05, 0.2])
@pytest.mark.parametrize("dt", ["0.01", "0.0001"])
def test_rock_that_a_tie_covers_in_part(keyway, cover, dt):
    """A tie that covers 2 % of a facet leaves motions of the rock with nearly no mass, whose
    periods are far below any increment. A force that comes at once on the damped rock moves it by
    no more than twice what it does at rest; it was 1e6 times as much."""
    force = "*CLOAD\nEDGE, 3, -2e4\n*NODE PRINT, NSET=EDGE\nU, A\n"
    rest = keyway(partly_covered(cover) + f"*STEP\n*STATIC\n{force}*END STEP\n", name="rest")
    step = f"*STEP, INC=1000\n*DYNAMIC, DIRECT\n{dt}, 0.03\n{force}*END STEP\n"
    moved = keyway(partly_covered(cover) + step, name="moved")
    still = np.abs(rest.csv("node_EDGE")["U3"]).max()
    assert np.abs(moved.csv("node_EDGE")["U3"]).max() < 2.0 * still


def fine(*arguments, **options) -> str:
    return brick_on_rock.shaken(*arguments, **options).replace("0.01,", "0.0025,")
