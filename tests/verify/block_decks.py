"""Two blocks, one on the other: matching meshes with JOINT8 elements, or different ones."""

from __future__ import annotations

from dataclasses import dataclass

import h5py
import numpy as np
from joint_decks import material
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.deck_text import mesh_deck
from uplift_decks import facets, joined


@dataclass
class Pair:
    """A block on a base, the joint in the plane z = 0; the whole rotated about the y axis.

    The same counts on both sides make JOINT8 elements, others a joint between two surfaces.
    """

    size: tuple[float, float, float] = (2.0, 1.0, 1.0)  # of the block [m]
    counts: tuple[int, int, int] = (2, 2, 1)
    base_counts: tuple[int, int, int] = (2, 2, 1)
    slope: float = 0.0  # [degrees] down towards +x
    young: float = 1e13
    density: float = 2400.0
    law: str = "KN=1e10, KT=1e10"
    base_is_slave: bool = False
    lift: float = 0.0  # of the block in the mesh [m]

    def turned(self, x: np.ndarray) -> np.ndarray:
        """Coordinates or vectors of the joint's axes in those of the deck."""
        a = np.radians(self.slope)
        turn = [[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]]
        return np.asarray(x) @ np.array(turn).T

    @property
    def weight(self) -> float:
        return self.density * 9.81 * float(np.prod(self.size))

    @property
    def area(self) -> float:
        return self.size[0] * self.size[1]

    def deck(self, steps: str, supports: str = "") -> str:
        """Sets BLOCK, TOP, BODY and BASE; the joint is SEAM."""
        length, width, _height = self.size
        base = stretched((length, width, 0.5))
        mesh, (block, under) = joined(
            box_mesh(self.counts, stretched(self.size)),
            box_mesh(self.base_counts, lambda a, b, c: base(a, b, c - 1.0)),
        )
        bricks = np.arange(np.prod(self.counts)).reshape(self.counts)
        below = bricks.size + np.arange(np.prod(self.base_counts)).reshape(self.base_counts)
        mesh.x[block.ravel(), 2] += self.lift
        mesh.x = self.turned(mesh.x)
        mesh.brick_sets = {"BLOCK": bricks.ravel(), "BASE": below.ravel()}
        mesh.node_sets = {
            "TOP": block[:, :, -1].ravel(),
            "BODY": block.ravel(),
            "BASE": under.ravel(),
        }
        mesh.surfaces = {
            "SOLE": [(int(brick), 1) for brick in bricks[:, :, 0].ravel()],
            "ROOF": [(int(brick), 2) for brick in below[:, :, -1].ravel()],
        }
        pair = "ROOF, SOLE" if self.base_is_slave else "SOLE, ROOF"
        joint = f"*JOINT, NAME=SEAM, LAW=LAW\n{pair}\n"
        if self.counts[:2] == self.base_counts[:2]:
            sides = [facets(under[:, :, -1]), facets(block[:, :, 0])]
            mesh.joints = np.concatenate(sides[:: -1 if self.base_is_slave else 1], axis=1)
            mesh.joint_sets["SEAM"] = np.arange(len(mesh.joints))
            joint = "*JOINT, NAME=SEAM, LAW=LAW, ELSET=SEAM\n"
        return (
            mesh_deck(mesh, {"BLOCK": "C3D8", "BASE": "C3D8"}, "")
            + material("STUFF", self.young, 0.0, self.density)
            + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STUFF\n"
            + "*SOLID SECTION, ELSET=BASE, MATERIAL=STUFF\n"
            + f"*JOINT LAW, NAME=LAW, {self.law}\n{joint}"
            + f"*BOUNDARY\nBASE, 1, 3\n{supports}"
            + steps
        )


MATCHING = {"counts": (2, 2, 1), "base_counts": (2, 2, 1)}
TWO_TO_THREE = {"counts": (2, 2, 1), "base_counts": (3, 3, 1)}
THREE_TO_TWO = {"counts": (3, 3, 1), "base_counts": (2, 2, 1)}
MESHES = {"JOINT8": MATCHING, "2:3": TWO_TO_THREE, "3:2": THREE_TO_TWO}


def joint_state(run, step: int = 1, name: str = "SEAM") -> dict[str, np.ndarray]:
    """Fields of a joint in job.h5 at the end of a step, and its resultant in the axes of the
    joint."""
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file[f"steps/{step:04d}/increments"]
        last = increments[sorted(increments)[-1]][f"joints/{name}"]
        fields = {key: value[:] for key, value in last.items()}
        fields |= {key: file[f"joints/{name}/{key}"][:] for key in ("x", "area", "rotation")}
    fields["force"] = fields["area"] @ fields["traction"]
    return fields
