"""The mortar projection itself: its weights against a closed form, and its stability.

The weights are read back: all nodes are held, one node of the master face after the other is moved,
and the reactions of a bonded joint at the slave nodes are k area weight times that.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from joint_decks import static
from mesh_pairs import Pair, Side, graded
from scipy.sparse.linalg import splu
from small_solids import box_stiffness

MOVED, SPRING = 1e-3, 1e9  # [m], [Pa/m]


def coupling_matrix(keyway, pair: Pair, slave: str, name: str = "job") -> np.ndarray:
    """int phi_a N_m dA (slave nodes, master nodes), as the program uses it."""
    faces = {"LOWER": pair.low[:, :, -1].ravel(), "UPPER": pair.high[:, :, 0].ravel()}
    master = "UPPER" if slave == "LOWER" else "LOWER"
    pair.mesh.node_sets["SLAVE"] = faces[slave]
    cards = (
        f"*JOINT LAW, NAME=L, KN={SPRING!r}, KT={SPRING!r}, TENSILE STRENGTH=1e12\n"
        f"*JOINT, NAME=J, LAW=L\n{slave}, {master}\n"
    )
    for node in faces[master]:
        moved = "".join(
            f"{node + 1}, {i + 1}, {i + 1}, {MOVED * pair.turn[i, 2]}\n" for i in range(3)
        )
        cards += static(
            f"*BOUNDARY, OP=NEW\nALL, 1, 3\n{moved}*NODE PRINT, NSET=SLAVE\nRF\n", name=f"N{node}"
        )
    table = keyway(pair.deck(cards), name=name).csv("node_SLAVE")
    forces = np.stack([table[f"RF{i}"] for i in (1, 2, 3)], axis=1) @ pair.turn[:, 2]
    order = np.lexsort((np.argsort(np.argsort(faces[slave]))[np.searchsorted(
        np.sort(faces[slave]), table["node"] - 1)], table["step"]))  # fmt: skip
    return -forces[order].reshape(len(faces[master]), -1).T / (MOVED * SPRING)


def line_integrals(slave: np.ndarray, master: np.ndarray) -> np.ndarray:
    """int phi_a N_m dx over lines of nodes: the dual function is 2 N_a - N_b in each element."""
    total = np.zeros((len(slave), len(master)))
    cuts = np.unique(np.concatenate((slave, master)).round(12))
    for start, end in pairwise(cuts):
        for place in 0.5 * (start + end) + 0.5 * (end - start) * np.array([-1, 1]) / np.sqrt(3.0):
            e, f = (np.searchsorted(line, place) - 1 for line in (slave, master))
            s = (place - slave[e]) / (slave[e + 1] - slave[e])
            m = (place - master[f]) / (master[f + 1] - master[f])
            dual, shape = np.array([2.0 - 3.0 * s, 3.0 * s - 1.0]), np.array([1.0 - m, m])
            total[e : e + 2, f : f + 2] += 0.5 * (end - start) * np.outer(dual, shape)
    return total


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
def test_weights_are_those_of_the_dual_functions(keyway, slave):
    """Graded grids, 3 x 2 against 4 x 5: products of integrals along lines, to 1e-10."""
    pair = Pair(Side((3, 2, 1), graded(3.0)), Side((4, 5, 1), graded(0.4)))
    lines = []
    for face in (pair.low[:, :, -1], pair.high[:, :, 0]):
        lines.append((pair.local[face[:, 0], 0], pair.local[face[0, :], 1]))
    if slave == "UPPER":
        lines.reverse()
    exact = np.kron(*(line_integrals(lines[0][i], lines[1][i]) for i in (0, 1)))
    found = coupling_matrix(keyway, pair, slave)
    assert found == pytest.approx(exact, abs=1e-10 * np.abs(exact).max())


def inf_sup(keyway, slave_parts: int, master_parts: int, name: str) -> float:
    """The stability of a strip's coupling with so many facets on the two faces.

    The least of sup_v b(lambda, v)^2 / (|lambda|^2 |v|^2) over multipliers lambda on the slave
    nodes: b the virtual work of lambda on the jump of both blocks, |v|^2 their strain energy times
    two, |lambda|^2 = h / E int lambda^2 with the slave facet's size h, which stands for the
    norm of H^-1/2 (Wohlmuth 2001).
    """
    size, height, young = (2.0, 0.25), 1.0, 1.0
    sides = [Side((n, 1, n // 2)) for n in (slave_parts, master_parts)]
    pair = Pair(*sides, size=size, heights=(height, height), turn=np.eye(3))
    matrix = coupling_matrix(keyway, pair, "LOWER", name)
    area = matrix.sum(axis=1)
    total = np.zeros((3 * len(area),) * 2)
    for side, rows, is_upper in ((sides[0], np.diag(area), False), (sides[1], matrix, True)):
        stiffness, number = box_stiffness(side.counts, (*size, height), young, 0.2)
        held = (3 * number[:, :, -1 if is_upper else 0].ravel()[:, None] + np.arange(3)).ravel()
        face = (3 * number[:, :, 0 if is_upper else -1].ravel()[:, None] + np.arange(3)).ravel()
        free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
        work = np.zeros((stiffness.shape[0], len(total)))
        work[face] = np.kron(rows, np.eye(3)).T
        total += work[free].T @ splu(stiffness[free][:, free]).solve(work[free])
    norm = np.repeat(area, 3) * size[0] / slave_parts / young
    return float(np.linalg.eigvalsh(total / np.sqrt(np.outer(norm, norm)))[0])


def test_stability_does_not_depend_on_refinement_of_one_side(keyway, documented):
    """Refined slave, refined master, and meshes that do not nest.

    A traction that changes sign from one fine slave node to the next does work on the slave alone,
    the master being too coarse to follow: half of what two equal faces give, and no less.
    """
    pairs = [(8, 8), (16, 8), (32, 8), (8, 16), (8, 32), (14, 6), (6, 14)]
    found = {pair: inf_sup(keyway, *pair, "pair_{}_{}".format(*pair)) for pair in pairs}
    assert min(found.values()) > 0.5 * found[8, 8]
    assert found[32, 8] == pytest.approx(found[16, 8], rel=0.01)
    for (slave, master), number in found.items():
        documented("inf-sup", "", f"{slave} : {master}", number)
