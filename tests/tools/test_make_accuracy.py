"""docs/accuracy.md has what the data of its studies say."""

from pathlib import Path

import make_accuracy
import pytest
from keyway_tools.report.browser import find_browser, opened
from keyway_tools.study.page import accuracy_page
from keyway_tools.study.pictures import draw

NEEDS = "no Chromium, Chrome or Edge; tools/test installs chromium on Debian"


def test_the_page_and_its_data_agree():
    """`tools/make_accuracy.py` writes the page again after a change."""
    assert make_accuracy.main(["--check"]) == 0


def test_lines_of_the_page_are_not_too_long():
    text = "\n".join(make_accuracy.section(facts) for facts in make_accuracy.studies())
    assert max(len(line) for line in text.splitlines()) <= 120


@pytest.mark.parametrize("facts", make_accuracy.studies(), ids=make_accuracy.name_of)
def test_each_study_has_its_picture(facts):
    name = f"accuracy_of_{make_accuracy.name_of(facts)}.png"
    assert (make_accuracy.PICTURES / name).exists() == bool(draw(facts))


def test_promised_errors_hold_where_they_were_checked():
    """The runs that the ladders do not use: what was said is not smaller than what was found."""
    checks = [facts["verified"] for facts in make_accuracy.studies() if facts["verified"]]
    assert checks
    for check in checks:
        late = [row for row in check["rows"] if row["found"] > row["promised"]]
        assert not late


@pytest.mark.skipif(find_browser() is None, reason=NEEDS)
@pytest.mark.timeout(900)
@pytest.mark.parametrize("width", [1000, 700])
def test_the_page_of_a_study_fits_its_window(tmp_path, width):
    """The study with most quantities: tables are not wider than the window, or scroll by
    themselves."""
    facts = max(make_accuracy.studies(), key=lambda facts: len(facts["quantities"]))
    path, errors = tmp_path / "accuracy.html", []
    path.write_text(accuracy_page(Path(facts["deck"]), facts), encoding="utf-8")
    with opened(path, errors, "body") as page:
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        wide = "[...document.querySelectorAll('.wide')].map(box => box.scrollWidth)"
        if width == 1000:
            assert max(page.evaluate(wide)) <= width
    assert errors == []
