"""The error that increments leave in the law of concrete, from twins of points whose increments are
halved, against runs with much finer increments."""

import numpy as np
import pytest
from brick_decks import brick_deck
from concrete_decks import Concrete, paper_concrete
from keyway_tools.box_mesh import box_mesh, stretched

FINE = 64  # times the increments
# The largest strain and shear of the path; the shear comes while the crack opens.
PATHS = {"shear follows": (3e-4, 8e-4), "crushing": (-4e-3, 2e-3)}
CONCRETE = {"shear follows": paper_concrete(), "crushing": Concrete(
    compression=((20e6, 0.0), (30e6, 1e-3), (6e6, 6e-3)),
    crushing=((0.0, 0.0), (0.1, 1e-3), (0.7, 6e-3)),
)}  # fmt: skip


def led(path: str, increments: int, count: int = 1) -> str:
    """A block whose surface moves as under a uniform strain: first along x, then shear is added."""
    mesh, number = box_mesh((count, count, count), stretched((1.0, 1.0, 1.0)))
    inside = set(number[1:-1, 1:-1, 1:-1].ravel().tolist())
    surface = [node for node in range(len(mesh.x)) if node not in inside]
    mesh.node_sets["SURFACE"] = np.array(surface)
    stretch, shear = PATHS[path]

    def moved(dof: int, size: float) -> str:
        return "".join(
            f"{node + 1}, {dof}, {dof}, {float(size * mesh.x[node, 0])!r}\n" for node in surface
        )

    cards = CONCRETE[path].cards("STUFF") + "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF\n"
    cards += "*AMPLITUDE, NAME=FIRST\n0., 0., 0.5, 0.6, 1., 1.\n"
    cards += "*AMPLITUDE, NAME=LATER\n0., 0., 0.3, 0., 1., 1.\n"
    cards += "*BOUNDARY\nSURFACE, 3, 3\n*STEP, INC=100000\n"
    cards += f"*STATIC, DIRECT\n{1.0 / increments!r}, 1.\n"
    cards += f"*BOUNDARY, AMPLITUDE=FIRST\n{moved(1, stretch)}"
    cards += f"*BOUNDARY, AMPLITUDE=LATER\n{moved(2, shear)}*END STEP\n"
    return brick_deck(mesh, "C3D8", cards)


@pytest.mark.parametrize("path", PATHS)
def test_dissipated_energy(keyway, documented, path):
    """One element: the law has its strains, and nothing else has an error."""
    fine = keyway(led(path, 20 * FINE))
    true = sum(fine.json["damage"]["dissipated"].values())
    for increments in (20, 40, 80):
        run = keyway(led(path, increments))
        found, own = run.json["accuracy"]["estimates"]["law"], run.json["damage"]["dissipated"]
        assert found["value"] == pytest.approx(sum(own.values()))
        effectivity = found["relative"] / abs(sum(own.values()) / true - 1.0)
        assert 0.5 < effectivity < 2.0
        documented("error of the law", path, f"{increments}", effectivity)


def test_crushed_block(keyway, documented):
    """27 elements, whose inside finds its own strains."""
    true = sum(keyway(led("crushing", 20 * FINE, 3)).json["damage"]["dissipated"].values())
    for increments in (20, 40):
        run = keyway(led("crushing", increments, 3))
        found, own = run.json["accuracy"]["estimates"]["law"], run.json["damage"]["dissipated"]
        effectivity = found["relative"] / abs(sum(own.values()) / true - 1.0)
        assert 0.5 < effectivity < 2.0
        documented("error of the law", "crushing, 27 elements", f"{increments}", effectivity)


def test_a_crushed_place_has_no_error(keyway):
    """The largest compression is that of crushing concrete: no estimate holds there."""
    deck = led("crushing", 20, 3).replace("*END STEP", "*ENVELOPE\nS3\n*END STEP")
    found = keyway(deck).json["accuracy"]["estimates"]
    assert found["S3"]["not_known"] == "the solid has left elasticity"
    assert 0.0 <= found["stress"]["elastic_volume"] <= 1.0


def test_a_step_without_estimates(keyway):
    """The twins miss its increments: nothing is said of the law afterwards."""
    deck = led("crushing", 10)
    step = deck[deck.index("*STEP") :].replace("FIRST", "KEPT").replace("LATER", "KEPT")
    steps = step.replace("*BOUNDARY", "*CONTROLS, ERROR ESTIMATE=OFF\n*BOUNDARY", 1) + step
    deck = deck.replace("*STEP", "*AMPLITUDE, NAME=KEPT\n0., 1., 1., 1.\n*STEP") + steps
    assert "law" not in keyway(deck).json["accuracy"]["estimates"]


def test_switched_off(keyway):
    path = "*BOUNDARY, AMPLITUDE=FIRST"
    run = keyway(led("crushing", 10).replace(path, f"*CONTROLS, ERROR ESTIMATE=OFF\n{path}"))
    assert run.json["accuracy"]["estimates"] == {}
    assert not any(part["name"].startswith("estimate") for part in run.json["ledger"]["parts"])
