"""A bar breaks in its weak element: curve and energy do not depend on the number of elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from concrete_decks import Bar, Concrete, force_of, paper_concrete, pull, work_of
from joint_decks import dynamic, static

YOUNG, STRENGTH, FRACTURE = 25e9, 2.48e6, 150.0  # [Pa], [Pa], [N/m]
LENGTH, SIDE = 0.5, 0.1  # [m]; the bar itself snaps back above 1.219 m
AREA = SIDE**2
LAST_OPENING = 2.0 * FRACTURE / STRENGTH  # 121 um
# A dilation with which cracks open without moving sideways: 3/2 S_2 / q + tan(psi) / 3 = 0, nearly
STRAIGHT = (56.2, 0.0001, 1.125, 2.0 / 3.0, 0.0)
DAMAGES = (0.5, 0.9)  # at the end of the softening


def broken_bar(keyway, num_rest: int, element: str = "C3D8", weakness: float = 0.97, **constants):
    """Run of a bar of 1 + num_rest equal elements whose middle one is weaker.

    With increments of 0.05 s one of C3D8I takes 61 iterations or is cut, as round-off has it.
    """
    weak = Concrete(young=YOUNG, tension_type="GFI", tension=((STRENGTH, FRACTURE),), **constants)
    rest = replace(weak, tension=((STRENGTH / weakness, FRACTURE),))
    bar = Bar(weak, rest, LENGTH, SIDE, num_rest, weak_at=num_rest // 2, element=element)
    path = [STRENGTH / YOUNG * LENGTH, 1.05 * LAST_OPENING]
    return keyway(bar.deck(pull(path, largest=0.025)), name=f"bar{num_rest}")


def closed_form(displacement: np.ndarray) -> np.ndarray:
    """Force [N] of the whole bar: elastic up to the strength, then u = sigma L / E + w."""
    softening = STRENGTH / LAST_OPENING
    cracked = (STRENGTH - softening * displacement) / (1.0 - softening * LENGTH / YOUNG)
    stress = np.minimum(YOUNG * displacement / LENGTH, np.maximum(cracked, 0.0))
    return AREA * stress


def measure(run) -> tuple[float, float, float]:
    """Largest distance from the closed form over the strength; work and dissipation over G_f A."""
    displacement, force = force_of(run)
    apart = np.abs(force - closed_form(displacement)).max() / (AREA * STRENGTH)
    step = run.json["steps"][-1]
    dissipated = step["energy"]["fracture"] / (FRACTURE * AREA)
    work = work_of(displacement, force) / (FRACTURE * AREA)
    return float(apart), work, dissipated


@pytest.mark.parametrize("num_rest", [1, 5, 20])
@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_the_mesh_does_not_matter(keyway, documented, num_rest, element):
    """Force against displacement within 1 % of the strength, energy G_f A within 1 %.

    Reference: the closed form of a linear cohesive crack in an elastic bar.
    """
    run = broken_bar(keyway, num_rest, element, poisson=0.0, flow=STRAIGHT)
    apart, work, dissipated = measure(run)
    documented("bar", element, f"1 + {num_rest}", apart, dissipated)
    assert apart < 0.01
    assert work == pytest.approx(1.0, abs=0.01)
    assert dissipated == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("num_rest", [1, 5, 20])
@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_keeps_the_energy(keyway, documented, num_rest, damage):
    """The same with damage that grows with the opening: damage affects unloading alone."""
    table = ((0.0, 0.0), (damage, LAST_OPENING))
    run = broken_bar(keyway, num_rest, poisson=0.0, flow=STRAIGHT, damage=table)
    apart, work, dissipated = measure(run)
    documented("bar", f"C3D8, damage up to {damage}", f"1 + {num_rest}", apart, dissipated)
    assert apart < 0.01
    assert work == pytest.approx(1.0, abs=0.01)
    assert dissipated == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("num_rest", [1, 5, 20])
def test_fixed_sides(keyway, num_rest):
    """The paper's dilation (32.5 deg): the cracked element contracts laterally, the undamaged
    elements prevent this, and it cracks in all directions at once. There Eq. 19 has the strength

        (1 - alpha) c / ((c / t) (1 - alpha) - 1 + 2 alpha) = 1.079 t      (30 MPa, 2.48 MPa)

    so that the energy is G_f A or up to 8 % more (and 1 % for the corners of bricks).
    """
    run = broken_bar(keyway, num_rest, weakness=0.85)
    _, work, dissipated = measure(run)
    assert 0.99 < work < 1.09
    assert 0.99 < dissipated < 1.09


def test_more_load_than_strength(keyway):
    """Under a prescribed force a bar has no equilibrium beyond its strength: the run stops there,
    within 1e-4, with a message, and keeps its results.
    """
    load = 1.5 * STRENGTH * AREA / 4.0
    bar = Bar(paper_concrete(), None, LENGTH, SIDE, num_rest=3)
    step = static(f"*CLOAD\nRIGHT, 1, {load!r}\n*NODE PRINT, NSET=RIGHT\nU\n", "0.1, 1.")
    run = keyway(bar.deck(step), code=1)
    assert run.json["status"] == "stopped"
    assert "no equilibrium" in run.json["message"]
    last = run.csv("node_RIGHT")
    assert last["time"][-1] == pytest.approx(1.0 / 1.5, abs=1e-4)
    assert last["U1"][-1] == pytest.approx(STRENGTH / YOUNG * LENGTH, rel=1e-3)


def test_bar_that_snaps_back(keyway):
    """5 m are more than 2 E G_f / f_t^2 = 1.219 m: in statics the cracked bar has no near
    equilibrium, and a warning reports the jump to the broken bar. In motion it breaks with G_f A.
    The halves separate with 2 f_t / (rho c) = 0.64 m/s, so that the crack opens in 0.19 ms:
    increments of 10 us follow it, larger ones dissipate more. The residual strength of f_t/1000
    adds its work over an opening of 1 mm: 2 % of G_f A.
    """
    weak = Concrete(
        young=YOUNG,
        poisson=0.0,
        density=2400.0,
        flow=STRAIGHT,
        tension_type="GFI",
        tension=((STRENGTH, FRACTURE),),
    )
    rest = replace(weak, tension=((2.0 * STRENGTH, 4.0 * FRACTURE),))
    bar = Bar(weak, rest, 5.0, SIDE, num_rest=9, weak_at=4)
    jump = keyway(bar.deck(pull([6e-4])), name="at_rest")
    assert any("jumped from one equilibrium" in warning for warning in jump.json["warnings"])
    last = 5.0 * STRENGTH / YOUNG
    moving = "*BOUNDARY, AMPLITUDE={}\nRIGHT, 1, 1, 1.\n*NODE PRINT, NSET=RIGHT\nU, RF\n"
    ramp = f"*AMPLITUDE, NAME=SLOW\n0., 0., 1., {0.99 * last!r}\n"
    ramp += f"*AMPLITUDE, NAME=ON\n0., {0.99 * last!r}, 0.002, {1.02 * last!r}\n"
    steps = static(moving.format("SLOW"), "0.1, 1.")
    steps += dynamic(moving.format("ON"), 1e-5, 0.004).replace(", DIRECT", "")
    run = keyway(bar.deck(ramp + steps), name="in_motion")
    table = run.csv("energy")
    assert table["fracture"][-1] == pytest.approx(FRACTURE * AREA, rel=0.02)
    assert table["error"].max() < 1e-3
