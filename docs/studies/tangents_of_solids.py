"""Which tangent of solids that crack converges best per second? Scenes, four tangents.

    python docs/studies/tangents_of_solids.py KEYWAY FOLDER [--scenes NAME ..] [--fine]

notched   a notched beam in three-point bending, led by the displacement of its middle (static)
monolith  Koyna's section, weight and a shake of 3 s that cracks it (dynamic)
dam       an arch dam with two contraction joints, weight and the same shake (dynamic)
pushed    the same dam pushed downstream by 0.8 g in a static step (static)

Every scene runs with *CONTROLS, TANGENT=CONSISTENT, SECANT, ELASTIC and AUTO; the table tells what
each took. Concrete: f_t 2.5 MPa, 0.8 MPa at an opening of 0.1 mm (in the dams, whose elements are
of 1 to 10 m, at a strain of 0.1e-3), 0.05 MPa at 0.35 mm; damage 0.6 and 0.95 there.
"""

import argparse
import csv
import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_monolith import DOWNSTREAM, LEVELS, upstream_faces
from keyway_tools.deck_text import mesh_deck

TANGENTS = ("CONSISTENT", "SECANT", "ELASTIC", "AUTO")
CONCRETE = """*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
{young}, 0.2
*CONCRETE DAMAGED PLASTICITY
36., 0.1, 1.16, 0.6667
*CONCRETE COMPRESSION HARDENING
20e6, 0.
28e6, 1e-3
25e6, 4e-3
*CONCRETE TENSION STIFFENING, TYPE={type}
2.5e6, 0.
0.8e6, 0.1e-3
0.05e6, 0.35e-3
*CONCRETE TENSION DAMAGE, TYPE={type}
0., 0.
0.6, 0.1e-3
0.95, 0.35e-3
"""


def notched(fine: bool) -> str:
    """Beam of 2.05 m x 0.5 m x 0.1 m, notched to half its depth; its top is pressed down."""
    across, high, thick = (82, 20, 4) if fine else (41, 10, 1)
    across += 1 - across % 2
    mesh, number = box_mesh(
        (across, thick, high), lambda a, b, c: np.stack([2.05 * a, 0.1 * b, 0.5 * c], axis=-1)
    )
    centre = mesh.x[mesh.bricks].mean(axis=1)
    in_notch = (abs(centre[:, 0] - 1.025) < 1.0 / across) & (centre[:, 2] < 0.25)
    mesh.bricks = mesh.bricks[~in_notch]
    mesh.brick_sets["BEAM"] = np.arange(len(mesh.bricks))
    half = across // 2
    mesh.node_sets["LEFT"] = number[1, :, 0].ravel()
    mesh.node_sets["RIGHT"] = number[-2, :, 0].ravel()
    mesh.node_sets["TOP"] = number[half : half + 2, :, -1].ravel()
    mesh.node_sets["FACE"] = number[:, 0, :].ravel()
    used = np.unique(mesh.bricks)
    mesh.node_sets["FACE"] = np.intersect1d(mesh.node_sets["FACE"], used)
    return (
        mesh_deck(mesh, {"BEAM": "C3D8"}, "")
        + CONCRETE.format(young="30e9", type="DISPLACEMENT")
        + """*SOLID SECTION, ELSET=BEAM, MATERIAL=CONCRETE
*BOUNDARY
LEFT, 1, 1
LEFT, 3, 3
RIGHT, 3, 3
FACE, 2, 2
*STEP
*STATIC
0.02, 1.
*CONTROLS, TANGENT={tangent}
*BOUNDARY
TOP, 3, 3, -0.6e-3
*NODE PRINT, NSET=TOP
U, RF
*END STEP
"""
    )


def shake(dofs: tuple[int, ...]) -> tuple[str, str]:
    """Cards of the model and of the step: 6 and 3 m/s2, growing and fading in 3 s, 2.5 Hz."""
    t = np.arange(0.0, 3.0, 0.01)
    value = np.sin(np.pi * t / 3.0) * np.sin(2 * np.pi * 2.5 * t)
    rows = "".join(f"{a:.2f}, {b:.6f}\n" for a, b in zip(t, value, strict=True))
    motions = "".join(
        f"*BASE MOTION, DOF={dof}, AMPLITUDE=SHAKE, TYPE=ACCELERATION, SCALE={scale}\n"
        for dof, scale in zip(dofs, (6.0, 3.0), strict=False)
    )
    return f"*AMPLITUDE, NAME=SHAKE\n{rows}", motions


def monolith(fine: bool) -> str:
    """Koyna's section in a slice of 2 m, full to 91.75 m, shaken along the river."""
    across, below, above, thick = (24, 36, 24, 3) if fine else (16, 24, 16, 1)

    def place(a, b, c):
        z = np.interp(c * (below + above), [0, below, below + above], LEVELS)
        return np.stack([a * np.interp(z, LEVELS, DOWNSTREAM), b * 2.0, z], axis=-1)

    mesh, number = box_mesh((across, thick, below + above), place)
    mesh.brick_sets["MONOLITH"] = np.arange(len(mesh.bricks))
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["SLICE"] = number[:, 0, :].ravel()
    mesh.surfaces["UPSTREAM"] = upstream_faces(mesh, number)
    amplitude, motions = shake((1, 3))
    return (
        mesh_deck(mesh, {"MONOLITH": "C3D8"}, "")
        + CONCRETE.format(young="31e9", type="STRAIN")
        + amplitude
        + """*SOLID SECTION, ELSET=MONOLITH, MATERIAL=CONCRETE
*BOUNDARY
BASE, 1, 1
BASE, 3, 3
SLICE, 2, 2
*STEP
*STATIC
0.25, 1.
*CONTROLS, TANGENT={tangent}
*DLOAD
MONOLITH, GRAV, 9.81, 0., 0., -1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=91.75, BED=0
*END STEP
*STEP, INC=100000
*DYNAMIC
0.01, 3.
*DAMPING, RATIO=0.03, F1=2., F2=12.
"""
        + motions
        + """*NODE PRINT, NSET=BASE, FREQUENCY=100
U
*END STEP
"""
    )


