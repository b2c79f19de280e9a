"""A run that is killed and continued has the estimates of errors of the run that was not."""

import json

import pytest
from restart_case import continue_killed
from test_opening_time_errors import shaken


@pytest.mark.parametrize("controls", ["", "*CONTROLS, ERROR ESTIMATE=OFF\n"], ids=["on", "off"])
def test_goes_on(program_path, tmp_path, controls):
    """Modes are found again; what has added up is in the checkpoint."""
    deck = shaken("near resonance", 0.01, controls=controls + "*RESTART, WRITE, FREQUENCY=50\n")
    path = tmp_path / "job.inp"
    path.write_text(deck)
    found = []
    for name, kills in (("whole", []), ("killed", [(180, 0.0), (390, 0.0)])):
        out = tmp_path / name
        continue_killed(program_path, path, out, ["-j", "1"], kills)
        found.append(json.loads((out / "job.json").read_text())["accuracy"]["estimates"])
    assert found[0] == found[1]
    assert ("opening" in found[0]) == (not controls)
    assert ("displacement" in found[0]) == (not controls)
