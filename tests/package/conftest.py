"""Keyway as pip and CMake install it, each once for all tests of this folder."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from harness import ROOT
from installation import Installed

SOURCES = ("pyproject.toml", "VERSION", "LICENSE", "README.md")


@pytest.fixture(scope="session")
def installed(program_path, tmp_path_factory) -> Installed:
    """`pip install` of a copy of the sources into a folder with blanks, without a network."""
    place = tmp_path_factory.mktemp("installed") / "with a blank"
    source = place / "source"
    source.mkdir(parents=True)
    for name in SOURCES:
        shutil.copy(ROOT / name, source)
    for package in ("keyway", "keyway_tools"):
        leave = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "tools" / package, source / "tools" / package, ignore=leave)
    found = Installed(place, program_path)
    command = [sys.executable, "-m", "pip", "--python", str(found.scripts / "python"), "install"]
    command += ["--quiet", "--no-deps", "--no-index", "--no-build-isolation", str(source)]
    subprocess.run(command, check=True, capture_output=True, timeout=200)
    shutil.rmtree(source)
    return found


@pytest.fixture(scope="session")
def build(program_path) -> Path:
    folder = program_path.parent
    if not (folder / "cmake_install.cmake").exists():
        pytest.skip("the program does not stand in its build folder")
    return folder


@pytest.fixture(scope="session")
def prefix(build, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("prefix") / "with a blank"
    command = ["cmake", "--install", str(build), "--prefix", str(place)]
    subprocess.run(command, check=True, capture_output=True, timeout=280)
    return place
