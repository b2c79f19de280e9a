"""The estimated error of the mesh in the stresses, against true errors in the energy norm.

The true error follows from energies: a Galerkin solution under given forces is too stiff, and
|error|^2 = |exact|^2 - |computed|^2 (twice the strain energies). The effectivity, estimate over
truth, is 1 for a perfect estimate.
"""

import h5py
import numpy as np
import pytest
from block_decks import Pair
from brick_decks import brick_deck, elastic, nodal_forces
from joint_decks import static
from keyway_tools.box_mesh import box_mesh

BORE, OUTSIDE, MODULUS, POISSON = 3.0, 9.0, 1000.0, 0.3
LENGTH, HEIGHT = 8.0, 1.0


def estimate(run) -> dict[str, float]:
    return run.json["accuracy"]["estimates"]["stress"]


def cylinder(count: int, element: str):
    """A quarter of a thick cylinder in plane strain, one thick, under a pressure of 1; its mesh."""

    def place(a, b, c):
        r, angle = BORE + (OUTSIDE - BORE) * a, 0.5 * np.pi * b
        return np.stack([r * np.cos(angle), r * np.sin(angle), c], axis=-1)

    mesh, number = box_mesh((count, count, 1), place)
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["ON_X"] = number[:, 0].ravel()
    mesh.node_sets["ON_Y"] = number[:, -1].ravel()
    mesh.surfaces["BORE"] = [(brick, 6) for brick in range(count)]
    cards = elastic(MODULUS, POISSON) + "*BOUNDARY\nALL, 3, 3\nON_X, 2, 2\nON_Y, 1, 1\n"
    cards += "*STEP\n*STATIC\n*DSLOAD\nBORE, P, 1.\n*EL PRINT, ELSET=BODY\nS\n*END STEP\n"
    return brick_deck(mesh, element, cards), mesh


def cook(count: int, element: str) -> str:
    """Cook's membrane as a slab in plane strain, one thick."""

    def place(a, b, c):
        low, high = 44.0 * a, 44.0 + 16.0 * a
        return np.stack([48.0 * a, low + c * (high - low), -b], axis=-1)

    mesh, number = box_mesh((count, 1, count), place)
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["ROOT"] = number[0].ravel()
    forces = {}
    for k in range(count + 1):
        for node in number[-1, :, k]:
            forces[int(node)] = (0.0, 0.5 * (0.5 if k in (0, count) else 1.0) / count, 0.0)
    cards = elastic(1.0, 1.0 / 3.0) + "*BOUNDARY\nALL, 3, 3\nROOT, 1, 2\n*STEP\n*STATIC\n*CLOAD\n"
    return brick_deck(mesh, element, cards + nodal_forces(forces) + "*END STEP\n")


def cantilever(count: int, element: str) -> str:
    """A beam 8 x 1 x 1 with `count` elements in its height, a force at its end."""
    mesh, number = box_mesh(
        (4 * count, count, count),
        lambda a, b, c: np.stack([LENGTH * a, HEIGHT * b, HEIGHT * c], axis=-1),
    )
    mesh.node_sets["ROOT"] = number[0].ravel()
    weight = np.ones((count + 1, count + 1))
    weight[[0, -1]] *= 0.5
    weight[:, [0, -1]] *= 0.5
    forces = {
        int(node): (0.0, 0.0, float(w) / count**2)
        for node, w in zip(number[-1].ravel(), weight.ravel(), strict=True)
    }
    cards = elastic(MODULUS, POISSON) + "*BOUNDARY\nROOT, 1, 3\n*STEP\n*STATIC\n*CLOAD\n"
    return brick_deck(mesh, element, cards + nodal_forces(forces) + "*END STEP\n")


def points_of(x: np.ndarray, bricks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places (bricks, 8, 3) and volumes (bricks, 8) of 2 x 2 x 2 points, in the program's order."""
    corner = 2.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) - 1.0
    corner = np.column_stack((np.tile(corner, (2, 1)), np.repeat([-1.0, 1.0], 4)))
    order = [0, 1, 3, 2, 4, 5, 7, 6]
    at = corner[order] / np.sqrt(3.0)
    factors = 1.0 + at[:, None, :] * corner[None]
    shape = factors.prod(axis=2) / 8.0
    slope = np.stack(
        [corner[:, i] * np.delete(factors, i, axis=2).prod(axis=2) / 8.0 for i in range(3)], axis=-1
    )
    corners = x[bricks]
    volume = np.linalg.det(np.einsum("eai,qaj->eqij", corners, slope))
    return np.einsum("qa,eai->eqi", shape, corners), volume


