"""Uplift in joints whose faces come and go with *MODEL CHANGE (docs/different_meshes.md, 13.6).

A base of 4 m x 1 m stands on ground: A covers its first two metres, B the others; each is 2 m high.
While B is absent the diagram ends at the edge between A and B. All forces are closed forms: the
pressure of the reservoir falls linearly to none at the edge of the solids that are there. Both
faces of the joint are held: the reactions of the dam's sole are the forces of the water.
"""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from stage_decks import add, remove, step
from tied_blocks import CORNERS, Blocks, node_set

HEAD = 1000.0 * 9.81  # of a metre of water [Pa]
ROUND_OFF = {"rel": 1e-8}  # of heights and of the residual
KINDS = pytest.mark.parametrize("kind", ["elements", "matching", "different"])
POINTS = pytest.mark.parametrize("points", ["NODES", "GAUSS"])
LAKE = "*RESERVOIR, NAME=LAKE, SURFACE={}, LEVEL={}, BED=0.\n"
OUTPUT = "*NODE PRINT, NSET=DAM\nRF\n*NODE FILE\nU, OPENING\n"


def base(kind: str, law: str = "TENSILE STRENGTH=1e9", integration: str = "NODES") -> str:
    """The model: block G is the ground, A and B stand on it and share nodes."""
    columns = 4
    blocks = Blocks()
    blocks.add("G", (6 if kind == "different" else 2 * columns, 0, 4), (1, 0, 1), (1, -1, 0))
    blocks.add("A", (columns, 0, 2), (1, 0, 1), (1, 0, 2))
    blocks.add("B", (columns, 2, 4), (1, 0, 1), (1, 0, 2))
    blocks.share("A", "B")
    cards = node_set("GROUND", range(blocks.nodes["G"].size))
    cards += node_set("DAM", np.unique([blocks.side(name, "Z0") for name in "AB"]))
    cards += "*SURFACE, NAME=SOLE\nA, S1\nB, S1\n*SURFACE, NAME=ROOF\nG, S2\n"
    rule = f"*JOINT, NAME=J, LAW=LAW, INTEGRATION={integration}"
    faces = f"{rule}\nSOLE, ROOF\n"
    if kind == "elements":
        cards += joint_elements(blocks, columns)
        faces = f"{rule}, ELSET=J\n"
    cards += f"*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, UPLIFT=LAKE, {law}\n"
    cards += faces + "*BOUNDARY\nGROUND, 1, 3\nDAM, 1, 3\n"
    return blocks.deck({"": "*ELASTIC\n2e10, 0.\n"}, cards)


def joint_elements(blocks: Blocks, columns: int) -> str:
    """JOINT8 elements between G and the two blocks on it."""
    text = "*ELEMENT, TYPE=JOINT8, ELSET=J\n"
    ring = [c[:2] for c in CORNERS if c[2] == 0]
    for i in range(2 * columns):
        name, at = ("A", i) if i < columns else ("B", i - columns)
        below = [blocks.nodes["G"][i + a, b, 1] + 1 for a, b in ring]
        above = [blocks.nodes[name][at + a, b, 0] + 1 for a, b in ring]
        text += ", ".join(map(str, [900 + i, *below, *above])) + "\n"
    return text


def uplift(run, number: int) -> float:
    """Force of the water on the dam at the end of a step, up [N]."""
    rows = run.csv("node_DAM")
    here = rows["step"] == number
    here &= rows["increment"] == rows["increment"][here].max()
    return -float(rows["RF3"][here].sum())


def water(run, number: int) -> tuple[np.ndarray, np.ndarray]:
    """x and pressure of the points at the end of a step [Pa]."""
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file[f"steps/{number:04d}/increments"]
        values = increments[sorted(increments)[-1]]["joints/J/water"][:]
        return file["joints/J/x"][:, 0], values


