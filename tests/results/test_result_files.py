"""The files of results, written by a unit test with known fields."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
import pyvista
from keyway_tools.results import Results

JOB = "hand driven"
YOUNG = 20e9  # nu = 0
# Numbers are printed with 13 significant digits.
PRINTED = 1e-12
# Stresses are sums of 24 products of about 1e10 * 1e-2 * 1: roundoff, far below the values.
ROUNDOFF = 1e-6


@pytest.fixture(scope="module")
def folder(program_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs the driver; its deck is only read for the digest."""
    place = tmp_path_factory.mktemp("results")
    (place / f"{JOB}.inp").write_text("abc")
    driver = program_path.parent / "unit" / "test_result_files"
    subprocess.run([driver, "out/below"], cwd=place, check=True, capture_output=True)
    return place / "out" / "below"


@pytest.fixture(scope="module")
def results(folder: Path) -> Results:
    return Results(folder, JOB)


def read_grid(folder: Path, name: str) -> pyvista.UnstructuredGrid:
    return pyvista.read(folder / f"{JOB}_vtk" / f"{JOB}_{name}.vtu")


def stress(x: float) -> list[float]:
    """S11 S22 S33 S12 S13 S23 at time x."""
    return [1e-3 * x * YOUNG, 0, -2e-3 * x * YOUNG, 0.5e-3 * x * YOUNG, 0, 0]


def test_no_half_written_file_is_left(folder: Path):
    assert not list(folder.rglob("*.part"))
    assert not list(folder.rglob(".keyway*"))


def test_headers_are_those_of_the_contract(folder: Path):
    heads = {p.name: p.read_text().splitlines()[0] for p in folder.glob("*.csv")}
    assert heads == {
        f"{JOB}_node_TOP.csv": "step,increment,time,node,U1,U2,U3,RF1,RF2,RF3,V1,V2,V3",
        f"{JOB}_el_TWO_BLOCKS.csv": "step,increment,time,element,point,"
        "S11,S22,S33,S12,S13,S23,SP1,SP2,SP3",
        f"{JOB}_joint_MIDDLE.csv": "step,increment,time,point,x,y,z,"
        "opening,slip1,slip2,tn,t1,t2,state",
        f"{JOB}_energy.csv": "step,increment,time,external,kinetic,strain,damping,friction,"
        "fracture,crushing,numerical,error",
    }


def test_node_rows_follow_frequency_and_last_increment(results: Results):
    table = results.table("node_TOP")
    keys = list(zip(table["step"], table["increment"], table["node"], strict=True))
    assert keys == [
        *((1, i, n) for i in (1, 2) for n in (130, 140)),
        *((2, i, n) for i in (2, 3) for n in (140, 200)),
    ]
    assert table["time"] == pytest.approx([0.5, 0.5, 1, 1, 1.2, 1.2, 1.3, 1.3], rel=PRINTED)
    assert table["U1"][-1] == pytest.approx(1e-3 * 1.3 * 5, rel=PRINTED)
    assert table["V1"][:4] == pytest.approx(0)
    assert table["V1"][-1] == pytest.approx(5e-3, rel=PRINTED)


def test_element_rows_hold_stresses_at_all_points(results: Results):
    table = results.table("el_TWO_BLOCKS")
    assert list(table["element"]) == ([10] * 8 + [20]) * 2
    assert list(table["point"]) == [*range(1, 9), 1] * 2
    found = np.column_stack([table[f"S{c}"] for c in ("11", "22", "33", "12", "13", "23")])
    assert found[:9] == pytest.approx(np.tile(stress(0.5), (9, 1)), abs=ROUNDOFF)
    middle, radius = 5e6, np.hypot(5e6, 5e6)
    assert table["SP1"][0] == pytest.approx(middle + radius)
    assert table["SP2"][0] == pytest.approx(middle - radius)
    assert table["SP3"][0] == pytest.approx(-2e7)


