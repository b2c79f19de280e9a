"""Bad decks: one for each message, the output compared to the letter.

tests/errors/README.md describes the tables; tests/update_errors.py writes changed messages into
them.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from error_cases import Case, base_decks, read_tables


@pytest.mark.parametrize("case", [pytest.param(c, id=c.name) for c in read_tables()])
def test_bad_deck(case: Case, program_path: Path, tmp_path: Path) -> None:
    done = case.run(program_path, tmp_path)
    assert done.stderr == case.stderr
    assert done.returncode == case.code


@pytest.mark.parametrize("deck", base_decks(), ids=lambda path: path.stem)
def test_base_deck_is_good(deck: Path, program_path: Path) -> None:
    options = ["--material"] if deck.stem == "material_test" else []
    command = [str(program_path), "--check", *options, str(deck)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stderr == ""
    assert done.returncode == 0
