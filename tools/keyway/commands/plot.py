"""Draw the pictures of runs, without a display.

    keyway-plot RESULTS ... [-o FOLDER] [--job NAME] [--range WHAT] [--format png,svg,pdf]
    keyway-plot RESULTS --animate mp4
    keyway-plot material CURVE.csv ... [--experiment POINTS.csv] [-o PICTURE.png]

RESULTS is the folder that a run was given with -o, or a job in it as in out/dam.json. For each job:
principal-stress, displacement and damage envelopes on the dam's faces and on sections, its damaged
elements, openings, slip and state over the joints, openings in time, the stages of construction,
the deformed shape, mode shapes, histories of nodes and energies, as far as the run has stored them.
The pictures show MPa and mm; --units says what the deck has if it is not in m and Pa. A deck in t,
mm and s is recognised. The names of the pictures are printed.

The colours of stresses end where 99 % of the nodes do if the extreme is far beyond (a corner), and
the picture says so. --range full: to the extreme; --range S1=3: to 3 MPa; --range shared: one range
for all RESULTS. --line S1=2.48 draws the line where S1 is 2.48 MPa.

`material` draws the curves of `keyway --material` (job_material_NAME.csv), several in one picture:
stress against strain, damage, energies, beside measured points (strain, stress a line) if given.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from keyway_tools.colour_scale import FIELDS, Scales, parse_levels, parse_ranges
from keyway_tools.command import Parser, command
from keyway_tools.deck_units import open_in_si
from keyway_tools.picture_style import FORMATS, Sheet
from keyway_tools.pictures_curves import (
    plot_damage_growth,
    plot_energy,
    plot_nodes,
    plot_openings,
)
from keyway_tools.pictures_joints import plot_joint_areas, plot_joint_slips, plot_joint_states
from keyway_tools.pictures_material import COMPONENTS, plot_material, read_curve
from keyway_tools.program import command_name, reason_of
from keyway_tools.results import Step, find_jobs, folder_and_job, why_incomplete
from keyway_tools.si_results import SiResults, Units

if TYPE_CHECKING:
    from keyway_tools.dam_views import Faces


def draw_job(results: SiResults, sheet: Sheet, scales: Scales) -> Iterator[list[Path]]:
    """Make the pictures of one job, one by one; no file where there is nothing to draw."""
    # VTK takes a second to load: not for a wrong command line
    from keyway_tools.dam_views import Faces
    from keyway_tools.pictures_damage import plot_damaged_elements
    from keyway_tools.pictures_shapes import plot_deformed, plot_modes
    from keyway_tools.pictures_stages import plot_stages

    def on(name: str) -> Sheet:
        return replace(sheet, path=sheet.path / f"{results.job}_{name}")

    faces = Faces(results)
    kept = [step for step in results.steps() if step.envelopes]
    if kept:
        yield from _draw_envelopes(Faces(results, kept[-1].number), kept[-1], on, scales)
    yield plot_stages(faces, on("stages"))
    yield plot_joint_slips(results, scales, on("slip_joints"))
    yield plot_joint_states(results, on("state_joints"))
    yield plot_damaged_elements(faces, scales, on("damage"))
    yield plot_deformed(faces, scales, on("deformed"))
    yield plot_modes(faces, on("modes"))
    yield plot_openings(results, on("openings"))
    yield plot_nodes(results, on("displacements"))
    yield plot_energy(results, on("energy"))
    yield plot_damage_growth(results, on("damage_growth"))


def _draw_envelopes(
    faces: Faces, step: Step, on: Callable[[str], Sheet], scales: Scales
) -> Iterator[list[Path]]:
    """The pictures of the envelopes of a step."""
    from keyway_tools.pictures_damage import plot_mean_envelope
    from keyway_tools.pictures_faces import plot_envelope, plot_face_openings
    from keyway_tools.pictures_sections import plot_section

    for name in step.means:
        yield plot_mean_envelope(faces, step, name, scales, on(f"envelope_{name.lower()}"))
    drawn = {"OPENING", *step.means}
    for name in (name for name in FIELDS if name in set(step.envelopes) - drawn):
        if np.isfinite(step.envelopes[name][faces.nodes]).any():
            yield plot_envelope(faces, step, name, scales, on(f"envelope_{name.lower()}"))
    for name in (name for name in ("S1", "S3") if name in step.envelopes):
        yield plot_section(faces, step, name, scales, on(f"section_{name.lower()}"))
    if "OPENING" in step.envelopes:
        yield plot_face_openings(faces, step, scales, on("envelope_opening"))
        yield plot_joint_areas(faces.results, step, scales, on("envelope_opening_joints"))


def draw_material(arguments: list[str]) -> int:
    """Draw curves of material tests in one picture."""
    parser = Parser(prog=f"{command_name('plot.py')} material")
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
        print(f"plot: {reason_of(error)}", file=sys.stderr)
        return 2
    return 0


def parse(arguments: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, nargs="+", help="folders of results, or jobs in them")
    parser.add_argument("-o", "--output", type=Path, help="folder of the pictures (RESULTS)")
    parser.add_argument("--job", help="only this job")
    what = "end of a scale: full, shared, FIELD=END; may be repeated"
    parser.add_argument("--range", action="append", default=[], metavar="WHAT", help=what)
    line = "draw the line of a value; may be repeated"
    parser.add_argument("--line", action="append", default=[], metavar="FIELD=VALUE", help=line)
    parser.add_argument("--format", default="png", help="png, svg, pdf, or several with commas")
    parser.add_argument("--animate", choices=("mp4", "gif"), help="only a film of the dam")
    units = "of the deck, as in mm,MPa (those that its densities show, else m,Pa)"
    parser.add_argument("--units", help=units)
    chosen = parser.parse_args(arguments)
    chosen.format = tuple(chosen.format.split(","))
    if not set(chosen.format) <= set(FORMATS):
        parser.error(f"--format: expected some of {', '.join(FORMATS)}")
    try:
        chosen.range, chosen.is_shared = parse_ranges(chosen.range)
        chosen.range = replace(chosen.range, levels=parse_levels(chosen.line))
        chosen.units = chosen.units and Units.parse(chosen.units)
    except ValueError as error:
        parser.error(str(error))
    if len(chosen.results) > 1 and chosen.output:
        parser.error("-o takes the pictures of one folder of results")
    return chosen


@command("plot")
def main(arguments: list[str] | None = None) -> int:
    """Draw every job of the folders."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments[:1] == ["material"]:
        return draw_material(arguments[1:])
    chosen = parse(arguments)
    found: list[SiResults] = []
    for given in chosen.results:
        folder, job = folder_and_job(given)
        jobs = [name] if (name := chosen.job or job) else find_jobs(folder)
        missing = [job for job in jobs if not (folder / f"{job}.h5").exists()]
        if missing or not jobs:
            what = f"{missing[0]}.h5" if missing else "job.h5"
            print(f"plot: no {what} in {folder}; give the folder of a run", file=sys.stderr)
            return 2
        found += [open_in_si(folder, job, chosen.units, "plot") for job in jobs]
    try:
        for results in found:
            if results.path(".json").exists():
                _ = results.summary  # raises ValueError where it is not whole
    except ValueError as error:
        print(f"plot: {error}", file=sys.stderr)
        return 2
    draw(found, chosen)
    return 0


