"""Words of Abaqus and CalculiX that the program takes, by what they do."""

from pathlib import Path

import numpy as np
import pytest
from keyway_tools.study.mesh_sets import support_of

BLOCK = (Path(__file__).resolve().parents[1] / "errors/base/block.inp").read_text(encoding="utf-8")
PUSH = "*CLOAD\nTOP, 1, 1e6\nTOP, 2, 1e6\nTOP, 3, 1e6\n*NODE PRINT, NSET=TOP\nU\n*END STEP"


@pytest.mark.parametrize(("name", "free"), [("XASYMM", 1), ("YASYMM", 2), ("ZASYMM", 3)])
def test_antisymmetry_holds_the_directions_in_its_plane(keyway, name, free):
    deck = BLOCK.replace("BASE, 1, 3", f"BASE, 1, 3\nTOP, {name}").replace("*END STEP", PUSH)
    table = keyway(deck).csv("node_TOP")
    for direction in (1, 2, 3):
        moves = np.abs(table[f"U{direction}"]) > 0.0
        assert np.all(moves) if direction == free else not np.any(moves)


@pytest.mark.parametrize(("line", "increments"), [(", 1., , 0.5", 2), (", 1., , 4.", 1)])
def test_the_first_increment_is_at_most_the_largest(keyway, line, increments):
    run = keyway(BLOCK.replace("*STATIC", f"*STATIC\n{line}"))
    assert run.json["steps"][0]["increments"] == increments


@pytest.mark.parametrize(
    ("name", "held"), [("XASYMM", (2, 3)), ("YASYMM", (1, 3)), ("ZASYMM", (1, 2)), ("YSYMM", (2,))]
)
def test_names_of_supports_hold_their_directions(name, held):
    """The tools read them as the program does."""
    assert support_of(f"SIDE, {name}") == ("SIDE", held, 0.0)


def test_components_ask_for_their_field(keyway):
    """deck.md: a field may be a component, U3 or S11; so may those of the other fields."""
    prints = "*NODE PRINT, NSET=TOP\nU3, RF1\n*EL PRINT, ELSET=DAM\nLE22, SP3\n*EL FILE\nE33\n"
    run = keyway(BLOCK.replace("*END STEP", prints + "*END STEP"))
    assert run.json["ignored_input"] == []
    assert {"U1", "U2", "U3", "RF1", "RF2", "RF3"} <= set(run.csv("node_TOP"))
    written = set(run.csv("el_DAM"))
    assert {"E11", "E22", "E33", "E12", "E13", "E23", "SP1", "SP2", "SP3"} <= written
    assert not written & {"S11", "U1"}
    assert list(run.folder.glob("job_vtk/*.vtu"))


def test_components_of_fields_that_are_missing_get_their_warning(keyway):
    prints = "*NODE PRINT, NSET=TOP\nU3, V3\n*EL PRINT, ELSET=DAM\nS33, PE12, SDV1, THE33\n"
    run = keyway(BLOCK.replace("*END STEP", prints + "*END STEP"))
    warnings = "\n".join(run.json["warnings"])
    for said in ("there is no V:", "has PE;", "has SDV;", "THE is not written"):
        assert said in warnings
