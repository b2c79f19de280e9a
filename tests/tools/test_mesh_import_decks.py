"""Meshes of Abaqus and CalculiX: sets keep all their members, and what cannot be taken is said."""

import numpy as np
import pytest
from keyway_tools.mesh_import.__main__ import main
from keyway_tools.mesh_import.build import import_mesh
from keyway_tools.mesh_import.grouped_mesh import MeshError, read_grouped_mesh

# Three cubes in a row along x: nodes 101 to 104 at y = z = 0, elements 10, 13, 16.
NODES = "*NODE\n" + "".join(
    f"{100 + 10 * (2 * z + y) + x + 1}, {x}., {y}., {z}.\n"
    for z in (0, 1)
    for y in (0, 1)
    for x in range(4)
)
BRICKS = "*ELEMENT, TYPE=C3D8R, ELSET=ALL\n" + "".join(
    f"{10 + 3 * x}, {101 + x}, {102 + x}, {112 + x}, {111 + x},\n"
    f" {121 + x}, {122 + x}, {132 + x}, {131 + x}\n"
    for x in range(3)
)
MESH = NODES + BRICKS


def read(tmp_path, text, mesh=MESH):
    path = tmp_path / "m.inp"
    path.write_text(mesh + text, encoding="utf-8")
    return read_grouped_mesh(path)


@pytest.mark.parametrize(
    "text",
    [
        "*NSET, NSET=BASE\n101, 102\n*NSET, NSET=base\n103\n",
        "*NSET, NSET=A\n101, 102\n*NSET, NSET=BASE\nA, 103\n",
        "*NSET, NSET=BASE\n** remark\n101, 102,\n\n** remark\n103\n",
        "*NSET, NSET=BASE, GENERATE\n101, 102\n103, 103, 1\n",
        "*NSET, NSET=BASE, GENERATE\n101, 103, 1\n",
        '*Nset, nset="BASE", internal\n101, 102, 103\n',
        "*INCLUDE, INPUT=base.inc\n103\n",
    ],
)
def test_a_set_of_nodes_is_whole(tmp_path, text):
    (tmp_path / "base.inc").write_text("*NSET, NSET=BASE\n101, 102\n")
    assert list(read(tmp_path, text).node_groups["BASE"]) == [0, 1, 2]


def test_a_set_of_the_nodes_of_elements(tmp_path):
    """The corners of the first and the last cube."""
    text = "*ELSET, ELSET=Ends\n10, 16\n*NSET, NSET=CORNERS, ELSET=ENDS\n*NSET, NSET=CORNERS\n101\n"
    assert list(read(tmp_path, text).node_groups["CORNERS"]) == list(range(16))
    text = "*NSET, NSET=CORNERS, ELSET=ALL\n"
    assert list(read(tmp_path, text).node_groups["CORNERS"]) == list(range(16))
    text = "*ELSET, ELSET=ONE\n10\n*NSET, NSET=CORNERS, ELSET=ONE\n"
    assert list(read(tmp_path, text).node_groups["CORNERS"]) == [0, 1, 4, 5, 8, 9, 12, 13]


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("*NSET, NSET=Empty\n", "NSET 'Empty' has no members; left out"),
        ("*ELSET, ELSET=E\n** remark\n", "ELSET 'E' has no members; left out"),
        ("*NODE, NSET=N\n", "NSET 'N' has no members; left out"),
        ("*NSET, NSET=FUß\n101\n", "group 'FUß' is FUSS in the deck"),
        (
            "*ELEMENT, TYPE=T3D2, ELSET=BARS\n90, 101, 102\n91, 102, 103\n",
            "group BARS: 2 cells of the kind line; left out",
        ),
    ],
)
def test_what_becomes_of_a_set_is_noted(tmp_path, text, note):
    assert note in read(tmp_path, text).notes


def test_a_set_of_nodes_without_solids_is_noted(tmp_path):
    imported = import_mesh(read(tmp_path, "*NODE, NSET=FAR\n900, 9., 9., 9.\n"), [], {})
    assert "set of nodes FAR: no solid has these nodes; left out" in imported.notes


@pytest.mark.parametrize(
    "text",
    [
        "*ELSET, ELSET=E\n10\n*ELSET, ELSET=E\n16\n",
        "*ELSET, ELSET=A\n10\n*ELSET, ELSET=E\nA, 16\n",
        "*ELSET, ELSET=E\n10,\n** remark\n16\n",
        "*ELSET, ELSET=E, GENERATE\n10, 16, 6\n",
    ],
)
def test_a_set_of_elements_is_whole(tmp_path, text):
    grouped = read(tmp_path, text)
    assert list(grouped.brick_groups["E"]) == [0, 2]
    assert list(grouped.brick_groups["ALL"]) == [0, 1, 2]


def test_cards_of_the_mesh_may_come_again(tmp_path):
    """Nodes and elements of several cards, in included files, with faces and sets of their own."""
    (tmp_path / "more.inp").write_text(
        "*NODE, NSET=FAR\n201, 9., 0., 0.\n*ELEMENT, TYPE=S4, ELSET=END\n90, 101, 111, 131, 121\n"
        "*ELEMENT, TYPE=C3D8, ELSET=ALL\n17, 104, 201, 202, 114, 124, 203, 204, 134\n"
        "*NODE, NSET=FAR\n202, 9., 1., 0.\n203, 9., 0., 1.\n204, 9., 1., 1.\n"
    )
    grouped = read(tmp_path, "*INCLUDE, INPUT=more.inp\n*ELSET, ELSET=TWO\n17, END\n")
    assert len(grouped.bricks) == 4
    assert list(grouped.node_groups["FAR"]) == [16, 17, 18, 19]
    assert np.array_equal(grouped.x[19], [9.0, 1.0, 1.0])
    assert list(grouped.brick_groups["ALL"]) == [0, 1, 2, 3]
    assert list(grouped.brick_groups["TWO"]) == [3]
    assert list(grouped.face_groups["END"]) == list(grouped.face_groups["TWO"]) == [0]


