"""Imported first by the scripts of tools/: runs them with the Python of the checkout.

A Python without the packages that the tools need, as that of the system, is replaced by
.venv/bin/python; without a .venv one line says what to do.
"""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path

NEEDED = (
    "h5py", "jinja2", "matplotlib", "meshio", "numpy", "pandas", "plotly", "pyvista", "scipy"
)  # fmt: skip
VENV = Path(__file__).resolve().parents[2] / ".venv"
EXIT_SYSTEM = 3


def run_with_own_python(venv: Path = VENV, needed: tuple[str, ...] = NEEDED) -> None:
    """Start this script anew with the Python of `venv` where this Python lacks a package."""
    missing = [name for name in needed if find_spec(name) is None]
    if not missing:
        return
    python = venv / "bin" / "python"
    if python.is_file() and Path(sys.prefix).resolve() != venv.resolve():
        os.execv(python, [str(python), *sys.argv])
    script = Path(sys.argv[0])
    lacks = f"{sys.executable} has no package {missing[0]}"
    call = f"call tools/setup once, then {python} {script}"
    print(f"{script.stem}: {lacks}; {call}", file=sys.stderr)
    raise SystemExit(EXIT_SYSTEM)


run_with_own_python()
