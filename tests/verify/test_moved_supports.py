"""A body strained by its supports alone: the reference force is that of the reactions."""

import numpy as np
from brick_decks import brick_deck, elastic, last_state
from keyway_tools.box_mesh import box_mesh, stretched


def test_a_strained_block_is_at_rest_in_statics_and_dynamics(keyway):
    """A cube between a fixed and a lowered face, sides held: linear; 1e-12 of it is round-off."""
    mesh, number = box_mesh((2, 2, 2), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BOTTOM"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:, :, -1].ravel()
    cards = elastic(25.0e9, 0.2, 2400.0) + "*BOUNDARY\nALL, 1, 2\nBOTTOM, 3, 3\n"
    cards += "*STEP\n*STATIC\n*BOUNDARY\nTOP, 3, 3, -1.e-3\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    cards += "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*END STEP\n"
    run = keyway(brick_deck(mesh, "C3D8", cards))
    u = last_state(run, "ALL")
    assert np.abs(u[:, 2] + 1.0e-3 * mesh.x[:, 2]).max() < 1e-15
    assert [step["increments"] for step in run.json["steps"]] == [1, 10]
