"""A block on rock, with what several processes work on: decks of a few hundred unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from brick_decks import elastic
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck
from keyway_tools.arch_rock import RockOptions
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.deck_text import mesh_deck
from uplift_decks import joined

# More processes than processors, in containers that run as root, must not spin while they wait.
LAUNCH = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}


@dataclass
class BlockOnRock:
    """Two boxes that touch in the plane z = 0, one upon the other, each with its own mesh."""

    counts: tuple[int, int, int] = (4, 4, 5)
    rock_counts: tuple[int, int, int] = (3, 3, 2)
    coupling: str = "*TIE, NAME=T\nSOLE, ROOF\n"
    rock_has_mass: bool = True
    element: str = "C3D8I"
    poisson: float = 0.2
    supports: str = "BED, 1, 3\n"

    def deck(self, steps: str) -> str:
        """Sets BLOCK, TOP, BED; the upstream face of the block is UPSTREAM."""
        ground = stretched((6.0, 6.0, 3.0))
        mesh, (block, rock) = joined(
            box_mesh(self.counts, stretched((5.0, 4.0, 8.0))),
            box_mesh(self.rock_counts, lambda a, b, c: ground(a, b, c - 1.0)),
        )
        bricks = np.arange(np.prod(self.counts)).reshape(self.counts)
        below = bricks.size + np.arange(np.prod(self.rock_counts)).reshape(self.rock_counts)
        mesh.brick_sets = {"BLOCK": bricks.ravel(), "ROCK": below.ravel()}
        mesh.node_sets = {"TOP": block[:, :, -1].ravel(), "BED": rock[:, :, 0].ravel()}
        mesh.surfaces = {
            "SOLE": [(int(brick), 1) for brick in bricks[:, :, 0].ravel()],
            "ROOF": [(int(brick), 2) for brick in below[:, :, -1].ravel()],
            "UPSTREAM": [(int(brick), 6) for brick in bricks[0].ravel()],
        }
        rock_density = 2600.0 if self.rock_has_mass else None
        return (
            mesh_deck(mesh, {"BLOCK": self.element, "ROCK": "C3D8"}, "")
            + elastic(3e10, self.poisson, 2400.0).replace("BODY", "BLOCK")
            + elastic(2e10, 0.25, rock_density).replace("BODY", "ROCK").replace("=M\n", "=R\n")
            + self.coupling
            + (f"*BOUNDARY\n{self.supports}" if self.supports else "")
            + steps
        )


OUTPUT = "*NODE PRINT, NSET=TOP\nU\n*NODE FILE\nU\n*EL FILE\nS\n"
LAKE = "*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=7., BED=0., ADDED MASS=WESTERGAARD\n"
WEIGHT = (
    "*STEP, NAME=WEIGHT\n*STATIC\n0.5, 1.\n"
    f"*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n{LAKE}{OUTPUT}*END STEP\n"
)
MOTION = (
    "*STEP, NAME=MOTION\n*DYNAMIC, DIRECT\n0.01, 0.1\n*DAMPING, RATIO=0.05, F1=2., F2=30.\n"
    f"*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n{OUTPUT}*NODE PRINT, NSET=TOP\nV, A\n*END STEP\n"
)
QUAKE = "*AMPLITUDE, NAME=QUAKE\n0., 0., 0.03, 1., 0.07, -1., 0.1, 0.\n"
SPRINGS = "*TIE, NAME=T, STIFFNESS=1e11\nSOLE, ROOF\n"


def stretched_dam() -> dict[str, str]:
    """An arch dam of 14 832 unknowns, files by name: weight and water, five increments of motion.
    Each of 8 layers of massless rock is 2.2 times as thick as the one before."""
    return dam_on_layers(DamOptions(28, 12, 3, 4, num_joints=0, rock=rock_layers(8, 2.2)))


def refined_dam(factor: int) -> dict[str, str]:
    """An arch dam with even rock, every element divided by `factor` in each direction."""
    layers = rock_layers(2 * factor, 1.6 ** (1.0 / factor))
    counts = (16 * factor, 6 * factor, 2 * factor, 4 * factor)
    return dam_on_layers(DamOptions(*counts, num_joints=0, rock=layers))


def rock_layers(count: int, growth: float) -> RockOptions:
    return RockOptions(num_upstream=count, num_downstream=count, num_deep=count, growth=growth)


def dam_on_layers(dam: DamOptions) -> dict[str, str]:
    mesh = build_arch_dam(ArchShape(), dam)
    options = DeckOptions(motions=("motion.txt",), duration=0.05, picture_frequency=10**6)
    motion = "\n".join(f"{np.sin(20.0 * t):.9g}" for t in np.arange(0.0, 0.055, options.motion_dt))
    return {
        "job.inp": arch_dam_deck(mesh, "layers of rock", "mesh.inp", options),
        "mesh.inp": mesh_deck(mesh, dict.fromkeys(mesh.brick_sets, "C3D8"), ""),
        "motion.txt": motion + "\n",
    }
