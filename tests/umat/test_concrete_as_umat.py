"""Plastic-damage concrete behind the interface of user subroutines: the same law."""

from __future__ import annotations

import re
import subprocess

import numpy as np
import pytest
from concrete_constants import as_user_material
from harness import ROOT

DECK = ROOT / "input" / "material" / "table1_tension.inp"
CYCLES = ROOT / "input" / "material" / "cyclic_uniaxial.inp"


@pytest.fixture(scope="module")
def one_file(tmp_path_factory):
    """What tools/make_umat writes for other programs."""
    path = tmp_path_factory.mktemp("umat") / "umat_concrete.f90"
    subprocess.run([ROOT / "tools" / "make_umat", path], check=True, capture_output=True)
    return path


@pytest.mark.parametrize("deck", [DECK, CYCLES], ids=lambda path: path.stem)
def test_is_the_law_of_the_program(keyway, one_file, deck):
    text = deck.read_text()
    own = keyway(text, "--material", name="own")
    other = keyway(as_user_material(text), "--umat", str(one_file), "--material", name="other")
    for test in re.findall(r"^\*MATERIAL TEST, NAME=(\w+)", text, re.M):
        expected, found = own.csv(f"material_{test}"), other.csv(f"material_{test}")
        for name in ("E11", "E22", "S11", "S22", "S12", "stored"):
            # The same operations on the same numbers; strains under stress control are iterated.
            scale = np.abs(expected[name]).max() + 1e-300
            assert np.abs(found[name] - expected[name]).max() <= 1e-9 * scale, (test, name)
        assert np.allclose(found["SDV9"], expected["DAMAGET"], atol=1e-9)
