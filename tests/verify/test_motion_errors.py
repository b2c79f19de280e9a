"""The estimated errors of the mesh in a dynamic step: of the largest displacement of a structure
without joints, and of the openings of an arch dam, against finer meshes."""

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from harness import ROOT
from joint_decks import amplitude, dynamic
from keyway_tools.box_mesh import box_mesh
from keyway_tools.study.deck_cards import read_deck
from keyway_tools.study.refined_mesh import refine

WIDTH, HEIGHT = 2.0, 8.0  # m
GRID = 0.02  # s, between the corners of the motion
DURATION = 5.2  # s; the modes take part in steps of more than 500 increments
MODULUS, DENSITY = 4e7, 2400.0
FINE = 16  # elements in the width
FREQUENCIES = {"below": 0.45, "above": 0.9}  # of the motion [Hz]; the first mode has 0.65 Hz
# Bending deforms a square C3D8B in plane strain almost exactly: errors of two signs cancel.
EXACT = "C3D8B"


def tower(count: int, element: str, frequency: float) -> str:
    """A slab in plane strain that bends under a motion of its base."""
    mesh, number = box_mesh(
        (count, 1, 4 * count), lambda a, b, c: np.stack([WIDTH * a, b, HEIGHT * c], axis=-1)
    )
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["ROOT"] = number[:, :, 0].ravel()
    times = np.arange(0.0, DURATION + GRID, GRID)
    motion = 1.5 * np.sin(2.0 * np.pi * frequency * times) * np.minimum(1.0, times)
    motion *= 1.0 + 0.4 * np.sin(7.0 * times)
    cards = elastic(MODULUS, 0.2, DENSITY) + "*BOUNDARY\nROOT, 1, 3\nALL, 2, 2\n"
    content = "*DAMPING, RATIO=0.03, F1=0.5, F2=8\n*BASE MOTION, DOF=1, AMPLITUDE=MOVE\n"
    steps = dynamic(content, 0.01, DURATION)
    return brick_deck(mesh, element, cards + amplitude("MOVE", times, motion) + steps)


def of_displacement(run) -> dict[str, float]:
    return run.json["accuracy"]["estimates"]["displacement"]


@pytest.mark.parametrize("place", FREQUENCIES)
def test_displacement(keyway, documented, place):
    """The error of the coarsest mesh is up to half of the displacement."""
    frequency = FREQUENCIES[place]
    limit = keyway(tower(FINE, "C3D8I", frequency)).json["displacement"]["anywhere"]["value"]
    for element in ("C3D8", "C3D8I", "C3D8R", EXACT):
        for count in (2, 4):
            found = of_displacement(keyway(tower(count, element, frequency)))
            true = abs(limit - found["value"])
            if element == EXACT:
                assert true < 0.01 * limit
                assert true < found["mesh"]
                continue
            assert 0.5 < found["mesh"] / true < 2.0
            documented("mesh error in motion", (place, element), f"{count}", found["mesh"] / true)


def openings(run, joint: str) -> tuple[np.ndarray, np.ndarray]:
    """Places (points, 3) and histories (times, points) of a joint in the dynamic step."""
    table = run.csv(f"joint_{joint}")
    points = int(table["point"].max())
    x = np.stack([np.asarray(table[name])[:points] for name in "xyz"], axis=1)
    return x, np.maximum(0.0, np.asarray(table["opening"])).reshape(-1, points)


@pytest.mark.full
@pytest.mark.parametrize("element", ["C3D8", "C3D8I"])
def test_openings(keyway, documented, tmp_path, element):
    """input/gmsh_arch for 2.4 s. The truth: the largest difference at any point and time from the
    mesh refined once, times 4/3 for an error of second order."""
    folder = ROOT / "input/gmsh_arch"
    mesh = (folder / "gmsh_arch_mesh.inp").read_text(encoding="utf-8")
    mesh = mesh.replace("*ELEMENT, TYPE=C3D8,", f"*ELEMENT, TYPE={element},")
    (tmp_path / "mesh.inp").write_text(mesh, encoding="utf-8")
    deck = (folder / "gmsh_arch.inp").read_text(encoding="utf-8")
    deck = deck.replace("gmsh_arch_mesh.inp", str(tmp_path / "mesh.inp"))
    path = tmp_path / "arch.inp"
    path.write_text(deck.replace("0.01, 1.", "0.004, 2.4"), encoding="utf-8")
    coarse = read_deck(path)
    runs = [keyway(coarse.text(), name="coarse"), keyway(refine(coarse).text(), name="fine")]
    worst = 0.0
    for joint in ("JOINT1", "JOINT2"):
        (x, own), (fine_x, fine) = (openings(run, joint) for run in runs)
        near = [int(np.argmin(((fine_x - place) ** 2).sum(axis=1))) for place in x]
        count = min(len(own), len(fine))
        worst = max(worst, np.abs(own[-count:] - fine[-count:, near]).max())
    found = runs[0].json["accuracy"]["estimates"]["opening"]
    effectivity = found["mesh"] / (4.0 / 3.0 * worst)
    assert 0.5 < effectivity < 2.0
    documented("mesh error of openings in motion", "arch", element, effectivity)
