"""Time of runs relative to the bare work of the equation solver: ratios within one process."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from bare_cholmod import BareSolve, bench_program, measure_beside, missing_program
from measured_run import Program, Run
from scenes import INCREMENT, dam_of_size, make_concrete, scaled_dam, write_deck

STATIC_LIMIT = 1.6  # whole program over analyse + factor + solve
STEP_LIMIT = 2.0  # linear increment over solve
SOUND_LIMIT = 1.5  # increment of undamaged concrete over the same without its laws
MEMORY_LIMIT_MB = {145_000: 1600.0}  # of a static run
READING_LIMIT = 2.0  # [s] for 200 000 nodes and elements

# Parts of the ledger that occur once in a step, not in its increments.
ONCE = (
    "start program|read deck|open results|assemble .*|analyse structure|factor structure|"
    "condense .*|solve initial acceleration"
)


@dataclass
class Figure:
    """One measured figure."""

    scene: str
    what: str
    value: float
    limit: float | None
    detail: str

    @property
    def is_kept(self) -> bool:
        return self.limit is None or self.value <= self.limit


def measure_static(program: Program, folder: Path, size: int) -> list[Figure]:
    run = program.run(write_deck(folder, f"static_{size}", dam_of_size(size)))
    work, _ = run.cost("(analyse|factor|solve) structure")
    scene = f"arch dam, {run.unknowns} unknowns"
    detail = f"{run.wall:.2f} s over {work:.2f} s for analyse + factor + solve"
    memory = run.results.find("ledger.peak_memory_mb")
    return [
        Figure(scene, "static run / bare solver", run.wall / work, STATIC_LIMIT, detail),
        Figure(scene, "memory of the static run [MB]", memory, MEMORY_LIMIT_MB.get(size), ""),
    ]


def measure_dynamic(program: Program, folder: Path, size: int, count: int) -> list[Figure]:
    """Linear increments with hardly any output, and with envelopes of the stresses.

    The first over a solve of CHOLMOD alone, too, where the program of the bare solves is built:
    with the factor in double precision, and with a copy in single precision.
    """
    has_bare = bench_program(program).exists()
    if not has_bare:
        print(f"bench: no figure over bare solves: {missing_program(program)}", flush=True)
    mesh = dam_of_size(size)
    figures = []
    for has_envelopes in (False, True):
        name = f"dynamic_{size}_{has_envelopes:d}"
        deck = write_deck(folder, name, mesh, count * INCREMENT, has_envelopes=has_envelopes)
        if has_bare and not has_envelopes:
            run, bare = measure_beside(program, deck, partial(program.run, deck))
            figures.append(over_bare_solve(run, bare))
            mixed = with_single_copy(deck)
            run, bare = measure_beside(program, mixed, partial(program.run, mixed))
            figures.append(over_bare_solve(run, bare, ", PRECISION=MIXED"))
        else:
            run = program.run(deck)
        what = "linear increment" + (" with envelopes" if has_envelopes else "") + " / solve"
        limit = None if has_envelopes else STEP_LIMIT
        figures.append(ratio_of_increment(run, "solve structure", what, limit))
    return figures


def with_single_copy(deck: Path) -> Path:
    """The same run with a copy of the factor in single precision."""
    copy = deck.with_name(f"{deck.stem}_mixed.inp")
    copy.write_text(deck.read_text().replace("*DYNAMIC", "*CONTROLS, PRECISION=MIXED\n*DYNAMIC"))
    return copy


def measure_jointed(program: Program, folder: Path, size: int, count: int) -> Figure:
    """Increments of a dam whose two joints open and slide."""
    mesh = dam_of_size(size, num_joints=2)
    deck = write_deck(folder, f"jointed_{size}", mesh, count * INCREMENT, has_envelopes=False)
    run = program.run(deck)
    what = "increment with two joints / solve"
    return ratio_of_increment(run, "solve( forward| backward)? structure", what, None)


def measure_sound(program: Program, folder: Path, size: int, count: int) -> Figure:
    """Increments of a dam of undamaged concrete, with and without the time of the laws."""
    mesh = dam_of_size(size)
    deck = write_deck(folder, f"sound_{size}", mesh, count * INCREMENT, has_envelopes=False)
    run = program.run(make_concrete(deck))
    laws, calls = run.cost("update .*")
    once, _ = run.cost(ONCE)
    whole = run.results.find("ledger.wall_s") - once
    detail = f"{len(mesh.brick_sets['DAM'])} elements, laws {laws / calls * 1e3:.1f} ms a call"
    scene = f"arch dam, {run.unknowns} unknowns"
    what = "increment of undamaged concrete / without its laws"
    return Figure(scene, what, whole / (whole - laws), SOUND_LIMIT, detail)


def time_of_increment(run: Run, count: int) -> float:
    """Seconds from the first increment to the end, over the increments."""
    return (run.results.find("ledger.wall_s") - run.cost(ONCE)[0]) / count


def over_bare_solve(run: Run, bare: BareSolve, settings: str = "") -> Figure:
    """A linear increment over a solve of CHOLMOD in the order of METIS, in double precision."""
    step = time_of_increment(run, run.cost("solve structure")[1])
    detail = (
        f"{step * 1e3:.1f} ms over {bare.own_order * 1e3:.1f} ms; "
        f"{bare.same_order * 1e3:.1f} ms in the order of the program"
    )
    scene = f"arch dam, {run.unknowns} unknowns"
    what = f"linear increment{settings} / solve of CHOLMOD alone"
    return Figure(scene, what, step / bare.own_order, None, detail)


def ratio_of_increment(run: Run, solving: str, what: str, limit: float | None) -> Figure:
    """Time from the first increment to the end over the time of the solves, in one process."""
    time_of_solves, count = run.cost(solving)
    step, solve = time_of_increment(run, count), time_of_solves / count
    detail = f"{step * 1e3:.1f} ms over {solve * 1e3:.1f} ms"
    return Figure(f"arch dam, {run.unknowns} unknowns", what, step / solve, limit, detail)


def measure_reading(program: Program, folder: Path) -> Figure:
    """An arch dam of some 200 000 nodes and elements, read and verified (processor seconds).

    It is too large for --check to plan its factor for the forecast, which would be measured too.
    """
    mesh = scaled_dam(46, 0, 0)
    deck = write_deck(folder, "reading", mesh)
    seconds = program.check(deck)
    size = (folder / "reading_mesh.inp").stat().st_size / 1.0e6
    scene = f"arch dam, {len(mesh.x) + len(mesh.bricks)} nodes and elements"
    detail = f"{size:.1f} MB"
    return Figure(scene, "deck read and verified [s]", seconds, READING_LIMIT, detail)


def measure_all(program: Program, folder: Path, sizes: list[int], count: int) -> list[Figure]:
    figures = [measure_reading(program, folder)]
    for size in sizes:
        figures += measure_static(program, folder, size)
        figures += measure_dynamic(program, folder, size, count)
        figures.append(measure_jointed(program, folder, size, count))
        figures.append(measure_sound(program, folder, size, count))
    return figures