def arch_dam(fine: bool) -> str:
    """The dam of tools/make_dam.py on rigid rock: mesh, concrete, joints and weight."""
    numbers = {"num_arc": 48, "num_height": 22, "num_thick": 5} if fine else {}
    mesh = build_arch_dam(ArchShape(), DamOptions(num_joints=2, rock=None, **numbers))
    return (
        mesh_deck(mesh, {"DAM": "C3D8"}, "")
        + CONCRETE.format(young="22e9", type="STRAIN")
        + """*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*BOUNDARY
FIXED, 1, 3
*JOINT LAW, NAME=CONTRACTION, THICKNESS=0.02, FRICTION=0.6
*JOINT, NAME=JOINT1, LAW=CONTRACTION, ELSET=JOINT1
*JOINT, NAME=JOINT2, LAW=CONTRACTION, ELSET=JOINT2
"""
    )


WEIGHT = """*STEP
*STATIC
0.25, 1.
*CONTROLS, TANGENT={tangent}
*DLOAD
DAM, GRAV, 9.81, 0., 0., -1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=105., BED=0., ADDED MASS=WESTERGAARD
"""


def dam(fine: bool) -> str:
    """The dam in motion."""
    amplitude, motions = shake((2, 1))
    return (
        arch_dam(fine)
        + amplitude
        + WEIGHT
        + """*END STEP
*STEP, INC=100000
*DYNAMIC
0.01, 1.5
*DAMPING, RATIO=0.05, F1=2., F2=10.
"""
        + motions
        + "*END STEP\n"
    )


def pushed(fine: bool) -> str:
    """The dam pushed downstream."""
    return arch_dam(fine) + WEIGHT + "*DLOAD\nDAM, GRAV, 8., 0., 1., 0.\n*END STEP\n"


SCENES = {"notched": notched, "monolith": monolith, "dam": dam, "pushed": pushed}


def run(keyway: Path, deck: Path, folder: Path) -> tuple[dict, int]:
    """Runs a deck and takes from its job.json what counts."""
    folder.mkdir(parents=True, exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([keyway, "-q", "-j", "1", "-o", folder, deck], check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    record = json.loads((folder / f"{deck.stem}.json").read_text())
    parts = record["ledger"]["parts"]
    with (folder / f"{deck.stem}_energy.csv").open() as file:
        energy = list(csv.DictReader(file))[-1]
    steps = record["steps"]

    def seconds(*works):
        return sum(part["wall_s"] for part in parts if named(part, works))

    def calls(work):
        return max((part["calls"] for part in parts if named(part, (work,))), default=0)

    def named(part, works):
        """Work on joints and solids goes by the kind of effect, other work by its name."""
        if part["kind"] in ("inelastic", "joint"):
            return f"{part['kind']} {part['work']}" in works
        return part["name"] in works

    return {
        "status": record["status"],
        "time": sum(step["time"] for step in steps),
        "increments": sum(step["increments"] for step in steps),
        "iterations": sum(step["iterations"] for step in steps),
        "cuts": sum(step["cutbacks"] for step in steps),
        "factors": calls("factor structure"),
        "laws": calls("inelastic update"),
        "s factor": seconds("factor structure", "inelastic assemble"),
        "s solve": seconds(
            *(f"solve{half} structure" for half in ("", " forward", " backward")),
            *("joint iterate", "joint condense"),
        ),
        "s laws": seconds("inelastic update"),
        "s cpu": after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
        "fracture J": float(energy["fracture"]),
        "error": max(step["energy"]["error"] for step in steps),
    }, record["model"]["unknowns"]


def main() -> None:
    """Runs the scenes and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("keyway", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--tangents", nargs="+", default=list(TANGENTS))
    parser.add_argument("--fine", action="store_true", help="finer meshes")
    chosen = parser.parse_args()
    for scene in chosen.scenes:
        text = SCENES[scene](chosen.fine)
        for tangent in chosen.tangents:
            deck = chosen.folder / f"{scene}_{tangent.lower()}.inp"
            chosen.folder.mkdir(parents=True, exist_ok=True)
            deck.write_text(text.replace("{tangent}", tangent))
            row, unknowns = run(chosen.keyway, deck, chosen.folder / "results")
            if tangent == chosen.tangents[0]:
                print(f"{scene}: {unknowns} unknowns, one thread")
                print("tangent    " + " ".join(f"{name:>10}" for name in row))
            cells = (f"{v:10.4g}" if isinstance(v, float) else f"{v!s:>10}" for v in row.values())
            print(f"{tangent:10} " + " ".join(cells), flush=True)


if __name__ == "__main__":
    main()
