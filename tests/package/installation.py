"""The package as pip installs it, in an environment of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import matplotlib


class Installed:
    """A virtual environment with the package, a clean environment and a working folder.

    The libraries that the package needs are those of the tests.
    """

    def __init__(self, place: Path, program: Path):
        venv = place / "venv"
        words = [sys.executable, "-m", "venv", "--without-pip", str(venv)]
        subprocess.run(words, check=True, timeout=200)
        self.scripts = venv / "bin"
        self.place = Path(sysconfig.get_path("purelib", vars={"base": str(venv)}))
        (self.place / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n")
        self.folder = place / "elsewhere"
        self.folder.mkdir()
        (self.scripts / "keyway").symlink_to(program.resolve())
        self.environment = {
            "PATH": f"{self.scripts}{os.pathsep}{os.environ['PATH']}",
            "HOME": str(place),
            "MPLBACKEND": "Agg",
            "MPLCONFIGDIR": matplotlib.get_cachedir(),  # a list of fonts takes seconds to make
        }

    def __call__(self, command: str, *arguments: str, code: int = 0) -> str:
        """Run an installed command, or python with `command` = 'python'; its output."""
        done = subprocess.run(
            [self.scripts / command, *arguments], cwd=self.folder, env=self.environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=200,
        )  # fmt: skip
        assert done.returncode == code, f"{command} {arguments}: {done.stdout}"
        return done.stdout
