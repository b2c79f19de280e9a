"""Results of a joint between different meshes: two columns, 3:2 and 6:4 facets.

The columns stand side by side, x from -4 to 4 m with the joint at x = 0, y = 0 upstream and y = 6 m
downstream, 12 m high. First the right one, the slave, is pressed against the left one, then it is
pulled off and rotated as a rigid body, so that every value is known; at last its weight acts.
"""

from __future__ import annotations

import csv

import h5py
import meshio
import numpy as np
import pytest
import pyvista
from harness import Program, Run
from keyway.commands import plot
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck
from keyway_tools.mesh_data import BrickMesh
from keyway_tools.results import Results

LENGTHS = np.array([4.0, 6.0, 12.0])  # of each column [m]
YOUNG, KN = 20e9, 1e12  # nu = 0
PRESS = 1e-3  # the far end of the slave moves towards the joint [m]
PRESSURE = PRESS / (2 * LENGTHS[0] / YOUNG + 1 / KN)
AWAY, TURN = 1e-3, np.array([2e-3, 1e-4])  # opening at the foot [m]; it grows with z and y
SOLVED = 1e-8  # of the displacements: *CONTROLS, RESIDUAL=1e-9 and a margin for the condition
JOB = "columns"


def column(counts: tuple[int, int, int], start: float) -> tuple[BrickMesh, np.ndarray]:
    """A column from x = start on."""

    def place(*shares):
        return np.stack(shares, axis=-1) * LENGTHS + (start, 0.0, 0.0)

    return box_mesh(counts, place)


def two_columns() -> BrickMesh:
    """Both columns with their sets and surfaces."""
    (left, low), (right, high) = column((2, 2, 4), -LENGTHS[0]), column((2, 3, 6), 0.0)
    high = high + len(left.x)
    bricks = np.concatenate((left.bricks, right.bricks + len(left.x)))
    mesh = BrickMesh(np.concatenate((left.x, right.x)), bricks, np.zeros((0, 8), dtype=int))
    split = len(left.bricks)
    mesh.brick_sets = {"LEFT": np.arange(split), "RIGHT": np.arange(split, len(bricks))}
    mesh.node_sets = {
        "LEFT_END": low[0].ravel(),
        "RIGHT_END": high[-1].ravel(),
        "WATCHED": np.array([low[-1, -1, -1], low[-1, 1, 2]]),  # master nodes
    }
    owner = {frozenset(n): pair[0] for n, pair in mesh.exterior_faces().items()}
    for name, nodes in {
        "MASTER": low[-1], "SLAVE": high[0], "WATER": np.append(low[:, 0], high[:, 0])
    }.items():  # fmt: skip
        inside = set(nodes.ravel().tolist())
        mesh.surfaces[name] = [pair for face, pair in owner.items() if face <= inside]
    return mesh


def rigid(x: np.ndarray) -> np.ndarray:
    """Displacements of the slave in a rotation: the opening along x grows with z and y."""
    u = np.zeros_like(x)
    u[:, 0] = AWAY + x[:, 1:] @ TURN[::-1]
    u[:, 1], u[:, 2] = -TURN[1] * x[:, 0], -TURN[0] * x[:, 0]
    return u


CARDS = f"""
*MATERIAL, NAME=CONCRETE
*DENSITY
2400
*ELASTIC
{YOUNG}, 0
*SOLID SECTION, ELSET=LEFT, MATERIAL=CONCRETE
*SOLID SECTION, ELSET=RIGHT, MATERIAL=CONCRETE
*JOINT LAW, NAME=CONTACT, KN={KN}, KT={KN}
*JOINT, NAME=SEAM, LAW=CONTACT, INTEGRATION=%s
SLAVE, MASTER
*BOUNDARY
LEFT_END, 1, 3
*STEP, NAME=PRESS
*STATIC
1, 1
*BOUNDARY
RIGHT_END, 1, 1, {-PRESS}
RIGHT_END, 2, 3
*RESERVOIR, NAME=LAKE, SURFACE=WATER, LEVEL=10, BED=0, HYDROSTATIC=NO, ADDED MASS=WESTERGAARD
*JOINT PRINT, JOINT=SEAM, NSET=WATCHED
*NODE FILE
U, OPENING
*CONTROLS, RESIDUAL=1e-9, INCREMENT=1e-9
*END STEP
*STEP, NAME=TURN
*STATIC, DIRECT
1, 1
*ENVELOPE
OPENING, U
*BOUNDARY
%s
*END STEP
*STEP, NAME=WEIGHT
*STATIC, DIRECT
1, 1
*DLOAD
RIGHT, GRAV, 9.81, 0, 0, -1
*EL FILE
S
*END STEP
"""


