"""The bench measures correctly; its limits, for large models, are not checked here."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_bench_measures_a_small_dam(program_path: Path, tmp_path: Path):
    figures = tmp_path / "figures.json"
    words = ["run", "--sizes", "1500", "--increments", "5", "--threads", "1", "--json", figures]
    command = [sys.executable, ROOT / "tools/bench", *words, "--program", program_path]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stderr == ""
    found = {figure["what"]: figure["value"] for figure in json.loads(figures.read_text())}
    assert found.keys() == {
        "deck read and verified [s]",
        "static run / bare solver",
        "memory of the static run [MB]",
        "linear increment / solve",
        "linear increment with envelopes / solve",
        "increment with two joints / solve",
        "increment of undamaged concrete / without its laws",
    }
    assert all(value > 0.0 for value in found.values())
    assert found["linear increment / solve"] > 1.0