def test_joint_rows_near_a_node_and_then_all(results: Results):
    table = results.table("joint_MIDDLE")
    assert list(table["point"]) == [4, 4] + [1, 2, 3, 4] * 3
    # Jump and gap: 1e-3 (t z - 1) + 1e-4 at z = 3.
    assert table["opening"][:2] == pytest.approx([0.6e-3, 2.1e-3], rel=PRINTED)
    assert table["slip2"][3] == pytest.approx(-1.1e-3, rel=PRINTED)
    assert table["tn"][3] == pytest.approx(-1e6, rel=PRINTED)


def test_series_lists_every_frame(folder: Path):
    reader = pyvista.PVDReader(folder / f"{JOB}.pvd")
    assert reader.time_values == pytest.approx([0.5, 1.0, 1.2, 1.3], rel=PRINTED)
    reader = pyvista.PVDReader(folder / f"{JOB}_joints.pvd")
    assert reader.time_values == pytest.approx([1.2, 1.3], rel=PRINTED)


def test_frame_holds_solids_and_fields(folder: Path):
    grid = read_grid(folder, "0002")
    assert list(grid.celltypes) == [12, 12, 13, 12]
    assert grid.compute_cell_sizes()["Volume"] == pytest.approx([6, 6, 2, 2])
    assert list(grid["ELEMENT_ID"]) == [10, 20, 40, 50]
    assert list(grid["MATERIAL"]) == [1, 1, 1, 2]
    assert list(grid["NODE_ID"]) == list(range(10, 230, 10))
    assert set(grid.point_data) == {"NODE_ID", "U", "S", "SP"}
    s11, s22, s33, s12, s13, s23 = stress(1.0)
    vtk_order = [s11, s22, s33, s12, s23, s13]
    assert grid["S"] == pytest.approx(np.tile(vtk_order, (22, 1)), abs=ROUNDOFF)
    assert grid["U"][:, 0] == pytest.approx(1e-3 * grid.points[:, :2].sum(axis=1))


