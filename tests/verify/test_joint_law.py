"""The joint law in decks: tensile strength (Eq. 9), gap, friction and cohesion, one cube each."""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import Block, amplitude, static

STIFFNESS = 1e10  # k_n and k_t [Pa/m]
MODULUS = 2e10  # of a cube of 1 m: it gives way twice as little as the joint [Pa]
ROUND_OFF = 1e-9  # relative; the iteration stops at 1e-6, but these joints are linear by pieces


def moved_cube(law: str, dof: int, path: list[float], more: str = "", joint: str = "") -> str:
    """A cube on a joint whose top goes along a path of displacements, 10 increments a leg."""
    time = np.linspace(0.0, 1.0, len(path))
    cube = Block(
        (1.0, 1.0, 1.0),
        young=MODULUS,
        law=f"KN={STIFFNESS!r}, KT={STIFFNESS!r}{law}",
        joint=joint,
        cards=amplitude("PATH", time, np.array(path)),
    )
    size = 0.1 / (len(path) - 1)
    held = "".join(f"TOP, {other}, {other}, 0.\n" for other in (1, 2, 3) if other != dof)
    print_all = "*JOINT PRINT, JOINT=BED\n*NODE PRINT, NSET=TOP\nU, RF\n"
    moved = f"*BOUNDARY, AMPLITUDE=PATH\nTOP, {dof}, {dof}, 1.\n"
    free = "" if more else "*BOUNDARY\n" + held
    return cube.deck(static(more + free + moved + print_all, f"{size!r}, 1., , {size!r}"))


def first_point(run) -> dict[str, np.ndarray]:
    table = run.csv("joint_BED")
    assert np.all(np.ptp(table["tn"].reshape(-1, 4), axis=1) <= 1e-6 * np.max(np.abs(table["tn"])))
    return {name: column[table["point"] == 1] for name, column in table.items()}


@pytest.mark.parametrize("integration", ["NODES", "GAUSS"])
def test_strength_is_lost_permanently(keyway, integration):
    """Eq. 9; paper_notes.md, 4: linear to q_on, zero for good when open, k_n v when closed again.

    The cube (E/L = 2 k_n) shares its top's displacement u with the joint while that carries:
    traction = u / (1/k_n + L/E). Numbers to round-off.
    """
    strength = 1e6
    series = 1.0 / (1.0 / STIFFNESS + 1.0 / MODULUS)
    breaking = strength / series
    path = [0.0, 0.9 * breaking, -breaking, 0.99 * breaking, 2.0 * breaking, -breaking, breaking]
    choice = f", INTEGRATION={integration}"
    run = keyway(moved_cube(f", TENSILE STRENGTH={strength!r}", 3, path, joint=choice))
    point = first_point(run)
    opening, traction, state = point["opening"], point["tn"], point["state"]
    moved = np.interp(point["time"], np.linspace(0.0, 1.0, len(path)), path)
    broken = np.maximum.accumulate(moved) > breaking
    expected = np.where(broken, np.minimum(moved, 0.0), moved) * series
    scale = ROUND_OFF * strength
    assert traction == pytest.approx(expected, abs=scale)
    assert traction.max() <= strength * (1.0 + ROUND_OFF)
    law = STIFFNESS * np.where(broken, np.minimum(opening, 0.0), opening)
    assert traction == pytest.approx(law, abs=scale)
    assert set(state[~broken]) == {3.0}
    assert set(state[broken & (moved > 1e-12)]) == {0.0}
    assert set(state[broken & (moved < -1e-12)]) <= {1.0, 2.0}
    lost = run.csv("energy")["fracture"][-1]
    assert lost == pytest.approx(0.5 * strength**2 / STIFFNESS, rel=ROUND_OFF)


def test_gap_closes(keyway):
    """A gap of 1 mm: no force until the gap is closed, then two springs in series."""
    gap = 1e-3
    run = keyway(moved_cube(f", GAP={gap!r}", 3, [0.0, -3.0 * gap, 0.0]))
    point = first_point(run)
    moved = np.interp(point["time"], [0.0, 0.5, 1.0], [0.0, -3.0 * gap, 0.0])
    series = 1.0 / (1.0 / STIFFNESS + 1.0 / MODULUS)
    expected = np.minimum(moved + gap, 0.0) * series
    assert point["tn"] == pytest.approx(expected, abs=ROUND_OFF * 2.0 * gap * series)
    open_now = moved + gap > 1e-9
    assert point["opening"][open_now] == pytest.approx(moved[open_now] + gap, abs=1e-12)
    assert set(point["state"][open_now]) == {0.0}


@pytest.mark.parametrize(("friction", "cohesion"), [(0.0, 2e5), (0.6, 0.0), (0.5, 1e5)])
def test_shear_strength(keyway, friction, cohesion):
    """|t_t| <= mu p + c: a cube pressed by 1 MPa whose top is pushed along and back.

    It sticks with 1/k_t + L/G in series up to the limit; then the joint slides by the remainder.
    Sliding bends the cube and would load one edge more: its nodes move up and down together.
    """
    pressure = 1e6
    limit = friction * pressure + cohesion
    shear = 1.0 / (1.0 / STIFFNESS + 2.0 / MODULUS)
    far = 3.0 * limit / shear
    cards = f"*BOUNDARY\nBODY, 2, 2, 0.\n*BOUNDARY\nBODY, 3, 3, {-pressure / STIFFNESS!r}\n"
    law = f", FRICTION={friction!r}, COHESION={cohesion!r}"
    cube = Block(
        (1.0, 1.0, 1.0),
        young=MODULUS,
        law=f"KN={STIFFNESS!r}, KT={STIFFNESS!r}{law}",
        cards=amplitude("PATH", np.array([0.0, 0.5, 1.0]), np.array([0.0, far, -far])),
    )
    push = "*BOUNDARY, AMPLITUDE=PATH\nTOP, 1, 1, 1.\n*JOINT PRINT, JOINT=BED\n"
    run = keyway(cube.deck(static(cards) + static(cards + push, "0.05, 1., , 0.05")))
    point = first_point(run)
    there = point["step"] == 2
    moved = np.interp(point["time"][there] - 1.0, [0.0, 0.5, 1.0], [0.0, far, -far])
    expected, slip = elastic_slider(moved, shear, limit)
    assert point["tn"][there] == pytest.approx(-pressure, rel=ROUND_OFF)
    assert point["t1"][there] == pytest.approx(expected, abs=1e-6 * limit)
    assert point["slip1"][there] == pytest.approx(slip, abs=1e-6 * far)
    assert np.all(np.abs(point["t1"]) <= limit * (1.0 + ROUND_OFF))
    assert np.all(np.abs(point["t2"]) <= 1e-6 * limit)
    work = run.csv("energy")["friction"][-1]
    assert work == pytest.approx(limit * np.sum(np.abs(np.diff(slip))), rel=1e-6)


def elastic_slider(moved: np.ndarray, stiffness: float, limit: float):
    """Traction and slip of a spring in series with a slider, along a path."""
    traction, slip, slipped = np.zeros_like(moved), np.zeros_like(moved), 0.0
    for i, u in enumerate(moved):
        trial = stiffness * (u - slipped)
        traction[i] = np.clip(trial, -limit, limit)
        slipped = u - traction[i] / stiffness
        slip[i] = slipped
    return traction, slip
