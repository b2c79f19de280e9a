"""Joints with more unknowns than the end of a factor holds: a dam with 40 joints of 1500 points.

In motion the unknowns of so many joints stand anywhere in the factor. The compliance of each group
comes from a part of the matrix near it, and solves with the whole matrix make up for the rest. The
full Newton method, which does neither, is the reference. Under weight 3000 points stand at the end
of the factor; of more points each joint is a separator.
"""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import make_dam
import numpy as np
import pytest
from tied_blocks import Blocks, node_set

SIZES = "--joints 40 --arc 82 --levels 14 --bottom 20 --thick 4 --no-rock"
LIFTS = (
    "--height 200 --crest-arc 500 --arc 44 --levels 16 --bottom 12 --thick 3 --refine 2 "
    "--joints 12 --lifts 4"
)
OPENING = (8, 9, 20, 21, 32, 33)  # of 40 joints; the others are grouted
GROUT = "*JOINT LAW, NAME=GROUT, THICKNESS=0.02, TENSILE STRENGTH=1e9, FRICTION=1, COHESION=1e9\n"
TIGHT = "*CONTROLS, {solver}RESIDUAL=1e-10, INCREMENT=1e-8, ERROR ESTIMATE=OFF"


def dam(folder: Path, solver: str = "", sizes: str = SIZES) -> str:
    """Weight and water, then 0.1 s of a motion of three components."""
    time = 0.01 * np.arange(20)
    files = []
    for k, axis in enumerate("xyz"):
        files.append(str(folder / f"motion_{axis}.txt"))
        np.savetxt(files[-1], 20.0 / (k + 1) * np.sin(10.0 * np.pi * time + k))
    options = ["--motion-unit", "M/S2", "--duration", "0.1", "--motion", *files]
    assert make_dam.main(["-o", str(folder / "dam.inp"), *sizes.split(), *options]) == 0
    mesh = (folder / "dam_mesh.inp").read_text()
    deck = (folder / "dam.inp").read_text().replace("*INCLUDE, INPUT=dam_mesh.inp\n", mesh)
    for first in ("*DLOAD", "*DAMPING"):  # of both steps
        deck = deck.replace(first, f"{TIGHT.format(solver=solver)}\n{first}")
    return deck.replace("INPUT=dam_motion", f"INPUT={folder}/dam_motion")


def histories(run) -> dict[str, np.ndarray]:
    """Openings, slips and tractions of all joints over the largest of their kind."""
    tables = {joint: run.csv(f"joint_{joint}") for joint in run.json["joints"]}
    found = {}
    for names in (("opening",), ("slip1", "slip2"), ("tn", "t1", "t2")):
        size = max(np.abs(table[name]).max() for table in tables.values() for name in names)
        found |= {f"{joint} {name}": table[name] / size
                  for joint, table in tables.items() for name in names}  # fmt: skip
    return found


def test_two_threads_find_the_same(keyway, tmp_path):
    """Joints open by millimetres, and the energy is balanced; 1e-8 as with the full method."""
    one, two = (keyway(dam(tmp_path), "-j", str(n), name=f"threads_{n}") for n in (1, 2))
    joints = one.json["joints"]
    assert sum(joint["points"] for joint in joints.values()) >= 1500
    assert max(one.csv(f"joint_{joint}")["opening"].max() for joint in joints) > 1e-3  # [m]
    assert abs(one.csv("energy")["error"][-1]) < 1e-9  # increments end at 1e-10
    other = histories(two)
    for name, values in histories(one).items():
        assert other[name] == pytest.approx(values, abs=1e-8), name


def test_joints_that_are_separators(keyway, tmp_path):
    """Weight and water on 3140 points. The dam is symmetric; the order of elimination is not."""
    head, weight, _ = dam(tmp_path, sizes=SIZES.replace("levels 14", "levels 30")).split("*STEP")
    head = head.replace("*JOINT LAW", f"{GROUT}*JOINT LAW", 1)
    for number in set(range(1, 41)) - set(OPENING):
        head = re.sub(rf"(\*JOINT, NAME=JOINT{number}, LAW=)CONTRACTION", r"\1GROUT", head)
    one, two = (
        keyway(f"{head}*STEP{weight}", "-j", str(n), name=f"separators_{n}") for n in (1, 2)
    )
    assert sum(joint["points"] for joint in one.json["joints"].values()) > 3000
    assert one.json["steps"][0]["cutbacks"] == 0
    for run in (one, two):
        found = {n: run.json["joints"][f"JOINT{n}"] for n in OPENING}
        for measure in ("opening", "slip"):
            largest = {n: joint[measure]["anywhere"]["value"] for n, joint in found.items()}
            size = max(largest.values())
            assert size > 1e-4  # [m]
            for n in OPENING[:3]:  # increments end at 1e-10
                assert abs(largest[n] - largest[41 - n]) < 1e-9 * size


