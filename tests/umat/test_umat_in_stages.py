"""User materials whose elements come and go (docs/theory.md, 15.1)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_umat_in_a_structure import HERE, YOUNG, deck, pull

INPUT = Path(__file__).resolve().parents[2] / "input" / "umat"
ROUND_OFF = 1e-12  # of sums of a few terms, over the largest value
CHANGE = "*STEP, NAME={0}\n*STATIC\n{1}*MODEL CHANGE, {0}\n205\n*END STEP"


def change(word: str, data: str = "") -> str:
    """A static step that takes out, or adds, the right cube."""
    return CHANGE.format(word, f"{data}\n" if data else "")


def at_end(run, step: int) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Whether rows are of the left and of the right cube, and the last increment of a step."""
    rows = run.csv("el_BAR")
    last = rows["increment"][rows["step"] == step].max()
    chosen = (rows["step"] == step) & (rows["increment"] == last)
    rows = {name: column[chosen] for name, column in rows.items()}
    return rows["element"] == 101, rows["element"] == 205, rows


def test_a_cube_that_returns_has_a_new_history(keyway):
    """SDVINI gives it its variables anew; only increments since then are counted.

    The left cube counts all increments: 10 of the pull, 4 without its neighbour, 2 with it.
    """
    steps = "\n".join(
        [pull(), change("REMOVE", "0.25, 1., , 0.25"), change("ADD", "0.5, 1., , 0.5")]
    )
    text = deck(f"{YOUNG}, 0.25", 3, steps=steps)
    run = keyway(text, "--umat", str(HERE / "history.for"))
    for step, counts in ((1, (10, 10)), (2, (14, 0)), (3, (16, 2))):
        left, right, rows = at_end(run, step)
        assert set(rows["SDV3"][left]) == {counts[0]}
        assert set(rows["SDV3"][right]) == {counts[1]}
    assert set(rows["SDV1"][right]) == {10 * 205 + point for point in range(1, 9)}
    told = (run.folder / "job.msg").read_text()
    assert "moment" in told


def test_plastic_strain_leaves_with_its_cube(keyway):
    """A bar beyond its yield stress of 200 MPa: the cube that returns has no stress and no strain.

    The left cube is free without its neighbour: it keeps its plastic strain and loses its stress.
    The right end is where it was in the deck, so that nothing pulls the cube that returns.
    At a strain of 0.3 % both yield, with s = 200 MPa + 10 GPa p and s/E + p = 0.003.
    """
    table = "200e9, 0.3, 200e6, 0., 300e6, 0.01, 320e6, 0.05"
    free = change("REMOVE").replace("*MODEL", "*BOUNDARY\nRIGHT, 1, 1, 0.\n*MODEL")
    steps = "\n".join([pull().replace("0.002", "0.006"), free, change("ADD")])
    run = keyway(deck(table, 7, steps=steps), "--umat", str(INPUT / "plastic_j2.f90"))
    plastic = (0.003 - 0.001) / (1.0 + 10e9 / 200e9)
    left, right, rows = at_end(run, 1)
    assert rows["SDV1"] == pytest.approx(plastic, rel=1e-9)
    assert rows["S11"] == pytest.approx(200e6 + 10e9 * plastic, rel=1e-9)
    for step in (2, 3):
        left, right, rows = at_end(run, step)
        assert rows["SDV1"][left] == pytest.approx(plastic, rel=1e-9)
        assert np.abs(rows["S11"]).max() < 1e-9 * 200e6
        assert np.abs([rows[f"SDV{i}"][right] for i in range(1, 8)]).max() < ROUND_OFF
    assert run.json["steps"][-1]["energy"]["error"] < 1e-6


def test_a_column_of_lifts_of_a_umat(keyway):
    """The UMAT of Hooke's law gives the stress of the elastic material, lift by lift."""
    pull_free = "*STEP, NAME=REMOVE\n*STATIC\n*MODEL CHANGE, REMOVE\n205\n"
    pull_free += "*DLOAD\nBAR, GRAV, 10., -1, 0, 0\n*EL PRINT, ELSET=BAR\nS\n*END STEP\n"
    steps = pull_free + change("ADD")
    text = deck(f"{YOUNG}, 0.25", steps=steps)
    run = keyway(text, "--umat", str(INPUT / "elastic.for"), name="umat")
    hooke = text.replace("*USER MATERIAL, CONSTANTS=2", "*ELASTIC")
    other = keyway(hooke, name="elastic")
    for step in (1, 2):
        found, wanted = at_end(run, step)[2], at_end(other, step)[2]
        for i in ("11", "22", "33", "12", "13", "23"):
            scale = 2.0 * 7850.0 * 10.0
            assert np.abs(found[f"S{i}"] - wanted[f"S{i}"]).max() < 1e-9 * scale
    assert run.json["steps"][-1]["energy"]["error"] < ROUND_OFF
