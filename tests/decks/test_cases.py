"""Every case of this folder gives its values."""

from pathlib import Path

import pytest
from harness import check_case, read_case

CASES = [read_case(path) for path in sorted(Path(__file__).parent.glob("*/case.toml"))]


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(c, id=c.folder.name, marks=[pytest.mark.full] if c.is_long else [])
        for c in CASES
    ],
)
def test_case(case, keyway):
    check_case(case, keyway)
