"""The tutorials: their files are written and their commands run, from what is installed alone."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from harness import ROOT
from installation import Installed

PAGES = ROOT / "docs"
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Tutorial:
    """A page that is followed in a folder: files first, commands in their order."""

    def __init__(self, folder: Path, prefix: Path, installed: Installed):
        self.folder = folder
        self.prefix = folder / "opt"  # the names of both places hold blanks
        self.prefix.symlink_to(prefix)
        places = [f"{prefix}/bin", str(installed.scripts), "/usr/bin", "/bin"]
        self.environment = {
            **installed.environment, "PATH": os.pathsep.join(places), "HOME": str(folder)
        }  # fmt: skip

    def follow(self, page: str, changed: Callable[[str], str] = str) -> str:
        """Run a page, its files and commands after a change; its output."""
        text = (PAGES / page).read_text(encoding="utf-8")
        commands = []
        for kind, title, content in BLOCK.findall(text):
            if title:
                (self.folder / title).parent.mkdir(exist_ok=True)
                (self.folder / title).write_text(changed(content), encoding="utf-8")
            elif kind == "sh":
                commands.append(changed(content).replace("/opt/keyway", str(self.prefix)))
        script = "set -e\n" + "".join(commands).replace("mkdir ", "mkdir -p ")
        done = subprocess.run(
            ["bash", "-c", script], cwd=self.folder, env=self.environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout[-4000:]
        return done.stdout


@pytest.fixture
def tutorial(prefix, installed, tmp_path) -> Tutorial:
    return Tutorial(tmp_path, prefix, installed)


def test_first_dam(tutorial):
    text = tutorial.follow("tutorials/first_dam.md")
    thrust = float(re.search(r"^thrust (\S+)", text, re.M)[1])
    assert abs(thrust) == pytest.approx(0.5 * 1000 * 9.81 * 91.75**2, rel=1e-6)  # hydrostatics
    crest = float(re.search(r"^crest (\S+)", text, re.M)[1])
    assert crest == pytest.approx(11.3e-3, abs=0.05e-3)  # as the page says
    assert (tutorial.folder / "first_dam/results/dam_report.html").exists()


def test_from_gmsh_to_pictures(tutorial):
    tutorial.follow("gmsh.md")
    pictures = list((tutorial.folder / "gmsh_arch/results").glob("*.png"))
    assert any("openings" in picture.name for picture in pictures)


def test_your_umat(tutorial):
    text = tutorial.follow("tutorials/your_umat.md")
    assert "finished" in text
    assert (tutorial.folder / "umat/curve.png").exists()


def test_many_records(tutorial):
    text = tutorial.follow(
        "tutorials/many_records.md", lambda file: file.replace("count = 100", "count = 5")
    )
    assert re.search(r"^0\.50 ", text, re.M)
    assert (tutorial.folder / "records/fractiles.png").stat().st_size > 1000
    rows = (tutorial.folder / "records/results/batch.csv").read_text().splitlines()
    assert len(rows) == 6


def test_fragility(tutorial):
    text = tutorial.follow("fragility.md", lambda text: text.replace("py 200", "py 4"))
    assert "records; mean misfit of their spectra" in text
    rows = (tutorial.folder / "fragility/results/batch.csv").read_text().splitlines()
    assert len(rows) == 5
    assert (tutorial.folder / "fragility/fragility.png").stat().st_size > 10_000


def test_cracking_dam(tutorial):
    text = tutorial.follow("tutorials/cracking_dam.md")
    error = float(re.search(r"^error of the balance (\S+)", text, re.M)[1])
    assert error < 1e-3
    for name in ("damage", "damage_growth"):
        assert (tutorial.folder / f"cracking_dam/results/dam_{name}.png").exists()
