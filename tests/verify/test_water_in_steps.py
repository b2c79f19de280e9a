"""Water that comes and goes with the steps: a reservoir that grows with the dam, meets joints whose
lifts are absent, and is emptied.

Three lifts of 1 m are 2 m long and 1 m wide, of one brick each, with a joint below the second and
the third one. Joint points are at nodes: full head upstream, none downstream.
"""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import pyvista
from stage_decks import add, remove, step
from tied_blocks import Blocks, node_set

HEAD = 1000.0 * 9.81  # of a metre of water [Pa]
OUTPUT = "*NODE PRINT, NSET=BASE\nRF\n*NODE FILE\nU, OPENING\n*JOINT PRINT, JOINT=J3\n"
LAKE = "*RESERVOIR, NAME=LAKE, SURFACE={}, LEVEL={}, BED=0.{}\n"
EMPTY = ", HYDROSTATIC=NO"
ROUND_OFF = {"rel": 1e-9, "abs": 1e-6}  # of heights and of the residual


def lifts(law: str = "UPLIFT=LAKE") -> str:
    """The model; U1, U2 and U3 are the upstream faces up to each lift, D3 the whole one behind."""
    blocks = Blocks()
    for i in (1, 2, 3):
        blocks.add(f"L{i}", (1, 0, 2), (1, 0, 1), (1, i - 1, i))
    cards = node_set("BASE", blocks.side("L1", "Z0"))
    for name, face, top in (("U1", "S6", 1), ("U2", "S6", 2), ("U3", "S6", 3), ("D3", "S4", 3)):
        cards += f"*SURFACE, NAME={name}\n" + "".join(f"L{i}, {face}\n" for i in range(1, top + 1))
    cards += f"*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, TENSILE STRENGTH=1e9, {law}\n"
    cards += "".join(f"*JOINT, NAME=J{i}, LAW=LAW\nL{i}_Z0, L{i - 1}_Z1\n" for i in (2, 3))
    return blocks.deck({"": "*ELASTIC\n2e10, 0.\n"}, cards + "*BOUNDARY\nBASE, 1, 3\n")


def water(run, number: int, name: str, upstream: bool = True) -> np.ndarray:
    """Water at the points on one edge of a joint at the end of a step [Pa]."""
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file[f"steps/{number:04d}/increments"]
        values = increments[sorted(increments)[-1]][f"joints/{name}/water"][:]
        return values[np.isclose(file[f"joints/{name}/x"][:, 0], 0.0 if upstream else 2.0)]


def push(run) -> np.ndarray:
    """The horizontal force on the base in each increment [N]."""
    return -run.csv("node_BASE")["RF1"].reshape(-1, 4).sum(axis=1)


def of_reservoirs(run) -> list[str]:
    """Warnings of *RESERVOIR."""
    return [text for text in run.json["warnings"] if "*RESERVOIR: " in text]


@pytest.mark.parametrize("surfaces", [("U1", "U2", "U3"), ("U3", "U3", "U3")])
def test_the_surface_grows_with_the_dam(keyway, surfaces):
    """U1 does not reach the upper joint; the water is that of a surface named as a whole."""
    first, second, third = surfaces
    river = "*RESERVOIR, NAME=RIVER, SURFACE=D3, LEVEL=2.2, BED=0.\n"
    run = keyway(
        lifts("UPLIFT=LAKE, TAIL WATER=RIVER")
        + step(remove("L2", "L3") + LAKE.format(first, 0.5, "") + OUTPUT)
        + step(add("L2") + LAKE.format(second, 1.5, ""))
        + step(add("L3") + LAKE.format(third, 3.0, "") + river)
    )
    found = {(s, j): water(run, s, j) / HEAD for s in (1, 2, 3) for j in ("J2", "J3")}
    heads = {(1, "J2"): 0, (1, "J3"): 0, (2, "J2"): 0.5, (2, "J3"): 0, (3, "J2"): 2, (3, "J3"): 1}
    for key, head in heads.items():
        assert found[key] == pytest.approx([head, head], **ROUND_OFF), key
    tail = water(run, 3, "J3", upstream=False) / HEAD
    assert tail == pytest.approx([0.2, 0.2], **ROUND_OFF)
    forces = np.array([0.5**2, 1.5**2, 3.0**2 - 2.2**2]) / 2.0 * HEAD
    table = run.csv("node_BASE")
    ends = [np.nonzero(table["step"][::4] == s)[0][-1] for s in (1, 2, 3)]
    assert push(run)[ends] == pytest.approx(forces, rel=1e-8)


def test_no_water_in_a_joint_that_is_absent(keyway):
    """In all results; once its lift is there the joint has the water."""
    deck = lifts() + step(remove("L3") + LAKE.format("U3", 3.0, "") + OUTPUT)
    absent = keyway(deck, name="absent")
    assert water(absent, 1, "J3") == pytest.approx([0.0, 0.0], abs=0.0)
    assert water(absent, 1, "J2") == pytest.approx([2.0 * HEAD] * 2, **ROUND_OFF)
    largest = {name: joint["water"]["anywhere"] for name, joint in absent.json["joints"].items()}
    assert largest["J2"]["value"] == pytest.approx(2.0 * HEAD, rel=1e-9)
    assert largest["J3"]["value"] == pytest.approx(0.0, abs=0.0)
    (picture,) = (absent.folder / "absent_vtk").glob("absent_joints_0*.vtu")
    fields = pyvista.read(picture).point_data
    there = fields["GROUTED"] > 0
    assert not fields["WATER"][~there].any()
    assert fields["WATER"][there].max() == pytest.approx(2.0 * HEAD, rel=1e-6)  # single precision
    built = keyway(deck + step(add("L3")), name="built")
    assert water(built, 2, "J3") == pytest.approx([HEAD, HEAD], **ROUND_OFF)


