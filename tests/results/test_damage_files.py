"""Damage in all files of the results, from histories set by a unit test."""

from __future__ import annotations

import subprocess
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
import pyvista
from keyway_tools.results import Results

JOB = "cracked dam"
# Numbers are printed with 13 significant digits.
PRINTED = 1e-12
TENSION = [0.1 * q for q in range(1, 9)]  # of the points of element 10
CENTRE = [0.5, 3.0, 1.5]  # of element 20, where its one point is


@pytest.fixture(scope="module")
def folder(program_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs the driver; its deck is only read for the digest."""
    place = tmp_path_factory.mktemp("damage")
    (place / f"{JOB}.inp").write_text("abc")
    driver = program_path.parent / "unit" / "test_damage_files"
    subprocess.run([driver, "out"], cwd=place, check=True, capture_output=True)
    return place / "out"


@pytest.fixture(scope="module")
def results(folder: Path) -> Results:
    return Results(folder, JOB)


def read_grid(folder: Path, name: str) -> pyvista.UnstructuredGrid:
    return pyvista.read(folder / f"{JOB}_vtk" / f"{JOB}_{name}.vtu")


def test_columns_of_points(folder: Path, results: Results):
    head = (folder / f"{JOB}_el_BODY.csv").read_text().splitlines()[0].split(",")
    assert head[11:] == [
        *(f"PE{c}" for c in ("11", "22", "33", "12", "13", "23")),
        "DAMAGET",
        *(f"SDV{i}" for i in range(1, 9)),
    ]
    table = results.table("el_BODY")
    last = table["increment"] == 3
    assert list(table["element"][last]) == [10] * 8 + [20] + [40] * 8 + [50] * 8
    assert table["DAMAGET"][last] == pytest.approx([*TENSION, 0.95] + [0] * 16, rel=PRINTED)
    assert table["SDV1"][last] == pytest.approx(table["DAMAGET"][last], rel=PRINTED)
    assert table["PE22"][last] == pytest.approx([1e-3] * 8 + [0] * 17, rel=PRINTED)
    # Cracked elements carry nothing; the others (1 - nu)/((1 + nu)(1 - 2 nu)) E e33, nu = 0.2.
    carried = 0.8 / (1.2 * 0.6) * 20e9 * 1.5e-4
    assert table["S33"][last] == pytest.approx([0] * 9 + [carried] * 16, rel=1e-9)


def test_nodes_take_the_nearest_points(folder: Path):
    grid = read_grid(folder, "0003")
    damage = grid.point_data["DAMAGET"]
    # Nodes of element 10 alone, of 10 and 20, of 10 and the wedge, of all three; of the rock alone.
    assert damage[[6, 7]] == pytest.approx([0.1, 0.2])
    assert damage[[8, 9]] == pytest.approx([(0.3 + 0.95) / 2, (0.4 + 0.95) / 2])
    assert damage[[12, 13]] == pytest.approx([0.5 / 2, 0.6 / 2])
    assert damage[15] == pytest.approx((0.8 + 0.95) / 3)
    assert damage[:6] == pytest.approx([0] * 6)
    assert grid.point_data["DAMAGEC"][11] == pytest.approx(0.25)
    assert grid.point_data["SDV"].shape == (20, 8)
    assert grid.point_data["SDV"][:, 0] == pytest.approx(damage)
    assert grid.point_data["PE"][6] == pytest.approx([0, 1e-3, 0, 0, 0, 0])
    # Element 10 carries nothing; extrapolated from its points the node would get more or less.
    assert grid.point_data["S"][6] == pytest.approx([0] * 6, abs=0)


def test_cells_hold_the_mean_damage(folder: Path):
    grid = read_grid(folder, "0003")
    assert list(grid.cell_data["ELEMENT_ID"]) == [10, 20, 40, 50]
    assert grid.cell_data["DAMAGET_MEAN"] == pytest.approx([0.45, 0.95, 0, 0])
    assert grid.cell_data["DAMAGEC_MEAN"] == pytest.approx([0, 0.25, 0, 0])
    assert read_grid(folder, "0001").cell_data["DAMAGET_MEAN"] == pytest.approx([0, 0, 0, 0])


def test_every_vtu_is_read_alike_by_meshio(folder: Path):
    files = sorted((folder / f"{JOB}_vtk").glob("*.vtu"))
    assert len(files) == 4
    for file in files:
        grid, other = pyvista.read(file), meshio.read(file)
        for name in grid.point_data:
            assert np.array_equal(grid.point_data[name], other.point_data[name]), (file, name)
        for name in grid.cell_data:
            joined = np.concatenate(other.cell_data[name])
            assert sorted(joined) == sorted(grid.cell_data[name]), (file, name)


def test_envelope_keeps_damage_and_time(folder: Path):
    grid = read_grid(folder, "envelope_step1")
    last = read_grid(folder, "0003")
    assert grid["DAMAGET_MAX"] == pytest.approx(last.point_data["DAMAGET"])
    assert grid.cell_data["DAMAGET_MEAN_MAX"] == pytest.approx([0.45, 0.95, 0, 0])
    with h5py.File(folder / f"{JOB}.h5") as file:
        kept = file["steps/0001/envelopes"]
        assert kept["DAMAGET_MEAN_MAX"][:] == pytest.approx([0.45, 0.95, 0, 0])
    assert list(grid["DAMAGET_MAX_TIME"][[6, 8, 0]]) == [1.0, 1.5, 0.5]


def test_points_in_hdf5(folder: Path):
    with h5py.File(folder / f"{JOB}.h5") as file:
        points = file["points"]
        assert points["x"].shape == (17, 3)
        assert list(points["element"]) == [10] * 8 + [20] + [40] * 8
        assert list(points["number"]) == [*range(1, 9), 1, *range(1, 9)]
        assert list(points["material"]) == [0] * 17
        assert points["volume"][:9] == pytest.approx([0.75] * 8 + [6])
        steps = file["steps/0001/increments"]
        now = [steps[f"00000{i}/points"] for i in (1, 2, 3)]
        assert [part["row"].shape for part in now] == [(0,), (8,), (9,)]
        assert [part["S"].shape for part in now] == [(0, 6), (8, 6), (9, 6)]
        assert set(now[2]) == {"row", "S", "E", "PE", "DAMAGET", "DAMAGEC", "SDV"}
        assert list(points["element"][:][now[2]["row"][:]]) == [10] * 8 + [20]
        assert now[2]["DAMAGET"][:] == pytest.approx([*TENSION, 0.95])
        assert now[2]["E"][:] == pytest.approx(np.tile([0, 0, 1.5e-4, 0, 0, 0], (9, 1)), abs=1e-18)
        assert now[2]["SDV"].attrs["components"].decode().startswith("SDV1,SDV2,")


def test_damage_in_the_summary(results: Results):
    damage = results.summary["damage"]
    assert damage["DAMAGET"] == {
        "value": 0.95, "time": 1.5, "x": CENTRE, "element": 20, "point": 1,
    }  # fmt: skip
    assert damage["DAMAGEC"]["value"] == 0.25
    # Points of element 10 hold 0.75 m3 each, the one of element 20 6 m3.
    assert damage["damaged_volume"] == [
        {"at_least": 0.1, "volume": pytest.approx(8 * 0.75 + 6), "elements": 2},
        {"at_least": 0.5, "volume": pytest.approx(4 * 0.75 + 6), "elements": 2},
        {"at_least": 0.9, "volume": pytest.approx(6), "elements": 1},
    ]
    assert damage["inelastic"] == {"volume": pytest.approx(12), "elements": 2}
    assert damage["dissipated"] == {
        "cracking": pytest.approx(100 * 6), "crushing": pytest.approx(50 * 6),
    }  # fmt: skip


def test_damage_envelope_by_face(results: Results):
    found = results.find("envelopes.DAMAGET")
    assert set(found) == {"anywhere", "upstream", "downstream"}
    assert found["anywhere"] == {"value": 0.95, "time": 1.5, "x": CENTRE}
    assert found["downstream"]["value"] == 0.95
    assert results.find("envelopes.DAMAGEC")["anywhere"]["value"] == 0.25


def test_growth_of_damage(folder: Path, results: Results):
    table = results.table("damage")
    assert list(table["increment"]) == [1, 2, 3]
    assert table["DAMAGET"] == pytest.approx([0, 0.8, 0.95], rel=PRINTED)
    assert table["DAMAGEC"] == pytest.approx([0, 0, 0.25], rel=PRINTED)
    assert table["volume_50"] == pytest.approx([0, 4 * 0.75, 4 * 0.75 + 6])
    assert table["cracking"] == pytest.approx([0, 0, 600])
    with h5py.File(folder / f"{JOB}.h5") as file:
        names = file["history/damage"].attrs["columns"].decode().split(",")
        for column, name in enumerate(names):
            assert file["history/damage"][:, column] == pytest.approx(table[name], rel=PRINTED)


def test_material_is_an_effect(results: Results):
    assert {"name": "CONCRETE", "kind": "inelastic"} in results.summary["effects"]
