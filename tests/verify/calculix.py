"""Runs CalculiX on the deck of a Keyway test and reads its output."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

NEEDS_CALCULIX = "CalculiX (ccx, package calculix-ccx) is not installed; tools/test --full does it"

needs_calculix = pytest.mark.skipif(shutil.which("ccx") is None, reason=NEEDS_CALCULIX)


def run_calculix(deck: str, folder: Path, name: str = "other") -> list[str]:
    """Lines of the .dat file."""
    (folder / f"{name}.inp").write_text(deck, encoding="utf-8")
    done = subprocess.run(
        ["ccx", name], cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL
    )
    assert done.returncode == 0 and "*ERROR" not in done.stdout, done.stdout[-3000:]
    return (folder / f"{name}.dat").read_text().splitlines()


def displacements(lines: list[str]) -> dict[float, np.ndarray]:
    """Displacements (nodes, 3) by time, of *NODE PRINT with one set; seven digits."""
    blocks: dict[float, list[list[float]]] = {}
    rows: list[list[float]] = []
    for line in lines:
        head = re.match(r" displacements .* and time +(\S+)", line)
        if head:
            rows = blocks.setdefault(float(head[1]), [])
        elif line.strip() and blocks:
            rows.append([float(word) for word in line.split()[1:]])
    return {time: np.array(rows) for time, rows in blocks.items()}


def table_below(lines: list[str], title: str) -> np.ndarray:
    """Columns of numbers of the first table below a title, as in 'E I G E N V A L U E'."""
    start = next(i for i, line in enumerate(lines) if title in line)
    rows: list[list[float]] = []
    for line in lines[start + 1 :]:
        words = line.split()
        if words and words[0].isdigit():
            rows.append([float(word) for word in words])
        elif rows:
            break
    return np.array(rows)
