"""The jointed dam converges, is never cut back, and its energy never grows after the motion.

Sizes of the motion, joint stiffnesses and increments as in the table of docs/verification.md. The
bulk has no viscous damping here (that of the time stepping alone), the hardest case for energy.
"""

import dataclasses

import pytest
from dam_trials import FULL_MATRIX, Trial, measure, run_trial, trial_of
from keyway_tools.arch_blocks import BlockOptions

MOST_ITERATIONS = 15
# The energy is a difference of sums over the increments, each printed with 13 digits, of equations
# solved to 1e-6 of their forces: the balance itself closes to 1e-7 of the largest energy.
ROUNDOFF = 1e-6
CORNERS = [(1.0, 1e10, 0.01), (2.0, 1e13, 0.01), (2.0, 1e10, 0.002), (1.0, 1e13, 0.002)]


def check(keyway, trial: Trial) -> None:
    result = measure(run_trial(keyway, trial))
    assert result.most_iterations <= MOST_ITERATIONS
    assert result.cutbacks == 0
    assert result.growth <= ROUNDOFF
    assert result.unbalance <= ROUNDOFF
    assert result.opening > 1e-3


@pytest.mark.parametrize(("size", "stiffness", "dt"), CORNERS)
def test_corners_of_the_matrix(keyway, size, stiffness, dt):
    check(keyway, trial_of(size, stiffness, dt, is_coarse=True, duration=3.5))


# Blocks of one mesh by JOINT8 elements and by surfaces, the middle block twice as fine as slave and
# as master of its neighbours.
MESHES = {
    "matching": BlockOptions(),
    "surfaces": BlockOptions(join="surfaces"),
    "fine slave": BlockOptions(fine=(2,)),
    "fine master": BlockOptions(fine=(2,), slave="coarse"),
}


@pytest.mark.parametrize(("size", "stiffness", "friction"), [(1.0, 1e12, 0.6), (0.8, 3e12, 1.35)])
@pytest.mark.parametrize("meshes", MESHES)
def test_different_meshes(keyway, meshes, size, stiffness, friction):
    """A dam whose blocks have meshes of their own, its base held.

    Without an r of their own for points that change their direction of slip, the second case has no
    equilibrium (theory.md, 2.3).
    """
    trial = trial_of(size, stiffness, 0.01, is_coarse=True, duration=3.0, has_rock=False)
    options = dataclasses.replace(trial.options, friction=friction)
    check(keyway, dataclasses.replace(trial, options=options, blocks=MESHES[meshes]))


@pytest.mark.full
@pytest.mark.parametrize(("size", "stiffness", "dt"), FULL_MATRIX)
def test_matrix(keyway, size, stiffness, dt):
    check(keyway, trial_of(size, stiffness, dt))
