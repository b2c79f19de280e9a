#!/usr/bin/env python3
"""Write the decks of input/: the small ones and the arch dams.

The mesh of input/xingbiling is large and not kept: `tools/run` lets `--only main` write it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
import make_dam
import make_motion
import make_temperature
from keyway_tools.command import Parser
from keyway_tools.small_decks import SMALL_DECKS

INPUT = Path(__file__).resolve().parents[1] / "input"
DAM_NOTES = (
    "Source: the dam of section 4.1 of Xu, Chen, Li and Yue (2014) (paper_notes.md, 14): sizes, "
    "water 105 m deep, concrete 22 GPa, 0.167, 2400 kg/m3, rock 20 GPa, 0.24, q_on = 0, friction "
    "0.6, 0.269 g. Neither its geometry nor its record is published beyond this "
    "(paper_notes.md, 16)",
    "Motion (assumed): x and y 0.269 g, z 2/3 of it, 10 s; fitted to the spectrum of NB 35047-2015 "
    "for arch dams, T_g = 0.2 s, seed 3; see motion.json",
    "Damping (assumed): 5 % at 2 and 10 Hz, Rayleigh on the elastic stiffness",
    "Joint stiffness (paper_notes.md, 3): k_n = E / 2 cm = 1.1e12 Pa/m, k_t = k_n / (2 (1 + nu))",
)
DAM_MESH = "--arc 34 --levels 14 --bottom 6 --thick 3 --joints 2"
ROCK_MESH = " --rock-upstream 5 --rock-downstream 5 --rock-deep 6"
# Elements of the dam half as long as those above, as many layers of rock: 41 226 unknowns.
MAIN_MESH = "--arc 78 --levels 32 --bottom 14 --thick 4 --joints 2"
MAIN_TIMES = " --duration 20 --picture-every 50"
MAIN_NOTES = tuple(note.replace("10 s; fitted", "20 s; fitted") for note in DAM_NOTES)
MAIN_NOTES = (
    "Shows: the paper's dam at the size of a study, 2000 increments",
    *MAIN_NOTES,
    "Expect: README.md",
)
DIFFERENT_NOTES = (
    "Shows: contraction joints between blocks whose meshes differ 3:2, without joint elements and "
    "without interface elements; the finer middle block is tied to the rock",
    *DAM_NOTES[:1],
    "Motion (assumed): that of input/xingbiling_matching",
    *DAM_NOTES[2:],
    "Expect: what the dam of one mesh gives, within what the meshes differ: README.md",
)
DIFFERENT_MESH = "--arc 16 --levels 7 --bottom 2 --thick 2 --joints 2 --refine 2"
DIFFERENT_MESH += " --fine 2 --fine-refine 3 --fine-thick 3"

BUILT_MESH = "--arc 20 --levels 8 --bottom 4 --thick 3 --joints 4"
BUILT = "--lifts 8 --grouting 4 8 --temperatures 1e-5 16 10 --seasons seasons.csv 16.5 0.5"
BUILT_SHAKEN = "--duration 5 --picture-every 50 --histories"
SEASONS = "--air 10 14 --water 12 10 6 --level 105 --year 12 --start 9 --linear --no-picture"
BUILT_NOTES = (
    "Shows: a dam that is built in eight lifts of free cantilevers, cooled and grouted in two "
    "campaigns, filled, cooled and warmed by the seasons from October on, and shaken in the middle "
    "of its second February",
    "Sizes: those of the dam of section 4.1 of Xu, Chen, Li and Yue (2014) (paper_notes.md, 14) in "
    "a mesh that runs in seconds; four joints",
    "Seasons (assumed): tools/make_temperature.py with air 10 degrees, amplitude 14, water of "
    "Zhu's formula with 12 and 10 at the surface, 6 at the bottom; straight through the thickness. "
    "Time of static steps: months in SEASONS, without a meaning in all others",
    "Motion (assumed): the first 5 s of that of input/xingbiling_matching",
    "Damping (assumed): 5 % at 2 and 10 Hz, Rayleigh on the elastic stiffness",
    "Left out: creep, heat of hydration, uplift, water in winter lower than in summer",
    "Expect: README.md",
)


def write_small_decks(folder: Path) -> None:
    """The decks of one file each, with the files that they read."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text_of in SMALL_DECKS.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text_of())
        print(f"wrote {folder / name}")