def test_opening_is_written_on_both_sides_of_a_joint(folder: Path):
    grid = read_grid(folder, "0004")
    expected = np.zeros(22)
    expected[[6, 7, 8, 9]] = -0.9e-3
    expected[[14, 15, 16, 17]] = 3.0e-3
    assert grid["OPENING"] == pytest.approx(expected, rel=PRINTED)
    surface = read_grid(folder, "joints_0004")
    assert surface["OPENING"] == pytest.approx(np.where(surface.points[:, 2] > 0, 3e-3, -0.9e-3))
    assert list(surface["ELEMENT_ID"]) == [30]
    assert set(surface.point_data) == {
        "NODE_ID", "U", "OPENING", "SLIP", "TRACTION", "STATE", "REACH_USED"
    }  # fmt: skip
    # The slave nodes, which are numbered 90, 100, 170, 180 in the deck.
    assert surface["U"] == pytest.approx(grid["U"][surface["NODE_ID"] // 10 - 1])
    assert sorted(surface["NODE_ID"]) == [90, 100, 170, 180]
    assert surface["TRACTION"][:, 0] == pytest.approx(-1e6 * surface.points[:, 0])
    # The right-hand rule about the joint's normal, y.
    corner = surface.get_cell(0).points
    normal = np.cross(corner[2] - corner[0], corner[3] - corner[1])
    assert normal / np.linalg.norm(normal) == pytest.approx([0, 1, 0])


def test_envelopes_keep_value_and_time(folder: Path):
    grid = read_grid(folder, "envelope_step2")
    assert grid["S3_MIN"] == pytest.approx(-2e-3 * 1.3 * YOUNG)
    assert grid["S3_MIN_TIME"] == pytest.approx(1.3)
    assert grid["OPENING_MAX"].max() == pytest.approx(3e-3)
    assert grid["OPENING_MAX"].min() == 0
    # The base does not move: its largest value is the first.
    assert grid["U_MAX_TIME"][4] == pytest.approx(1.0)


def test_every_vtu_is_read_alike_by_meshio(folder: Path):
    files = sorted((folder / f"{JOB}_vtk").glob("*.vtu"))
    assert len(files) == 9
    for file in files:
        grid, other = pyvista.read(file), meshio.read(file)
        assert set(grid.point_data) == set(other.point_data)
        for name in grid.point_data:
            assert np.array_equal(grid[name], other.point_data[name]), (file, name)


def test_hdf5_layout(folder: Path):
    with h5py.File(folder / f"{JOB}.h5") as file:
        assert list(file["sets/nodes/TOP"]) == [130, 140, 190, 200]
        assert file["sets/surfaces/WATER"][:].tolist() == [[10, 6], [20, 6]]
        assert file["mesh/connectivity"][1].tolist() == [8, 9, 11, 10, 16, 17, 19, 18]
        assert file["mesh/element_type"][2] == b"JOINT8"
        assert file["joints/MIDDLE/rotation"][0].tolist() == [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
        cells = file["joints/MIDDLE/cells"]
        assert cells["first"][:].tolist() == [1, 5]
        assert sorted(cells["node"][cells["corner"][:] - 1]) == [90, 100, 170, 180]
        assert cells["element"][:].tolist() == [30]
        assert cells["weight"][:].tolist() == [1, 1, 1, 1]
        assert file["steps/0001"].attrs["procedure"] == b"STATIC"
        group = file["steps/0002/increments/000003"]
        assert group.attrs["time"] == pytest.approx(1.3)
        assert set(group) == {"U", "V", "RF", "E", "OPENING", "joints"}
        assert group["E"][0] == pytest.approx([1.3e-3, 0, -2.6e-3, 1.3e-3, 0, 0], abs=1e-15)
        assert group["joints/MIDDLE/opening"].shape == (4,)
        assert file["history/increments"].shape == (5, 6)
        assert file["history/joints/MIDDLE"][:, 3] == pytest.approx(
            1e-3 * (3 * np.array([0.5, 1.0, 1.1, 1.2, 1.3]) - 0.9)
        )
        assert file["steps/0003/modes/shape"].shape == (2, 22, 3)
        assert file["steps/0002/envelopes/S3_MIN"].shape == (22,)


def test_summary(results: Results):
    summary = results.summary
    assert summary["status"] == "finished"
    assert summary["deck"] == {
        "file": f"{JOB}.inp",
        "sha256": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
    }
    assert summary["model"] == {
        "nodes": 22,
        "elements": 5,
        "unknowns": 66,
        "joints": 1,
        "materials": 2,
    }
    assert summary["ignored_input"] == [
        {"file": f"{JOB}.inp", "line": 7, "keyword": "PREPRINT", "why": "no effect here"}
    ]
    assert [step["procedure"] for step in summary["steps"]] == ["static", "dynamic", "frequency"]
    assert results.find("steps.1.energy.error") == pytest.approx(3e-4)
    assert results.find("steps.2.frequencies.1.hz") == 5.0
    assert (
        "static steps have no field V: job.h5 and the VTK series are without it there"
        in summary["warnings"]
    )
    assert {part["name"] for part in summary["ledger"]["parts"]} >= {"write CSV", "write VTK"}


def test_extremes_have_place_and_time(results: Results):
    joint = results.find("joints.MIDDLE")
    make = {name: joint[name] for name in ("kind", "integration", "points", "area")}
    assert make == {"kind": "elements", "integration": "nodes", "points": 4, "area": 3.0}
    assert joint["opening"]["anywhere"]["value"] == pytest.approx(3e-3)
    assert joint["opening"]["anywhere"]["time"] == pytest.approx(1.3)
    assert joint["opening"]["upstream"]["x"] == [0, 2, 3]
    assert joint["opening"]["downstream"]["x"] == [1, 2, 3]
    assert joint["pressure"]["downstream"] == {"value": 1e6, "time": 0.5, "x": [1, 2, 0]}
    envelopes = results.find("envelopes")
    assert set(envelopes) == {"S1", "S3", "U", "OPENING"}
    assert envelopes["S3"]["anywhere"]["value"] == pytest.approx(-2e-3 * 1.3 * YOUNG)
    assert set(envelopes["U"]) == {"anywhere", "upstream", "downstream"}


def test_listed_files_exist(folder: Path):
    listed = json.loads((folder / f"{JOB}.json").read_text())["files"]
    assert f"{JOB}_vtk/{JOB}_envelope_step2.vtu" in listed
    assert all((folder / name).is_file() for name in listed)
