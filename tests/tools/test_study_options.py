"""Options of tools/accuracy that have no effect on a deck are said."""

import subprocess
from pathlib import Path

import pytest
from keyway_tools.study.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
INPUT = ROOT / "input"


def test_options_without_effect_on_a_deck_are_said(program_path, tmp_path):
    """Modes alone: no effect to switch off, no dynamic step to shorten."""
    deck = INPUT / "monolith_frequencies.inp"
    command = [ROOT / "tools/accuracy", deck, "--program", program_path.resolve()]
    options = ["--effects", "--duration", "1", "-o", tmp_path / "study"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "--duration 1s: no effect, the deck has no dynamic step at all" in done.stdout
    assert f"accuracy: {deck}: no effect to switch off: no joints, loads" in done.stderr


def test_a_study_of_no_time_is_refused(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["dam.inp", "--duration", "0"])
    assert stop.value.code == 2
    assert "--duration 0: expected a time above 0" in capsys.readouterr().err