def write_motion(folder: Path, *options: str) -> None:
    """The ground motion of a dam and its spectra."""
    make_motion.main(["-o", str(folder / "motion"), "--seed", "3", *options])
    (folder / "motion_records.png").unlink()  # the spectra are sufficient


def write_dam(folder: Path) -> None:
    """The arch dam with its coarse mesh."""
    title = "Xingbiling arch dam, 135.5 m, joints between matching meshes"
    write_shaken_dam(folder, DAM_MESH + ROCK_MESH, title, DAM_NOTES, folder)


def write_main_dam(folder: Path) -> None:
    """The arch dam with its fine mesh."""
    title = "Xingbiling arch dam, 135.5 m, fine mesh, 20 s of motion"
    write_shaken_dam(folder, MAIN_MESH + ROCK_MESH + MAIN_TIMES, title, MAIN_NOTES, folder)


def write_different_dam(folder: Path) -> None:
    """The arch dam with a separate mesh in the middle block."""
    title = "Xingbiling arch dam, 135.5 m, joints between different meshes"
    motion = folder.parent / "xingbiling_matching"
    write_shaken_dam(folder, DIFFERENT_MESH + ROCK_MESH, title, DIFFERENT_NOTES, motion)


def write_built_dam(folder: Path) -> None:
    """The arch dam that is built in lifts, with the temperatures of its seasons."""
    title = "Arch dam built in lifts, grouted, filled, cooled through a winter and shaken"
    mesh = f"{BUILT_MESH} {BUILT} {BUILT_SHAKEN}"
    motion = folder.parent / "xingbiling_matching"
    write_shaken_dam(folder, mesh, title, BUILT_NOTES, motion, modes=0)
    months = [str(month) for month in range(18)]
    options = [*SEASONS.split(), "--times", *months, "-o", str(folder / "seasons.csv")]
    make_temperature.main([str(folder / f"{folder.name}.inp"), *options])


def write_shaken_dam(
    folder: Path, mesh: str, title: str, notes: tuple[str, ...], motion: Path, modes: int = 8
) -> None:
    """A dam under the motion of a folder."""
    files = [str(motion / f"motion_{axis}.txt") for axis in "xyz"]
    options = ["-o", str(folder / f"{folder.name}.inp"), *mesh.split()]
    options += ["--motion", *files, "--title", title, "--modes", str(modes)]
    for note in notes:
        options += ["--note", note]
    make_dam.main(options)


def main(arguments: list[str] | None = None) -> int:
    """Write everything below a folder."""
    parser = Parser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=INPUT, help="input/")
    parser.add_argument(
        "--only", choices=("small", "dam", "main", "built"), help="leave out the rest"
    )
    chosen = parser.parse_args(arguments)
    if chosen.only in (None, "small"):
        write_small_decks(chosen.folder)
    if chosen.only in (None, "dam"):
        write_motion(chosen.folder / "xingbiling_matching")
        write_motion(chosen.folder / "xingbiling", "--duration", "20")
        write_dam(chosen.folder / "xingbiling_matching")
        write_different_dam(chosen.folder / "xingbiling_different")
    if chosen.only in (None, "dam", "built"):
        write_built_dam(chosen.folder / "built_in_lifts")
    if chosen.only in (None, "dam", "main"):
        write_main_dam(chosen.folder / "xingbiling")
    return 0


if __name__ == "__main__":
    sys.exit(main())
