"""The worked example of a material law: plasticity of von Mises, against its closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
DECK = HERE / "von_mises" / "deck.inp"
YOUNG, POISSON, YIELD, HARDENING = 200e9, 0.3, 200e6, 20e9  # of the deck [Pa]
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
VOLUME = 2.0  # of the bar [m3]
# An increment ends where the residual is below 1e-6 of the force.
TOLERANCE = 1e-6


def tension_test(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stress, plastic strain and its sum without sign along a path of strains: the law has one
    spring, and a slider whose resistance grows with the sum."""
    stress, plastic, total, rows = 0.0, 0.0, 0.0, []
    for e in strain:
        trial = YOUNG * (e - plastic)
        slip = max(abs(trial) - YIELD - HARDENING * total, 0.0) / (YOUNG + HARDENING)
        plastic += np.sign(trial) * slip
        total += slip
        stress = YOUNG * (e - plastic)
        rows.append((stress, plastic, total))
    return tuple(np.array(rows).T)


def test_bar_in_tension_and_compression(example):
    """Stress, plastic strain and dissipated energy of the bar are those of the closed form."""
    run = example("von_mises")(DECK)
    table = run.csv("el_BAR")
    here = (table["element"] == 1) & (table["point"] == 1)
    stress, plastic, total = tension_test(table["E11"][here])
    assert table["S11"][here] == pytest.approx(stress, abs=TOLERANCE * YIELD)
    assert table["PE11"][here] == pytest.approx(plastic, abs=TOLERANCE * YIELD / YOUNG)
    assert table["PE22"][here] == pytest.approx(-0.5 * plastic, abs=TOLERANCE * YIELD / YOUNG)
    assert table["SDV7"][here] == pytest.approx(total, abs=TOLERANCE * YIELD / YOUNG)
    assert table["S22"][here] == pytest.approx(0.0, abs=TOLERANCE * YIELD)
    # The path yields in both directions and is elastic between them.
    assert stress.max() > 1.2 * YIELD and stress.min() < -1.2 * YIELD
    assert np.any((np.diff(total) == 0.0) & (total[1:] > 0.0))
    energy = run.csv("energy")
    work = (YIELD * total + 0.5 * HARDENING * total**2) * VOLUME
    assert energy["fracture"][-len(work) :] == pytest.approx(work, abs=TOLERANCE * work[-1])
    assert energy["error"].max() < TOLERANCE


def test_newton_is_quadratic(example):
    """With the consistent tangent a bar with a straight hardening branch needs few iterations."""
    run = example("von_mises")(DECK)
    assert run.json["accuracy"]["most_iterations"] <= 4


def test_shear(example):
    """A test at a point: the yield stress in shear is that in tension over sqrt(3)."""
    text = DECK.read_text(encoding="utf-8")
    material = text[text.index("*MATERIAL") : text.index("*SOLID SECTION")]
    deck = material + "*MATERIAL TEST, NAME=S, TYPE=SHEAR, INCREMENTS=20\n0.004\n"
    program = example("von_mises")
    (program.folder / "point.inp").write_text(deck, encoding="utf-8")
    done = program.call("--material", "-o", str(program.folder), str(program.folder / "point.inp"))
    assert done.returncode == 0, done.stderr
    table = np.genfromtxt(program.folder / "point_material_S.csv", delimiter=",", names=True)
    knee = YIELD / np.sqrt(3.0) / SHEAR
    slope = 1.0 / (1.0 / SHEAR + 3.0 / HARDENING)
    gamma = table["E12"]
    expected = np.where(gamma < knee, SHEAR * gamma, SHEAR * knee + slope * (gamma - knee))
    assert table["S12"] == pytest.approx(expected, abs=TOLERANCE * YIELD)
    assert gamma.max() > 2.0 * knee


def test_help_and_messages_name_the_new_law(example):
    """The reader, the help and the messages are made from the catalogue."""
    program = example("von_mises")
    assert "hardening" in program.call("--keywords", "VON MISES").stdout
    text = DECK.read_text(encoding="utf-8")
    run = program(text.replace("*ELASTIC\n200e9, 0.3\n", ""), code=2)
    assert "material 'STEEL' has no *ELASTIC" in run.stderr
    run = program(text.replace("200e6, 20e9", "0., 20e9"), code=2)
    assert "yield stress" in run.stderr
    run = program(text.replace("*ELASTIC\n200e9, 0.3\n*VON MISES\n200e6, 20e9\n", ""), code=2)
    assert "*CONCRETE DAMAGED PLASTICITY, *VON MISES" in run.stderr
