"""Measures the time of runs relative to the equation solver, and the time for given accuracy.

usage: .venv/bin/python tools/bench [run] [accuracy] [joints] [cracks] [reduced] [scale]
           [estimates] [peers] [forecast] [ranks]
           [--sizes N ...] [--json FILE]

run (default): ratios of times taken in one process, which hardly depend on the machine:
  static    the whole program, from deck to results, over analyse + factor + solve
  dynamic   one linear increment over one solve with the same matrix; also with two joints
  sound     increments of undamaged concrete, over the same without the time of its laws
Peak memory and the time to read a large deck are measured too. A figure past its limit is marked,
and the exit code is 1.

accuracy: a small arch dam with finer meshes, every element, and smaller increments: time of the
run against the errors of displacement, stress and frequency, as in docs/accuracy.md; --picture
FILE draws them.

joints: dams of --joints joints in a strong motion: an increment in solves, the set-up of the joints
in factorisations.

cracks: a dam with two joints whose concrete cracks, Table 1 and a table of openings: increments in
solves, iterations, share of the laws. --refine divides its elements.

Both, and run, count in solves of the program and in solves of CHOLMOD alone with the same matrix,
before and after the run: build `bench_bare_solve` beside the program. Without it run prints a line
and leaves these figures out.

reduced: a dam with the first of --joints joints, with the full and with the reduced model: time of
an increment, error of the openings and its estimate.

scale: growth of time and memory with the unknowns of a linear dam (10 000 to 400 000, or --sizes),
and with the points of joints in a strong motion (1 to 50 --joints, 160 to 11 000 points); exponents
are printed, and --picture FILE draws them. With --keep FILE each size is kept as soon as it is
measured, and a second call goes on. A size that would need more than --memory MB (what is free) is
left out with a line.

estimates: the share of the estimates of errors in the time of each deck of input/ (or --decks).

peers: the same dam in Keyway, CalculiX (Debian's calculix-ccx) and OpenSees (pip's openseespy, in
a Python named by --opensees-python): weight, a linear history, a history with two joints. Time,
memory and displacements side by side, as in docs/studies/other_programs.md. The first of --sizes
is used.

ranks: a linear dam on 1, 2 and 4 processes with both solvers, beside the program with two threads;
--petsc-program is the program of the preset petsc (docs/large_models.md).

forecast: what `keyway --check` says of --decks (all of input/) on an idle machine, and what their
runs took, as in docs/performance.md.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

SIZES = [48_000, 145_000]  # unknowns of the models of `run`
ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools"))

from cost_forecast import decks_of, measure_forecasts  # noqa: E402
from cost_of_accuracy import draw, measure_accuracy, tables  # noqa: E402
from cost_of_cracks import measure_cracks  # noqa: E402
from cost_of_estimates import HEAD, decks_of_input, measure_estimates  # noqa: E402
from cost_of_joints import DAMS, measure_joints  # noqa: E402
from cost_of_ranks import measure_ranks  # noqa: E402
from cost_of_reduced import measure_reduced  # noqa: E402
from cost_of_run import Figure, measure_all  # noqa: E402
from cost_of_scale import ScaleOptions, draw_growth, measure_scale  # noqa: E402
from keyway_tools.option_types import above_zero, count  # noqa: E402
from measured_run import Program  # noqa: E402
from peers.comparison_of_peers import PeerOptions, compare_peers  # noqa: E402


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("what", nargs="*", metavar="run|accuracy|joints|...", help="what to measure (run)")
    add("--sizes", type=count, nargs="+", help="unknowns of the models (48000 145000)")
    add("--increments", type=count, default=60, help="dynamic increments (60)")
    add("--joints", type=int, nargs="+", choices=DAMS, help="of the dams (2 12)")
    add("--refine", type=count, default=1, help="of the dam that cracks (1)")
    add("--threads", type=count, default=2, help="of the program (2)")
    add("--program", type=Path, default=ROOT / "build/release/keyway", help="the program")
    petsc = ROOT / "build/petsc/keyway"
    add("--petsc-program", type=Path, default=petsc, help="the program of several processes")
    add("--decks", type=Path, nargs="+", help="of estimates and forecast (all of input/)")
    add("--json", type=Path, metavar="FILE", help="write the figures as JSON too")
    add("--limit", type=above_zero, default=200.0, help="of a run of peers (200) [s]")
    add("--memory", type=above_zero, help="that a run of scale may take (what is free) [MB]")
    add("--keep", type=Path, metavar="FILE", help="of the sizes of scale that are measured")
    add("--opensees-python", metavar="PYTHON", help="a Python that has openseespy")
    add("--picture", type=Path, metavar="FILE", help="draw time against accuracy")
    options = parser.parse_args(arguments)
    options.what = options.what or ["run"]
    known = {"run", "accuracy", "joints", "cracks", "reduced", "scale", "estimates", "peers",
             "forecast", "ranks"}  # fmt: skip
    if set(options.what) - known:
        parser.error(f"expected one of {', '.join(sorted(known))}")
    return options


def table(figures: list[Figure]) -> str:
    """Figures as lines of a table in Markdown."""
    lines = ["| model | what | measured | limit | |", "|---|---|---|---|---|"]
    for f in figures:
        limit = "" if f.limit is None else f"{f.limit:g}"
        mark = "" if f.is_kept else " PAST THE LIMIT"
        lines.append(f"| {f.scene} | {f.what} | {f.value:.4g} | {limit} | {f.detail}{mark} |")
    return "\n".join(lines)


def peer_options(options: argparse.Namespace) -> PeerOptions:
    """The programs that are there."""
    return PeerOptions(
        keyway=options.program.resolve(),
        calculix=shutil.which("ccx"),
        opensees_python=options.opensees_python,
        threads=options.threads,
        unknowns=(options.sizes or [20_000])[0],
        limit=options.limit,
    )


def report_scale(program: Program, folder: Path, options: argparse.Namespace) -> None:
    wanted = ScaleOptions(
        sizes=options.sizes or [10_000, 25_000, 50_000, 100_000, 200_000, 400_000],
        joints=options.joints or list(DAMS),
        memory=options.memory,
        keep=options.keep,
    )
    growths = measure_scale(program, folder, wanted)
    print("\n\n".join(growth.table() for growth in growths))
    if options.picture:
        draw_growth(growths, options.picture)


def report_others(program: Program, folder: Path, options: argparse.Namespace) -> None:
    """Measurements that have a report of their own."""
    if "scale" in options.what:
        report_scale(program, folder, options)
    if "estimates" in options.what:
        print(HEAD)
        decks = options.decks or decks_of_input(ROOT / "input")
        measure_estimates(program, decks, folder)
    if "forecast" in options.what:
        decks = options.decks or decks_of(ROOT / "input")
        print(measure_forecasts(program, folder, decks))
    if "ranks" in options.what:
        measure_ranks(program, options.petsc_program.resolve(), folder, options.sizes or [100_000])
    if "peers" in options.what:
        compare_peers(peer_options(options), folder)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    figures: list[Figure] = []
    rows = []
    with tempfile.TemporaryDirectory(prefix="keyway_bench_") as name:
        program, folder = Program(options.program.resolve(), options.threads), Path(name)
        if "run" in options.what:
            figures = measure_all(program, folder, options.sizes or SIZES, options.increments)
            print(table(figures))
        if "accuracy" in options.what:
            rows = measure_accuracy(Program(program.path, 1), folder)
            print(tables(rows))
        if "joints" in options.what:
            duration = 0.01 * options.increments  # of 0.01 s each
            print(measure_joints(program, folder, options.joints or [2, 12], duration))
        if "cracks" in options.what:
            duration = 0.04 * options.increments  # strong motion has begun after 0.4 s
            print(measure_cracks(program, folder, options.refine, duration))
        if "reduced" in options.what:
            duration = 0.01 * options.increments
            print(measure_reduced(program, folder, (options.joints or [2])[0], duration))
        report_others(program, folder, options)
    if options.picture and rows:
        draw(rows, options.picture)
    if options.json:
        options.json.write_text(json.dumps([asdict(f) for f in figures + rows], indent=2) + "\n")
    return 0 if all(f.is_kept for f in figures) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
