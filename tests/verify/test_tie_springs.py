"""*TIE with STIFFNESS: springs on the segments of two surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from exact_fields import uniform
from loaded_pairs import Loaded
from mesh_pairs import Pair, Side, graded, scattered

SPRINGS = 2e12  # [Pa/m]
STRESS = 1e6 * np.array([[1.0, 0.4, -0.3], [0.4, -2.0, 0.5], [-0.3, 0.5, 1.5]])  # [Pa]


@pytest.mark.parametrize("names", ["LOWER, UPPER", "UPPER, LOWER"])
@pytest.mark.parametrize("wedges", [False, True])
def test_opening_is_traction_over_stiffness(keyway, names, wedges):
    """Uniform stress crosses bricks or wedges against lots; 1e-10, round-off."""
    pair = Pair(Side((7, 6, 1), graded(10.0), wedges=wedges), Side((4, 5, 1), scattered(0.25, 5)))
    loaded = Loaded(pair, {"ALL": uniform(STRESS, pair, np.full(3, 1.0 / SPRINGS))})
    run = keyway(loaded.deck(f"*TIE, NAME=T, STIFFNESS={SPRINGS!r}\n{names}\n"))
    assert max(loaded.errors_of_uniform_stress(run)) < 1e-10
    assert [effect["kind"] for effect in run.json["effects"]][-1] == "coupling"
    (cover,) = run.json["interfaces"]
    assert cover["kind"] == "tie" and cover["largest_gap"] < 1e-14
    assert abs(cover["covered_area"] / cover["slave_area"] - 1.0) < 1e-12
