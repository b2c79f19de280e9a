"""The package keyway is typed: mypy finds nothing (its settings are in pyproject.toml)."""

from __future__ import annotations

import subprocess
import sys

from harness import ROOT


def test_the_package_is_typed(tmp_path):
    assert (ROOT / "tools/keyway/py.typed").exists()
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", tmp_path],
        cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