def draw(found: list[SiResults], chosen: argparse.Namespace) -> None:
    """Draw the pictures of the jobs."""
    scales = chosen.range
    if chosen.is_shared:
        from keyway_tools.shared_scales import shared_scales

        scales = shared_scales(found, scales)
    for results in found:
        why = why_incomplete(results.folder, results.job)
        if why:
            print(f"plot: {results.job} is incomplete: {why}", file=sys.stderr)
        folder = chosen.output or results.folder
        folder.mkdir(parents=True, exist_ok=True)
        print_pictures(results, Sheet(folder, chosen.format, results.note), scales, chosen.animate)


def print_pictures(results: SiResults, sheet: Sheet, scales: Scales, film: str | None) -> None:
    """Make the pictures of a job, or its film, and print their names."""
    num_pictures = 0
    wanted = "*ENVELOPE, *NODE FILE, *NODE PRINT or *JOINT PRINT in the deck"
    if film:
        pictures = draw_film(results, sheet.path, scales, film)
        wanted = "U of *NODE FILE at three times or more"
    else:
        pictures = draw_job(results, sheet, scales)
    for files in pictures:
        for picture in files:
            print(picture, flush=True)
            num_pictures += 1
    if num_pictures == 0:
        print(f"plot: {results.job} has nothing to draw; request it with {wanted}", file=sys.stderr)


def draw_film(results: SiResults, folder: Path, scales: Scales, kind: str) -> Iterator[list[Path]]:
    """The film of a job."""
    from keyway_tools.animation import animate
    from keyway_tools.dam_views import Faces

    yield animate(Faces(results), scales, folder / f"{results.job}_motion.{kind}")


if __name__ == "__main__":
    sys.exit(main())
