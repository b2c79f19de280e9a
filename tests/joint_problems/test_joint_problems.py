"""The policy of the iteration solves all saved joint problems, or shows that none can be solved."""

import pytest
from limit_load import least_error
from solved import SAVED, solve, unpack

FILES = sorted(SAVED.glob("*.h5.xz"))
# An equilibrium exists; the policy does not find it (docs/studies/joint_problems.md).
UNSOLVED = {("crossing_1_1_1.h5", 3)}


@pytest.fixture
def solver(program_path):
    path = program_path.parent / "tests/joint_problems/solve_joint_problems"
    assert path.exists(), f"{path} is not built"
    return path


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.name.split(".")[0])
def test_policy_solves_all_or_finds_no_equilibrium(solver, tmp_path, file):
    for found in solve(solver, "policy", unpack(tmp_path, [file])):
        if (found.file, found.problem) in UNSOLVED and not found.converged:
            continue
        assert found.converged != found.is_loose
        # The residual of the tolerance of *CONTROLS, measured with the laws alone.
        assert found.is_loose or found.residual <= 2e-6


# Files with static problems of which some have no equilibrium.
STATIC = [path for path in FILES if path.name.startswith(("arch", "crossing"))]


@pytest.mark.parametrize("file", STATIC, ids=lambda path: path.name.split(".")[0])
def test_no_equilibrium_exists_exactly_where_the_policy_finds_none(solver, tmp_path, file):
    """The least error is 2e-4 or more of the load without an equilibrium, round-off with one."""
    files = unpack(tmp_path, [file])
    for found in solve(solver, "policy", files):
        error = least_error(files[0], found.problem)
        assert error > 1e-4 if found.is_loose else error < 1e-9


def test_block_that_wedges(solver, tmp_path):
    """Newton's iteration goes between two states of the edge of a block with friction 2.

    Given limits of friction have an equilibrium in each pass. Those of the last one are the laws'.
    """
    files = unpack(tmp_path, [SAVED / "wedged" / "block_1.h5.xz"])
    (found,) = solve(solver, "policy", files)
    assert found.converged and found.passes > 1
    assert found.residual <= 2e-6


def test_there_are_a_few_hundred_problems():
    assert len(FILES) >= 20
