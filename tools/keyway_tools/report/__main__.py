"""Write the report of a run: one HTML page that opens from disk, without a network.

    tools/report RESULTS ... [-o FILE.html] [--job NAME] [--range WHAT] [--units mm,MPa] [--pdf]

RESULTS is the folder that a run was given with -o, or a job in it as in out/dam.json. The page
JOB_report.html in it says how the run ended, shows the key numbers, the dam in space with its
envelopes, joints, motion and modes, the histories, the cost, and what the deck assumes. Of two
folders one page shows both runs side by side. --pdf prints the page too, by Chromium, Chrome or
Edge.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..colour_scale import Scales, parse_ranges
from ..command import Parser, command
from ..deck_units import open_in_si
from ..program import command_name, reason_of
from ..results import Results
from ..si_results import SiResults, Units

START_OF_PAGE = 1000  # [bytes] in which a page says that it is HTML


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(
        prog=command_name("report"),
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("results", type=Path, nargs="+", help="folders of results, or jobs in them")
    parser.add_argument("-o", "--output", type=Path, help="the page (JOB_report.html in RESULTS)")
    parser.add_argument("--job", help="the job, where a folder has several")
    what = "end of a scale of colours, as for plot.py: full, FIELD=END"
    parser.add_argument("--range", action="append", default=[], metavar="WHAT", help=what)
    units = "of the deck, as in mm,MPa (those that its densities show, else m,Pa)"
    parser.add_argument("--units", help=units)
    parser.add_argument("--pdf", action="store_true", help="print the page to PDF, too")
    chosen = parser.parse_args(arguments)
    try:
        chosen.scales, _ = parse_ranges(chosen.range)
        chosen.units = chosen.units and Units.parse(chosen.units)
    except ValueError as error:
        parser.error(str(error))
    if chosen.output and len(chosen.results) > 2:
        parser.error("-o takes the page of one run or of two")
    return chosen


@command("report")
def main(arguments: list[str] | None = None) -> int:
    """Write the pages and print their names."""
    chosen = parse(arguments)
    try:
        refuse_other_file(chosen.output)
        jobs = [Results(folder, chosen.job).job for folder in chosen.results]
        found = [
            open_in_si(folder, job, chosen.units, "report")
            for folder, job in zip(chosen.results, jobs, strict=True)
        ]
        for results in found:
            results.find("status")
            if results.path(".h5").exists():
                results.file.keys()  # a run that is not at its end is an error
    except (OSError, ValueError, KeyError) as error:
        print(f"report: {reason_of(error)}", file=sys.stderr)
        return 2
    pages = [found] if len(found) == 2 else [[results] for results in found]
    return max(write(runs, chosen) for runs in pages)


def refuse_other_file(output: Path | None) -> None:
    """Raises ValueError where the page would replace a file that is no page, as the deck."""
    if output is None or not output.is_file():
        return
    with output.open("rb") as file:
        start = file.read(START_OF_PAGE).lower()
    if start.strip() and b"<html" not in start and b"<!doctype html" not in start:
        raise ValueError(f"{output} exists and is no HTML page; expected the name of a new file")


def write(runs: list[SiResults], chosen: argparse.Namespace) -> int:
    """Write one page, and its PDF where that is wanted."""
    # VTK takes a second to load: not for a wrong command line
    from ..shared_scales import shared_scales
    from .browser import find_browser, print_pdf
    from .page import write_page

    scales: Scales = chosen.scales
    if len(runs) > 1:
        scales = shared_scales(runs, scales)
    name = "_and_".join(dict.fromkeys(results.job for results in runs))
    path = write_page(runs, scales, chosen.output or runs[0].folder / f"{name}_report.html")
    print(path)
    if not chosen.pdf:
        return 0
    if find_browser() is None:
        why = "there is no Chromium, Chrome or Edge; print the page in your browser"
        print(f"report: no PDF: {why}", file=sys.stderr)
        return 3
    print(print_pdf(path))
    return 0


if __name__ == "__main__":
    sys.exit(main())
