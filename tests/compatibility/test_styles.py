"""Decks in the style of PrePoMax, Gmsh and HyperMesh: a column with a closed form."""

import numpy as np
import pytest
import styles
from flat_twin import last_field

HEIGHT, AREA = styles.COLUMN.size[2], styles.COLUMN.size[0] * styles.COLUMN.size[1]
WEIGHT = styles.DENSITY * styles.GRAVITY  # per volume


@pytest.mark.parametrize("program", [styles.prepomax, styles.gmsh, styles.hypermesh])
def test_column(keyway, program):
    """Without Poisson's ratio a column is a bar; linear elements meet the displacements of a bar
    under weight at their nodes: (w (L z - z^2/2) + p z)/E downwards. 1e-9 is above round-off."""
    run = keyway(program())
    z = run.results.x[:, 2]
    exact = -(WEIGHT * (HEIGHT * z - z**2 / 2) + styles.PRESSURE * z) / styles.YOUNG
    moved = last_field(run, "U")
    assert moved[:, 2] == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    force = last_field(run, "RF").sum(axis=0)
    total = WEIGHT * AREA * HEIGHT + styles.PRESSURE * AREA
    assert force == pytest.approx([0.0, 0.0, total], abs=1e-9 * total)


@pytest.mark.parametrize("kind", ["NODES", "NODE", "ELEMENT SET"])
def test_surfaces_of_groups_in_the_deck(keyway, kind):
    """The pressure on the surface of a physical group is that on faces of elements."""
    deck = styles.gmsh()
    one = keyway(deck, name="faces")
    load = f"CAP, P2, {styles.PRESSURE}\n"
    assert load in deck
    deck = deck.replace(load, f"*DSLOAD\nCROWN, P, {styles.PRESSURE}\n")
    deck = deck.replace("*BOUNDARY\n", f"*SURFACE, NAME=CROWN, TYPE={kind}\nTOP\n*BOUNDARY\n", 1)
    other = keyway(deck, name="surface")
    a, b = last_field(one, "U"), last_field(other, "U")
    assert np.abs(a - b).max() <= 1e-13 * np.abs(a).max()  # round-off of sums in another order


def test_what_gmsh_adds_is_named(keyway):
    """Elements of lines and faces are left out, each card with its own note."""
    noted = [n["why"] for n in keyway(styles.gmsh()).json["ignored_input"]]
    assert sum("T3D2" in why for why in noted) == 1
    assert sum("CPS4" in why for why in noted) == 2


def test_beams_and_shells_with_sections_are_errors(keyway):
    """Where a section makes them carry loads, they are not left out."""
    deck = styles.gmsh().replace(
        "*BOUNDARY", "*SHELL SECTION, ELSET=TOP, MATERIAL=CONCRETE\n0.1\n*BOUNDARY"
    )
    run = keyway(deck, code=2)
    assert "*ELEMENT: TYPE: found 'CPS4'" in run.stderr


def test_names_with_quotes_inside(keyway):
    """Abaqus/CAE quotes names with blanks on either side of the point."""
    from test_parts import assembly

    plain = assembly(0.0)
    quoted = plain.replace("Block-1", '"Block 1"').replace("Block-2", '"Block 2"')
    quoted = quoted.replace("name=Block\n", 'name="The Block"\n')
    quoted = quoted.replace("part=Block\n", 'part="The Block"\n')
    one, other = keyway(plain, name="plain"), keyway(quoted, name="quoted")
    assert '"Block 1".Base, ENCASTRE' in quoted
    assert np.array_equal(last_field(one, "U"), last_field(other, "U"))
