"""Solids of concrete in static and dynamic steps: the order of Newton's method in a notched beam,
the same answer with every tangent, in any number of threads and beside joints, and the energy.

No other reference is needed: all tangents solve the same equations, and energies are compared with
the work of the forces.
"""

import re

import numpy as np
import pytest
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck

TANGENTS = ("CONSISTENT", "SECANT", "ELASTIC")
DEPTH, WIDTH, LENGTH = 0.2, 0.1, 0.84  # of the beam [m]
CONCRETE = """*MATERIAL, NAME=CONCRETE
*DENSITY
2400.
*ELASTIC
30e9, 0.2
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


def notched_beam() -> str:
    """Three-point bending, 21 x 5 bricks of 40 mm, notched over two of the five."""
    mesh, number = box_mesh(
        (21, 1, 5), lambda a, b, c: np.stack([LENGTH * a, WIDTH * b, DEPTH * c], axis=-1)
    )
    centre = mesh.x[mesh.bricks].mean(axis=1)
    mesh.bricks = mesh.bricks[(abs(centre[:, 0] - LENGTH / 2) > 0.001) | (centre[:, 2] > 0.08)]
    mesh.brick_sets["BEAM"] = np.arange(len(mesh.bricks))
    mesh.node_sets["LEFT"] = number[1, :, 0].ravel()
    mesh.node_sets["RIGHT"] = number[-2, :, 0].ravel()
    mesh.node_sets["TOP"] = number[10:12, :, -1].ravel()
    mesh.node_sets["FACE"] = np.intersect1d(number[:, 0, :], mesh.bricks)
    return (
        mesh_deck(mesh, {"BEAM": "C3D8"}, "")
        + CONCRETE.format(type="DISPLACEMENT")
        + """*SOLID SECTION, ELSET=BEAM, MATERIAL=CONCRETE
*BOUNDARY
LEFT, 1, 1
LEFT, 3, 3
RIGHT, 3, 3
FACE, 2, 2
"""
    )


def pressed(share: float, increment: float, controls: str) -> str:
    """A static step that presses the middle of the top to a share of 0.8 mm."""
    return f"""*STEP
*STATIC, DIRECT
{increment}, 1.
*CONTROLS, {controls}
*BOUNDARY
TOP, 3, 3, {-0.8e-3 * share!r}
*NODE PRINT, NSET=TOP
U, RF
*END STEP
"""


def force_of(run) -> np.ndarray:
    """The force on the top at the end of each increment [N]."""
    table = run.csv("node_TOP")
    moments = np.unique(np.stack([table["step"], table["increment"]], axis=1), axis=0)
    return np.array(
        [-table["RF3"][(table["step"] == s) & (table["increment"] == i)].sum() for s, i in moments]
    )


def test_newton_is_quadratic_in_a_notched_beam(keyway):
    """One more increment past the peak, stopped after 1, 2, .. iterations: the residuals.

    A residual r goes to c r^2: log r doubles, so the order of the last three above round-off
    (1e-12) is near 2; 1.7 leaves room for the kinks of the tables.
    """
    beam = notched_beam() + pressed(0.3, 0.1, "RESIDUAL=1e-9")
    residuals = []
    for count in range(1, 12):
        controls = f"TANGENT=CONSISTENT, RESIDUAL=1e-15, INCREMENT=1e-15, ITERATIONS={count}"
        run = keyway(beam + pressed(0.35, 1.0, controls), code=1, name=f"newton{count}")
        residuals.append(float(re.search(r"no equilibrium: residual (\S+)", run.stderr)[1]))
        if residuals[-1] < 1e-12:
            break
    r = np.log([r for r in residuals if r > 1e-12][-3:])
    order = (r[2] - r[1]) / (r[1] - r[0])
    assert order > 1.7


def test_failure_of_a_beam_beyond_its_peak_names_the_node(keyway):
    """10 kN on each node of the top, more than its strength: the message gives a node and its
    place."""
    step = pressed(0.3, 0.1, "TANGENT=AUTO").replace(
        "*STATIC, DIRECT\n0.1, 1.", "*STATIC\n0.1, 1., 0.05"
    )
    step = re.sub(r"\*BOUNDARY\n.*", "*CLOAD\nTOP, 3, -1e4", step)
    run = keyway(notched_beam() + step, code=1, name="overloaded")
    assert re.search(r"no equilibrium: .*; largest at node \d+ at \(.*, .*, .*\)", run.stderr)
    assert "needs prescribed displacements, not forces" in run.stderr
    assert len(run.csv("node_TOP")["RF3"]) > 0


def test_tangents_agree_in_a_notched_beam(keyway):
    """Past the peak, to a fifth of it: the curves differ by the tolerance of the residual, 1e-8 of
    the force, times 100 for a softening beam."""
    runs = [
        keyway(
            notched_beam() + pressed(1.0, 0.025, f"TANGENT={tangent}, RESIDUAL=1e-8"),
            name=f"notched_{tangent.lower()}",
        )
        for tangent in TANGENTS
    ]
    curves = [force_of(run) for run in runs]
    peak = curves[0].max()
    assert curves[0][-1] < 0.5 * peak
    for run, curve in zip(runs, curves, strict=True):
        assert np.abs(curve - curves[0]).max() <= 1e-6 * peak
        step = run.json["steps"][0]
        assert step["energy"]["error"] <= 1e-8
    energy = runs[0].json["steps"][0]["energy"]
    # Work of the top by the trapezoidal rule: all there is, as stored or dissipated.
    u = np.linspace(0.0, 0.8e-3, 41)
    f = np.concatenate([[0.0], curves[0]])
    work = ((f[1:] + f[:-1]) / 2 * np.diff(u)).sum()
    assert energy["external"] == pytest.approx(work, rel=1e-6)
    assert abs(energy["numerical"]) <= 0.02 * energy["external"]


def test_threads_do_not_change_a_crack(keyway):
    """Laws and sums do not depend on threads; the factor's sums may, by round-off."""
    deck = notched_beam() + pressed(1.0, 0.05, "RESIDUAL=1e-9")
    curves = [force_of(keyway(deck, "-j", str(count), name=f"threads{count}")) for count in (1, 2)]
    assert np.abs(curves[0] - curves[1]).max() <= 1e-8 * curves[0].max()