def lame_stress(x: np.ndarray) -> np.ndarray:
    """Stress (..., 6) in plane strain: radial a - b/r2, hoop a + b/r2, along 2 nu a."""
    r2 = x[..., 0] ** 2 + x[..., 1] ** 2
    a = BORE**2 / (OUTSIDE**2 - BORE**2)
    b = a * OUTSIDE**2
    c2, s2, cs = x[..., 0] ** 2 / r2, x[..., 1] ** 2 / r2, x[..., 0] * x[..., 1] / r2
    radial, hoop = a - b / r2, a + b / r2
    zero = np.zeros_like(r2)
    across = radial * c2 + hoop * s2, radial * s2 + hoop * c2, 2 * POISSON * a + zero
    return np.stack([*across, (radial - hoop) * cs, zero, zero], axis=-1)


def squared_norm(stress: np.ndarray, volume: np.ndarray) -> float:
    """The integral of stress : D^-1 : stress."""
    trace = stress[..., :3].sum(axis=-1)
    own = (stress[..., :3] ** 2).sum(axis=-1) + 2.0 * (stress[..., 3:] ** 2).sum(axis=-1)
    return float((volume * ((1.0 + POISSON) * own - POISSON * trace**2)).sum() / MODULUS)


@pytest.mark.parametrize("element", ["C3D8", "C3D8I", "C3D8B", "C3D8R"])
@pytest.mark.parametrize("count", [4, 8, 16])
def test_thick_cylinder(keyway, documented, element, count):
    """The true error at the points, from the exact stress."""
    deck, mesh = cylinder(count, element)
    run = keyway(deck)
    points, volume = points_of(mesh.x, mesh.bricks)
    table = run.csv("el_BODY")
    stress = np.stack([table[f"S{i}"] for i in (11, 22, 33, 12, 13, 23)], axis=1)
    stress = stress.reshape(len(mesh.bricks), -1, 6)
    true = np.sqrt(squared_norm(lame_stress(points) - stress, volume))
    effectivity = estimate(run)["error"] / true
    assert 0.5 < effectivity < 2.0
    documented("mesh error of a cylinder", element, str(count), effectivity)


def energy_error(keyway, make, element: str, count: int, limit: float) -> float:
    """Estimate over truth; the truth from twice the strain energy in the limit."""
    run = keyway(make(count, element))
    energy = run.json["steps"][0]["energy"]["strain"]
    return estimate(run)["error"] / np.sqrt(limit - 2.0 * energy)


def compare_energies(keyway, documented, make, table: str, counts: tuple[int, ...], fine: int):
    """Estimate over truth; the truth from twice the strain energy of C3D8I on a fine mesh."""
    limit = 2.0 * keyway(make(fine, "C3D8I")).json["steps"][0]["energy"]["strain"]
    for element in ("C3D8", "C3D8I", "C3D8B"):
        for count in counts:
            run = keyway(make(count, element))
            energy = run.json["steps"][0]["energy"]["strain"]
            effectivity = estimate(run)["error"] / np.sqrt(limit - 2.0 * energy)
            assert 0.5 < effectivity < 2.0
            documented(table, element, str(count), effectivity)


def test_cook_membrane(keyway, documented):
    """C3D8R is no Galerkin solution: its energy says nothing of its error."""
    compare_energies(keyway, documented, cook, "mesh error of a membrane", (4, 8, 16), 64)


def test_cantilever(keyway, documented):
    """The edges of the root are singular."""
    compare_energies(keyway, documented, cantilever, "mesh error of a cantilever", (1, 2, 4), 8)


@pytest.mark.parametrize("element", ["C3D8", "C3D8I"])
def test_sections_have_no_part_in_the_error(keyway, element):
    """A section for each slice, of two materials with the same constants: stresses jump no more
    than in one section. The sums are the same, in another order of the patches."""
    whole = cantilever(2, element)
    section = "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n"
    assert section in whole
    slices = "".join(
        f"*ELSET, ELSET=S{i}, GENERATE\n{4 * i + 1}, {4 * i + 4}\n"
        f"*SOLID SECTION, ELSET=S{i}, MATERIAL={'MN'[i % 2]}\n"
        for i in range(8)
    )
    twin = f"*MATERIAL, NAME=N\n*ELASTIC\n{MODULUS!r}, {POISSON!r}\n"
    one, many = keyway(whole), keyway(whole.replace(section, twin + slices))
    assert estimate(one)["relative"] > 0.05  # not zero
    for quantity in ("stress", "displacement"):
        expected = one.json["accuracy"]["estimates"][quantity]["mesh"]
        found = many.json["accuracy"]["estimates"][quantity]["mesh"]
        assert found == pytest.approx(expected, rel=1e-9)


