"""Instructions of the program's procedures, counted by valgrind."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from harness import ROOT

SOURCES = {path.stem: path.parent.relative_to(ROOT / "src") for path in ROOT.glob("src/**/*.f90")}
NEEDS_VALGRIND = [
    pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed"),
    pytest.mark.timeout(600),
]


def watch(program: Path, folder: Path, tool: str, arguments: list[str]) -> Path:
    """The file that a tool of valgrind leaves of a run; the program starts itself once more."""
    out = f"--{tool}-out-file={folder}/out.%p"
    command = ["valgrind", "-q", f"--tool={tool}", "--trace-children=yes", out, str(program)]
    # valgrind does not know the instructions of the newest kernels
    env = {**os.environ, "OPENBLAS_CORETYPE": "HASWELL"}
    command += arguments
    done = subprocess.run(command, env=env, timeout=300, capture_output=True, text=True)
    assert done.returncode in (0, 2), done.stderr
    return max(folder.glob("out.*"), key=lambda path: path.stat().st_size)


def module_of(symbol: str) -> str:
    """The module of a procedure of the program; '' of others."""
    found = re.search(r"__(?:\w+\.)?(\w+?)_MOD_", symbol)
    return found[1] if found and found[1] in SOURCES else ""


def instructions(path: Path) -> Counter:
    """Instructions by module, without those of the procedures that they call."""
    command = ["callgrind_annotate", "--threshold=100", str(path)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    total: Counter = Counter()
    for number, symbol in re.findall(r"^\s*([\d,]+) \([^)]*\)\s+(\S+)", text, re.M):
        total[module_of(symbol)] += int(number.replace(",", ""))
    return total
