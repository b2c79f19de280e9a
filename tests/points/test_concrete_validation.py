"""The numbers of docs/concrete_validation.md: curves by the program beside published ones."""

from __future__ import annotations

import numpy as np
import published
import pytest
from concrete_validation import (
    GOPALARATNAM_SHAH_LENGTHS,
    GOPALARATNAM_SHAH_OPENINGS,
    KARSAN_JIRSA_PEAK,
    KARSAN_JIRSA_TURNS,
    at,
    biaxial_envelope,
    curves_of,
    opening,
    residuals,
)
from concretes import TABLE_1
from exponential_laws import ExponentialLaw
from harness import Program


@pytest.fixture(scope="module")
def curves(program_path, tmp_path_factory):
    return curves_of(Program(program_path, tmp_path_factory.mktemp("validation"), 1))


@pytest.mark.parametrize(
    "sign, points",
    [("T", published.BLACKBEAR_TENSION), ("C", published.BLACKBEAR_COMPRESSION)],
)
def test_blackbear(curves, sign, points):
    """Its laws in its increments; 3 % is allowed, tables of 51 rows give 1e-5."""
    assert at(curves[f"STEPS{sign}"], points[:, 0]) == pytest.approx(points[:, 1], rel=1e-5)


def test_exponential_laws(curves):
    """The laws themselves: peak, and area to the strain reached, which the steps change."""
    compression = np.abs(curves["EXACTC"].stress[:, 0])
    assert compression.max() == pytest.approx(27.6e6, rel=1e-3)
    for sign, points, allowed in (
        ("T", published.BLACKBEAR_TENSION, 0.03),
        ("C", published.BLACKBEAR_COMPRESSION, 0.06),
    ):
        found = at(curves[f"EXACT{sign}"], points[:, 0])
        assert found == pytest.approx(points[:, 1], rel=allowed)


def test_constants_of_the_exponential_laws():
    """Area, peak and the two damages come back out of the derived constants."""
    law = ExponentialLaw.with_peak(18.3e6, 27.6e6, 68.89e3, 0.25)
    plastic = np.linspace(0.0, 0.03, 300001)
    strength = law.strength(plastic)
    assert np.trapezoid(strength, plastic) == pytest.approx(68.89e3, rel=1e-6)
    assert strength.max() == pytest.approx(27.6e6, rel=1e-8)
    assert law.damage(plastic[strength.argmax()]) == pytest.approx(0.25, abs=1e-4)
    falling = ExponentialLaw.falling(3.48e6, 0.7, 12.3e3, 0.51)
    strength = falling.strength(plastic)
    assert np.trapezoid(strength, plastic) == pytest.approx(12.3e3, rel=1e-4)
    half = np.interp(-0.5, -strength / 3.48e6, plastic)
    assert falling.damage(half) == pytest.approx(0.51, abs=1e-6)
    slope = (strength[1] - strength[0]) / plastic[1]
    assert slope == pytest.approx(-0.7 * 9.0 / 8.0 * 3.48e6**2 / 12.3e3, rel=1e-3)


def test_table_1(curves):
    """The curve of Fig 12 passes through the rows (2 %: increments of 5e-6 cut its corners)."""
    strain = TABLE_1[:, 1] + TABLE_1[:, 0] / 25e9
    assert at(curves["TABLE1"], strain) == pytest.approx(TABLE_1[:, 0], rel=0.02)


def test_gopalaratnam_shah(curves):
    """At the rows of the table, in two lengths; chords between rows are off by 2 % of the peak."""
    for length in GOPALARATNAM_SHAH_LENGTHS:
        width, share = opening(curves[f"GOPALARATNAM{round(1e3 * length)}"], length)
        rows = GOPALARATNAM_SHAH_OPENINGS[1:-1]
        expected = published.gopalaratnam_shah(rows)
        assert np.interp(rows, width, share) == pytest.approx(expected, rel=5e-4)
        assert share == pytest.approx(published.gopalaratnam_shah(width), abs=0.025)


def test_karsan_jirsa(curves):
    """The scatter of a fit of three numbers, as measured: envelope 0.6 MPa, strains 0.08e-3."""
    points = published.KARSAN_JIRSA_ENVELOPE
    apart = at(curves["KARSANENVELOPE"], points[:, 0] * 1e-3) / 1e6 - points[:, 1]
    assert np.sqrt(np.mean(apart**2)) < 0.6
    rest = published.karsan_jirsa_residual(np.array(KARSAN_JIRSA_TURNS), KARSAN_JIRSA_PEAK)
    assert residuals(curves["KARSAN"]) == pytest.approx(rest, abs=0.08e-3)


def test_kupfer(curves):
    """Fitted to the uniaxial curve alone; the biaxial ones follow from f_b0/f_c0 = 1.16.

    Equal stresses: 37.05 MPa measured, 1 % allowed. At 1 : 0.52 the surface of Lubliner is known
    to be too strong: 1.29 f_c against 1.24 (5 %).
    """
    equal = np.abs(curves["KUPFEREQUAL"].stress[:, 0]).max()
    assert equal == pytest.approx(published.KUPFER_EQUAL[:, 1].max() * 1e6, rel=0.01)
    half = np.abs(curves["KUPFERHALF"].stress[:, 0]).max()
    assert half == pytest.approx(published.KUPFER_HALF[:, 1].max() * 1e6, rel=0.05)
    ratio, strength = biaxial_envelope(curves).T
    assert strength == pytest.approx(published.kupfer_gerstle(ratio), rel=0.06)
    # Plane stress in Eq. 19, no damage of one sign by the other: alpha = 0.16/1.32. Peaks lie
    # between increments of 1e-5: 1e-4.
    alpha = 0.16 / 1.32
    closed = (1.0 - alpha) / (np.sqrt(1.0 - ratio + ratio**2) - alpha * (1.0 + ratio))
    assert strength == pytest.approx(closed, rel=1e-4)
