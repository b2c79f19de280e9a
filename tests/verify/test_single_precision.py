"""*CONTROLS, PRECISION=SINGLE and MIXED: the results of a factor in double precision.

A solve leaves at most 0.3 of the admissible residual (theory.md, 8). With RESIDUAL=1e-6 forces are
exact to 1e-6 of the largest force, and so are displacements and openings of a dam, whose increments
are well conditioned. With smaller residuals the agreement follows.
"""

import dataclasses
import re

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from dam_trials import DeckOptions, Trial, run_trial
from harness import ROOT
from keyway_tools.box_mesh import box_mesh

SINGLE = "*CONTROLS, PRECISION=SINGLE"
MIXED = "*CONTROLS, PRECISION=MIXED"
PLAIN = "*CONTROLS"


def shaken(controls: str, **changes) -> Trial:
    """A dam whose first step, and all after it, have some controls."""
    trial = Trial(duration=1.5, options=DeckOptions(), **changes)
    return dataclasses.replace(trial, edits=(("*STATIC", f"{controls}\n*STATIC"),))


def difference(first, second, columns) -> float:
    return max(
        np.abs(first[name] - second[name]).max() / np.abs(first[name]).max() for name in columns
    )


def solutions_in_single(run) -> int:
    """How many solutions the copy of PRECISION=MIXED has given."""
    log = (run.folder / f"{run.job}.log").read_text()
    return int(re.search(r"(\d+) of the last \d+ solutions in single precision", log)[1])


@pytest.mark.parametrize("kind", [SINGLE, MIXED])
@pytest.mark.parametrize(
    ("residual", "threads", "apart"), [("1e-6", 1, 1e-6), ("1e-9", 1, 1e-8), ("1e-9", 2, 1e-8)]
)
def test_jointed_dam(keyway, kind, residual, threads, apart):
    """Openings and displacements of a dam whose joints open and slide."""
    sharp = f", RESIDUAL={residual}, INCREMENT=1e-9"
    double, single = (
        run_trial(keyway, shaken(controls + sharp), "-j", str(threads), name=name)
        for controls, name in ((PLAIN, "double"), (kind, "single"))
    )
    assert np.abs(double.csv("joint_JOINT1")["opening"]).max() > 1e-3
    for table, columns in (("node_CROWN_CREST", ("U1", "U2", "U3")), ("joint_JOINT1", ["opening"])):
        assert difference(double.csv(table), single.csv(table), columns) <= apart


@pytest.mark.parametrize(("kind", "apart"), [(SINGLE, 1e-7), (MIXED, 1e-6)])
def test_dam_without_joints(keyway, kind, apart):
    """With SINGLE, smooth increments are exact to more digits than RESIDUAL asks for."""
    double, single = (
        run_trial(keyway, shaken(controls, num_joints=0), name=name)
        for controls, name in (("*CONTROLS, RESIDUAL=1e-6", "double"), (kind, "single"))
    )
    if kind == MIXED:
        assert solutions_in_single(single) > 0
    tables = [run.csv("node_CROWN_CREST") for run in (double, single)]
    assert difference(*tables, ("U1", "U2", "U3")) <= apart


LENGTH = 10.0  # of the strip [m]


def plate(thickness: float, element: str, controls: str) -> str:
    """A strip of 10 m by 1 m, clamped at one end, under its weight."""

    def place(a, b, c):
        return np.stack([LENGTH * a, b, thickness * c], axis=-1)

    mesh, number = box_mesh((40, 4, 1), place)
    mesh.node_sets["ROOT"] = number[0].ravel()
    mesh.node_sets["TIP"] = number[-1].ravel()
    steps = f"""*BOUNDARY
ROOT, 1, 3
*STEP
{controls}
*STATIC
*DLOAD
BODY, GRAV, 9.81, 0., 0., -1.
*NODE PRINT, NSET=TIP
U
*END STEP
"""
    return brick_deck(mesh, element, elastic(30.0e9, 0.2, 2400.0) + steps)


