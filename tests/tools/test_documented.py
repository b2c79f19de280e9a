"""Numbers of tables in the documentation are found, compared and rewritten."""

from pathlib import Path

import pytest
from documented import Documented

PAGE = """# Page

<!-- table beams -->
| mesh | load | C3D8 | both |
|---|---|---|---|
| regular | pull | 0.986 | 0.5 %, 1.001 |
| | twist | 0.892 | +4.5e-3, 120: 2 |

| mesh | load | C3D8 |
|---|---|---|
| regular | pull | 7 |
"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    path = tmp_path / "page.md"
    path.write_text(PAGE)
    return path


def test_numbers_are_compared_to_their_last_digit(page):
    documented = Documented(page)
    documented("beams", ("regular", "pull"), "C3D8", 0.98647)
    documented("beams", ("regular", "pull"), "both", 0.0047, 1.0013)
    documented("beams", ("regular", "twist"), "both", 4.46e-3, 120.3, 2.0)


@pytest.mark.parametrize(
    ("row", "column", "values", "fault"),
    [
        ("pull", "C3D8", (0.9867,), "the page has 0.986, computed 0.9867"),
        ("pull", "both", (0.0057, 1.001), "the page has 0.5 %, computed 0.57"),
        ("pull", "both", (0.005,), "'0.5 %, 1.001' is not 1 numbers"),
        ("bend", "C3D8", (1.0,), "has no row"),
        ("pull", "C3D9", (1.0,), "has no column 'C3D9'"),
    ],
)
def test_difference_is_an_error(page, row, column, values, fault):
    with pytest.raises(AssertionError, match=fault):
        Documented(page)("beams", ("regular", row), column, *values)


def test_unknown_table(page):
    with pytest.raises(AssertionError, match="the page has no table 'bars'"):
        Documented(page)("bars", "a", "b", 1.0)


def test_update_keeps_the_form_of_the_numbers(page):
    documented = Documented(page, update=True)
    documented("beams", ("regular", "pull"), "both", 0.01234, 0.99949)
    documented("beams", ("regular", "twist"), "both", 1.234e-5, 99.9, 1.7)
    assert page.read_text() == PAGE.replace("0.5 %, 1.001", "1.2 %, 0.999").replace(
        "+4.5e-3, 120: 2", "+1.2e-5, 100: 2"
    )