@pytest.mark.parametrize(("one", "two"), [("Süd", "Söd"), ("S.1", "S-1"), ("Süd", "SÜD")])
@pytest.mark.parametrize("of_faces", [False, True])
def test_sets_whose_names_become_one_are_refused(tmp_path, one, two, of_faces):
    """Two sets of nodes, and a set of faces, whose nodes become a set too, beside one of nodes."""
    first = f"*NSET, NSET={one}\n101, 102\n"
    if of_faces:
        first = f"*ELEMENT, TYPE=S4, ELSET={one}\n90, 101, 111, 131, 121\n"
    with pytest.raises(MeshError, match=rf"'{one}' and '{two}' would both be S_"):
        read(tmp_path, f"{first}*NSET, NSET={two}\n103\n")


def test_a_set_of_nodes_with_another_name_in_the_deck_is_noted(tmp_path, capsys):
    (tmp_path / "m.inp").write_text(MESH + "*NSET, NSET=Base Fels\n101\n")
    assert main([str(tmp_path / "m.inp")]) == 0
    assert "note: group 'Base Fels' is BASE_FELS in the deck" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*NSET, NSET=A\n101, B\n", "m.inp:26: found 'B'; expected a whole number or the name of"),
        ("*NSET\n101\n", r"m.inp:25: \*NSET: no name; expected NSET=name"),
        ("*NSET, NSET=A\n101, 900\n", "node 900 of set A is not there"),
        ("*ELSET, ELSET=A, GENERATE\n10, 16, 1\n", "element 11 of set A is not there"),
        ("*NSET, NSET=A, GENERATE\n103, 101, -1\n", "m.inp:26: found '103, 101, -1'; expected fir"),
        ("*NSET, NSET=A, GENERATE\n103, 101\n", "integers > 0 with first <= last"),
        ("*NSET, NSET=A, GENERATE\n101, 103, 0\n", "integers > 0 with first <= last"),
        ("*ELSET, ELSET=A, GENERATE\n10\n", "m.inp:26: found '10'; expected first, last, step"),
        ("*NSET, NSET=A, ELSET=B\n", r"m.inp:25: \*NSET: found 'B'; expected the name of a set of"),
        ("*NODE\n101, 1., 2., 3.\n", "m.inp:26: node 101 is there twice"),
        ("*NODE\n201, 1., 2 m\n", "m.inp:26: found '201, 1., 2 m'; expected numbers"),
        ("*ELEMENT, TYPE=S4\n10, 101, 102, 112, 111\n", "m.inp:26: element 10 is there twice"),
        ("*ELEMENT, TYPE=C3D6\n90, 101, 102, 103, 999, 104, 111\n", "node 999 of element 90"),
        ("*ELEMENT, TYPE=C3D8\n90, 101, 102, 103\n", "element 90 has 3 nodes; expected 8"),
        ("*ELEMENT, TYPE=S3\n90, 101, 102, 103, 104\n", "m.inp:26: 4 nodes; expected 3"),
        ("*ELEMENT, TYPE=COH3D8\n90, 101\n", "m.inp:25: .*elements of the type 'COH3D8'"),
        ("*NGEN\n101, 104, 1\n", r"m.inp:25: \*NGEN makes or moves nodes or elements"),
        ("*INCLUDE, INPUT=none.inp\n", "m.inp:25: .*none.inp"),
        ("*ELEMENT, TYPE=C3D4\n90, 101, 102, 103, 111\n", "1 cells of the kind tetra"),
    ],
)
def test_what_cannot_be_taken_is_said_with_its_place(tmp_path, text, message):
    with pytest.raises(MeshError, match=message):
        read(tmp_path, text)


def test_no_solid_is_lost_where_a_group_has_the_name_of_the_rest(tmp_path):
    """Solids of no group are SOLID_2 where SOLID is a group; the deck lost those of the group."""
    mesh = NODES + BRICKS.replace(", ELSET=ALL", "")
    (tmp_path / "m.inp").write_text(mesh + "*ELSET, ELSET=SOLID\n10\n")
    assert main([str(tmp_path / "m.inp"), "-o", str(tmp_path / "out.inp")]) == 0
    grouped = read_grouped_mesh(tmp_path / "out.inp")
    assert {name: len(own) for name, own in grouped.brick_groups.items()} == {
        "SOLID": 1,
        "SOLID_2": 2,
    }


def test_shells_are_taken_as_faces_with_a_note(tmp_path):
    shells = "*ELEMENT, TYPE=S4, ELSET=SK\n30, 101, 102, 112, 111\n31, 102, 103, 113, 112\n"
    imported = import_mesh(read(tmp_path, shells), [], {})
    assert len(imported.mesh.surfaces["SK"]) == 2
    note = "2 elements of the type S4 are taken as faces, for surfaces and sets of nodes"
    assert [n for n in imported.notes if n.startswith(note)]


@pytest.mark.parametrize("value", ["nan", "-inf", "1e999"])
def test_coordinates_of_a_deck_are_finite(tmp_path, value):
    mesh = MESH.replace("102, 1., 0., 0.", f"102, 1., {value}, 0.")
    words = rf"m.inp:3: node 102 has the coordinates 1., {value}, 0.; expected finite numbers"
    with pytest.raises(MeshError, match=words):
        read(tmp_path, "", mesh)
