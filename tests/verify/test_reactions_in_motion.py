"""Reactions of a dynamic step against accelerations and loads (docs/theory.md, 7.2, RF and A).

A brick stands on its base and is pulled upwards: one unknown, the mean of its top.
"""

from __future__ import annotations

import numpy as np
import pytest
from tied_blocks import Blocks, node_set

YOUNG, DENSITY, DT = 20e9, 2400.0, 1e-5
TIMES, FACTORS = [0.0, 1e-4, 2e-4, 3e-4, 1e-3], [0.0, 1.0, -1.0, 0.5, 0.0]
PULL, CORNER = 4e5, 3e4  # [N]
# The held node 9 stretches the difference of two nodes of the top, 6 and 8.
EQUATIONS = ("6, 3, 1., 8, 3, -1., 9, 3, 1.", "8, 3, -1., 6, 3, 1., 9, 3, 1.")


def brick(alpha: float, equation: str = "") -> str:
    """The deck; with an equation a corner carries more than the others."""
    blocks = Blocks()
    blocks.add("L1", (1, 0, 1), (1, 0, 1), (1, 0, 1))
    top, base = blocks.side("L1", "Z1"), blocks.side("L1", "Z0")
    cards = node_set("TOP", top) + node_set("BASE", base)
    cards += "*AMPLITUDE, NAME=R\n" + "".join(
        f"{t!r}, {f!r}\n" for t, f in zip(TIMES, FACTORS, strict=True)
    )
    every, held, more = [*top, *base], "", ""
    if equation:
        cards = "*NODE\n9, 0., 0., 5.\n" + cards + f"*EQUATION\n3\n{equation}\n"
        every, held, more = [*every, 8], "9, 1, 3\n", f"{top[0] + 1}, 3, {CORNER!r}\n"
    cards += node_set("EVERY", every) + f"*BOUNDARY\nBASE, 1, 3\nTOP, 1, 2\n{held}"
    cards += f"*STEP\n*DYNAMIC, DIRECT, ALPHA={alpha!r}\n{DT!r}, 3e-4\n"
    cards += f"*CLOAD, AMPLITUDE=R\nTOP, 3, {PULL / 4.0!r}\n{more}"
    cards += "*NODE PRINT, NSET=EVERY\nU, A, RF\n*END STEP\n"
    return blocks.deck({"": f"*DENSITY\n{DENSITY!r}\n*ELASTIC\n{YOUNG!r}, 0.\n"}, cards)


@pytest.mark.parametrize("alpha", [0.0, -0.2])
def test_reactions_hold_the_forces_at_the_end_of_the_increment(keyway, alpha):
    """Their sum is inertia less loads, less the residual of the free unknown."""
    table = keyway(brick(alpha)).csv("node_EVERY")
    rows = {key: table[key].reshape(-1, 8) for key in ("time", "U3", "A3", "RF3")}
    is_top = np.abs(rows["U3"]).max(axis=0) > 0.0
    u, a = (rows[key][:, is_top].mean(axis=1) for key in ("U3", "A3"))
    load = PULL * np.interp(rows["time"][:, 0], TIMES, FACTORS)
    bulk = load - YOUNG * u
    residual = alpha * np.diff(bulk, prepend=0.0)
    assert (np.abs(residual).max() > 0.01 * PULL) == (alpha != 0.0)
    wanted = DENSITY / 2.0 * a - load - residual
    # U, A and RF are printed with 13 digits; the residual of the solver is smaller.
    assert rows["RF3"].sum(axis=1) == pytest.approx(wanted, abs=1e-9 * PULL)


def test_reactions_depend_on_the_displacement_that_an_equation_begins_with(keyway):
    """With ALPHA other than 0; the motion does not."""
    for alpha, is_same in ((0.0, True), (-0.2, False)):
        first, second = (
            keyway(brick(alpha, equation), name=f"first{i}").csv("node_EVERY")
            for i, equation in enumerate(EQUATIONS)
        )
        for key in ("U3", "A3"):
            assert first[key] == pytest.approx(second[key], abs=1e-9 * np.abs(first[key]).max())
        largest = np.abs(first["RF3"]).max()
        change = np.abs(first["RF3"] - second["RF3"]).max()
        assert (change < 1e-9 * largest) == is_same
        assert is_same or change > 0.01 * largest
