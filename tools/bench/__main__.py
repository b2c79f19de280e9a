"""Measures what a run costs against the bare work of the equation solver, inside one run.

usage: .venv/bin/python tools/bench [--sizes 48000 145000] [--json FILE]

Arch dams without joints (linear scenes) of the sizes asked for. Ratios of times taken in one and
the same process hardly depend on the machine:
  static    the whole program, from deck to results, over analyse + factor + solve
  dynamic   one increment over one solve with the same matrix
Peak memory is told with them. A figure past its limit is marked, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools"))

from keyway_tools.arch_dam import DamOptions, build_arch_dam  # noqa: E402
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck  # noqa: E402
from keyway_tools.arch_rock import RockOptions  # noqa: E402
from keyway_tools.arch_shape import ArchShape  # noqa: E402
from keyway_tools.deck_text import mesh_deck  # noqa: E402
from keyway_tools.mesh_data import BrickMesh  # noqa: E402
from keyway_tools.results_folder import ResultsFolder  # noqa: E402

STATIC_LIMIT = 1.6  # whole program over analyse + factor + solve
STEP_LIMIT = 2.0  # increment over solve
MEMORY_LIMIT_MB = {145_000: 1600.0}  # of a static run
INCREMENT = 0.01  # [s]


@dataclass
class Figure:
    """One measured figure."""

    scene: str
    unknowns: int
    what: str
    value: float
    limit: float | None
    detail: str

    @property
    def is_kept(self) -> bool:
        return self.limit is None or self.value <= self.limit


def unknowns_of(mesh: BrickMesh) -> int:
    return 3 * (len(mesh.x) - len(mesh.node_sets["FIXED"]))


def dam_of_size(unknowns: int) -> BrickMesh:
    """The arch dam whose number of unknowns is nearest to the one asked for."""
    meshes: list[BrickMesh] = []
    for levels in range(6, 60):
        meshes += [scaled_dam(levels, more) for more in (0, 2, 4)]
        if unknowns_of(meshes[-3]) > unknowns:
            break
    return min(meshes, key=lambda mesh: abs(unknowns_of(mesh) - unknowns))


def scaled_dam(levels: int, more: int) -> BrickMesh:
    """An arch dam with rock, counts in proportion to its levels, and `more` along the arc."""
    layers = max(2, round(levels / 3))
    rock = RockOptions(num_upstream=layers, num_downstream=layers, num_deep=layers)
    bottom = 2 * max(1, levels // 6)
    options = DamOptions(
        num_arc=2 * levels + bottom + more,
        num_height=levels,
        num_thick=max(2, levels // 4),
        num_bottom=bottom,
        num_joints=0,
        rock=rock,
    )
    return build_arch_dam(ArchShape(), options)


def write_deck(folder: Path, name: str, mesh: BrickMesh, num_increments: int) -> Path:
    """Gravity and water, then a motion of some increments; nothing is printed or drawn."""
    motions = ()
    if num_increments:
        (folder / "motion.txt").write_text("\n".join(str(k % 5 - 2) for k in range(999)) + "\n")
        motions = ("motion.txt",)
    options = DeckOptions(
        motions=motions,
        motion_dt=INCREMENT,
        duration=num_increments * INCREMENT,
        increment=INCREMENT,
        picture_frequency=10**6,
    )
    types = {name: "C3D8" for name in mesh.brick_sets}
    (folder / f"{name}_mesh.inp").write_text(mesh_deck(mesh, types, "Mesh of bench"))
    deck = folder / f"{name}.inp"
    deck.write_text(arch_dam_deck(mesh, "bench", f"{name}_mesh.inp", options))
    return deck


def run(program: Path, deck: Path, threads: int) -> tuple[float, ResultsFolder]:
    """Seconds of the whole program, and its results."""
    out = deck.parent / f"results_{deck.stem}"
    start = time.monotonic()
    command = [str(program), "-j", str(threads), "-q", "-o", str(out), str(deck)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    seconds = time.monotonic() - start
    if done.returncode:
        raise SystemExit(f"bench: {deck} ended with code {done.returncode}")
    return seconds, ResultsFolder(out, deck.stem)


def cost(results: ResultsFolder, pattern: str) -> tuple[float, int]:
    """Seconds and calls of the ledger's parts whose name fits."""
    parts = [p for p in results.find("ledger.parts") if re.search(pattern, p["name"])]
    if not parts:
        names = ", ".join(p["name"] for p in results.find("ledger.parts"))
        raise SystemExit(f"bench: the ledger has no part like '{pattern}', it has {names}")
    return sum(p["wall_s"] for p in parts), sum(p["calls"] for p in parts)


def measure_static(program: Path, folder: Path, size: int, threads: int) -> list[Figure]:
    mesh = dam_of_size(size)
    seconds, results = run(program, write_deck(folder, f"static_{size}", mesh, 0), threads)
    # The first factorisation may have analysed on the way; then it is not told apart.
    work, _ = cost(results, "^(analyse|factorise|solve)$")
    unknowns = results.find("model.unknowns")
    memory = results.find("ledger.peak_memory_mb")
    told = f"{seconds:.2f} s over {work:.2f} s"
    scene = f"arch dam {size}"
    return [
        Figure(scene, unknowns, "static", seconds / work, STATIC_LIMIT, told),
        Figure(scene, unknowns, "memory [MB]", memory, MEMORY_LIMIT_MB.get(size), "static run"),
    ]


def measure_dynamic(program: Path, folder: Path, size: int, threads: int, count: int) -> Figure:
    """The seconds of the dynamic increments are those by which a longer run is longer."""
    mesh = dam_of_size(size)
    runs = [
        run(program, write_deck(folder, f"dynamic_{size}_{n}", mesh, n), threads)
        for n in (count, 3 * count)
    ]
    step = (runs[1][0] - runs[0][0]) / (2 * count)
    time_of_solves, num_solves = cost(runs[1][1], "^solve$")
    solve = time_of_solves / num_solves
    told = f"{step * 1e3:.1f} ms over {solve * 1e3:.1f} ms"
    unknowns = runs[1][1].find("model.unknowns")
    return Figure(f"arch dam {size}", unknowns, "dynamic", step / solve, STEP_LIMIT, told)


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("--sizes", type=int, nargs="+", default=[48_000, 145_000], help="unknowns of the scenes")
    add("--increments", type=int, default=30, help="dynamic increments (30, and thrice as many)")
    add("--threads", type=int, default=2, help="of the program (2)")
    add("--program", type=Path, default=ROOT / "build/release/keyway", help="the program")
    add("--json", type=Path, metavar="FILE", help="write the figures as JSON too")
    return parser.parse_args(arguments)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    figures: list[Figure] = []
    with tempfile.TemporaryDirectory(prefix="keyway_bench_") as name:
        for size in options.sizes:
            place = (options.program.resolve(), Path(name), size, options.threads)
            figures += measure_static(*place)
            figures.append(measure_dynamic(*place, options.increments))
    for f in figures:
        limit = "" if f.limit is None else f" (limit {f.limit:g})"
        mark = "" if f.is_kept else "  PAST THE LIMIT"
        print(f"{f.scene} ({f.unknowns} unknowns) {f.what}: {f.value:.3g}{limit}, {f.detail}{mark}")
    if options.json:
        options.json.write_text(json.dumps([asdict(f) for f in figures], indent=2) + "\n")
    return 0 if all(f.is_kept for f in figures) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
