"""The pairs of blocks that the checks of different meshes use, where the meshes still match.

One welded mesh and pairs of JOINT8 show the accuracy of the elements alone: uniform stresses are
exact, beams converge with the orders that the theory of trilinear bricks gives.
"""

from __future__ import annotations

import numpy as np
import pytest
from brick_decks import order_of
from exact_fields import bending, sheared_across, sheared_along, uniform
from keyway_tools.box_mesh import quads
from loaded_pairs import Loaded
from mesh_pairs import Pair, Side, scattered


@pytest.mark.parametrize("element", ["C3D8", "C3D8I", "C3D8B", "C3D8R"])
def test_joint8_passes_on_uniform_stress(keyway, element):
    """Inner nodes at random, the pair at an angle: 1e-10, round-off and the digits of the
    tables."""
    side = Side((3, 4, 2), scattered(0.25, 1))
    pair = Pair(side, side, element=element)
    faces = (pair.low[:, :, -1], pair.high[:, :, 0])
    pair.mesh.joints = np.concatenate([np.array(quads(face)) for face in faces], axis=1)
    pair.mesh.joint_sets["J"] = np.arange(len(pair.mesh.joints))
    stress = 1e6 * np.array([[1.0, 0.4, -0.3], [0.4, -2.0, 0.5], [-0.3, 0.5, 1.5]])
    loaded = Loaded(pair, {"ALL": uniform(stress, pair, np.array([1 / 4e11, 1 / 4e11, 1 / 1e12]))})
    law = "*JOINT LAW, NAME=L, KN=1e12, KT=4e11, TENSILE STRENGTH=1e12\n"
    run = keyway(loaded.deck(law + "*JOINT, NAME=J, LAW=L, ELSET=J\n"))
    assert max(loaded.errors_of_uniform_stress(run)) < 1e-10


@pytest.mark.parametrize("solution", [bending, sheared_across, sheared_along])
def test_welded_beams_converge(keyway, solution):
    """C3D8: first order in energy, second in displacement (measured 0.97 to 0.98, 1.9 to 2.0)."""
    errors = {"energy": [], "displacement": []}
    for n in (2, 4):
        lies = solution is sheared_along
        side = Side((8 * n, n, n) if lies else (2 * n, n, 4 * n))
        pair = Pair(
            side,
            side,
            size=(4.0, 1.0) if lies else (1.0, 1.0),
            heights=(0.5, 0.5) if lies else (2.0, 2.0),
            poisson=0.3 if solution is bending else 0.0,
        )
        pair.weld()
        if lies:
            pair.hold_end()
        loaded = Loaded(pair, {"BEAM": solution(pair, 1e6)})
        run = keyway(loaded.deck(""), name=f"beam_{n}")
        errors["energy"].append(loaded.energy_error(run, "BEAM"))
        errors["displacement"].append(loaded.displacement_error(run, "BEAM"))
    assert order_of((1.0, 0.5), errors["energy"]) > 0.9
    assert order_of((1.0, 0.5), errors["displacement"]) > 1.8
