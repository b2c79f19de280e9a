"""Joints between surfaces where points have jumps of their own and where they have not: on held
and tied nodes, on an edge that two joints share, in a plane state. The iteration on the joints
alone and the one on all unknowns are different equations with one answer.
"""

import subprocess

import numpy as np
import pytest
from joint_decks import static
from mesh_pairs import Pair, Side
from tied_blocks import Blocks, node_set, state_of, ties

ELASTIC = "*ELASTIC\n1e9, 0.2\n*DENSITY\n2000.\n"
LAW = "*JOINT LAW, NAME=LAW, FRICTION=0.4, KN=1e12, KT=4e11\n"
# of iterations that end at a residual of 1e-9
SAME = 1e-6


def joints(*pairs: tuple[str, str]) -> str:
    """*JOINT of pairs of surfaces, slave first."""
    cards = (f"*JOINT, NAME=J{i}, LAW=LAW\n{s}, {m}\n" for i, (s, m) in enumerate(pairs, 1))
    return LAW + "".join(cards)


def steps(static: str, dynamic: str, solver: str) -> str:
    """A load in two increments, then another one in time."""
    controls = f"*CONTROLS, JOINT SOLVER={solver}, RESIDUAL=1e-9, INCREMENT=1e-9\n"
    prints = "*NODE PRINT, NSET=ALL\nU, RF\n*JOINT PRINT, JOINT=J1\n*END STEP\n"
    text = f"*STEP\n*STATIC\n0.5, 1.\n{controls}{static}{prints}"
    return text + f"*STEP\n*DYNAMIC, DIRECT\n0.005, 0.05\n{controls}{dynamic}{prints}"


def cross() -> tuple[str, str, str]:
    """Four blocks on a floor; two of them are slaves of two joints, which meet at their edges."""
    blocks = Blocks()
    for name, (i, j), n in (("A", (0, 0), 3), ("B", (1, 0), 2), ("C", (1, 1), 3), ("D", (0, 1), 2)):
        blocks.add(name, (n, i, i + 1), (n, j, j + 1), (n, 0, 1))
    text = joints(("B_X0", "A_X1"), ("D_Y0", "A_Y1"), ("D_X1", "C_X0"), ("B_Y1", "C_Y0"))
    floor = np.concatenate([blocks.side(b, "Z0") for b in "ABCD"])
    text += node_set("BASE", floor) + "*BOUNDARY\nBASE, 1, 3\n"
    squeeze = "*DSLOAD\nA_X0, P, 3e5\nB_X1, P, 3e5\nA_Y0, P, 2e5\nD_Y1, P, 2e5\n"
    return blocks.deck({"": ELASTIC}, text), squeeze, "*DSLOAD\nA_Z1, P, 2e5\nC_Y1, P, -1e5\n"


def tied() -> tuple[str, str, str]:
    """Two blocks tied to a rock of another mesh, with a joint between them."""
    blocks = Blocks()
    blocks.add("ROCK", (3, 0, 4), (2, 0, 1), (1, 0, 1))
    blocks.add("L", (3, 0, 2), (3, 0, 1), (4, 1, 3))
    blocks.add("R", (2, 2, 4), (2, 0, 1), (3, 1, 3))
    text = ties(("L_Z0", "ROCK_Z1"), ("R_Z0", "ROCK_Z1")) + joints(("L_X1", "R_X0"))
    text += node_set("BASE", blocks.side("ROCK", "Z0")) + "*BOUNDARY\nBASE, 1, 3\n"
    return blocks.deck({"": ELASTIC}, text), "*DSLOAD\nL_X0, P, 2e5\n", "*DSLOAD\nL_X0, P, -1e5\n"


def plane() -> tuple[str, str, str]:
    """A block on another one, all nodes held along y: no point has jumps."""
    blocks = Blocks()
    blocks.add("BLOCK", (3, 0.5, 1.5), (1, 0, 1), (2, 1, 2))
    blocks.add("FLOOR", (5, 0, 2), (1, 0, 1), (2, 0, 1))
    text = joints(("BLOCK_Z0", "FLOOR_Z1")) + node_set("BASE", blocks.side("FLOOR", "Z0"))
    text += "*BOUNDARY\nALL, 2\nBASE, 1, 3\n"
    press = "*DSLOAD\nBLOCK_Z1, P, 1e5\n"
    return blocks.deck({"": ELASTIC}, text), press, "*DSLOAD\nBLOCK_X0, P, 6e4\n"


@pytest.mark.parametrize("make", [cross, tied, plane])
def test_condensed_and_full_iteration_agree(keyway, make):
    model, static, dynamic = make()
    runs = [
        keyway(model + steps(static, dynamic, solver), name=solver)
        for solver in ("CONDENSED", "FULL")
    ]
    for step in (1, 2):
        one, two = (state_of(run, "ALL", "U", step) for run in runs)
        assert np.abs(one - two).max() < SAME * np.abs(two).max()
    tables = [run.csv("joint_J1") for run in runs]
    for column in ("opening", "slip1", "slip2"):
        size = np.abs(tables[1]["slip1"]).max() + np.abs(tables[1]["opening"]).max()
        assert np.abs(tables[0][column] - tables[1][column]).max() < SAME * size
    # it iterates, and one solve an increment is enough
    assert runs[0].json["steps"][1]["iterations"] > runs[0].json["steps"][1]["increments"]
    calls = {part["name"]: part["calls"] for part in runs[0].json["ledger"]["parts"]}
    assert calls["solve forward structure"] >= 12
    assert "solve structure" not in calls
    assert runs[0].json["steps"][1]["energy"]["error"] < 1e-6


@pytest.mark.parametrize("make", [cross, tied, plane])
def test_forces_on_supports(keyway, make):
    """Reactions balance the loads, also through tied nodes."""
    model, static, dynamic = make()
    run = keyway(model + steps(static, dynamic, "AUTO").split("*STEP\n*DYNAMIC")[0])
    total = state_of(run, "ALL", "RF", 1).sum(axis=0)
    applied = {"cross": (0, 0, 0), "tied": (4e5, 0, 0), "plane": (0, 0, -1e5)}[make.__name__]
    assert np.abs(total + applied).max() < 1e-7 * 4e5


def test_missing_memory_is_reported(program_path, tmp_path):
    """A joint of 3721 points on a coarse master makes dense equations; the system allows 1.5 GB."""
    pair = Pair(Side((60, 60, 1)), Side((12, 12, 1)))
    joint = "*JOINT LAW, NAME=L, KN=1e12\n*JOINT, NAME=J, LAW=L\nLOWER, UPPER\n"
    step = static("*BOUNDARY\nFAR, 1, 3\n*DSLOAD\nTOP, P, 1e5\n")
    (tmp_path / "large.inp").write_text(pair.deck(joint + step))
    command = f"ulimit -v 1500000; exec '{program_path}' large.inp"
    run = subprocess.run(["sh", "-c", command], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 3
    assert "not enough memory in part 'analyse structure'" in run.stderr