DAM = """*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE
*BOUNDARY
FIXED, 1, 3
*JOINT LAW, NAME=CONTRACTION, THICKNESS=0.02, FRICTION=0.6{law}
*JOINT, NAME=JOINT1, LAW=CONTRACTION, ELSET=JOINT1
*JOINT, NAME=JOINT2, LAW=CONTRACTION, ELSET=JOINT2
*AMPLITUDE, NAME=QUAKE
0., 0., 0.1, 6., 0.3, -6., 0.5, 6.
*STEP
*STATIC, DIRECT
0.25, 1.
*CONTROLS, TANGENT={tangent}, RESIDUAL=1e-8
*DLOAD
DAM, GRAV, 9.81, 0., 0., -1.
*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=105., BED=0., ADDED MASS=WESTERGAARD
*END STEP
*STEP
*DYNAMIC, DIRECT
0.005, 0.3
*DAMPING, RATIO=0.05, F1=2., F2=10.
*BASE MOTION, DOF=2, AMPLITUDE=QUAKE
*NODE PRINT, NSET=ALL, FREQUENCY=60
U
*END STEP
"""


@pytest.mark.parametrize(("law", "allowed"), [("", 1e-6), (", PENETRATION=1e-6", 1e-5)])
def test_a_jointed_dam_cracks(keyway, law, allowed):
    """Joints open and slide while the concrete cracks: two tangents give one motion, and the energy
    balance closes.

    Residuals are 1e-8, over 64 increments. Without penetration the remaining penetration differs
    too, up to 1e-6 m in openings of 20 mm.
    """
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_joints=2, rock=None, num_arc=16, num_height=6, num_thick=2)
    )
    mesh.node_sets["ALL"] = np.arange(len(mesh.x))
    head = mesh_deck(mesh, {"DAM": "C3D8"}, "") + CONCRETE.format(type="STRAIN")
    runs = [
        keyway(
            head + DAM.replace("{tangent}", tangent).replace("{law}", law),
            name=f"dam_{tangent.lower()}",
        )
        for tangent in ("SECANT", "CONSISTENT")
    ]
    moved = [np.stack([run.csv("node_ALL")[f"U{i}"] for i in (1, 2, 3)]) for run in runs]
    apart = np.abs(moved[0] - moved[1]).max() / np.abs(moved[0]).max()
    energies = [run.json["steps"][1]["energy"] for run in runs]
    assert apart <= allowed
    for energy in energies:
        assert energy["fracture"] > 0.01 * energy["external"]
        assert energy["friction"] > 0.0
        assert energy["error"] <= 1e-8
