"""Keyway as pip and CMake install it, each once for all tests of this folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from harness import ROOT

SOURCES = ("pyproject.toml", "VERSION", "LICENSE", "README.md")


class Installed:
    """A folder of installed packages, with a clean environment and a working folder."""

    def __init__(self, place: Path, program: Path):
        self.place = place / "site"
        self.folder = place / "elsewhere"
        self.folder.mkdir()
        bin_folder = place / "bin"
        bin_folder.mkdir()
        (bin_folder / "keyway").symlink_to(program)
        self.environment = {
            "PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(self.place),
            "HOME": str(place),
            "MPLBACKEND": "Agg",
        }

    def __call__(self, command: str, *arguments: str, code: int = 0) -> str:
        """Run an installed command, or python with `command` = 'python'; its output."""
        script = self.place / "bin" / command
        start = [sys.executable] if command == "python" else [sys.executable, str(script)]
        done = subprocess.run(
            [*start, *arguments], cwd=self.folder, env=self.environment, text=True, timeout=200,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        assert done.returncode == code, f"{command} {arguments}: {done.stdout}"
        return done.stdout


@pytest.fixture(scope="session")
def installed(program_path, tmp_path_factory) -> Installed:
    """`pip install` of a copy of the sources, without a network."""
    place = tmp_path_factory.mktemp("installed")
    source = place / "source"
    source.mkdir()
    for name in SOURCES:
        shutil.copy(ROOT / name, source)
    for package in ("keyway", "keyway_tools"):
        leave = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "tools" / package, source / "tools" / package, ignore=leave)
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    command += ["--no-build-isolation", "--target", str(place / "site"), str(source)]
    subprocess.run(command, check=True, capture_output=True, timeout=200)
    shutil.rmtree(source)
    return Installed(place, program_path)


@pytest.fixture(scope="session")
def build(program_path) -> Path:
    folder = program_path.parent
    if not (folder / "cmake_install.cmake").exists():
        pytest.skip("the program does not stand in its build folder")
    return folder


@pytest.fixture(scope="session")
def prefix(build, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("prefix")
    command = ["cmake", "--install", str(build), "--prefix", str(place)]
    subprocess.run(command, check=True, capture_output=True, timeout=280)
    return place
