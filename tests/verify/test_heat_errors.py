"""The estimated error of the mesh in thermal stresses, against true errors (theory.md, 14.1)."""

from __future__ import annotations

import numpy as np
import pytest
from heat_decks import (
    ALPHA,
    YOUNG,
    brick,
    components,
    last_rows,
    lines_of,
    model,
    statically,
    warm,
)
from test_mesh_error import points_of
from test_temperature import FORMULATIONS, WARMER, cylinder, radial
from tied_blocks import Blocks

NU = 0.2


def bricks_of(blocks: Blocks) -> np.ndarray:
    """The nodes of the elements of block A, in the order of the deck (elements, 8)."""
    n = blocks.nodes["A"]
    low, high = slice(None, -1), slice(1, None)
    corners = [(low, low), (high, low), (high, high), (low, high)]
    return np.stack([n[i, j, k].ravel() for k in (low, high) for i, j in corners], axis=-1)


def squared_norm(stress: np.ndarray, volume: np.ndarray) -> float:
    """The integral of stress : D^-1 : stress."""
    trace = stress[..., :3].sum(axis=-1)
    own = (stress[..., :3] ** 2).sum(axis=-1) + 2.0 * (stress[..., 3:] ** 2).sum(axis=-1)
    return float((volume * ((1.0 + NU) * own - NU * trace**2)).sum() / YOUNG)


def cylinder_stress(x: np.ndarray) -> np.ndarray:
    """Stress (..., 6) of test_temperature's cylinder, Timoshenko and Goodier, article 151.

    Equilibrium gives the radial stress from the hoop stress and the free faces; in plane strain
    the stress along the axis is nu times the sum of both less E alpha T.
    """
    r = np.hypot(x[..., 0], x[..., 1])
    t = WARMER * np.log(2.0 / r) / np.log(2.0)
    hoop = radial(r, NU)[1]
    # The sum of both stresses is C - alpha E T/(1 - nu), C from the outer face: radial 0, T 0.
    total = radial(np.array(2.0), NU)[1] - ALPHA * YOUNG * t / (1.0 - NU)
    across = total - hoop
    c, s, zero = x[..., 0] / r, x[..., 1] / r, np.zeros_like(r)
    sides = across * c**2 + hoop * s**2, across * s**2 + hoop * c**2
    axial = NU * total - ALPHA * YOUNG * t
    return np.stack([*sides, axial, (across - hoop) * c * s, zero, zero], axis=-1)


@FORMULATIONS
def test_a_cylinder_with_a_radial_field(keyway, element):
    """The estimate is within 10 % of the true error of the stresses; 8 elements a side."""
    blocks, supports = cylinder(8)
    field = lines_of(
        blocks, lambda x: 10.0 + WARMER * np.log(2.0 / np.hypot(*x.T[:2])) / np.log(2.0)
    )
    run = keyway(model(blocks, supports, element=element) + warm(field))
    points, volume = points_of(blocks.x, bricks_of(blocks))
    stress = components(last_rows(run, "el_BODY"), "S").reshape(len(points), -1, 6)
    exact = cylinder_stress(points)
    true = np.sqrt(squared_norm(exact - stress, volume))
    assert 0.02 < true / np.sqrt(squared_norm(exact, volume)) < 0.2
    estimate = run.json["accuracy"]["estimates"]["stress"]
    assert estimate["error"] / true == pytest.approx(1.0, abs=0.1)


@FORMULATIONS
def test_a_free_plate_with_a_gradient(keyway, element):
    """All stress is error but in C3D8I, which has none: the exact plate bends without stress."""
    blocks = brick((4, 4, 4))
    field = lines_of(blocks, lambda x: 10.0 + 40.0 * x[:, 2])
    run = keyway(model(blocks, statically(blocks), element=element) + warm(field))
    estimates = run.json["accuracy"]["estimates"]
    if element == "C3D8I":
        assert "stress" not in estimates
        return
    true = np.sqrt(2.0 * run.json["steps"][0]["energy"]["strain"])
    assert 0.5 < estimates["stress"]["error"] / true < 2.0


@FORMULATIONS
@pytest.mark.parametrize("value", [10.3, 12.7, 30.0])
def test_a_free_body_has_no_error(keyway, element, value):
    """Stress that is round-off has no estimate, whatever the sign of its energy."""
    blocks = brick((3, 3, 3))
    blocks.x += np.random.default_rng(3).uniform(-0.03, 0.03, blocks.x.shape)
    run = keyway(model(blocks, statically(blocks), element=element) + warm(value))
    assert "stress" not in run.json["accuracy"]["estimates"]
