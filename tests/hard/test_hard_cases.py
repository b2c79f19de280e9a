"""Every hard case holds; docs/hard_cases.md has all of them, as they are."""

import pytest
from catalogue import CASES, HOLDS, NOT_RUN, PAGE, page_of, rows_of_page

LIMIT = 4 * 3600  # of a long case [s]


def marked(case):
    marks = [pytest.mark.full, pytest.mark.timeout(LIMIT)] if case.full else []
    if case.waits_for:
        marks.append(pytest.mark.xfail(reason=f"waits for {case.waits_for}", strict=False))
    return pytest.param(case, id=case.name, marks=marks)


def cells_of(case) -> list[str]:
    """Case, unknowns, result, number, limit and effort on the page."""
    row = rows_of_page()[case.name]
    return [cell.strip() for cell in row.strip("|").split("|")]


@pytest.mark.parametrize("case", [marked(case) for case in CASES])
def test_case_holds(keyway, case):
    finding = case.run(keyway)
    assert finding.value <= case.limit
    assert cells_of(case)[1] in (str(finding.unknowns), "")


def test_there_are_thirty_cases_with_names_of_their_own():
    assert len(CASES) >= 30
    assert len({case.name for case in CASES}) == len(CASES)


def test_page_is_current():
    """Its text is made of the cases; results other than 'holds' have a reason."""
    assert PAGE.read_text(encoding="utf-8") == page_of(rows_of_page()), (
        "docs/hard_cases.md is out of date: run python tools/make_hard_cases.py"
    )
    for case in CASES:
        cells = cells_of(case)
        assert cells[4] == f"{case.limit:g}"
        if not case.waits_for:
            assert cells[2] in ((HOLDS, NOT_RUN) if case.full else (HOLDS,))
