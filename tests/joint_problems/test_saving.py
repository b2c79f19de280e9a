"""--save-joint-problems writes increments that the solver of saved problems solves alike."""

from crossing_cases import CROSSINGS
from solved import solve


def test_saved_increment_takes_the_iterations_of_the_run(program_path, keyway, tmp_path):
    case = next(case for case in CROSSINGS.cases if case.name == "T crossing")
    runs = []

    def saving(deck, *options, **more):
        runs.append(keyway(deck, "--save-joint-problems", "0", *options, **more))
        return runs[-1]

    finding = case.run(saving)
    files = sorted(runs[0].folder.glob("*_joints_*.h5"))
    assert len(files) == 1
    (found,) = solve(
        program_path.parent / "tests/joint_problems/solve_joint_problems", "policy", files
    )
    assert found.converged
    assert found.iterations == finding.iterations


def test_a_number_is_needed(keyway):
    done = keyway.call("--save-joint-problems", "few", "job.inp")
    assert done.returncode == 2
    assert "found '--save-joint-problems few'" in done.stderr
