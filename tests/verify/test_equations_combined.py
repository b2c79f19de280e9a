"""Equations beside cracks, joints, stages and checkpoints: nodes that equations hold together move
as one node does."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest
from keyway_tools.results import Results
from stopped_runs import stop_after

LAYERS = 4  # of the column; equations hold layer 3 to layer 2
CUT = 2
CONCRETE = """\
*MATERIAL, NAME=C
*DENSITY
2400.
*ELASTIC
2e10, 0.2
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
2e7, 0.
*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT
1e5, 0.
1e3, 3e-4
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, 3e-4
"""
JOINT = "*JOINT LAW, NAME=L, FRICTION=0.7, KN=1e10, KT=5e9\n*JOINT, NAME=BED, LAW=L, ELSET=BED\n"
# The models have the same unknowns; elimination and sums differ by round-off, which the residuals
# of 1e-10 let pass.
SAME = 1e-7


def column(*, cut: bool, steps: str) -> str:
    """A column of cubes on a joint; its upper half has the nodes of the lower one, or its own."""
    x = [(i, j) for j in (0.0, 1.0) for i in (0.0, 1.0)]
    nodes, solids = [], []

    def layer(first: int, z: float) -> list[int]:
        nodes.extend(f"{first + k}, {p[0]}, {p[1]}, {z}" for k, p in enumerate(x))
        return [first, first + 1, first + 3, first + 2]

    ground = layer(901, 0.0)
    levels = [layer(1 + 4 * k, float(k)) for k in range(LAYERS + 1)]
    upper = layer(501, float(CUT)) if cut else levels[CUT]
    for k in range(LAYERS):
        low = upper if k == CUT else levels[k]
        solids.append(f"{k + 1}, " + ", ".join(map(str, low + levels[k + 1])))
    bed = ", ".join(map(str, ground + levels[0]))
    text = "*NODE\n" + "\n".join(nodes) + "\n*ELEMENT, TYPE=C3D8, ELSET=ALL\n" + "\n".join(solids)
    text += f"\n*ELEMENT, TYPE=JOINT8, ELSET=BED\n99, {bed}\n*ELSET, ELSET=UPPER\n3, 4\n"
    text += "*NSET, NSET=TOP, GENERATE\n17, 20\n*NSET, NSET=MID, GENERATE\n9, 12\n"
    text += "*NSET, NSET=FOOT, GENERATE\n1, 4\n*NSET, NSET=GROUND, GENERATE\n901, 904\n"
    if cut:
        text += "*NSET, NSET=OWN, GENERATE\n501, 504\n*EQUATION\n"
        text += "".join(f"2\nOWN, {i}, 1., MID, {i}, -1.\n" for i in (1, 2, 3))
    text += CONCRETE + "*SOLID SECTION, ELSET=ALL, MATERIAL=C\n" + JOINT
    return text + "*BOUNDARY\nGROUND, 1, 3\n" + steps


def step(procedure: str, cards: str) -> str:
    prints = (
        "*NODE PRINT, NSET=TOP\nU, RF\n*NODE PRINT, NSET=MID\nU\n*EL PRINT, ELSET=ALL\nS, DAMAGET\n"
    )
    controls = "*CONTROLS, RESIDUAL=1e-10\n"
    return f"*STEP, INC=500\n{procedure}\n{controls}{cards}{prints}*END STEP\n"


WEIGHT = "*DLOAD\nALL, GRAV, 9.81, 0., 0., -1.\n"
PULL = "*BOUNDARY\nFOOT, 1, 3\nTOP, 3, 3, 2e-4\n"
SHAKE = "*AMPLITUDE, NAME=A\n0., 0., 0.02, 1., 0.05, -1., 0.1, 0.8, 0.15, 0.\n"
QUAKE = step("*DYNAMIC, DIRECT\n0.002, 0.15", "*BASE MOTION, DOF=1, AMPLITUDE=A, SCALE=9.\n")
CASES = {
    "cracks": step("*STATIC\n0.1, 1., 1e-3, 0.1", WEIGHT + PULL),
    "joint in motion": SHAKE + step("*STATIC", WEIGHT) + QUAKE,
    "stages": step("*STATIC", "*MODEL CHANGE, REMOVE\nUPPER\n" + WEIGHT)
    + step("*STATIC", "*MODEL CHANGE, ADD\nUPPER\n")
    + step("*STATIC", "*CLOAD\nTOP, 1, 1e3\n"),
}


@pytest.mark.parametrize("case", CASES)
def test_equals_common_nodes(keyway, case):
    runs = [keyway(column(cut=cut, steps=CASES[case]), name=f"cut{cut:d}") for cut in (False, True)]
    for name in ("node_TOP", "node_MID", "el_ALL"):
        one, other = (run.csv(name) for run in runs)
        for key in one:
            scale = np.abs(one[key]).max()
            if key[0] == "S" and key[1:].isdigit():
                scale = np.abs(one["S33"]).max()
            if key[0] == "U":
                scale = max(np.abs(one[f"U{i}"]).max() for i in (1, 2, 3))
            assert other[key] == pytest.approx(one[key], abs=SAME * max(scale, 1e-30)), (name, key)
    if case == "cracks":
        assert runs[1].csv("el_ALL")["DAMAGET"].max() > 0.3
    if case == "joint in motion":
        assert runs[1].json["joints"]["BED"]["opening"]["anywhere"]["value"] > 1e-5
    assert all(s["energy"]["error"] < 1e-6 for s in runs[1].json["steps"])


def test_continued_run(keyway, program_path, tmp_path):
    """A run with equations, a joint and cracks that is stopped and goes on: the same bits."""
    steps = CASES["joint in motion"].replace("*DYNAMIC", "*RESTART, WRITE, FREQUENCY=5\n*DYNAMIC")
    steps = steps.replace("0.002, 0.15", "0.0005, 0.15")
    whole = keyway(column(cut=True, steps=steps)).csv("node_TOP")
    folder, file = tmp_path / "parts", tmp_path / "job.inp"
    assert stop_after(program_path, folder, file, 30)
    subprocess.run([program_path, "-q", "-j", "1", "-o", folder, "--continue", file], check=True)
    parts = Results(folder, "job").table("node_TOP")
    assert all(np.array_equal(whole[name], parts[name]) for name in whole)
