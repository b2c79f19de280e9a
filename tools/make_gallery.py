#!/usr/bin/env python3
"""Runs small decks of input/ and draws their pictures for the gallery of the site.

usage: make_gallery.py [-o FOLDER]

Writes the page of the gallery into FOLDER and the pictures beside it. Runs and pictures that are
newer than the program and their deck are kept. `mkdocs build` calls this tool (site_hooks.py).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway_tools.command import Parser
from keyway_tools.program import given_program

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build" / "gallery"

INTRODUCTION = """\
# Gallery

Pictures of small decks that come with Keyway, drawn while this site was built. Each of these runs
takes seconds:

    keyway -o results DECK.inp
    keyway-plot results

[Pictures and reports](pictures.md) lists all pictures. Larger dams are shown where they are
studied: [hard cases](hard_cases.md), [accuracy](accuracy.md), [fragility](fragility.md).
"""


@dataclass(frozen=True)
class Scene:
    """A deck and those of its pictures that are shown."""

    title: str
    deck: str  # below input/
    text: str
    pictures: tuple[str, ...]  # names without the job
    is_material: bool = False

    @property
    def job(self) -> str:
        return Path(self.deck).stem


SCENES = (
    Scene(
        "An arch dam meshed with Gmsh",
        "gmsh_arch/gmsh_arch.inp",
        "Water and a short pulse open both contraction joints ([how](gmsh.md)).",
        ("envelope_opening_joints", "openings", "envelope_s1", "deformed", "energy"),
    ),
    Scene(
        "Xingbiling under an earthquake, reduced model",
        "fragility/fragility.inp",
        "The deck that runs 200 times in [fragility](fragility.md).",
        ("envelope_opening", "displacements"),
    ),
    Scene(
        "A gravity dam under water",
        "monolith_water.inp",
        "Largest principal stress of the [first dam](tutorials/first_dam.md).",
        ("envelope_s1",),
    ),
    Scene(
        "Its natural modes",
        "monolith_frequencies.inp",
        "Shapes from the side, with effective masses.",
        ("modes",),
    ),
    Scene(
        "A block that slides",
        "sliding_block.inp",
        "Friction on a shaken base: the model of [a hundred records](tutorials/many_records.md).",
        ("displacements",),
    ),
    Scene(
        "Concrete at a point",
        "material/dam_concrete.inp",
        "Tests of a material before it goes into a dam ([materials](material.md)).",
        ("material",),
        is_material=True,
    ),
)


def run(scene: Scene, program: Path, folder: Path) -> None:
    """Run a deck into a folder and draw its pictures."""
    shutil.rmtree(folder, ignore_errors=True)
    options = ["--material"] if scene.is_material else []
    deck = ROOT / "input" / scene.deck
    call(str(program), "-q", "-j", "1", *options, "-o", str(folder), str(deck))
    plot = [sys.executable, str(ROOT / "tools" / "plot.py")]
    if scene.is_material:
        curves = sorted(map(str, folder.glob(f"{scene.job}_material_*.csv")))
        call(*plot, "material", *curves, "-o", str(folder / f"{scene.job}_material.png"))
    else:
        call(*plot, str(folder))


def call(*command: str) -> None:
    """Run a command. Raises RuntimeError with what it said."""
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr or done.stdout}")


def is_fresh(scene: Scene, program: Path, pictures: list[Path]) -> bool:
    """Whether all pictures are newer than the program and the files of the deck."""
    sources = [program, *(ROOT / "input" / scene.deck).parent.glob("*.inp")]
    if not all(picture.exists() for picture in pictures):
        return False
    oldest = min(picture.stat().st_mtime for picture in pictures)
    return oldest > max(source.stat().st_mtime for source in sources)


def make_gallery(folder: Path = FOLDER) -> dict[str, Path]:
    """Write the page and the pictures; the pictures by their names in the page.

    Raises FileNotFoundError where there is no program, RuntimeError for a run that fails.
    """
    program = given_program(None)
    parts, files = [INTRODUCTION], {}
    for scene in SCENES:
        results = folder / scene.job
        pictures = [results / f"{scene.job}_{name}.png" for name in scene.pictures]
        if not is_fresh(scene, program, pictures):
            run(scene, program, results)
        parts.append(f"## {scene.title}\n\n{scene.text} Deck: `input/{scene.deck}`.\n")
        for picture in pictures:
            name = f"gallery/{picture.name}"
            files[name] = picture
            parts.append(f"![{scene.title}: {picture.stem}]({name})\n")
    (folder / "gallery.md").write_text("\n".join(parts), encoding="utf-8")
    return files


def main(arguments: list[str] | None = None) -> int:
    """Make the gallery."""
    parser = Parser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=FOLDER)
    options = parser.parse_args(arguments)
    for picture in make_gallery(options.output).values():
        print(picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
