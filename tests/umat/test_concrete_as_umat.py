"""Plastic-damage concrete behind the interface of user subroutines: the same law."""

from __future__ import annotations

import re
import subprocess

import numpy as np
import pytest
from harness import ROOT
from keyway_tools.concrete_constants import as_user_material, materials_of

MATERIALS = ROOT / "input" / "material"
CYCLES = (MATERIALS / "cyclic_uniaxial.inp").read_text()
SURFACE = "*CONCRETE DAMAGED PLASTICITY\n32.5, 0.1, 1.16, 0.6666666666666667\n"
SLOW = "*CONCRETE DAMAGED PLASTICITY, RECOVERY=SIGN\n32.5, 0.1, 1.16, 0.6666666666666667, 0.02\n"
DECKS = {
    "table 1": (MATERIALS / "table1_tension.inp").read_text(),
    "crushing, recovery": CYCLES,
    "openings": (MATERIALS / "dam_concrete.inp").read_text(),
    "two stresses": (MATERIALS / "kupfer.inp").read_text(),
    "viscosity, recovery by sign": CYCLES.replace(SURFACE, SLOW),
    "viscosity, recovery by energy": CYCLES.replace(SURFACE, SLOW.replace("SIGN", "ENERGY")),
}
# Two cubes of 0.5 m in a row, the second a twentieth weaker, pulled until it has cracked and
# pressed until the crack has closed.
BAR = """*NODE
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=STRONG
1, 1, 5, 7, 3, 2, 6, 8, 4
*ELEMENT, TYPE=C3D8, ELSET=WEAK
2, 5, 9, 11, 7, 6, 10, 12, 8
*ELSET, ELSET=BAR
STRONG, WEAK
*NSET, NSET=LEFT
1, 2, 3, 4
*NSET, NSET=RIGHT
9, 10, 11, 12
{materials}*SOLID SECTION, ELSET=STRONG, MATERIAL=STRONG
*SOLID SECTION, ELSET=WEAK, MATERIAL=WEAK
*BOUNDARY
LEFT, 1, 3
*AMPLITUDE, NAME=PATH
0., 0., 1., 1., 2., -1.
*STEP
*STATIC, DIRECT
0.04, 2.
*CONTROLS, TANGENT=CONSISTENT, RESIDUAL=1e-10
*BOUNDARY, AMPLITUDE=PATH
RIGHT, 1, 1, 0.15e-3
*NODE PRINT, NSET=RIGHT
RF
*EL PRINT, ELSET=BAR
S, {fields}
*END STEP
"""


@pytest.fixture(scope="module")
def one_file(tmp_path_factory):
    """What tools/make_umat writes for other programs."""
    path = tmp_path_factory.mktemp("umat") / "umat_concrete.f90"
    subprocess.run([ROOT / "tools" / "make_umat", path], check=True, capture_output=True)
    return path


@pytest.fixture(scope="module")
def library(program_path, one_file):
    """The same, compiled once."""
    path = one_file.with_suffix(".so")
    command = [program_path, "--umat", one_file, "--umat-library", path]
    subprocess.run(command, check=True, capture_output=True)
    return path


@pytest.mark.parametrize("kind", DECKS)
def test_is_the_law_of_the_program(keyway, library, kind):
    text = DECKS[kind]
    own = keyway(text, "--material", name="own")
    other = keyway(as_user_material(text), "--umat", str(library), "--material", name="other")
    tests = re.findall(r"^\*MATERIAL TEST, NAME=(\w+)", text, re.M)
    assert tests
    for test in tests:
        expected, found = own.csv(f"material_{test}"), other.csv(f"material_{test}")
        for name in ("E11", "E22", "S11", "S22", "S12", "stored"):
            # The same operations on the same numbers; strains under stress control are iterated. A
            # stress that is held at zero is what the iteration leaves: the largest stress counts.
            names = ("S11", "S22", "S12") if name.startswith("S") else (name,)
            scale = max(np.abs(expected[n]).max() for n in names) + 1e-300
            assert np.abs(found[name] - expected[name]).max() <= 1e-9 * scale, (test, name)
        assert np.allclose(found["SDV9"], expected["DAMAGET"], atol=1e-9)
        assert np.allclose(found["SDV10"], expected["DAMAGEC"], atol=1e-9)


