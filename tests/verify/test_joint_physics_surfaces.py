"""Friction, strength, gap and cohesion of joints between different meshes, against closed forms.

A stiff block (k_n height / E = 1e-4) on a base; its top is moved. Matching meshes with JOINT8
elements have the same tests.
"""

import numpy as np
import pytest
from block_decks import MESHES, Pair, joint_state
from joint_decks import static

K = 1e9  # k_n = k_t [Pa/m]
SOFT = 3e-4  # of a value: the block's own strain, k height / E for either, and the solver's 1e-6
OUTPUT = "*NODE FILE\nU, OPENING\n"
meshes = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())
base_is_slave = pytest.mark.parametrize("base_is_slave", [False, True])


def moved(*motions: tuple[float, float, float]) -> str:
    """Static steps that move the whole block from place to place."""
    steps = []
    for number, motion in enumerate(motions):
        data = "".join(f"BODY, {i}, {i}, {u!r}\n" for i, u in enumerate(motion, start=1))
        steps.append(static(f"*BOUNDARY\n{data}{OUTPUT}", "0.5, 1.", f"S{number}"))
    return "".join(steps)


@meshes
@base_is_slave
def test_friction(keyway, mesh, base_is_slave) -> None:
    """Pressed, then slid to and fro in a skew direction: stick, slip, stick back, slip back.

    p = 1e6 Pa, mu = 0.5: slips at 5e-4 m, from there on with 5e5 Pa. The work of friction is what
    slides times mu p.
    """
    pair = Pair(law=f"KN={K}, KT={K}, FRICTION=0.5", base_is_slave=base_is_slave, **mesh)
    way = np.array([0.6, 0.8])
    places = (2e-4, 2e-3, 1.6e-3, 0.0)
    motions = [(0.0, 0.0, -1e-3)] + [(*(u * way).tolist(), -1e-3) for u in places]
    run = keyway(pair.deck(moved(*motions)))
    wanted = (0.0, 2e5, 5e5, 1e5, -5e5)
    side = -1.0 if base_is_slave else 1.0
    for number, shear in enumerate(wanted, start=1):
        found = joint_state(run, number)
        traction = side * np.einsum("pik,pi->pk", found["rotation"], found["traction"])
        assert traction[:, 2] == pytest.approx(-1e6, rel=SOFT)
        assert traction[:, :2] @ way == pytest.approx(shear, rel=SOFT, abs=SOFT * 5e5)
    slid = (2e-3 - 5e-4) + (1.5e-3 - 5e-4)  # and back: from 2e-3, sticking 1e-3 m
    work = 5e5 * slid * pair.area
    assert run.json["steps"][-1]["energy"]["friction"] == pytest.approx(work, rel=1e-3)
    assert run.json["steps"][-1]["energy"]["error"] < 1e-6


@meshes
@base_is_slave
def test_tensile_strength(keyway, mesh, base_is_slave) -> None:
    """Bonded up to 1e5 Pa at 1e-4 m, then free; closed again, compression without tension."""
    law = f"KN={K}, KT={K}, FRICTION=0.5, TENSILE STRENGTH=1e5"
    pair = Pair(law=law, base_is_slave=base_is_slave, **mesh)
    run = keyway(pair.deck(moved(*[(0.0, 0.0, u) for u in (9.9e-5, 1.5e-4, -1e-4, 5e-5)])))
    for number, normal in enumerate((9.9e4, 0.0, -1e5, 0.0), start=1):
        found = joint_state(run, number)
        assert found["traction"][:, 0] == pytest.approx(normal, rel=SOFT, abs=1e-6)
        assert (found["state"] == 3).all() == (number == 1)
    broken = 0.5 * 1e5 * 1e-4 * pair.area
    assert run.json["steps"][-1]["energy"]["fracture"] == pytest.approx(broken, rel=SOFT)


