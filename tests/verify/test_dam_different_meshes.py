"""An arch dam whose blocks have different meshes: against matching meshes, joined in both ways.

All meshes fill one body (keyway_tools/arch_lattice.py), so that what differs is the mesh and the
coupling. Three measures keep these apart:
  equal meshes joined by surfaces      the machinery alone: round-off
  levels half an element apart         the coupling at equal mesh size: non-nested faces
  a finer middle block, 2:1 and 3:2    must lie between both matching meshes but for the coupling
Numbers of the dam of input/xingbiling_matching: docs/studies/different_meshes.md.
"""

import dataclasses

import h5py
import numpy as np
import pytest
from dam_trials import (
    BlockOptions,
    DeckOptions,
    Trial,
    measure,
    mesh_of,
    run_trial,
    trial_of,
)
from keyway_tools.arch_lattice import PartMesh

THREE, FOUR, SHIFTED = PartMesh(3, 3), PartMesh(4, 4), PartMesh(2, 2, 0.5)
MESHES = {
    "coarse": BlockOptions(refine=2),
    "gauss": BlockOptions(refine=2),
    "shifted": BlockOptions(refine=2, fine=(1, 2, 3), fine_mesh=SHIFTED),
    "three": BlockOptions(refine=2, fine=(1, 2, 3), fine_mesh=THREE),
    "four": BlockOptions(refine=2, fine=(1, 2, 3), fine_mesh=FOUR),
    "1:1": BlockOptions(refine=2, join="surfaces"),
    "1:1 tied": BlockOptions(refine=2, join="surfaces", is_tied=True),
    "1:1 shifted": BlockOptions(refine=2, fine=(2,), fine_mesh=SHIFTED),
    "3:2": BlockOptions(refine=2, fine=(2,), fine_mesh=THREE),
    "2:1": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR),
    "2:1 swapped": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR, slave="coarse"),
    "upper third": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR, fine_above=0.66),
    "1:1 chain": BlockOptions(refine=2, join="chain"),
    "3:2 chain": BlockOptions(refine=2, fine=(2,), fine_mesh=THREE, join="chain"),
    "2:1 chain": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR, join="chain"),
}
GAUSS = tuple((f"ELSET=JOINT{n}\n", f"ELSET=JOINT{n}, INTEGRATION=GAUSS\n") for n in (1, 2))
QUICK = {"1:1 shifted", "3:2"}
MOST_ITERATIONS = 15
ROUNDOFF = 1e-6  # of the energy: equations are solved to 1e-6 of their forces


def trial(mesh: str, duration: float = 0.0, **changes) -> Trial:
    """Weight and water; with a duration, that much of the motion, 5 % damped."""
    options = dataclasses.replace(DeckOptions(), **changes)
    moving = duration > 0.0
    return Trial(
        blocks=MESHES[mesh],
        is_coarse=True,
        duration=duration if moving else 0.01,
        components=(moving, moving, moving),
        options=options,
        edits=GAUSS if mesh == "gauss" else (),
    )


@pytest.fixture
def runs(keyway):
    """Runs a mesh once."""
    done = {}

    def run(mesh: str, duration: float = 0.0, **changes):
        key = (mesh, duration, *changes.items())
        if key not in done:
            done[key] = run_trial(keyway, trial(mesh, duration, **changes), name=f"dam{len(done)}")
        return done[key]

    return run


def extremes(run) -> dict[str, float]:
    """The values of the study: [Pa] and [m]."""
    return {
        f"{name} {side}": run.json["envelopes"][name][side]["value"]
        for name in ("S1", "S3", "OPENING")
        for side in ("upstream", "downstream")
    }


def crown(run) -> float:
    """Displacement of the crest along the stream under weight and water [m]."""
    table = run.csv("node_CROWN_CREST")
    return float(table["U2"][table["step"] == 1][-1])


def work(run) -> float:
    """Work of weight and water [J]: twice the strain energy of a linear body."""
    return run.json["steps"][0]["energy"]["external"]


def displacements(run, trial: Trial) -> dict[tuple, np.ndarray]:
    """Static displacements of the nodes of the dam by place; nodes in one place are kept
    distinct."""
    mesh = mesh_of(trial.mesh_key)
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file["steps/0001/increments"]
        u = increments[sorted(increments)[-1]]["U"][:]
        x = file["mesh/x"][:]
    assert np.array_equal(x, mesh.x)
    centre = mesh.x[mesh.bricks[mesh.brick_sets["DAM"]]].mean(axis=1)
    found = {}
    for brick, middle in zip(mesh.brick_sets["DAM"], centre, strict=True):
        for node in mesh.bricks[brick]:
            found[(*np.round(middle, 3), *np.round(mesh.x[node], 3))] = u[node]
    return found


