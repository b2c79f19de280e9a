"""The hard cases (docs/hard_cases.md) hold on several processes, by the limits of one."""

from __future__ import annotations

import pytest
from catalogue import CASES

# Cases of tools/test --full take hours on one process.
SHORT = [pytest.param(case, id=case.name) for case in CASES if not case.full]


@pytest.mark.parametrize("case", SHORT)
def test_case_holds_on_two_ranks(on_ranks, case):
    finding = case.run(on_ranks(2))
    assert finding.value <= case.limit