@meshes
def test_strength_point_by_point(keyway, mesh) -> None:
    """Rotated about one edge the joint breaks where its opening exceeds q/k."""
    pair = Pair(law=f"KN={K}, KT={K}, TENSILE STRENGTH=1e5", **mesh)
    turn = 1.0e-4  # opens 2e-4 m at x = 2: points beyond x = 1 break
    x = [(i, j, k) for i in (0.0, 1.0, 2.0) for j in (0.0, 0.5, 1.0) for k in (0.0, 1.0)]
    if mesh["counts"][0] == 3:
        x = [(2 * i / 3, j / 3, k) for i in range(4) for j in range(4) for k in (0.0, 1.0)]
    lines = "".join(
        f"{n}, 1, 1, {-turn * p[2]!r}\n{n}, 2, 2, 0.\n{n}, 3, 3, {turn * p[0]!r}\n"
        for n, p in enumerate(x, start=1)
    )
    run = keyway(pair.deck(static(f"*BOUNDARY\n{lines}{OUTPUT}", "0.1, 1.")))
    found = joint_state(run)
    opening = turn * found["x"][:, 0]
    assert found["opening"] == pytest.approx(opening, abs=SOFT * turn)
    clear = abs(opening - 1e-4) > 1e-7
    assert (found["traction"][clear & (opening > 1e-4), 0] == 0.0).all()
    bonded = clear & (opening < 1e-4)
    assert found["traction"][bonded, 0] == pytest.approx(K * opening[bonded], abs=SOFT * 1e5)


@meshes
@base_is_slave
def test_gap(keyway, mesh, base_is_slave) -> None:
    """No force until the gap is closed, then k (u - g) and friction."""
    pair = Pair(law=f"KN={K}, KT={K}, FRICTION=0.5, GAP=1e-3", base_is_slave=base_is_slave, **mesh)
    run = keyway(pair.deck(moved((3e-4, 0.0, -9e-4), (3e-4, 0.0, -1.4e-3), (4e-4, 0.0, -1.4e-3))))
    shears = (0.0, 0.0, 1e5)  # 1e-4 m sticking; 2e5 Pa would slip
    for number, (normal, shear) in enumerate(zip((0.0, -4e5, -4e5), shears, strict=True), start=1):
        found = joint_state(run, number)
        assert found["traction"][:, 0] == pytest.approx(normal, rel=SOFT, abs=1e-6)
        size = np.hypot(*found["traction"][:, 1:].T)
        assert size == pytest.approx(shear, rel=1e-3, abs=SOFT * 4e5)


@meshes
@base_is_slave
def test_block_falls_through_its_gap(keyway, mesh, base_is_slave) -> None:
    """Nothing but the joint holds the block up; a hundred times its weight closes the gap.

    In between the block has no contact and moves far, which must not increase the residual (1e-6).
    """
    pair = Pair(
        size=(1.0, 1.0, 1.0),
        young=2e10,
        law="KN=1e12, FRICTION=0.6, GAP=1e-3",
        base_is_slave=base_is_slave,
        **mesh,
    )
    steps = static("*DLOAD\nBLOCK, GRAV, 981., 0., 0., -1.\n" + OUTPUT, "1., 1.")
    found = joint_state(keyway(pair.deck(steps)))
    assert -found["force"][0] == pytest.approx(1e2 * pair.weight, rel=1e-6)
    assert (found["traction"][:, 0] < 0.0).all()


@meshes
def test_cohesion(keyway, mesh) -> None:
    """mu p + c: 0.5 * 2e5 + 3e5 Pa; without pressure c alone; open: zero."""
    pair = Pair(law=f"KN={K}, KT={K}, FRICTION=0.5, COHESION=3e5", **mesh)
    run = keyway(
        pair.deck(
            moved((0.0, 0.0, -2e-4), (3.9e-4, 0.0, -2e-4), (1e-3, 0.0, -2e-4), (1e-3, 0.0, 1e-5))
        )
    )
    for number, shear in enumerate((0.0, 3.9e5, 4e5, 0.0), start=1):
        found = joint_state(run, number)
        size = np.hypot(*found["traction"][:, 1:].T)
        assert size == pytest.approx(shear, rel=SOFT, abs=1e-6)