def bar(fields: str) -> str:
    nodes = [(x, y, z) for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)]
    own = DECKS["openings"].split("*MATERIAL TEST")[0]
    strong = own[own.index("*MATERIAL") :].replace("NAME=DAM", "NAME=STRONG")
    weak = strong.replace("NAME=STRONG", "NAME=WEAK").replace("2.5e6, 200.", "2.375e6, 200.")
    lines = [f"{i + 1}, {0.5 * x}, {0.5 * y}, {0.5 * z}" for i, (x, y, z) in enumerate(nodes)]
    return BAR.format(nodes="\n".join(lines), materials=strong + weak, fields=fields)


def test_is_the_law_of_the_program_in_a_structure(keyway, library):
    """Cubes: CELENT is the width of the built-in law. Round-off, not the tolerance of the
    iteration, is what differs: its matrices and residuals are the same."""
    own = keyway(bar("DAMAGET, DAMAGEC"), name="own")
    other = keyway(as_user_material(bar("SDV")), "--umat", str(library), name="other")
    expected, found = own.csv("el_BAR"), other.csv("el_BAR")
    scale = np.abs(expected["S11"]).max()
    for name in ("S11", "S22", "S12"):
        assert np.abs(found[name] - expected[name]).max() <= 1e-8 * scale, name
    assert np.abs(found["SDV9"] - expected["DAMAGET"]).max() <= 1e-8
    cracked = expected["DAMAGET"][expected["element"] == 2].max()
    assert cracked > 0.5
    steps = own.json["steps"][0], other.json["steps"][0]
    assert steps[0]["increments"] == steps[1]["increments"]
    assert abs(steps[0]["iterations"] - steps[1]["iterations"]) <= 2
    for name in ("external", "strain", "fracture"):
        largest = abs(steps[0]["energy"]["external"])
        assert abs(steps[0]["energy"][name] - steps[1]["energy"][name]) <= 1e-8 * largest, name


def test_other_files_are_not_overwritten(one_file, tmp_path):
    """The file of an earlier call is replaced, the source of a user is not."""
    command = [ROOT / "tools" / "make_umat"]
    assert subprocess.run([*command, one_file], capture_output=True).returncode == 0
    mine = tmp_path / "my_umat.f90"
    mine.write_text("subroutine umat\nend subroutine\n")
    run = subprocess.run([*command, mine], capture_output=True, text=True)
    assert run.returncode == 2
    assert "exists and was not written by make_umat" in run.stderr
    assert mine.read_text() == "subroutine umat\nend subroutine\n"
    two = [tmp_path / "a.f90", tmp_path / "b.f90"]
    run = subprocess.run([*command, *two], capture_output=True, text=True)
    assert (run.returncode, two[0].exists()) == (2, False)
    assert "expected one FILE, found 2 words" in run.stderr


def test_constants_are_printed():
    """tools/make_umat --constants: what the tests above ran with."""
    deck = MATERIALS / "cyclic_uniaxial.inp"
    command = [ROOT / "tools" / "make_umat", "--constants", deck]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    names = [line.split("=")[1] for line in lines if line.startswith("*MATERIAL")]
    assert names == ["OPEN", "CLOSED", "HEALED"]
    start = lines.index("*USER MATERIAL, CONSTANTS=62, UNSYMM")
    end = lines.index("*DEPVAR")
    numbers = [float(word) for line in lines[start + 1 : end] for word in line.split(",")]
    assert numbers == materials_of(CYCLES)["OPEN"]
    assert numbers[:10] == [25e9, 0.167, 32.5, 0.1, 1.16, 0.6666666666666667, 0, 0, 0, 1]
    assert numbers[14:22] == [8, 8, 3, 3, 2.48e6, 0, 0.858e6, 0.175e-3]
    assert lines[end + 1] == "17"
