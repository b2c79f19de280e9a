#!/usr/bin/env python3
"""Write the decks of input/ anew: the small ones and the dam of input/xingbiling_matching."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import make_dam
import make_motion
from keyway_tools.small_decks import SMALL_DECKS

INPUT = Path(__file__).resolve().parents[1] / "input"
DAM_NOTES = (
    "Source: the dam of section 4.1 of Xu, Chen, Li and Yue (2014) as NOTES 14 gives it: sizes, "
    "water 105 m deep, concrete 22 GPa, 0.167, 2400 kg/m3, rock 20 GPa, 0.24, q_on = 0, friction "
    "0.6, 0.269 g. Neither its geometry nor its record is published beyond this (NOTES 16)",
    "Motion (assumed): x and y 0.269 g, z 2/3 of it, 10 s; fitted to the spectrum of NB 35047-2015 "
    "for arch dams, T_g = 0.2 s, seed 3; see motion.json",
    "Damping (assumed): 5 % at 2 and 10 Hz, Rayleigh on the elastic stiffness",
    "Joint stiffness (NOTES 3): k_n = E / 2 cm = 1.1e12 Pa/m, k_t = k_n / (2 (1 + nu))",
)
DAM_MESH = "--arc 34 --levels 14 --bottom 6 --thick 3 --joints 2"
DAM_MESH += " --rock-upstream 5 --rock-downstream 5 --rock-deep 6"


def write_small_decks(folder: Path) -> None:
    """The decks of one file each, with what they read."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text_of in SMALL_DECKS.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text_of())
        print(f"wrote {folder / name}")


def write_dam(folder: Path) -> None:
    """The arch dam and its ground motion."""
    make_motion.main(["-o", str(folder / "motion"), "--seed", "3"])
    files = [str(folder / f"motion_{axis}.txt") for axis in "xyz"]
    (folder / "motion_records.png").unlink()  # the spectra say enough
    options = ["-o", str(folder / "xingbiling_matching.inp"), *DAM_MESH.split(), "--motion", *files]
    options += ["--title", "Xingbiling arch dam, 135.5 m, joints between matching meshes"]
    options += ["--modes", "8"]
    for note in DAM_NOTES:
        options += ["--note", note]
    make_dam.main(options)


def main(arguments: list[str] | None = None) -> int:
    """Write everything below a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=INPUT, help="input/")
    parser.add_argument("--only", choices=("small", "dam"), help="leave out the rest")
    chosen = parser.parse_args(arguments)
    if chosen.only != "dam":
        write_small_decks(chosen.folder)
    if chosen.only != "small":
        write_dam(chosen.folder / "xingbiling_matching")
    return 0


if __name__ == "__main__":
    sys.exit(main())
