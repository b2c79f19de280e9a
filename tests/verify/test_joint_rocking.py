"""Blocks that rock on joints: closed forms for small tilts, landings, and the balance of energy."""

from __future__ import annotations

import numpy as np
import pytest
from joint_decks import (
    BOTH_MESHES,
    GRAVITY,
    Block,
    amplitude,
    dynamic,
    initial,
    static,
    weight,
)
from joint_histories import history, sound_energy


def tall_block(law: str, cards: str, base_is_slave: bool = False, meshes=None) -> Block:
    """1 m wide, 4 m high, stiff; it moves in the plane x, z."""
    return Block(
        (1.0, 1.0, 4.0),
        young=1e12,
        law=law,
        base_is_slave=base_is_slave,
        meshes=meshes,
        cards="*BOUNDARY\nBODY, 2\n" + cards,
    )


@BOTH_MESHES
def test_quarter_period_of_rocking(keyway, meshes):
    """Free from a tilt of 0.01 on: quarter period sqrt(2 theta I / (W b)), I = 4/3 m (b^2 + h^2).

    Tolerance 0.1 %: the edge gives way by W / (k_n A/2) = 2e-6 m, 2e-4 of the lift, and rings.
    """
    tilt = 0.01
    block = tall_block("KN=1e11, KT=1e11, FRICTION=2.", "", meshes=meshes)
    placed = [(i, 1, -tilt * x[2]) for i, x in enumerate(block.x) if x[2]]
    placed += [(i, 3, tilt * x[0]) for i, x in enumerate(block.x) if x[0]]
    block.cards += initial("DISPLACEMENT", placed)
    hold = static(f"*BOUNDARY\nRIGHT_EDGE, 3, 3, {tilt}\n" + weight())
    free = "*BOUNDARY, OP=NEW\nBASE, 1, 3\nBODY, 2\n*JOINT PRINT, JOINT=BED\n"
    run = keyway(block.deck(hold + dynamic(free, 5e-4, 0.4)))
    balance = sound_energy(run)
    time, opening = history(run, 1.0)
    down = np.nonzero(opening <= 0.0)[0][0]
    quarter = np.interp(0.0, opening[[down, down - 1]], time[[down, down - 1]]) - 1.0
    exact = np.sqrt(2.0 * tilt * 4.0 / 3.0 * (0.5**2 + 2.0**2) / (GRAVITY * 0.5))
    assert exact == pytest.approx(0.15201, rel=1e-4)
    assert quarter == pytest.approx(exact, rel=1e-3)
    largest = balance["kinetic"].max()
    assert largest == pytest.approx(2400.0 * 4.0 * GRAVITY * tilt * 0.5, rel=0.02)
    assert balance["friction"][-1] < 0.02 * largest
    _, other = history(run, 0.0)
    assert other.max() < tilt  # it rises on the other side, not as high


@BOTH_MESHES
@pytest.mark.parametrize("base_is_slave", [False, True])
def test_rocking_starts_at_a_quarter_of_gravity(keyway, base_is_slave, meshes):
    """Base acceleration that grows to 0.3 g in 10 s: the edge lifts at g b / h = 0.25 g.

    The weight is then on the other edge, and the last line of points before that edge opens; a base
    of three facets as slave has lines at thirds, whose farthest opens sooner. Tolerance 0.1 % of g:
    one increment of 0.005 s is 1.5e-4 g, and the block follows within some.
    """
    last_line = 1.0 / 3.0 if meshes and base_is_slave else 1.0
    ramp = amplitude("RAMP", np.array([0.0, 10.0]), np.array([0.0, 0.3 * GRAVITY]))
    block = tall_block("KN=1e10, KT=1e10, FRICTION=2.", ramp, base_is_slave, meshes)
    shake = "*BASE MOTION, DOF=1, AMPLITUDE=RAMP, TYPE=ACCELERATION\n*JOINT PRINT, JOINT=BED\n"
    run = keyway(block.deck(static(weight()) + dynamic(shake, 0.005, 9.0)))
    sound_energy(run)
    time, opening = history(run, last_line)
    lifted = time[np.nonzero(opening > 0.0)[0][0]] - 1.0
    assert 0.3 * lifted / 10.0 == pytest.approx(0.25, abs=1e-3)
    assert history(run, 0.0)[1].max() < 0.0


@BOTH_MESHES
@pytest.mark.parametrize(("forces", "is_fed"), [("IMPLICIT", False), ("HHT", True)])
def test_energy_generated_by_the_time_stepping_is_reported(keyway, forces, is_fed, meshes):
    """A column shaken at 2 Hz that lifts. Joint forces weighted as the bulk generate 58 % of the
    largest energy here, the implicit impulse 0.6 %; the balance closes in both, to 1e-7."""
    time = np.linspace(0.0, 1.0, 201)
    shake = amplitude("SHAKE", time, 6.0 * np.sin(4.0 * np.pi * time))
    column = Block(
        (1.0, 1.0, 4.0),
        (1, 1, 4),
        young=2e10,
        law="KN=1e10, KT=1e10, FRICTION=2.",
        meshes=meshes,
        cards="*BOUNDARY\nBODY, 2\n" + shake,
    )
    cards = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, TYPE=ACCELERATION\n"
    cards += f"*CONTROLS, JOINT FORCES={forces}\n"
    run = keyway(column.deck(static(weight()) + dynamic(cards, 0.01, 1.0)), name=forces)
    assert any("has added more than a tenth" in text for text in run.json["warnings"]) == is_fed
    assert run.csv("energy")["error"].max() < 1e-6


@BOTH_MESHES
@pytest.mark.parametrize("friction", [0.7, 2.0])
@pytest.mark.parametrize(("stiffness", "dt"), [(1e10, 0.01), (1e11, 0.002), (1e13, 0.01)])
def test_shaken_block_lands_on_its_edges(keyway, friction, stiffness, dt, meshes):
    """A block that rocks at 0.6 g, 1.5 Hz, lands and slides: every increment converges.

    With friction above 5/3 the edge of a rigid box of this slenderness wedges when it slides; some
    landings then take more than the 15 iterations that are the default.
    """
    time = np.linspace(0.0, 3.0, 301)
    wave = 6.0 * np.sin(3.0 * np.pi * time) * (time < 2.0)
    law = f"KN={stiffness!r}, KT={0.5 * stiffness!r}, FRICTION={friction!r}"
    block = tall_block(law, amplitude("SHAKE", time, wave), meshes=meshes)
    block.young, block.counts = 25e9, (4, 1, 4)
    shake = "*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n*JOINT PRINT, JOINT=BED\n"
    if friction > 1.0:
        shake = "*CONTROLS, ITERATIONS=40\n" + shake
    run = keyway(block.deck(static(weight()) + dynamic(shake, dt, 3.0)))
    assert run.json["steps"][1]["cutbacks"] == 0
    table = run.csv("energy")
    assert table["error"].max() < 1e-3
    assert history(run, 0.0)[1].max() > 0.01 and history(run, 1.0)[1].max() > 0.01