def tips(keyway, thickness: float, element: str) -> list[np.ndarray]:
    decks = [plate(thickness, element, kind + ", RESIDUAL=1e-9") for kind in (PLAIN, SINGLE)]
    runs = [keyway(deck, name=name) for deck, name in zip(decks, ("double", "single"), strict=True)]
    return [run.csv("node_TIP")["U3"] for run in runs]


@pytest.mark.parametrize("element", ["C3D8", "C3D8I"])
@pytest.mark.parametrize("thickness", [1e-1, 1e-2])
def test_thin_plate(keyway, thickness, element):
    """Bending is (length/thickness)^4 times as flexible as the stiffest deformation of an element.

    A factor in single precision knows nothing of bending then. The refined solution differs from
    that of a factor in double precision by the round-off of the latter: epsilon times that number.
    """
    double, single = tips(keyway, thickness, element)
    apart = max(1e-8, np.finfo(float).eps * (LENGTH / thickness) ** 4)
    assert np.abs(double - single).max() <= apart * np.abs(double).max()


def test_thinnest_plate(keyway):
    """The strip is symmetric; the displacements of its long edges differ by round-off.

    The difference of two solutions is at most the sum of the round-off of both.
    """
    double, single = tips(keyway, 1e-3, "C3D8")
    asymmetry = abs(double[0] - double[-1]) + abs(single[0] - single[-1])
    assert 1e-6 * abs(double[0]) < asymmetry < 1e-4 * abs(double[0])
    assert np.abs(double - single).max() <= asymmetry


@pytest.mark.parametrize("kind", [SINGLE, MIXED])
def test_cracking_monolith(keyway, kind):
    """Concrete that cracks: with SINGLE every iteration on the solids solves for all unknowns.

    RESIDUAL=1e-9 is exact to 1e-9 of the forces; cracks that open and close make up to 1e-5 of it.
    """
    source = ROOT / "input" / "cracking_monolith.inp"
    motion = source.with_name("cracking_monolith_motion.txt")
    text = source.read_text().replace("0.01, 6.,", "0.01, 1.2,")
    double, single = (
        keyway(
            text.replace("*STATIC", f"{controls}, RESIDUAL=1e-9\n*STATIC", 1),
            name=name,
            files={motion.name: motion.read_text()},
        )
        for controls, name in ((PLAIN, "double"), (kind, "single"))
    )
    tables = [run.csv("damage") for run in (double, single)]
    assert tables[0]["cracking"][-1] > 1.0
    assert difference(*tables, ["cracking"]) <= 1e-5


@pytest.mark.parametrize("kind", ["SINGLE", "MIXED"])
def test_full_newton_is_refused(keyway, kind):
    """The full solver factors in every iteration: an error of the deck, before the first step."""
    trial = shaken(f"*CONTROLS, PRECISION={kind}, JOINT SOLVER=FULL")
    run = run_trial(keyway, trial, code=2)
    assert f"{kind} and JOINT SOLVER=FULL exclude each other" in run.stderr


def test_cracking_monolith_in_small_increments(keyway):
    """The default residual admits the copy where increments are small; cracking is the same.

    RESIDUAL=1e-6 is exact to 1e-6 of the forces; cracks that open and close make up to 1e-2 of it.
    """
    source = ROOT / "input" / "cracking_monolith.inp"
    motion = source.with_name("cracking_monolith_motion.txt")
    text = source.read_text().replace("0.01, 6.,", "0.002, 1.2,")
    double, mixed = (
        keyway(
            text.replace("*STATIC", f"{controls}\n*STATIC", 1),
            name=name,
            files={motion.name: motion.read_text()},
        )
        for controls, name in (("*CONTROLS, RESIDUAL=1e-6", "double"), (MIXED, "mixed"))
    )
    assert solutions_in_single(mixed) > 0
    tables = [run.csv("damage") for run in (double, mixed)]
    assert tables[0]["cracking"][-1] > 1.0
    assert difference(*tables, ["cracking"]) <= 1e-2
    assert max(step["energy"]["error"] for step in mixed.json["steps"]) <= 1e-6
