"""Tractions of stiff joints between different meshes do not oscillate, whichever side is finer.

A cantilever of 4 x 1 m cut along its middle plane: exactly, a uniform shear traction of a sixteenth
of the largest bending stress and no normal one (exact_fields.sheared_along). The joint is 400 times
as stiff as E / h and bonded. The ends, where nodes of both faces are held, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from exact_fields import sheared_along
from loaded_pairs import SHARP, Loaded
from mesh_pairs import Pair, Side

STRESS = 1e6  # the largest of bending [Pa]
STIFF = 1e13  # [Pa/m]
SHEAR = STRESS / 16.0  # [Pa]


@dataclass
class Traction:
    """Along one line of the joint, over the bending stress."""

    normal: float  # largest
    shear: float  # largest error
    variation: float  # total, of the normal traction


def traction_along(
    keyway, n: int, ratio: tuple[int, int], slave: str, integration: str = "NODES"
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places along one line of the joint, normal and shear tractions over the bending stress.

    Elements a metre of the lower and the upper half: n times `ratio`; one across.
    """
    sides = [Side((4 * n * r, 1, max(1, n * r // 2))) for r in ratio]
    pair = Pair(*sides, size=(4.0, 0.25), heights=(0.5, 0.5), poisson=0.0)
    pair.hold_end()
    loaded = Loaded(pair, {"BEAM": sheared_along(pair, STRESS)})
    master = "UPPER" if slave == "LOWER" else "LOWER"
    deck = loaded.deck(
        f"*JOINT LAW, NAME=L, KN={STIFF!r}, KT={STIFF!r}, TENSILE STRENGTH=1e12\n"
        f"*JOINT, NAME=J, LAW=L, INTEGRATION={integration}\n{slave}, {master}\n",
        "*JOINT PRINT, JOINT=J\n",
    ).replace(SHARP, "*CONTROLS, RESIDUAL=1e-9, INCREMENT=1e-9\n")  # springs: 1e13 of 1e10
    table = keyway(deck, name=f"{ratio[0]}_{ratio[1]}_{slave}_{integration}").csv("joint_J")
    x = np.stack([table[c] for c in "xyz"], axis=1) @ pair.turn
    line = (x[:, 1] < x[:, 1].min() + 1e-9) & (x[:, 0] > 0.5) & (x[:, 0] < 3.5)
    order = np.argsort(x[line, 0])
    shear = np.hypot(table["t1"], table["t2"])[line][order]
    return x[line, 0][order], table["tn"][line][order] / STRESS, shear / STRESS


def traction(keyway, *of) -> Traction:
    """Errors of the tractions; arguments of traction_along."""
    _, normal, shear = traction_along(keyway, *of)
    return Traction(
        np.abs(normal).max(), np.abs(shear - SHEAR / STRESS).max(), np.abs(np.diff(normal)).sum()
    )


def smaller(pair: tuple[int, int]) -> str:
    """The face with fewer facets."""
    return "UPPER" if pair[0] > pair[1] else "LOWER"


def show(documented, n: int, ratio: tuple[int, int], column: str, found: Traction) -> None:
    """Compares tractions with the table of the page.

    The variation at points of segments depends on round-off: 3.08 and 3.01 with two optimisations.
    """
    row = f"{n * ratio[0]} : {n * ratio[1]}"
    numbers = (found.normal,) if "segments" in column else (found.normal, found.variation)
    documented("tractions", row, column, *numbers)


@pytest.mark.parametrize(
    ("n", "ratio", "slave", "integration", "column"),
    [
        (4, (1, 2), "LOWER", "NODES", "nodes, slave coarser"),
        (4, (2, 3), "LOWER", "NODES", "nodes, slave coarser"),
        (4, (2, 3), "UPPER", "NODES", "nodes, finer"),
        *(
            (n, ratio, slave, "GAUSS", column)
            for slave, column in (
                ("LOWER", "segments, slave coarser"),
                ("UPPER", "segments, finer"),
            )
            for n, ratio in ((2, (1, 2)), (2, (1, 4)), (4, (1, 2)), (4, (2, 3)))
        ),
    ],
)
def test_other_pairs_are_as_documented(keyway, documented, n, ratio, slave, integration, column):
    """Rows of the table that no other test of this file computes."""
    show(documented, n, ratio, column, traction(keyway, n, ratio, slave, integration))


@pytest.mark.parametrize("integration", ["NODES", "GAUSS"])
def test_equal_meshes_have_no_normal_traction(keyway, integration):
    """1e-9: round-off of the solution, times a joint 400 times as stiff as the beam."""
    found = traction(keyway, 2, (1, 1), "LOWER", integration)
    assert found.normal < 1e-9
    assert found.variation < 1e-9


@pytest.mark.parametrize("ratio", [(1, 2), (1, 4), (1, 8), (4, 1)])
def test_the_coarser_face_as_slave_is_smooth(keyway, documented, ratio):
    """Either half refined: normal traction and its variation below 2 % of the bending stress.

    Refining the other side adds nothing. Shear within 1.2 % (0.7 % with equal meshes).
    """
    found = traction(keyway, 2, ratio, smaller(ratio))
    if ratio[0] == 1:
        show(documented, 2, ratio, "nodes, slave coarser", found)
    assert found.normal < 0.02
    assert found.variation < 0.02
    assert found.shear < 0.012


def test_the_finer_face_as_slave_shows_the_kinks_of_the_coarser(keyway, documented):
    """A fine face on straight coarse facets is pressed at their kinks, as a beam on a polygon is.

    The traction follows, with the period of the coarse facets. It grows by a like amount with each
    doubling of the ratio, as a logarithm does, and halves with the size of all elements. So it is
    the error of the coarse mesh; one of an unstable pair would double with the ratio and stay as
    the meshes refine.
    """
    found = {(n, r): traction(keyway, n, (1, r), "UPPER") for n in (2, 4) for r in (2, 4, 8)}
    for n, r in ((2, 2), (2, 4), (2, 8), (4, 2)):
        show(documented, n, (1, r), "nodes, finer", found[n, r])
    by_ratio = [found[2, r].normal for r in (2, 4, 8)]
    assert by_ratio[2] - by_ratio[1] < by_ratio[1] - by_ratio[0] < 0.13
    finer = [found[4, r].normal for r in (2, 4)]
    assert finer[0] < 0.55 * by_ratio[0] and finer[1] < 0.55 * by_ratio[1]


@pytest.mark.parametrize("slave", ["LOWER", "UPPER"])
def test_nodes_are_smooth_where_points_of_segments_are_not(keyway, documented, slave):
    """2 against 3 facets; the normal traction over the bending stress, with exact value 0.

    The points of the segments lock: they are too many for the nodes.
    """
    nodes = traction(keyway, 2, (2, 3), slave)
    points = traction(keyway, 2, (2, 3), slave, "GAUSS")
    is_coarser = slave == "LOWER"
    show(documented, 2, (2, 3), "nodes, slave coarser" if is_coarser else "nodes, finer", nodes)
    column = "segments, slave coarser" if is_coarser else "segments, finer"
    show(documented, 2, (2, 3), column, points)
    assert nodes.normal < 0.02
    assert nodes.variation < 0.2
    assert points.normal > 0.5
    assert points.variation > 5.0
