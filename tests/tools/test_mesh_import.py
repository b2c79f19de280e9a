"""Meshes of other programs: groups, joints cut into the mesh, what is turned or refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from keyway_tools.mesh_import.__main__ import main
from keyway_tools.mesh_import.build import import_mesh
from keyway_tools.mesh_import.grouped_mesh import (
    GroupedMesh,
    deck_name,
    read_grouped_mesh,
)
from keyway_tools.mesh_quality import find_faults, volumes

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "input" / "gmsh_arch"


def grid(cells):
    """A box of unit cubes: nodes, bricks, and the position of a node."""
    counts = [n + 1 for n in cells]
    x = np.array(list(np.ndindex(*counts)), dtype=float)

    def node(i, j, k):
        return (i * counts[1] + j) * counts[2] + k

    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    bricks = [
        [node(i + a, j + b, k + c) for c in (0, 1) for a, b in ring]
        for i, j, k in np.ndindex(*cells)
    ]
    return x, np.array(bricks), node


def face_x(node, i, j, k):
    """The quad of the plane x = i at the cell (j, k)."""
    return [node(i, j + b, k + c) for b, c in ((0, 0), (1, 0), (1, 1), (0, 1))]


def face_y(node, i, j, k):
    """The quad of the plane y = j at the cell (i, k)."""
    return [node(i + a, j, k + c) for a, c in ((0, 0), (1, 0), (1, 1), (0, 1))]


def with_faces(cells, groups):
    """A grid with groups of quads, given by name."""
    x, bricks, node = grid(cells)
    faces, members = [], {}
    for name, quads in groups.items():
        own = [kind(node, *place) for kind, place in quads]
        members[name] = np.arange(len(faces), len(faces) + len(own))
        faces += own
    return GroupedMesh(x, bricks, np.array(faces), {}, members)


def coincide(mesh):
    return np.abs(mesh.x[mesh.joints[:, :4]] - mesh.x[mesh.joints[:, 4:]]).max() == 0.0


def test_one_joint_between_two_blocks():
    grouped = with_faces((2, 1, 1), {"J": [(face_x, (1, 0, 0))], "END": [(face_x, (2, 0, 0))]})
    mesh = import_mesh(grouped, ["J"], {}).mesh
    assert (len(mesh.x), len(mesh.joints)) == (12 + 4, 1)
    assert coincide(mesh)
    assert not set(mesh.bricks[0]) & set(mesh.bricks[1])
    assert find_faults(mesh) == []
    assert list(mesh.surfaces) == ["END"]
    (brick, face) = mesh.surfaces["END"][0]
    assert mesh.x[mesh.face_nodes(brick, face), 0].tolist() == [2.0] * 4


def test_crossing_joints_make_four_copies():
    """Two cuts that cross in a line: four bricks without a common node."""
    cuts = {
        "A": [(face_x, (1, 0, 0)), (face_x, (1, 1, 0))],
        "B": [(face_y, (0, 1, 0)), (face_y, (1, 1, 0))],
    }
    mesh = import_mesh(with_faces((2, 2, 1), cuts), ["A", "B"], {}).mesh
    assert len(mesh.x) == 4 * 8
    assert [len(mesh.joint_sets[name]) for name in ("A", "B")] == [2, 2]
    assert coincide(mesh)
    assert (np.abs(mesh.x - [1.0, 1.0, 0.0]).max(axis=1) == 0.0).sum() == 4


def test_end_of_a_cut_inside_a_body_stays_whole():
    """A cut through one of two rows: the line at its end belongs to all four bricks."""
    mesh = import_mesh(with_faces((2, 2, 1), {"A": [(face_x, (1, 0, 0))]}), ["A"], {}).mesh
    assert len(mesh.x) == 18 + 2
    assert (np.abs(mesh.x[:, :2] - [1.0, 1.0]).max(axis=1) == 0.0).sum() == 2
    assert coincide(mesh)


def test_surface_that_a_cut_crosses_keeps_its_faces():
    groups = {
        "J": [(face_x, (1, 0, 0))],
        "SIDE": [(face_y, (0, 0, 0)), (face_y, (1, 0, 0))],
    }
    mesh = import_mesh(with_faces((2, 1, 1), groups), ["J"], {}).mesh
    assert len(mesh.surfaces["SIDE"]) == 2
    assert len(mesh.node_sets["SIDE"]) == 8  # the nodes at the cut are there twice


def two_boxes(cells):
    """Two boxes side by side in x, with nodes of their own on the common face."""
    x, bricks, node = grid((1, 1, 2))
    more_x, more, other = grid((1, *cells))
    more_x = more_x * [1.0, 1.0 / cells[0], 2.0 / cells[1]] + [1.0, 0.0, 0.0]
    first = len(x)
    ours = [face_x(node, 1, 0, k) for k in range(2)]
    theirs = [[first + n for n in face_x(other, 0, j, k)] for j, k in np.ndindex(*cells)]
    return GroupedMesh(
        np.concatenate([x, more_x]),
        np.concatenate([bricks, more + first]),
        np.array(ours + theirs),
        {},
        {"A": np.arange(2), "B": np.arange(2, 2 + len(theirs))},
    )


def test_pair_of_faces_at_one_place_becomes_joint_elements():
    mesh = import_mesh(two_boxes((1, 2)), [], {"J": ("A", "B")}).mesh
    assert len(mesh.joint_sets["J"]) == 2
    assert coincide(mesh)
    assert set(mesh.joints[:, :4].ravel()) == set(mesh.node_sets["A"])


def test_pair_of_different_meshes_becomes_a_joint_of_surfaces():
    imported = import_mesh(two_boxes((2, 3)), [], {"J": ("A", "B")})
    assert imported.mesh.surface_joints == {"J": ("B", "A")}  # slave, master
    assert "the meshes of A and B differ" in imported.notes[0]


def test_groups_that_overlap():
    x, bricks, _ = grid((3, 1, 1))
    groups = {"ALL": np.arange(3), "LAST": np.array([2])}
    mesh = import_mesh(GroupedMesh(x, bricks[[2, 0, 1]], np.zeros((0, 4), int), groups), [], {})
    assert mesh.mesh.brick_sets["LAST"].tolist() == [0]
    assert mesh.mesh.brick_sets["ALL_REST"].tolist() == [1, 2]
    assert mesh.element_sets["ALL"].tolist() == [0, 1, 2]


def test_solids_inside_out_are_turned_and_counted():
    x, bricks, _ = grid((2, 1, 1))
    bricks[1] = bricks[1][[4, 5, 6, 7, 0, 1, 2, 3]]
    imported = import_mesh(GroupedMesh(x, bricks, np.zeros((0, 4), int)), [], {})
    assert volumes(imported.mesh) == pytest.approx([1.0, 1.0])
    assert imported.notes == ["1 solids were inside out and have been turned"]


@pytest.fixture
def wedge_file(tmp_path):
    """A wedge on a cube as Gmsh writes it, each cell in two groups, with an unused node."""
    x, bricks, node = grid((1, 1, 1))
    top = [node(0, 0, 1), node(1, 0, 1), node(1, 1, 1), node(0, 1, 1)]
    x = np.concatenate([x, [[0.0, 0.5, 2.0], [1.0, 0.5, 2.0], [9.0, 9.0, 9.0]]])
    wedge = [top[0], top[3], 8, top[1], top[2], 9]
    front = [top[0], top[1], 9, 8]
    cells = [("hexahedron", bricks), ("wedge", [wedge]), ("hexahedron", bricks)]
    cells += [("quad", [front]), ("triangle", [[top[1], top[2], 9]])]
    mesh = meshio.Mesh(
        x,
        cells,
        cell_data={
            "gmsh:physical": [[1], [2], [3], [4], [4]],
            "gmsh:geometrical": [[1], [2], [1], [1], [2]],
        },
        field_data={
            "Lower part": np.array([1, 3]),
            "roof": np.array([2, 3]),
            "2nd group": np.array([3, 3]),
            "wet": np.array([4, 2]),
        },
    )
    path = tmp_path / "house.msh"
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return path


def test_gmsh_file_with_wedges_and_cells_in_two_groups(wedge_file):
    grouped = read_grouped_mesh(wedge_file, scale=2.0)
    assert len(grouped.bricks) == 2
    imported = import_mesh(grouped, [], {})
    mesh = imported.mesh
    assert volumes(mesh) == pytest.approx([8.0, 4.0])
    assert {*mesh.brick_sets, *imported.element_sets} == {"LOWER_PART", "ROOF", "G2ND_GROUP"}
    assert len(mesh.surfaces["WET"]) == 2
    faces = [set(mesh.face_nodes(*pair)) for pair in mesh.surfaces["WET"]]
    assert sorted(map(len, faces)) == [3, 4]
    assert "1 nodes belong to no solid; left out" in imported.notes


def cube_file(path, names):
    """A cube, its top and one corner in groups of these names, all with the number 1."""
    x, bricks, node = grid((1, 1, 1))
    top = [[node(0, 0, 1), node(1, 0, 1), node(1, 1, 1), node(0, 1, 1)]]
    cells = [("hexahedron", bricks), ("quad", top), ("vertex", [[0]])]
    mesh = meshio.Mesh(
        x,
        cells,
        cell_data={"gmsh:physical": [[1]] * 3, "gmsh:geometrical": [[1]] * 3},
        field_data={name: np.array([1, dim]) for dim, name in names.items()},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return path


def test_a_number_is_that_of_one_dimension(tmp_path):
    """Volume, face and point have the number 1, as Gmsh counts them."""
    path = cube_file(tmp_path / "cube.msh", {3: "dam", 2: "up", 0: "Krone"})
    imported = import_mesh(read_grouped_mesh(path), [], {})
    assert set(imported.mesh.brick_sets) == {"DAM"}
    assert set(imported.mesh.surfaces) == {"UP"}
    assert list(imported.mesh.node_sets["KRONE"]) == [0]


def test_groups_whose_names_become_one(tmp_path, capsys):
    path = cube_file(tmp_path / "cube.msh", {3: "S\u00f6hle", 2: "S\u00e4hle", 0: "p"})
    assert main([str(path)]) == 2
    assert "would both be S_HLE" in capsys.readouterr().err
    path = cube_file(tmp_path / "cube.msh", {3: "Gr\u00fcndung", 2: "up", 0: "p"})
    assert main([str(path)]) == 0
    assert "note: group 'Gr\u00fcndung' is GR_NDUNG in the deck" in capsys.readouterr().out


def two_cubes(path, names):
    """Two volumes, 1 and 2, and a face, 1, of Gmsh; names of groups by dimension and number."""
    lines = [f'{dim} {number} "{name}"' for (dim, number), name in names.items()]
    x, bricks, node = grid((2, 1, 1))
    rows = [f"{k + 1} {' '.join(f'{v:g}' for v in point)}" for k, point in enumerate(x)]
    face = face_x(node, 2, 0, 0)
    cells = [(5, 1, bricks[0]), (5, 2, bricks[1]), (3, 1, face)]
    elements = [
        f"{k} {kind} 2 {number} {number} {' '.join(str(n + 1) for n in own)}"
        for k, (kind, number, own) in enumerate(cells, 1)
    ]
    parts = [["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]]
    for word, own in (("PhysicalNames", lines), ("Nodes", rows), ("Elements", elements)):
        parts.append([f"${word}", str(len(own)), *own, f"$End{word}"])
    path.write_text("\n".join(line for part in parts for line in part) + "\n")
    return path


def test_a_volume_and_a_surface_of_gmsh_have_one_name(tmp_path):
    """And one number; meshio keeps the last of them by name."""
    names = {(3, 1): "DAM", (3, 2): "ROCK", (2, 1): "DAM"}
    imported = import_mesh(read_grouped_mesh(two_cubes(tmp_path / "m.msh", names)), [], {})
    assert {name: len(own) for name, own in imported.mesh.brick_sets.items()} == {
        "DAM": 1,
        "ROCK": 1,
    }
    assert set(imported.mesh.surfaces) == {"DAM"}
    assert imported.notes == []


@pytest.mark.parametrize(
    ("second", "note"),
    [
        ("DAM", "groups 1, 2 of dimension 3 have one name, 'DAM', and are one group in the deck"),
        ("dam", "groups 'DAM' and 'dam' are one group, DAM: a deck does not tell small letters"),
    ],
)
def test_two_volumes_that_become_one_group_are_noted(tmp_path, capsys, second, note):
    path = two_cubes(tmp_path / "m.msh", {(3, 1): "DAM", (3, 2): second, (2, 1): "dam"})
    assert main([str(path)]) == 0
    said = capsys.readouterr().out
    assert f"note: {note}" in said
    assert "element sets: DAM (2)" in said
    assert said.count("note:") == 1


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_coordinates_are_finite(tmp_path, capsys, value):
    path = two_cubes(tmp_path / "m.msh", {(3, 1): "DAM"})
    path.write_text(path.read_text().replace("\n3 0 1 0\n", f"\n3 0 {value} 0\n"))
    assert main([str(path)]) == 2
    said = capsys.readouterr().err
    assert f"m.msh: node 3 in the order of the file has the coordinates 0, {value}, 0;" in said
    assert not list(tmp_path.glob("*.inp"))


def test_a_file_that_is_cut_is_said_to_be_so(tmp_path, capsys):
    whole = two_cubes(tmp_path / "m.msh", {(3, 1): "DAM"}).read_text()
    reasons = set()
    for share in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9):
        (tmp_path / "m.msh").write_text(whole[: int(share * len(whole))])
        assert main([str(tmp_path / "m.msh")]) == 2
        reasons.add(capsys.readouterr().err.split("meshio reads: ")[-1].strip())
    assert "the file is empty" in reasons
    assert "it is cut, or its contents are not those of .msh" in reasons
    for words in ("index out of range", "concatenate", "unpack", "NoneType"):
        assert not [reason for reason in reasons if words in reason]


def test_a_deck_with_parts_is_refused(tmp_path, capsys):
    """meshio would read one part alone, without its place in the assembly."""
    text = "*HEADING\n*Part, name=A\n*NODE\n1, 0., 0., 0.\n*End Part\n"
    (tmp_path / "parts.inp").write_text(text)
    assert main([str(tmp_path / "parts.inp"), "-o", str(tmp_path / "mesh.inp")]) == 2
    assert "a deck with parts and instances" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "a.inp",
            "*NODE\n1, 0., 0., 0.\n*element, elset=J, type=JOINT8\n1, 1, 1, 1, 1, 1, 1, 1, 1\n",
            "a deck with elements of Keyway (JOINT8); expected the mesh of another program",
        ),
        ("a.inp", "", "no nodes; expected a mesh of solids"),
        ("a.msh", "this is no mesh\n", "meshio reads: its contents are not those of .msh"),
        ("a.vtu", "", "not a mesh that meshio reads: the file is empty"),
    ],
)
def test_the_reason_is_given(tmp_path, capfd, name, text, message):
    """In one line, without what meshio prints beside it."""
    (tmp_path / name).write_text(text)
    assert main([str(tmp_path / name)]) == 2
    said = capfd.readouterr().err
    assert message in said
    assert len(said.splitlines()) == 1
    assert "(1)" not in said


def test_factors_are_finite(tmp_path, capsys):
    with pytest.raises(SystemExit):
        main([str(tmp_path / "a.msh"), "--scale", "inf"])
    assert "inf: expected a number above 0" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "expected"),
    [("joint 1", "JOINT_1"), ("2nd", "G2ND"), ("Fuß", "FU"), ("--", "GROUP"), ("a.b", "A_B")],
)
def test_names_become_words_of_a_deck(name, expected):
    assert deck_name(name) in {expected, "FUSS"}


def test_what_cannot_be_read(tmp_path, capsys):
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    tets, quads, text = (tmp_path / n for n in ("tets.vtk", "quads.vtk", "text.msh"))
    meshio.write(tets, meshio.Mesh(x, [("tetra", [[0, 1, 2, 3]])]))
    meshio.write(quads, meshio.Mesh(x, [("quad", [[0, 1, 2, 3]])]))
    text.write_text("this is no mesh\n")
    for path, message in (
        (tets, "1 cells of the kind tetra; expected hexahedra and wedges"),
        (quads, "no hexahedra and no wedges"),
        (text, "not a mesh that meshio reads"),
        (tmp_path / "none.msh", "no such file"),
        (tmp_path, "a folder; expected a mesh file"),
    ):
        assert main([str(path)]) == 2
        assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--split", "nowhere"], "no group of faces 'NOWHERE'; the mesh has ROOF_FACE"),
        (["--split", "roof face"], "1 solids have the face at [0.5, 0.5, 1.0]; expected a face"),
        (["--joint", "J=A"], "expected NAME=MASTER,SLAVE"),
        (["--joint", "J=roof face,floor"], "joint J: no group of faces 'FLOOR'"),
        (["--joint", "J=roof face,roof face"], "they share nodes"),
        (["-o", "MESH"], "would overwrite the mesh"),
    ],
)
def test_what_a_user_gets_wrong(tmp_path, capsys, arguments, message):
    x, bricks, node = grid((1, 1, 1))
    top = [[node(0, 0, 1), node(1, 0, 1), node(1, 1, 1), node(0, 1, 1)]]
    mesh = meshio.Mesh(
        x,
        [("hexahedron", bricks), ("quad", top)],
        cell_data={"gmsh:physical": [[1], [2]], "gmsh:geometrical": [[1], [1]]},
        field_data={"cube": np.array([1, 3]), "roof face": np.array([2, 2])},
    )
    path = tmp_path / "cube.msh"
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    assert main([str(path), *(str(path) if w == "MESH" else w for w in arguments)]) == 2
    assert message in capsys.readouterr().err


def test_example_has_the_mesh_that_the_tool_makes(tmp_path):
    """input/gmsh_arch: docs/gmsh.md shows this command."""
    output = tmp_path / "gmsh_arch_mesh.inp"
    file = str(EXAMPLE / "gmsh_arch.msh")
    assert main([file, "--split", "JOINT1", "JOINT2", "-o", str(output)]) == 0
    assert output.read_text() == (EXAMPLE / "gmsh_arch_mesh.inp").read_text()


def test_a_table_is_no_mesh(tmp_path, capsys):
    (tmp_path / "table.inp").write_text("node,0,1,2,3,4\n1,2,3,4,5,6\n2,3,4,5,6,7\n")
    assert main([str(tmp_path / "table.inp")]) == 2
    assert "table.inp: no nodes; expected a mesh of solids" in capsys.readouterr().err