def deck(integration: str) -> str:
    """The whole deck."""
    mesh = two_columns()
    end = mesh.node_sets["RIGHT_END"]
    moves = [
        f"{node + 1}, {dof}, {dof}, {value!r}"
        for node, row in zip(end, rigid(mesh.x[end]).tolist(), strict=True)
        for dof, value in enumerate(row, start=1)
    ]
    types = {"LEFT": "C3D8", "RIGHT": "C3D8"}
    return mesh_deck(mesh, types, "") + CARDS % (integration, "\n".join(moves))


@pytest.fixture(scope="module", params=["NODES", "GAUSS"])
def run(request, program_path, tmp_path_factory) -> Run:
    """Both integrations."""
    folder = tmp_path_factory.mktemp(request.param.lower())
    return Program(program_path, folder, 2)(deck(request.param), name=JOB)


def frame(run: Run, number: int) -> pyvista.UnstructuredGrid:
    return pyvista.read(run.folder / f"{JOB}_vtk" / f"{JOB}_joints_{number:04d}.vtu")


def is_nodal(run: Run) -> bool:
    return run.json["joints"]["SEAM"]["integration"] == "nodes"


def test_series_holds_every_frame_and_few_points(run: Run):
    reader = pyvista.PVDReader(run.folder / f"{JOB}_joints.pvd")
    assert reader.time_values == pytest.approx([1.0, 2.0, 3.0])
    surface = frame(run, 2)
    # Lines at y = 0, 2, 3, 4, 6 and at z = 0, 2, 3, 4, 6, 8, 9, 10, 12.
    assert (surface.n_cells, surface.n_points) == (4 * 8, 5 * 9)
    assert surface.compute_cell_sizes()["Area"].sum() == pytest.approx(72.0)
    assert np.abs(surface.points[:, 0]).max() < 1e-12
    for cell in surface.cell:  # by the right-hand rule about the joint's normal, x
        corner = cell.points
        assert np.cross(corner[2] - corner[0], corner[3] - corner[1])[0] > 0.0


def test_polygons_have_the_numbers_of_joint_and_solid(run: Run):
    surface = frame(run, 2)
    assert set(surface["JOINT"]) == {1}
    mesh = two_columns()
    middles = surface.cell_centers().points
    for middle, element in zip(middles, surface["ELEMENT_ID"], strict=True):
        x = mesh.x[mesh.bricks[element - 1]]
        assert (middle >= x.min(axis=0) - 1e-9).all()
        assert (middle <= x.max(axis=0) + 1e-9).all()
        assert x[:, 0].max() > 0.0  # the slave's
    on_node = surface["NODE_ID"] > 0
    assert surface.points[on_node] == pytest.approx(mesh.x[surface["NODE_ID"][on_node] - 1])
    assert on_node.sum() == 4 * 7  # the slave's nodes


def test_pressed_faces_carry_a_constant_traction(run: Run):
    surface = frame(run, 1)
    traction = np.tile([-PRESSURE, 0.0, 0.0], (surface.n_points, 1))
    assert surface["TRACTION"] == pytest.approx(traction, rel=SOLVED, abs=SOLVED * PRESSURE)
    assert surface["OPENING"] == pytest.approx(-PRESSURE / KN, rel=1e-6)
    assert set(surface["STATE"]) <= {1, 2}


def test_opening_is_linear_on_the_segments(run: Run):
    surface = frame(run, 2)
    expected = rigid(surface.points)
    assert surface["U"] == pytest.approx(expected, abs=SOLVED * np.abs(expected).max())
    if is_nodal(run):  # means of Gauss points are not at the nodes
        assert surface["OPENING"] == pytest.approx(expected[:, 0], abs=SOLVED * expected.max())
    assert surface["OPENING"].min() >= AWAY - SOLVED
    assert surface["OPENING"].max() <= expected[:, 0].max() * (1 + SOLVED)
    assert set(surface["STATE"]) == {0}
    assert np.abs(surface["TRACTION"]).max() == 0.0
    # The slave has not slid along the joint: it was turned about axes in it.
    assert surface["REACH_USED"].max() < SOLVED


def test_every_vtu_is_read_alike_by_meshio(run: Run):
    for file in sorted((run.folder / f"{JOB}_vtk").glob("*.vtu")):
        grid, other = pyvista.read(file), meshio.read(file)
        assert set(grid.point_data) == set(other.point_data)
        for name in grid.point_data:
            assert np.array_equal(grid[name], other.point_data[name]), (file, name)
        assert grid.n_cells == sum(len(block.data) for block in other.cells)


