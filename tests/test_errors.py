"""Bad decks: one for each message, the text compared to the letter.

tests/errors/CASE/ holds the deck `deck.inp` and what the program says, `expected.txt`.
The exit code is 2, for the cases called warning_* it is 0. Options besides --check stand in
`options.txt`.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

CASES = Path(__file__).resolve().parent / "errors"


@pytest.mark.parametrize("case", sorted(p.name for p in CASES.iterdir() if p.is_dir()))
def test_bad_deck(case: str, program_path: Path) -> None:
    folder = CASES / case
    more = folder / "options.txt"
    options = more.read_text(encoding="utf-8").split() if more.exists() else []
    done = subprocess.run(
        [str(program_path.resolve()), "--check", *options, "deck.inp"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    expected = (folder / "expected.txt").read_text(encoding="utf-8")
    assert done.stderr == expected
    assert done.returncode == (0 if case.startswith("warning_") else 2)
