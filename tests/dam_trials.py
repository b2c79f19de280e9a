"""Small jointed arch dams for the tests: decks with a motion that ends early, and what to read.

A trial is a dam of 135.5 m on a coarse mesh with rock and two joints, under weight and water and
then STRONG seconds of motion and a stretch of free vibration. Run as a script it prints the table
of docs/verification.md: `tests/dam_trials.py PROGRAM FOLDER [damped | free]`.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path

import h5py
import numpy as np

TESTS = Path(__file__).resolve().parent
sys.path += [str(TESTS), str(TESTS.parent / "tools")]

from harness import Program, Run  # noqa: E402
from keyway_tools.arch_blocks import BlockOptions, build_block_dam  # noqa: E402
from keyway_tools.arch_dam import DamOptions, build_arch_dam  # noqa: E402
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck  # noqa: E402
from keyway_tools.arch_rock import RockOptions  # noqa: E402
from keyway_tools.arch_shape import ArchShape  # noqa: E402
from keyway_tools.deck_text import mesh_deck  # noqa: E402
from keyway_tools.design_spectrum import DesignSpectrum  # noqa: E402
from keyway_tools.ground_motion import MotionOptions, fit_motion  # noqa: E402

STRONG = 2.5  # length of the motion [s]
MOTION_DT = 0.01  # [s]
PEAKS = (0.269 * 9.81, 0.269 * 9.81, 2.0 / 3.0 * 0.269 * 9.81)  # paper_notes.md, 14 [m/s2]
UNDAMPED = (0.0, 2.0, 10.0)
FULL_MATRIX = tuple(product((1.0, 2.0), (1e10, 1e11, 1e12, 1e13), (0.01, 0.005, 0.002)))


@dataclass(frozen=True)
class Trial:
    """Parameters of a trial."""

    size: float = 1.0  # of the motion
    components: tuple[bool, bool, bool] = (True, True, True)  # across, stream, vertical
    duration: float = 4.0  # motion and free vibration [s]
    num_joints: int = 2
    has_rock: bool = True
    is_coarse: bool = False
    shape: ArchShape = field(default_factory=ArchShape)
    options: DeckOptions = field(default_factory=lambda: DeckOptions(damping=UNDAMPED))
    edits: tuple[tuple[str, str], ...] = ()  # of the deck's text
    blocks: BlockOptions | None = None  # blocks with meshes of their own

    @property
    def mesh_key(self) -> tuple[int, bool, bool, ArchShape, BlockOptions | None]:
        """Parameters of the mesh of a trial."""
        return self.num_joints, self.has_rock, self.is_coarse, self.shape, self.blocks


@cache
def motion_of(axis: int) -> np.ndarray:
    """A component [m/s2] that fits the design spectrum, STRONG seconds long, zero at its end."""
    times = MotionOptions(
        duration=STRONG, dt=MOTION_DT, rise=0.25, strong=1.8, taper=0.2, num_trials=1
    )
    return PEAKS[axis] * fit_motion(DesignSpectrum(), [7, axis], times).acceleration


@cache
def mesh_of(trial_mesh: tuple[int, bool, bool, ArchShape, BlockOptions | None]):
    """Mesh of a trial; about 3000 unknowns, 1000 when coarse.

    Blocks that refine cells have larger ones: ordinary blocks keep their number of elements.
    """
    num_joints, has_rock, is_coarse, shape, blocks = trial_mesh
    rock = RockOptions(num_upstream=3, num_downstream=3, num_deep=3)
    if is_coarse:
        rock = RockOptions(num_upstream=2, num_downstream=2, num_deep=2)
    arc, height = (16, 6) if is_coarse else (24, 10)
    cell = blocks.refine if blocks else 1
    options = DamOptions(
        num_arc=arc // cell,
        num_height=height // cell,
        num_thick=2,
        num_bottom=4 // cell,
        num_joints=num_joints,
        rock=rock if has_rock else None,
    )
    if blocks:
        return build_block_dam(shape, options, blocks)
    return build_arch_dam(shape, options)


def deck_of(trial: Trial) -> tuple[str, dict[str, str]]:
    """Text of the deck and of the files beside it."""
    mesh = mesh_of(trial.mesh_key)
    types = dict.fromkeys(mesh.brick_sets, trial.options.element_type)
    files = {"mesh.inp": mesh_deck(mesh, types, "")}
    for axis, is_active in enumerate(trial.components):
        values = trial.size * motion_of(axis) if is_active else np.zeros(2)
        files[f"motion_{axis}.txt"] = "".join(f"{value:.12e}\n" for value in values)
    values = {name: getattr(trial.options, name) for name in DeckOptions.__dataclass_fields__}
    values["motions"] = tuple(f"motion_{axis}.txt" for axis in range(3))
    values["duration"] = trial.duration
    text = arch_dam_deck(mesh, "A trial", "mesh.inp", DeckOptions(**values))
    for old, new in trial.edits:
        assert old in text, f"the deck has no '{old}'"
        text = text.replace(old, new)
    return text, files


def run_trial(program: Program, trial: Trial, *options: str, name: str = "dam", code=0) -> Run:
    """Runs a trial."""
    text, files = deck_of(trial)
    return program(text, *options, name=name, files=files, code=code)


@dataclass(frozen=True)
class Robustness:
    """Effort of a run, and growth of its energy after the motion."""

    most_iterations: int
    mean_iterations: float  # of the dynamic increments
    cutbacks: int
    growth: float  # of the energy after the motion, over the largest kinetic energy then
    unbalance: float  # largest error of the energy balance
    opening: float  # largest [m]

    @property
    def row(self) -> str:
        return (
            f"{self.most_iterations:4d} {self.mean_iterations:7.2f} {self.cutbacks:4d} "
            f"{self.growth:10.1e} {self.unbalance:9.1e} {1e3 * self.opening:8.2f}"
        )


def increments_of(run: Run) -> dict[str, np.ndarray]:
    """The rows of /history/increments by column."""
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        table = file["history/increments"]
        names = table.attrs["columns"].decode().split(",")
        return dict(zip(names, np.asarray(table).T, strict=True))


def growth_of_energy(run: Run, end_of_motion: float) -> float:
    """Largest growth of the energy after the motion, over the largest kinetic energy then.

    The energy is kinetic and strain (with the joints' springs) less the work of the loads: of
    weight and water alone after the motion. It can only decrease.
    """
    table = run.csv("energy")
    is_free = table["time"] >= end_of_motion - 1e-9
    energy = (table["kinetic"] + table["strain"] - table["external"])[is_free]
    rise = np.max(energy - np.minimum.accumulate(energy))
    return float(rise / table["kinetic"][is_free].max())


def measure(run: Run, strong: float = STRONG) -> Robustness:
    """The numbers of a finished trial; the static step lasts 1 s."""
    rows = increments_of(run)
    is_dynamic = rows["step"] == 2
    return Robustness(
        most_iterations=int(rows["iterations"].max()),
        mean_iterations=float(rows["iterations"][is_dynamic].mean()),
        cutbacks=sum(step["cutbacks"] for step in run.json["steps"]),
        growth=growth_of_energy(run, 1.0 + strong),
        unbalance=max(step["energy"]["error"] for step in run.json["steps"]),
        opening=run.json["envelopes"]["OPENING"]["anywhere"]["value"],
    )


def trial_of(size: float, stiffness: float, dt: float, damping=UNDAMPED, **changes) -> Trial:
    """A cell of the matrix of sizes of the motion, k_n [Pa/m] and increments [s]."""
    options = DeckOptions(normal_stiffness=stiffness, increment=dt, damping=damping)
    return Trial(size=size, options=options, **changes)


def main(program: str, folder: str, kind: str = "free") -> None:
    """Prints the table of the matrix."""
    damping = UNDAMPED if kind == "free" else (0.05, 2.0, 10.0)
    print("size   k_n     dt  most  mean   cuts     growth unbalance  opening [mm]")
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    for size, stiffness, dt in FULL_MATRIX:
        trial = trial_of(size, stiffness, dt, damping)
        run = run_trial(Program(Path(program), place, 1), trial)
        print(f"{size:4.0f} {stiffness:7.0e} {dt:6.3f} {measure(run).row}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