def test_extremes_of_the_faces(run: Run):
    joint = run.json["joints"]["SEAM"]
    assert joint["kind"] == "surfaces"
    assert joint["area"] == pytest.approx(72.0)
    assert joint["pressure"]["anywhere"]["value"] == pytest.approx(PRESSURE)
    if not is_nodal(run):
        for face in ("upstream", "downstream"):
            x = joint["opening"][face]["x"]
            assert x[1] < 2 / 2 or x[1] > 6 - 2 / 2  # in the half of a slave facet beside the face
        return
    assert joint["points"] == 4 * 7
    at = {"upstream": (0.0, 0.0, 12.0), "downstream": (0.0, 6.0, 12.0)}
    for extremes in (joint["opening"], run.json["envelopes"]["OPENING"]):
        for face, x in at.items():
            assert extremes[face]["x"] == pytest.approx(x, abs=1e-12)
            assert extremes[face]["value"] == pytest.approx(rigid(np.array([x]))[0, 0], rel=1e-7)
        assert extremes["anywhere"] == extremes["downstream"]


def test_points_near_nodes_of_the_master_face(run: Run):
    with (run.folder / f"{JOB}_joint_SEAM.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["step"] == "2"]
    assert len(rows) == 2
    place = np.array([[float(row[name]) for name in "xyz"] for row in rows])
    place = place[np.argsort(place[:, 2])]
    near = [(0.0, 3.0, 6.0), (0.0, 6.0, 12.0)]
    facet = np.array([0.0, 2.0, 2.0])
    assert (np.abs(place - near) <= 0.5 * facet + 1e-9).all()
    for row in rows:
        expected = AWAY + TURN @ (float(row["z"]), float(row["y"]))
        assert float(row["opening"]) == pytest.approx(expected, abs=SOLVED)


def test_openings_on_both_sides_of_the_solids(run: Run):
    grid = pyvista.read(run.folder / f"{JOB}_vtk" / f"{JOB}_0002.vtu")
    opening, x = grid["OPENING"], grid.points
    on_joint = np.abs(x[:, 0]) < 1e-9
    assert np.abs(opening[~on_joint]).max() == 0.0
    expected = rigid(x)[:, 0]
    assert opening[on_joint].min() >= AWAY - SOLVED
    assert opening[on_joint].max() <= expected.max() * (1 + SOLVED)
    # A node of the master takes means over at most the two facets around it, of 2 m.
    assert np.abs(opening - expected)[on_joint].max() < 2.0 * TURN.sum()
    if is_nodal(run):
        slave = two_columns().surface_nodes("SLAVE")
        assert opening[slave] == pytest.approx(expected[slave], abs=SOLVED * expected.max())


def test_stresses_stay_in_their_own_body(run: Run):
    grid = pyvista.read(run.folder / f"{JOB}_vtk" / f"{JOB}_0003.vtu")
    stress = np.abs(grid["S"]).max(axis=1)
    mesh = two_columns()
    assert stress[mesh.surface_nodes("SLAVE")].max() > 1e4
    assert stress[mesh.surface_nodes("MASTER")].max() < 1e-6 * stress.max()


def test_hdf5_holds_the_polygons(run: Run):
    results = Results(run.folder, JOB)
    joint = results.joint_faces("SEAM")
    assert len(joint.rings) == 32
    assert len(joint.facets) == 3 * 6
    x = joint.on_corners(results.x)
    assert x.min(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)
    assert x.max(axis=0) == pytest.approx([0, 6, 12])
    with h5py.File(run.folder / f"{JOB}.h5") as file:
        group = file["joints/SEAM"]
        first, master = group["first"][:] - 1, group["first_master"][:] - 1
        for p in range(len(master)):
            assert group["weight"][first[p] : master[p]].sum() == pytest.approx(1.0)
            assert group["weight"][master[p] : first[p + 1]].sum() == pytest.approx(-1.0)
        assert (group["reach"][:] < 10.0).all()
        upstream = file["faces/upstream"][:] == 1
        downstream = file["faces/downstream"][:] == 1
    assert (results.x[upstream, 1] == 0.0).all()
    assert (results.x[downstream, 1] == 6.0).all()
    assert downstream.sum() == 3 * 5 + 3 * 7


def test_pictures(run: Run, capsys):
    assert plot.main([str(run.folder)]) == 0
    names = {name.split("/")[-1] for name in capsys.readouterr().out.split()}
    assert {f"{JOB}_envelope_opening.png", f"{JOB}_envelope_opening_joints.png"} <= names