@pytest.mark.parametrize("mesh", ["1:1", "1:1 tied"])
def test_equal_meshes_on_surfaces_are_the_classical_joint(runs, mesh):
    """The same equations but for the order of sums; the bound is the tolerance of the iteration."""
    one, other = (displacements(runs(m), trial(m)) for m in ("coarse", mesh))
    assert one.keys() == other.keys()
    largest = max(np.abs(u).max() for u in one.values())
    assert max(np.abs(one[p] - other[p]).max() for p in one) < 1e-6 * largest


def test_equal_meshes_on_surfaces_move_as_the_classical_joint(runs):
    """Over 1.5 s of motion, with joints that open and slide."""
    one, other = (extremes(runs(mesh, 1.5)) for mesh in ("coarse", "1:1"))
    assert one["OPENING downstream"] > 1e-3
    for name, value in one.items():
        assert other[name] == pytest.approx(value, rel=1e-6), name


@pytest.mark.parametrize(
    ("mesh", "fine"),
    [("3:2", "three"), ("2:1", "four"), ("2:1 swapped", "four"), ("upper third", "four")],
)
def test_stiffness_of_bonded_dam_is_between_those_of_both_meshes(runs, mesh, fine):
    """The work of the loads grows with the space of displacements (Galerkin).

    With the fine side as slave of a nested face, 2:1, the spaces are nested: the work lies between
    those of the matching meshes. Elsewhere the coupling may change the work by a thousandth of
    their difference, which is less than their errors.
    """
    bonded = {"has_joint_law": False}
    low, value, high = (work(runs(m, **bonded)) for m in ("coarse", mesh, fine))
    assert low < high
    slack = 1e-3 * (high - low)
    assert low - slack < value < high + slack


# With 2.5 s of motion a value may lie outside of those of both matching meshes by what the project
# aims at, 1 % of a stress and 0.5 % of an opening, and by a tenth of what they are apart: a dam of
# two meshes has frequencies and contact times of its own, no mean of others.
MOVING = 2.5
OF_GAIN = 0.1
DYNAMIC = [("1:1 shifted", "shifted"), ("3:2", "three"), ("2:1", "four")]


@pytest.mark.parametrize(
    ("mesh", "fine"),
    [pytest.param(*case, marks=[] if case[0] in QUICK else [pytest.mark.full]) for case in DYNAMIC],
)
def test_response_of_shaken_dam_is_between_matching_meshes(runs, mesh, fine):
    low, value, high = (extremes(runs(m, MOVING)) for m in ("coarse", mesh, fine))
    for name, found in value.items():
        ends = sorted((low[name], high[name]))
        outside = max(ends[0] - found, found - ends[1], 0.0) / max(map(abs, ends))
        gain = (ends[1] - ends[0]) / max(map(abs, ends))
        assert outside < (0.005 if "OPENING" in name else 0.01) + OF_GAIN * gain, name


def test_chain_is_as_compliant_as_its_penalty(runs):
    """Eq. 8 with k = 22e9 Pa/m: the dam moves as with joints of 1 / (1/k_n + 1/k), k_t alike.

    Such a joint is integrated at Gauss points, as the penalty: with two elements through the
    thickness springs at nodes are 1.5 times as stiff in bending. The joint is bonded, so that the
    problem is linear; its own springs are at nodes, hence the difference of a thousandth.
    """
    normal, penalty = 22e9 / 0.02, 22e9
    shear = normal / (2.0 * (1.0 + 0.167))
    bonded = {"has_joint_law": False}
    chain, joint = (crown(runs(mesh, **bonded)) for mesh in ("1:1 chain", "coarse"))
    softer = crown(
        runs(
            "gauss",
            normal_stiffness=1.0 / (1.0 / normal + 1.0 / penalty),
            shear_stiffness=1.0 / (1.0 / shear + 1.0 / penalty),
            **bonded,
        )
    )
    assert chain == pytest.approx(softer, rel=1e-3)
    assert abs(chain - joint) > 10.0 * abs(chain - softer)


CORNERS = [(1.0, 1e10, 0.01), (2.0, 1e13, 0.01), (2.0, 1e10, 0.002), (1.0, 1e13, 0.002)]
JOINED = ("3:2", "2:1", "upper third", "3:2 chain")


HARD = [
    pytest.param(mesh, *corner, marks=[] if mesh == "3:2" else [pytest.mark.full])
    for mesh in JOINED
    for corner in CORNERS
]


@pytest.mark.parametrize(("mesh", "size", "stiffness", "dt"), HARD)
def test_hard_motions_run_through(keyway, mesh, size, stiffness, dt):
    """As test_dam_robustness.py: no cutback, no growth of energy, without damping."""
    case = trial_of(size, stiffness, dt, is_coarse=True, duration=3.5, blocks=MESHES[mesh])
    result = measure(run_trial(keyway, case))
    assert result.most_iterations <= MOST_ITERATIONS
    assert result.cutbacks == 0
    assert result.growth <= ROUNDOFF
    assert result.unbalance <= ROUNDOFF
    assert result.opening > 1e-3
