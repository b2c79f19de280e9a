"""Bad decks: one for each message, the output compared to the letter.

tests/errors/README.md describes the tables; tests/update_errors.py writes changed messages into
them.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from error_cases import NAME, Case, base_decks, headlines, read_tables, without_names


@pytest.mark.parametrize("case", [pytest.param(c, id=c.name) for c in read_tables()])
def test_bad_deck(case: Case, program_path: Path, tmp_path: Path) -> None:
    done = case.run(program_path, tmp_path)
    assert without_names(done.stderr) == case.stderr
    assert done.returncode == case.code
    for line in headlines(done.stderr):
        assert NAME.search(line), f"no page of keyway --explain fits: {line}"


def test_every_name_has_a_page(program_path: Path) -> None:
    listed = subprocess.run([program_path, "--explain"], capture_output=True, text=True).stdout
    names = re.findall(r"^([a-z][a-z0-9-]*) ", listed, re.MULTILINE)[:-1]  # `keyway --explain ..`
    assert len(names) == len(set(names)) > 40
    for name in names:
        done = subprocess.run(
            [program_path, "--explain", f"[{name}]"], capture_output=True, text=True
        )
        assert done.returncode == 0
        assert done.stdout.startswith(f"{name}\n  ")
        assert "\nWhat to do\n" in done.stdout
    done = subprocess.run([program_path, "--explain", "no-suport"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "did you mean 'no-support'?" in done.stderr


@pytest.mark.parametrize("deck", base_decks(), ids=lambda path: path.stem)
def test_base_deck_is_good(deck: Path, program_path: Path) -> None:
    options = ["--material"] if deck.stem == "material_test" else []
    command = [str(program_path), "--check", *options, str(deck)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stderr == ""
    assert done.returncode == 0
