"""The runs whose increments become joint problems."""

from __future__ import annotations

import contextlib
import subprocess
from itertools import chain, product
from pathlib import Path

import crossing_cases as crossings
from block_cases import BLOCKS

LIMIT = 120.0  # time of a run [s]


class Saver:
    """A program that saves the increments with more iterations than some number."""

    def __init__(self, program: Path, folder: Path, iterations: int):
        self.program, self.folder, self.iterations = program, folder, iterations

    def __call__(self, deck: str, *options: str, name: str = "job", files=None, **_):
        (self.folder / f"{name}.inp").write_text(deck, encoding="utf-8")
        for other, text in (files or {}).items():
            (self.folder / other).write_text(text, encoding="utf-8")
        command = [str(self.program), "-q", "-j", "1", "-o", str(self.folder / "out"), *options]
        command += ["--save-joint-problems", str(self.iterations), str(self.folder / f"{name}.inp")]
        with contextlib.suppress(subprocess.TimeoutExpired):
            subprocess.run(command, timeout=LIMIT, capture_output=True, check=False)
        raise RunIsOver


class RunIsOver(Exception):  # noqa: N818
    """The results of the run do not matter."""


def crossing(friction: float, meshes: tuple[int, int], push: float):
    def run(keyway):
        blocks, pairs, names = crossings.four_blocks(meshes)
        side = blocks.side("C", "X0")
        weight = 4 * 125.0 * 2400.0 * crossings.GRAVITY
        load = f"*CLOAD\nSIDE, 1, {push * weight / len(side)!r}\n"
        more = crossings.node_set("SIDE", side)
        crossings.stand(keyway, blocks, pairs, names, friction, load, more)

    return run


def arch(count: int, meshes: tuple[int, int], thick: float, friction: float):
    def run(keyway):
        crossings.stand_arch(keyway, count, meshes, thick, friction)

    return run


def monoliths(facets: int, friction: float, size: float, duration: float):
    def run(keyway):
        crossings.shaken_monoliths(keyway, facets, friction, size, duration)

    return run


def shaken(friction: float, size: float, meshes: tuple[int, int]):
    def run(keyway):
        crossings.shake_crossing(keyway, friction, size, meshes)

    return run


def crossing_runs():
    for meshes in ((1, 1), (1, 2), (2, 1), (2, 3)):
        for friction, push in product((0.3, 0.5, 0.7, 0.9, 1.2), (0.1, 0.3)):
            yield f"crossing_{meshes[0]}_{meshes[1]}", 4, crossing(friction, meshes, push)
    for meshes in ((1, 1), (1, 2), (2, 3)):
        for friction, size in product((0.4, 0.8, 1.2), (0.3, 0.8)):
            yield f"shaken_{meshes[0]}_{meshes[1]}", 4, shaken(friction, size, meshes)


def arch_runs():
    for count, meshes, thick in ((8, (1, 1), 1.6), (12, (1, 2), 1.5), (16, (1, 1), 1.2)):
        for friction in (0.4, 0.6, 1.0):
            yield f"arch_{count}", 4, arch(count, meshes, thick, friction)


def monolith_runs():
    for facets, friction in product((3, 4, 5, 6), (0.5, 0.7, 1.0, 1.5)):
        yield f"monoliths_{facets}", 8, monoliths(facets, friction, 0.5, 0.6)


def case_runs():
    """Hard cases as they are."""
    for number, case in enumerate(BLOCKS.cases, 1):
        if not case.full:
            yield f"block_{number}", 3, case.judge
    for case in crossings.CROSSINGS.cases:
        if case.name.startswith(("T crossing", "lift")):
            yield case.name.split()[0].lower(), 3, case.judge


def large_runs():
    for friction in (0.6, 1.0):
        yield "arch_12_fine", 6, arch(12, (2, 4), 1.5, friction)
        yield "arch_10_fine", 6, arch(10, (8, 8), 2.0, friction)
        yield "monoliths_15", 12, monoliths(15, friction, 0.8, 0.6)


def runs(full: bool):
    """Names of files, most iterations of an increment that is not saved, and runs."""
    parts = [crossing_runs(), arch_runs(), monolith_runs(), case_runs()]
    return chain(*parts, large_runs() if full else ())
