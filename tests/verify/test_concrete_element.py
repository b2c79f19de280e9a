"""One element in tension: Table 1 of the paper; the stiffness of cracks that close (Eqs. 15-16)."""

from __future__ import annotations

import numpy as np
import pytest
from concrete_decks import TABLE_1, Bar, force_of, paper_concrete, pull

YOUNG = 25e9  # [Pa], paper_notes.md, 11
ELEMENTS = ("C3D8", "C3D8B", "C3D8I", "C3D8R")
SIDE = 1.0  # [m]


@pytest.mark.parametrize("element", ELEMENTS)
def test_table_1(keyway, element):
    """The rows of Table 1 are returned: sigma at eps = eps_ck + sigma / E_0 (paper_notes.md, 11).

    The curve is exact at the rows, where an increment ends; what is left is the iteration (1e-6 of
    the forces). 0.2 % is allowed.
    """
    strain = TABLE_1[:, 1] + TABLE_1[:, 0] / YOUNG
    bar = Bar(paper_concrete(), length=SIDE, side=SIDE, element=element)
    run = keyway(bar.deck(pull(strain * SIDE, dt=0.1)))
    displacement, force = force_of(run)
    stress = np.interp(strain * SIDE, displacement, force) / SIDE**2
    apart = np.abs(stress / TABLE_1[:, 0] - 1.0).max()
    assert apart < 1e-4
    damage = run.csv("el_WEAK")
    last = damage["time"] == damage["time"].max()
    assert damage["DAMAGET"][last] == pytest.approx(0.964, abs=1e-4)


def slope(displacement, force, first, last) -> float:
    """Stiffness [Pa] between two strains of a curve."""
    inside = [k for k, u in enumerate(displacement) if min(first, last) <= u <= max(first, last)]
    return float(np.polyfit(displacement[inside], force[inside], 1)[0]) / SIDE


@pytest.mark.parametrize("recovery", ["LEE-FENVES", "SIGN"])
@pytest.mark.parametrize("w_c", [0.0, 0.5, 1.0])
def test_cracks_close(keyway, recovery, w_c):
    """Unloading from a crack has (1 - d_t) E_0; compression (1 - (1 - w_c) d_t) E_0 (Eqs. 15-16).

    d_t from Table 1 at the strain of its fourth row. In uniaxial stress both weights r switch at
    zero stress; the slopes are those of straight lines, exact to the iteration.
    """
    top = TABLE_1[3, 1] + TABLE_1[3, 0] / YOUNG
    d_t, sigma = TABLE_1[3, 2], TABLE_1[3, 0]
    closed = top - sigma / ((1.0 - d_t) * YOUNG)  # the plastic strain
    bar = Bar(paper_concrete(recovery=recovery, w_c=w_c), length=SIDE, side=SIDE)
    path = [top, closed, closed - 2e-4]
    displacement, force = force_of(keyway(bar.deck(pull(path, dt=0.05))))
    steps = len(displacement) // 3
    down = slice(steps, 2 * steps)
    unloading = slope(displacement[down], force[down], closed + 1e-6, top - 1e-6)
    pressed = slice(2 * steps, None)
    pressing = slope(displacement[pressed], force[pressed], closed - 2e-4, closed - 1e-5)
    assert unloading == pytest.approx((1.0 - d_t) * YOUNG, rel=1e-4)
    assert pressing == pytest.approx((1.0 - (1.0 - w_c) * d_t) * YOUNG, rel=1e-4)


@pytest.mark.parametrize("w_t", [0.0, 0.5, 1.0])
def test_tension_after_crushing(keyway, w_t):
    """Tension after crushing has (1 - d_t)(1 - (1 - w_t) d_c) E_0 (Eqs. 15-16; paper_notes.md, 7).

    Crushed to an inelastic strain of 1e-3 where d_c = 0.4 and the strength is 30 MPa; then unloaded
    and pulled, below its tensile strength, so that d_t = 0.
    """
    crushing = ((0.0, 0.0), (0.4, 1e-3), (0.6, 4e-3))
    concrete = paper_concrete(crushing=crushing, w_t=w_t)
    bar = Bar(concrete, length=SIDE, side=SIDE)
    bottom = -(1e-3 + 30e6 / YOUNG)
    loose = bottom + 30e6 / (0.6 * YOUNG)
    stiffness = (1.0 - (1.0 - w_t) * 0.4) * YOUNG
    path = [bottom, loose, loose + 1e6 / stiffness]
    displacement, force = force_of(keyway(bar.deck(pull(path, dt=0.05))))
    steps = len(displacement) // 3
    back, pulled = slice(steps, 2 * steps), slice(2 * steps, None)
    unloading = slope(displacement[back], force[back], bottom + 1e-6, loose - 1e-6)
    pulling = slope(displacement[pulled], force[pulled], loose + 1e-7, path[2])
    assert force[steps - 1] == pytest.approx(-30e6 * SIDE**2, rel=1e-4)
    assert unloading == pytest.approx(0.6 * YOUNG, rel=1e-4)
    assert pulling == pytest.approx(stiffness, rel=1e-4)