def test_materials_of_other_stiffness_keep_their_jump(keyway):
    """Two bars side by side, stretched alike: the stress along them jumps and is exact; only the
    round-off is left."""
    mesh, number = box_mesh((4, 2, 1), lambda a, b, c: np.stack([4.0 * a, b, c], axis=-1))
    mesh.node_sets["LOW"], mesh.node_sets["HIGH"] = number[0].ravel(), number[-1].ravel()
    mesh.node_sets["EDGE"] = number[:, 0, 0].ravel()
    cards = (
        "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*MATERIAL, NAME=N\n*ELASTIC\n3000., 0.\n"
        "*ELSET, ELSET=ONE, GENERATE\n1, 7, 2\n*ELSET, ELSET=TWO, GENERATE\n2, 8, 2\n"
        "*SOLID SECTION, ELSET=ONE, MATERIAL=M\n*SOLID SECTION, ELSET=TWO, MATERIAL=N\n"
        "*BOUNDARY\nLOW, 1, 1\nEDGE, 2, 3\n*STEP\n*STATIC\n*BOUNDARY\nHIGH, 1, 1, 0.001\n"
        "HIGH, 3, 3\n*END STEP\n"
    )
    assert estimate(keyway(brick_deck(mesh, "C3D8", cards)))["relative"] < 1e-12


@pytest.mark.parametrize("counts", [(1, 1, 1), (2, 2, 2)])
def test_elements_without_neighbours(keyway, counts):
    """A block of one element on a joint: its stress jumps to no other one, and nothing is known."""
    law = "KN=1e10, KT=1e10, FRICTION=0.6"
    pair = Pair(young=1e9, counts=counts, base_counts=(1, 1, 1), law=law)
    run = keyway(pair.deck(static("*DLOAD\nBLOCK, GRAV, 9.81, 0.2, 0., -1.\n")))
    found = run.json["accuracy"]["estimates"]
    log = (run.folder / f"{run.job}.log").read_text(encoding="utf-8")
    is_alone = counts == (1, 1, 1)
    assert ("stress" not in found) == is_alone
    assert ("mesh" not in found["displacement"]) == is_alone
    assert ("errors not estimated: stresses (" in log) == is_alone
    (line,) = (x for x in log.splitlines() if x.startswith("largest displacement"))
    assert ("mesh not estimated" in line) == is_alone


def test_hourglasses_are_an_error(keyway):
    """One C3D8R in the height carries bending by its hourglass control: no stress shows it."""
    assert estimate(keyway(cantilever(1, "C3D8R")))["relative"] > 0.9


def walk(file: h5py.File) -> list[str]:
    """All paths of a file."""
    paths: list[str] = []
    file.visit(paths.append)
    return paths


@pytest.mark.parametrize("element", ["C3D8", "C3D8I", "C3D8B", "C3D8R"])
def test_constant_stress_has_no_error(keyway, element):
    """A distorted block in tension: only the round-off is left. The energy of the hourglass control
    is a small difference of large terms; its root is that of the round-off, 1e-8."""
    allowed = 1e-7 if element == "C3D8R" else 1e-12
    mesh, number = box_mesh((3, 3, 3), lambda a, b, c: np.stack([a, b, c], axis=-1))
    inside = number[1:-1, 1:-1, 1:-1].ravel()
    mesh.x[inside] += 0.08 * np.sin(7.0 * np.arange(3 * len(inside))).reshape(-1, 3)
    mesh.node_sets["LOW"], mesh.node_sets["HIGH"] = number[0].ravel(), number[-1].ravel()
    mesh.node_sets["FRONT"], mesh.node_sets["FLOOR"] = number[:, 0].ravel(), number[:, :, 0].ravel()
    cards = elastic(MODULUS, POISSON) + "*BOUNDARY\nLOW, 1, 1\nFRONT, 2, 2\nFLOOR, 3, 3\n"
    cards += "*STEP\n*STATIC\n*BOUNDARY\nHIGH, 1, 1, 0.001\n*EL FILE\nERROR\n*END STEP\n"
    run = keyway(brick_deck(mesh, element, cards))
    assert estimate(run)["relative"] < allowed
    with h5py.File(run.folder / "job.h5") as file:
        (frame,) = (part for part in walk(file) if part.endswith("elements/ERROR"))
        assert np.abs(file[frame][:]).max() < allowed
