"""A small deck with everything that has a state, and what two runs must agree in.

A column on a shaken base: a brick of concrete that cracks; a joint of JOINT8; an elastic brick; a
joint on surfaces of different meshes; four bricks; a tie between different meshes; a brick of a
UMAT that yields. A static step with weight, a step with modes, two dynamic steps.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

CONCRETE = """*MATERIAL, NAME=CONCRETE
*DENSITY
2400
*ELASTIC
20e9, 0.2
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
20e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
40e3, 0.5
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, 2.5e-5
*MATERIAL, NAME=STEEL
*DENSITY
2400
*USER MATERIAL, CONSTANTS=6
{umat}
*DEPVAR
7
*MATERIAL, NAME=ROCK
*DENSITY
2400
*ELASTIC
20e9, 0.2
"""

STEPS = """*AMPLITUDE, NAME=SHAKE
0., 0., 0.02, 1., 0.05, -1.2, 0.09, 1., 0.12, -0.5, 0.15, 0.
*STEP, NAME=WEIGHT
*RESTART, WRITE, FREQUENCY={frequency}
*STATIC
0.1, 1., 0.01, 0.1
{controls}*DLOAD
ALL, GRAV, 9.81, 0, 0, -1
*NODE PRINT, NSET=TOP
U, V
*EL PRINT, ELSET=FOOT, FREQUENCY=2
S, DAMAGET
*JOINT PRINT, JOINT=BED
OPENING
*NODE FILE, FREQUENCY=4
U, OPENING
*EL FILE, FREQUENCY=4
S, SP, DAMAGET, SDV
*ENVELOPE
S1, U, OPENING, DAMAGET
*END STEP
*STEP, NAME=MODES
*FREQUENCY
2
*END STEP
*STEP, NAME=QUAKE
*DYNAMIC
0.0025, 0.15, 1e-5, 0.0025
*BASE MOTION, DOF=1, AMPLITUDE=SHAKE, SCALE=6.
*ENVELOPE
S1, U, OPENING, DAMAGET
*END STEP
{last}"""

LAST = """*STEP, NAME=AFTER
*DYNAMIC
0.0025, 0.02, 1e-5, 0.0025
*CLOAD
TOP, 1, {force}
*ENVELOPE
S3
*END STEP
"""


def bricks(first: int, cells: int, z: float, side: float = 1.0) -> tuple[list[str], list[str]]:
    """Nodes and elements of a layer of cells x cells bricks, 1 m high; ids from `first` on."""
    n = cells + 1
    nodes = [
        f"{first + n * n * k + n * j + i}, {side * i / cells}, {side * j / cells}, {z + k}"
        for k in (0, 1)
        for j in range(n)
        for i in range(n)
    ]
    elements = []
    for j in range(cells):
        for i in range(cells):
            low = [first + n * (j + b) + i + a for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            ids = [first + cells * j + i, *low, *(node + n * n for node in low)]
            elements.append(", ".join(map(str, ids)))
    return nodes, elements


def deck(*, frequency: int = 4, controls: str = "", last: str | None = None) -> str:
    """The deck; `controls` are cards of the first step, `last` is the last step."""
    layers = {"FOOT": (1, 1, 0.0), "MIDDLE": (101, 1, 1.0), "FOUR": (201, 2, 2.0),
              "HEAD": (301, 1, 3.0)}  # fmt: skip
    kinds = {"FOOT": "C3D8I", "MIDDLE": "C3D8I", "FOUR": "C3D8I", "HEAD": "C3D8B"}
    materials = {"FOOT": "CONCRETE", "MIDDLE": "ROCK", "FOUR": "ROCK", "HEAD": "STEEL"}
    parts = {name: bricks(*layer) for name, layer in layers.items()}
    lines = ["*NODE", *(line for nodes, _ in parts.values() for line in nodes)]
    for name, (_, elements) in parts.items():
        lines += [f"*ELEMENT, TYPE={kinds[name]}, ELSET={name}", *elements]
    lines += ["*ELEMENT, TYPE=JOINT8, ELSET=BED", "901, 5, 6, 8, 7, 101, 102, 104, 103"]
    lines += ["*ELSET, ELSET=ALL", "FOOT, MIDDLE, FOUR, HEAD"]
    lines += ["*NSET, NSET=BASE", "1, 2, 3, 4", "*NSET, NSET=TOP", "305, 306, 307, 308"]
    for name, face in (("MIDDLE", 2), ("FOUR", 1), ("FOUR", 2), ("HEAD", 1)):
        lines += [f"*SURFACE, NAME={name}{face}, TYPE=ELEMENT", f"{name}, S{face}"]
    lines += [CONCRETE.format(umat="20e9, 0.2, 60e3, 0., 61e3, 0.01").rstrip()]
    lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL={m}" for name, m in materials.items()]
    lines += ["*JOINT LAW, NAME=DRY, KN=1e11, KT=1e11, FRICTION=0.6"]
    lines += ["*JOINT, NAME=BED, ELSET=BED, LAW=DRY", "*JOINT, NAME=UPPER, LAW=DRY"]
    lines += ["FOUR1, MIDDLE2", "*TIE, NAME=GLUE", "FOUR2, HEAD1", "*BOUNDARY", "BASE, 1, 3"]
    last = LAST.format(force=100) if last is None else last
    steps = STEPS.format(frequency=frequency, controls=controls, last=last)
    return "\n".join(lines) + "\n" + steps


def start(program: Path, *arguments: str | Path, **options) -> subprocess.Popen:
    """Starts the program with the signals as a shell sets them, whatever those of pytest are."""

    def usual_signals() -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXFSZ):
            signal.signal(number, signal.SIG_DFL)

    return subprocess.Popen(
        [program, *arguments],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        preexec_fn=usual_signals,  # noqa: PLW1509 (the tests have one thread)
        **options,
    )


def rows_of(path: Path) -> int:
    """Lines of a table below its header; 0 while there is none."""
    return max(path.read_bytes().count(b"\n") - 1, 0) if path.exists() else 0


def kill_at(process: subprocess.Popen, table: Path, row: int, number: int, delay: float) -> None:
    """Sends a signal a moment after a table has a row; does nothing to a run that has ended."""
    while process.poll() is None and rows_of(table) < row:
        time.sleep(0.0005)
    time.sleep(delay)
    if process.poll() is None:
        os.kill(process.pid, number)


def continue_killed(
    program: Path,
    deck_file: Path,
    out: Path,
    options: list[str],
    kills: list[tuple[int, float]],
    goes_on: bool = False,
) -> int:
    """Runs the deck, kills it at each (row, delay) and goes on; returns the number of kills."""
    table = out / f"{deck_file.stem}_energy.csv"
    num_killed = 0
    more = ["--continue"] if goes_on else []
    for row, delay in kills:
        process = start(program, "-q", "-o", out, *options, *more, deck_file)
        kill_at(process, table, row, signal.SIGKILL, delay)
        _, text = process.communicate()
        assert process.returncode in (0, -signal.SIGKILL), text
        num_killed += process.returncode != 0
        more = (
            ["--continue"] if list(out.glob("*.ckpt.h5")) or list(out.glob("*.ckpt_old.h5")) else []
        )
    process = start(program, "-q", "-o", out, *options, *more, deck_file)
    _, text = process.communicate()
    assert process.returncode == 0, text
    return num_killed


def random_kills(seed: int, num_rows: int) -> list[tuple[int, float]]:
    """One to three kills of one run, at growing rows."""
    choice = random.Random(seed)
    rows = sorted(choice.sample(range(1, num_rows), choice.randint(1, 3)))
    return [(row, choice.random() * 0.01) for row in rows]


def contents(path: Path) -> dict[str, tuple]:
    """All groups, arrays and attributes of an HDF5 file, bit by bit; without the ledger."""
    found = {}

    def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if name.startswith("ledger"):
            return
        attributes = sorted((k, np.asarray(v).tobytes()) for k, v in item.attrs.items())
        data = (item.shape, item.dtype.str, item[()].tobytes()) if hasattr(item, "shape") else ()
        found[name] = (attributes, data)

    with h5py.File(path) as file:
        file.visititems(visit)
    return found


def differences(one: Path, other: Path) -> list[str]:
    """Names of result files, and of what is in job.h5, that differ between two folders."""

    def names(folder: Path) -> set[str]:
        own = (".csv", ".pvd", ".vtu", ".h5")
        files = (p for p in folder.rglob("*") if p.suffix in own and ".ckpt" not in p.name)
        return {str(p.relative_to(folder)) for p in files}

    found = sorted(names(one) ^ names(other))
    for name in sorted(names(one) & names(other)):
        if name.endswith(".h5"):
            a, b = contents(one / name), contents(other / name)
            found += [
                f"{name}:{key}" for key in sorted(a.keys() | b.keys()) if a.get(key) != b.get(key)
            ]
        elif (one / name).read_bytes() != (other / name).read_bytes():
            found.append(name)
    return found


def main(program: Path, folder: Path, num_runs: int) -> None:
    """Prints the table of kills of docs/reliability.md: program, an empty folder, runs a line."""
    umat = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
    library, path = folder / "j2.so", folder / "job.inp"
    subprocess.run([program, "--umat", umat, "--umat-library", library], check=True)
    print("| threads | tangent | runs | kills | continued, bit by bit the same |")
    print("|---|---|---|---|---|")
    for threads in (1, 2):
        for tangent in ("AUTO", "CONSISTENT"):
            path.write_text(deck(controls=f"*CONTROLS, TANGENT={tangent}\n"))
            options = ["-j", str(threads), "--umat", str(library)]
            whole = folder / f"whole_{threads}_{tangent}"
            subprocess.run([program, "-q", "-o", whole, *options, path], check=True)
            num_kills = num_same = 0
            for seed in range(num_runs):
                out = folder / f"killed_{threads}_{tangent}_{seed}"
                kills = random_kills(seed, rows_of(whole / "job_energy.csv"))
                num_kills += continue_killed(program, path, out, options, kills)
                num_same += not differences(whole, out)
            print(f"| {threads} | {tangent} | {num_runs} | {num_kills} | {num_same} |", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