@pytest.mark.full
def test_the_full_method_finds_the_same(keyway, tmp_path):
    """To 1e-8 of the largest value: increments end at 1e-10."""
    near = histories(keyway(dam(tmp_path), name="near"))
    full = histories(keyway(dam(tmp_path, "JOINT SOLVER=FULL, "), name="full"))
    for name, values in full.items():
        assert near[name] == pytest.approx(values, abs=1e-8), name


def test_lifts_and_water_on_grouted_joints(keyway, tmp_path):
    """Grouted points touch without traction, and so do those of a new lift: all are closed in the
    first iterate. Where round-off decided which were open, the weight of the lift took four
    cut-backs after 120 iterations each. Under water points near the edge of friction change their
    states one after the other, with nearly the same residual: no cycle. As a cycle they led to ten
    cut-backs after 590 iterations each.
    """
    options = f"{LIFTS} --temperatures 1e-5 20 10 --grouting 2 4 -o {tmp_path / 'dam.inp'}"
    assert make_dam.main(options.split()) == 0
    head, *steps = (tmp_path / "dam.inp").read_text().split("*STEP")
    mesh = (tmp_path / "dam_mesh.inp").read_text()
    deck = "*STEP".join([head.replace("*INCLUDE, INPUT=dam_mesh.inp\n", mesh), *steps[:9]])
    found = {step["name"]: step for step in keyway(deck).json["steps"]}
    for name in ("LIFT3", "WATER"):
        assert (found[name]["increments"], found[name]["cutbacks"]) == (1, 0)
        assert found[name]["iterations"] <= 15  # as with JOINT SOLVER=FULL


def test_a_joint_between_held_faces(keyway):
    """A group without free unknowns has no part of the matrix, beside 13 joints that have one. The
    gaps stay open, and each block moves as it does alone.
    """
    names = [chr(ord("A") + i) for i in range(16)]
    blocks = Blocks()
    for i, name in enumerate(names):
        blocks.add(name, (1, 3.0 * i, 3.0 * i + 3.0), (10, 0.0, 8.0), (10, 0.0, 10.0))
    base = np.concatenate([blocks.side(name, "Z0") for name in names])
    held = node_set("HELD", np.concatenate([blocks.nodes[name].ravel() for name in "OP"]))
    pairs = [pair for pair in pairwise(names) if pair != ("N", "O")]
    joints = "*JOINT LAW, NAME=LAW, KN=1e11, KT=1e11, FRICTION=0.5, GAP=0.01\n" + "".join(
        f"*JOINT, NAME=J{b}, LAW=LAW\n{b}_X0, {a}_X1\n" for a, b in pairs
    )
    cards = f"{node_set('BASE', base)}{held}*BOUNDARY\nBASE, 1, 3\nHELD, 1, 3\n{joints}"
    deck = blocks.deck({"": "*DENSITY\n2400.\n*ELASTIC\n2e10, 0.2\n"}, cards)
    deck += (
        "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.03\n*CONTROLS, ERROR ESTIMATE=OFF, RESIDUAL=1e-8\n"
        "*DLOAD\nBODY, GRAV, 1., 1., 0., 0.\n*JOINT PRINT, JOINT=JB\nOPENING\n"
        "*JOINT PRINT, JOINT=JP\nOPENING\n*END STEP\n"
    )
    run = keyway(deck)
    assert sum(joint["points"] for joint in run.json["joints"].values()) == 14 * 121
    assert run.json["displacement"]["anywhere"]["value"] > 1e-6  # [m]
    # Blocks side by side move alike, so that gaps stay but for round-off of 1e-4 m and for
    # half of RESIDUAL as a force on closed joints; held ones, too.
    for joint in ("JB", "JP"):
        assert run.csv(f"joint_{joint}")["opening"] == pytest.approx(0.01, abs=1e-12), joint
