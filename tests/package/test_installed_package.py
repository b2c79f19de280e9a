"""The package as pip installs it: all commands and data, used from outside of the checkout."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from harness import ROOT

COMMANDS = ("accuracy", "batch", "compare", "mesh", "plot", "report")


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_says_what_it_does(installed, command):
    text = installed(f"keyway-{command}", "--help")
    assert text.startswith(f"usage: keyway-{command} ")


def test_no_file_is_left_out(installed):
    """Templates, styles and the mark of typed packages are installed as the sources are."""

    def files(place: Path) -> set[str]:
        found = (path for name in ("keyway", "keyway_tools") for path in place.glob(f"{name}/**/*"))
        return {str(path.relative_to(place)) for path in found
                if path.is_file() and "__pycache__" not in path.parts}  # fmt: skip

    assert files(installed.place) == files(ROOT / "tools")
    assert "keyway/py.typed" in files(installed.place)


def test_from_the_run_to_pictures_and_a_report(installed):
    """A batch of two decks, pictures, a report and a comparison, all from the installed files."""
    for name in ("block_on_joint", "cantilever"):
        shutil.copy(ROOT / "input" / f"{name}.inp", installed.folder)
    installed("keyway-batch", "block_on_joint.inp", "cantilever.inp", "-o", "out", "--threads", "1")
    pictures = installed("keyway-plot", "out/block_on_joint").split()
    assert pictures
    assert all((installed.folder / picture).stat().st_size > 1000 for picture in pictures)
    page = installed.folder / installed("keyway-report", "out/block_on_joint").strip()
    assert "<html" in page.read_text(encoding="utf-8")
    assert "equal" in installed("keyway-compare", "out/cantilever", "out/cantilever")
    installed("keyway-compare", "out/cantilever", "out/block_on_joint", code=1)


def test_meshes_of_other_programs(installed):
    shutil.copy(ROOT / "input/gmsh_arch/gmsh_arch.msh", installed.folder)
    text = installed("keyway-mesh", "gmsh_arch.msh")
    assert "wrote gmsh_arch_mesh.inp" in text


def test_a_study_of_accuracy(installed):
    shutil.copy(ROOT / "input/cantilever.inp", installed.folder)
    installed("keyway-accuracy", "cantilever.inp", "--budget", "5s", "-o", "study")
    assert (installed.folder / "study/accuracy.html").stat().st_size > 1000


def test_the_interface_of_python(installed):
    shutil.copy(ROOT / "input/cantilever.inp", installed.folder)
    code = (
        f"import keyway; assert keyway.__file__.startswith('{installed.place}'), keyway.__file__;"
        "deck = keyway.Deck('cantilever.inp'); deck.write('copy.inp');"
        "run = keyway.run('copy.inp', threads=2, results='copied');"
        "print(run.status, len(run.energies), run.mesh().n_cells)"
    )
    words = installed("python", "-c", code).split()
    assert words[0] == "finished"
    assert int(words[1]) >= 1
    assert int(words[2]) >= 1