def test_a_reservoir_is_emptied(keyway):
    """The card again with HYDROSTATIC=NO: the pressure and the uplift end, without a warning; then
    another reservoir may stand at the surface."""
    quarters = "0.25, 1.\n"
    empty = LAKE.format("U3", 3.0, EMPTY)
    deck = lifts() + step(LAKE.format("U3", 3.0, "") + OUTPUT) + step(empty, data=quarters)
    other = "*RESERVOIR, NAME=POND, SURFACE=U3, LEVEL=2., BED=0.\n"
    run = keyway((deck + step(other)).replace("*STATIC\n0.25", "*STATIC, DIRECT\n0.25"))
    assert not of_reservoirs(run)
    full = 4.5 * HEAD
    wanted = [full, 0.75 * full, 0.5 * full, 0.25 * full, 0.0, 2.0 * HEAD]
    assert push(run) == pytest.approx(wanted, rel=1e-8, abs=1e-8 * full)
    assert water(run, 1, "J2") == pytest.approx([2.0 * HEAD] * 2, **ROUND_OFF)
    assert water(run, 2, "J2") == pytest.approx([0.0, 0.0], abs=1e-6)
    again = keyway(deck + step(empty), name="again")
    (warning,) = of_reservoirs(again)
    assert "has no effect: HYDROSTATIC=NO" in warning


def joined(bricks: tuple, moved: tuple, faces: str) -> str:
    """Two blocks with joint J across the river, one brick thick from the lake to the tail water.

    PART is the upstream face of the first brick of each block, UP and DOWN the whole faces.
    """
    blocks = Blocks()
    blocks.add("A", (1, 0, 2), *bricks)
    blocks.add("B", (1, 0, 2), *moved)
    second = 1 + (blocks.nodes["A"].shape[1] - 1) * (blocks.nodes["A"].shape[2] - 1)
    cards = f"*SURFACE, NAME=PART\n1, S6\n{second}, S6\n"
    cards += "*SURFACE, NAME=UP\nA, S6\nB, S6\n*SURFACE, NAME=DOWN\nA, S4\nB, S4\n"
    cards += "*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, TENSILE STRENGTH=1e9, UPLIFT=LAKE, "
    cards += f"TAIL WATER=RIVER\n*JOINT, NAME=J, LAW=LAW\n{faces}\n"
    cards += node_set("BASE", np.nonzero(blocks.x[:, 2] == 0.0)[0])
    return blocks.deck({"": "*ELASTIC\n2e10, 0.\n"}, cards + "*BOUNDARY\nBASE, 1, 3\n")


LIFT = joined(((4, 0, 4), (1, 0, 1)), ((4, 0, 4), (1, 1, 2)), "B_Z0, A_Z1")
UPRIGHT = joined(((1, 0, 1), (3, 0, 3)), ((1, 1, 2), (3, 0, 3)), "B_Y0, A_Y1")


@pytest.mark.parametrize("model", [LIFT, UPRIGHT], ids=["lift", "upright"])
@pytest.mark.parametrize("way", ["*STATIC", "*DYNAMIC"])
def test_tail_water_where_the_lake_grows_along_the_joint(keyway, model, way):
    """The lake has its own head alone at its edge, in each step: the diagram of the tail water ends
    at the edge of the step. Over a static step the water goes from the one diagram to the other."""
    river = "*RESERVOIR, NAME=RIVER, SURFACE=DOWN, LEVEL={}, BED=0.\n"
    run = keyway(
        model.replace("*ELASTIC", "*DENSITY\n2400.\n*ELASTIC")
        + step(LAKE.format("PART", 2.0, "") + river.format(1.8) + OUTPUT.replace("J3", "J"))
        + step(LAKE.format("UP", 3.0, "")).replace("*STATIC\n", f"{way}, DIRECT\n0.5, 1.\n")
        + step(river.format(2.5))
    )
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        x, y, z = file["joints/J/x"][:].T
        part, growing, risen = (
            [group["joints/J/water"][:] / HEAD for _, group in sorted(step["increments"].items())]
            for _, step in sorted(file["steps"].items())
        )
    is_upstream = x == 0.0
    is_wet = is_upstream & ((y if model is LIFT else z) <= 1.0)  # in the first step
    assert part[-1][is_wet] == pytest.approx(2.0 - z[is_wet], **ROUND_OFF)
    for found, tail in ((growing[-1], 1.8), (risen[-1], 2.5)):
        wanted = np.maximum(np.where(is_upstream, 3.0, tail) - z, 0.0)
        assert found == pytest.approx(wanted, **ROUND_OFF)
    halfway = (part[-1] + growing[-1]) / 2.0 if way == "*STATIC" else growing[-1]
    assert growing[0] == pytest.approx(halfway, **ROUND_OFF)