def assert_diagram(
    run, number: int, edges: tuple[float, float], heads: tuple[float, float]
) -> None:
    """A straight line between heads [m] at two edges [m], nothing elsewhere, and its resultant.

    Points at nodes with linear weights add up to the resultant of a linear diagram (13.6).
    """
    x, found = water(run, number)
    share = (x - edges[0]) / (edges[1] - edges[0])
    within = (share > -1e-9) & (share < 1.0 + 1e-9)
    wanted = np.where(within, HEAD * (heads[0] + (heads[1] - heads[0]) * share), 0.0)
    assert found == pytest.approx(wanted, abs=1e-8 * HEAD)
    force = HEAD * (heads[0] + heads[1]) / 2.0 * (edges[1] - edges[0])
    assert uplift(run, number) == pytest.approx(force, **ROUND_OFF)


@KINDS
@POINTS
def test_the_diagram_ends_where_the_solids_end(keyway, kind, points):
    """B comes, leaves and comes again; the last step moves nothing but the level."""
    run = keyway(
        base(kind, integration=points)
        + step(remove("B") + LAKE.format("A_X0", 2.0) + OUTPUT)
        + step(add("B"))
        + step(remove("B"))
        + step(add("B") + LAKE.format("A_X0", 1.5))
    )
    assert_diagram(run, 1, (0.0, 2.0), (2.0, 0.0))
    assert_diagram(run, 2, (0.0, 4.0), (2.0, 0.0))
    assert_diagram(run, 3, (0.0, 2.0), (2.0, 0.0))
    assert_diagram(run, 4, (0.0, 4.0), (1.5, 0.0))
    assert max(s["energy"]["error"] for s in run.json["steps"]) < 1e-9
    effects = [(effect["kind"], effect["name"]) for effect in run.json["effects"]]
    assert len(effects) == len(set(effects)), "a reservoir of two levels is one effect"


@KINDS
@POINTS
def test_a_reservoir_at_an_interim_face(keyway, kind, points):
    """B is built first, with the water at its face towards A; then A comes."""
    run = keyway(
        base(kind, integration=points)
        + step(remove("A") + LAKE.format("B_X0", 1.0) + OUTPUT)
        + step(add("A") + LAKE.format("A_X0", 2.0))
    )
    assert_diagram(run, 1, (2.0, 4.0), (1.0, 0.0))
    assert_diagram(run, 2, (0.0, 4.0), (2.0, 0.0))


@KINDS
@POINTS
def test_tail_water_at_an_interim_face(keyway, kind, points):
    """The river stands at A while B is absent, then at B."""
    river = LAKE.replace("NAME=LAKE", "NAME=RIVER")
    run = keyway(
        base(kind, "TENSILE STRENGTH=1e9, TAIL WATER=RIVER", points)
        + step(remove("B") + LAKE.format("A_X0", 2.0) + river.format("A_X1", 0.5) + OUTPUT)
        + step(add("B") + river.format("B_X1", 1.0))
        + step(remove("B") + river.format("A_X1", 0.25))
    )
    assert_diagram(run, 1, (0.0, 2.0), (2.0, 0.5))
    assert_diagram(run, 2, (0.0, 4.0), (2.0, 1.0))
    assert_diagram(run, 3, (0.0, 2.0), (2.0, 0.25))


@KINDS
@POINTS
@pytest.mark.parametrize("first", ["A", "B"])
def test_water_in_an_open_joint_of_an_unfinished_base(keyway, kind, points, first):
    """A gap leaves all points open: the full head acts under the solids that are there, from the
    edge where the reservoir stands."""
    other = "B" if first == "A" else "A"
    run = keyway(
        base(kind, "GAP=0.01, PROFILE=OPEN", points)
        + step(remove(other) + LAKE.format(f"{first}_X0", 1.0) + OUTPUT)
        + step(add(other) + LAKE.format("A_X0", 2.0))
    )
    assert uplift(run, 1) == pytest.approx(HEAD * 1.0 * 2.0, **ROUND_OFF)
    assert uplift(run, 2) == pytest.approx(HEAD * 2.0 * 4.0, **ROUND_OFF)
