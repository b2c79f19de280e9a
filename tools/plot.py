#!/usr/bin/env python3
"""Draw the pictures of a run, without a display.

    tools/plot.py RESULTS [-o FOLDER] [--job NAME]
    tools/plot.py material CURVE.csv ... [--experiment POINTS.csv] [-o PICTURE.png]

RESULTS is the folder that the run was given with -o. For each job in it: principal-stress,
displacement and damage envelopes on the dam's faces, its damaged elements, openings over the
joints and in time, the deformed shape, mode shapes, histories of nodes and energies, as far as the
run has stored them. Units: SI in the deck, MPa and mm in the pictures. The names of the pictures
are printed.

`material` draws the curves of `keyway --material` (job_material_NAME.csv), several in one picture:
stress against strain, damage, energies, beside measured points (strain, stress a line) if given.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from keyway_tools.pictures_curves import (
    plot_damage_growth,
    plot_energy,
    plot_nodes,
    plot_openings,
)
from keyway_tools.pictures_joints import plot_joint_areas
from keyway_tools.pictures_material import COMPONENTS, plot_material, read_curve
from keyway_tools.results import Results, find_jobs, why_incomplete


def draw_job(results: Results, folder: Path) -> Iterator[Path | None]:
    """Make the pictures of one job, one by one; None where there is nothing to draw."""
    # VTK takes a second to load: not for a wrong command line
    from keyway_tools.pictures_damage import plot_damaged_elements, plot_mean_envelope
    from keyway_tools.pictures_faces import FIELDS, Faces, plot_envelope, plot_face_openings
    from keyway_tools.pictures_shapes import plot_deformed, plot_modes

    def path_of(name: str) -> Path:
        return folder / f"{results.job}_{name}.png"

    faces = Faces(results)
    kept = [step for step in results.steps() if step.envelopes]
    if kept:
        for name in kept[-1].means:
            yield plot_mean_envelope(faces, kept[-1], name, path_of(f"envelope_{name.lower()}"))
        drawn = {"OPENING", *kept[-1].means}
        for name in (name for name in FIELDS if name in set(kept[-1].envelopes) - drawn):
            if np.isfinite(kept[-1].envelopes[name][faces.nodes]).any():
                yield plot_envelope(faces, kept[-1], name, path_of(f"envelope_{name.lower()}"))
        if "OPENING" in kept[-1].envelopes:
            yield plot_face_openings(faces, kept[-1], path_of("envelope_opening"))
            yield plot_joint_areas(results, kept[-1], path_of("envelope_opening_joints"))
    yield plot_damaged_elements(faces, path_of("damage"))
    yield plot_deformed(faces, path_of("deformed"))
    yield plot_modes(faces, path_of("modes"))
    yield plot_openings(results, path_of("openings"))
    yield plot_nodes(results, path_of("displacements"))
    yield plot_energy(results, path_of("energy"))
    yield plot_damage_growth(results, path_of("damage_growth"))


def draw_material(arguments: list[str]) -> int:
    """Draw curves of material tests in one picture."""
    parser = argparse.ArgumentParser(prog="plot.py material")
    parser.add_argument("curves", type=Path, nargs="+", help="job_material_NAME.csv")
    points = "measured points, a strain and a stress per line; may be repeated"
    parser.add_argument("-e", "--experiment", type=Path, action="append", default=[], help=points)
    component = "of strain and stress (the one whose stress changes most)"
    parser.add_argument("-c", "--component", choices=COMPONENTS, help=component)
    parser.add_argument("-o", "--output", type=Path, help="picture (beside the first curve)")
    chosen = parser.parse_args(arguments)
    path = chosen.output or chosen.curves[0].with_suffix(".png")
    try:
        curves = [read_curve(file, chosen.component) for file in chosen.curves]
        path.parent.mkdir(parents=True, exist_ok=True)
        print(plot_material(curves, chosen.experiment, path))
    except (OSError, ValueError) as error:
        print(f"plot: {error}", file=sys.stderr)
        return 2
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Draw every job of a folder."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments[:1] == ["material"]:
        return draw_material(arguments[1:])
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", type=Path, help="folder of a run's results")
    parser.add_argument("-o", "--output", type=Path, help="folder of the pictures (RESULTS)")
    parser.add_argument("--job", help="only this job")
    chosen = parser.parse_args(arguments)
    jobs = [chosen.job] if chosen.job else find_jobs(chosen.results)
    missing = [job for job in jobs if not (chosen.results / f"{job}.h5").exists()]
    if missing or not jobs:
        what = f"{missing[0]}.h5" if missing else "job.h5"
        print(f"plot: no {what} in {chosen.results}; give the folder of a run", file=sys.stderr)
        return 2
    folder = chosen.output or chosen.results
    folder.mkdir(parents=True, exist_ok=True)
    for job in jobs:
        why = why_incomplete(chosen.results, job)
        if why:
            print(f"plot: {job} is incomplete: {why}", file=sys.stderr)
        num_pictures = 0
        for picture in draw_job(Results(chosen.results, job), folder):
            if picture is not None:
                print(picture, flush=True)
                num_pictures += 1
        if num_pictures == 0:
            wanted = "*ENVELOPE, *NODE FILE, *NODE PRINT or *JOINT PRINT in the deck"
            print(f"plot: {job} has nothing to draw; request it with {wanted}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
