"""A million random strain paths of one point of concrete: no failure, no NaN, no energy gained.

The paths are those of tests/unit/concrete_paths.f90. The unit test runs 20 000 of them with all
run-time checks; here the optimised program runs them.
"""

import re
import subprocess

import pytest

PATHS = 1_000_000


@pytest.mark.full
def test_a_million_paths(program_path):
    program = program_path.parent / "unit" / "test_damage_paths"
    if not program.exists():
        pytest.skip(f"{program} is not built")
    done = subprocess.run([program, str(PATHS)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    counts = [int(count) for count in re.findall(r": (\d+) paths", done.stdout)]
    assert sum(counts) == PATHS - PATHS % len(counts)
