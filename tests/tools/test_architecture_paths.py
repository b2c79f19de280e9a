"""The paths in docs/architecture.md name procedures that are in the files they name."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
HEADING = "## Following one quantity"
# The most calls that a reader may need: strain to residual, opening to files, record to force.
MOST_CALLS = (10, 12, 9)


def section() -> str:
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    return text.split(HEADING)[1].split("\n## ")[0]


def test_procedures_are_where_the_page_says() -> None:
    named = re.findall(r"`(\w+)` in\s+`(src/[\w/]+\.f90)`", section())
    assert len(named) > 20
    for procedure, path in named:
        source = (ROOT / path).read_text(encoding="utf-8")
        start = rf"^(?!\s*end\b).*\b(?:subroutine|function) {procedure}\b"
        assert re.search(start, source, re.M), f"{procedure} is not in {path}"


def test_paths_are_short() -> None:
    paths = re.split(r"^\*\*", section(), flags=re.M)[1:]
    assert len(paths) == len(MOST_CALLS)
    for path, most in zip(paths, MOST_CALLS, strict=True):
        assert 0 < len(re.findall(r"^\d+\. ", path, re.M)) <= most
