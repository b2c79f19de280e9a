"""Interfaces that are curved, the same for both blocks but for their facets: what stays exact.

A hypar c = 0.4 a b holds straight lines, so that facets of all grids along them lie in it. On
cylinders and bulges facets of different sizes lie apart by h^2 / 8 R.
"""

from __future__ import annotations

import numpy as np
import pytest
from brick_decks import order_of
from exact_fields import Field, uniform
from loaded_pairs import Loaded, at_end
from mesh_pairs import Pair, Side

SIZE = 1e6  # of a stress [Pa]
ANGLE = 1e-3  # of a rigid rotation
SHAPES = {
    "hypar": lambda a, b: 0.4 * (a - 0.5) * (b - 0.5),
    "cylinder": lambda a, b: np.sqrt(4.0 - (a - 0.5) ** 2) - 2.0 + 0.0 * b,
    "bulge": lambda a, b: 0.1 * np.sin(np.pi * a) * np.sin(np.pi * b),
}
TIE = "*TIE, NAME=J\n"
# Its jump t / k is 1e-10 of the displacement.
STIFF = "*JOINT LAW, NAME=L, KN=1e21, KT=1e21, TENSILE STRENGTH=1e15\n"
JOINT = STIFF + "*JOINT, NAME=J, LAW=L\n"
NONE = np.zeros(3)


def loaded_pair(shape: str, n: int) -> Loaded:
    """2 n against 3 n facets a side; pulled, sheared, pulled from all sides, turned."""
    surface = SHAPES[shape]
    pair = Pair(Side((2 * n, 2 * n, n), shape=surface), Side((3 * n, 3 * n, n), shape=surface))
    sheared = SIZE * np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    spin = ANGLE / np.sqrt(14.0) * np.array([[0, -1, 2], [1, 0, 3], [-2, -3, 0]])
    return Loaded(
        pair,
        {
            "PULLED": uniform(SIZE * np.diag([0.0, 0.0, 1.0]), pair, NONE),
            "SHEARED": uniform(sheared, pair, NONE),
            "SWOLLEN": uniform(SIZE * np.eye(3), pair, NONE),
            "TURNED": Field(lambda x: x @ spin.T, lambda x: np.zeros((*x.shape, 3))),
        },
    )


def run_pair(keyway, shape: str, n: int, way: str, slave: str) -> dict[str, float]:
    """Errors of the stress in energy, stress of the rotation over E times the angle, imbalance of
    forces and of moments about the origin, over SIZE times 1 m2 and 1 m3."""
    loaded = loaded_pair(shape, n)
    master = "UPPER" if slave == "LOWER" else "LOWER"
    deck = loaded.deck(f"{way}{slave}, {master}\n", "*NODE PRINT, NSET=FAR\nRF\n")
    run = keyway(deck, name=f"{shape}_{n}_{slave}")
    found = {name: loaded.energy_error(run, name) for name in loaded.fields if name != "TURNED"}
    found["TURNED"] = np.abs(loaded.found_stress(run, "TURNED")).max() / loaded.pair.young / ANGLE
    table = run.csv("node_FAR")
    now = at_end(table, 2)  # SHEARED
    far = table["node"][now].astype(int) - 1
    forces = loaded.forces("SHEARED")
    forces[far] = np.stack([table[f"RF{i}"][now] for i in (1, 2, 3)], axis=1)
    found["force"] = np.abs(forces.sum(axis=0)).max() / SIZE
    found["moment"] = np.abs(np.cross(loaded.pair.x, forces).sum(axis=0)).max() / SIZE
    return found


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
@pytest.mark.parametrize("way", [TIE, JOINT], ids=["tie", "joint"])
def test_facets_that_lie_in_one_surface(keyway, way, slave):
    """The hypar: uniform stresses are exact, rotations free of stress, forces and moments balance.

    1e-10 each, round-off (measured 2e-13), though the traction turns with the normal.
    """
    found = run_pair(keyway, "hypar", 2, way, slave)
    assert max(found.values()) < 1e-10


@pytest.mark.parametrize(
    "shape, way, slave",
    [("cylinder", JOINT, "LOWER"), ("cylinder", TIE, "UPPER"), ("bulge", JOINT, "UPPER")],
    ids=["cylinder, joint", "cylinder, tie", "bulge, joint"],
)
def test_facets_with_a_distance(keyway, shape, way, slave):
    """Forces balance to round-off. Moments do to the order h^2 of the distance, uniform stresses
    with an order above 1.4; a rotation leaves stresses of order h.
    """
    found = [run_pair(keyway, shape, n, way, slave) for n in (2, 4)]
    assert max(one["force"] for one in found) < 1e-10
    assert order_of((1.0, 0.5), [one["moment"] for one in found]) > 1.8
    for name in ("PULLED", "SHEARED", "SWOLLEN"):
        assert order_of((1.0, 0.5), [one[name] for one in found]) > 1.4
        assert found[0][name] < 0.01
    assert order_of((1.0, 0.5), [one["TURNED"] for one in found]) > 0.8
