"""A bar pulled until its middle layer cracks: the damage in all files agrees."""

from __future__ import annotations

from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
import pyvista

SIDE = 0.2  # of each cube of the bar [m]
STRENGTH, FRACTURE_ENERGY = 2.0e6, 200.0  # of the middle layer [Pa], [N/m]
# Longer than 2 E G_f / f_t^2 = 3 m the bar would snap; it is 1 m long.
KINDS = ("C3D8", "C3D8B", "C3D8I", "C3D8R", "WEDGE")
# Numbers are printed with 13 significant digits, sums over elements lose two of them at most.
PRINTED = 1e-11

CONCRETE = """*MATERIAL, NAME={name}
*ELASTIC
30e9, 0.2
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
30e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
{strength}, {energy}
"""
DAMAGE = f"""*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, {2.0 * FRACTURE_ENERGY / STRENGTH}
"""


def bar_deck(kind: str) -> str:
    """Five cubes on top of each other; the middle one, of a kind, is weak (a wedge is a half)."""
    lines = ["*NODE"]
    for k in range(6):
        for corner, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
            lines.append(f"{4 * k + corner + 1}, {SIDE * x}, {SIDE * y}, {SIDE * k}")
    lines.append("*ELEMENT, TYPE=C3D8B, ELSET=SOUND")
    for k in (0, 1, 3, 4):
        lines.append(", ".join(str(n) for n in (k + 1, *range(4 * k + 1, 4 * k + 9))))
    lines.append(f"*ELEMENT, TYPE={'C3D8' if kind == 'WEDGE' else kind}, ELSET=WEAK")
    if kind == "WEDGE":
        lines += ["3, 9, 10, 11, 11, 13, 14, 15, 15", "6, 9, 11, 12, 12, 13, 15, 16, 16"]
    else:
        lines.append("3, 9, 10, 11, 12, 13, 14, 15, 16")
    sound = CONCRETE.format(name="S", strength=2 * STRENGTH, energy=4 * FRACTURE_ENERGY)
    weak = CONCRETE.format(name="W", strength=STRENGTH, energy=FRACTURE_ENERGY)
    return "\n".join(lines) + f"\n{sound}{weak}{DAMAGE}" + BAR_CARDS


BAR_CARDS = """*SOLID SECTION, ELSET=WEAK, MATERIAL=W
*SOLID SECTION, ELSET=SOUND, MATERIAL=S
*NSET, NSET=TOP
21, 22, 23, 24
*NSET, NSET=BASE
1, 2, 3, 4
*BOUNDARY
BASE, 3, 3
1, 1, 2
2, 2, 2
*STEP
*STATIC
0.05, 1., 1e-4, 0.05
*BOUNDARY
TOP, 3, 3, 1.5e-4
*NODE PRINT, NSET=TOP
RF
*EL PRINT, ELSET=WEAK
S, SP, PE, DAMAGET, DAMAGEC
*EL FILE, FREQUENCY=5
S, E, PE, DAMAGET, DAMAGEC, SDV
*ENVELOPE
S1, DAMAGET
*ENVELOPE, POSITION=POINTS
S1, S3
*END STEP
"""


@pytest.fixture(scope="module", params=KINDS)
def run(request, program_path: Path, tmp_path_factory):
    from harness import Program

    folder = tmp_path_factory.mktemp("bar")
    return Program(program_path, folder, 1)(bar_deck(request.param), name="bar")


def last_frame(run) -> pyvista.UnstructuredGrid:
    return pyvista.read(sorted((run.folder / "bar_vtk").glob("bar_0*.vtu"))[-1])


def last_points(file: h5py.File) -> h5py.Group:
    steps = file["steps/0001/increments"]
    return steps[sorted(steps)[-1]]["points"]


def test_damage_is_in_the_weak_layer_alone(run):
    damage = run.json["damage"]
    assert 0.3 < damage["DAMAGET"]["value"] <= 0.9
    assert damage["DAMAGET"]["element"] in (3, 6)
    assert 2 * SIDE < damage["DAMAGET"]["x"][2] < 3 * SIDE
    assert damage["DAMAGEC"]["value"] == 0.0
    weak = [e for e in (3, 6) if e in run.csv("el_WEAK")["element"]]
    assert damage["inelastic"] == {"volume": pytest.approx(SIDE**3), "elements": len(weak)}


def test_no_point_carries_more_than_the_strength(run):
    table = run.csv("el_WEAK")
    # The law meets its yield surface to 1e-8 of the strength.
    assert table["SP1"].max() <= STRENGTH * (1 + 1e-7)
    assert table["SP1"].max() >= 0.9 * STRENGTH
    assert run.json["envelopes"]["S1"]["anywhere"]["value"] <= 2 * STRENGTH


def test_envelope_of_points(run):
    """Extremes at points are those of the table of points, and bound the picture on the nodes."""
    table, found = run.csv("el_WEAK"), run.json["envelopes"]
    largest = found["S1_POINT"]["anywhere"]
    # The strong cubes carry the same force; around the weak layer their stress is not uniform.
    assert table["SP1"].max() <= largest["value"] * (1 + PRINTED)
    assert largest["value"] <= 2 * STRENGTH * (1 + 1e-7)
    assert found["S3_POINT"]["anywhere"]["value"] <= table["SP3"].min() + 1e-9 * STRENGTH
    grid = pyvista.read(next((run.folder / "bar_vtk").glob("*envelope*.vtu")))
    assert grid.point_data["S1_POINT_MAX"].max() <= largest["value"] * (1 + PRINTED)
    assert grid.point_data["S3_POINT_MIN"].min() >= found["S3_POINT"]["anywhere"]["value"] - 1e-3
    with h5py.File(run.folder / "bar.h5") as file:
        stored = file["steps/0001/envelopes/S1_POINT_MAX"][:]
    assert stored == pytest.approx(grid.point_data["S1_POINT_MAX"])


def test_points_are_the_same_in_every_file(run):
    table = run.csv("el_WEAK")
    now = table["increment"] == table["increment"].max()
    with h5py.File(run.folder / "bar.h5") as file:
        points = last_points(file)
        row = points["row"][:]
        assert sorted(file["points/element"][:][row]) == sorted(table["element"][now])
        for name in ("DAMAGET", "DAMAGEC"):
            assert points[name][:] == pytest.approx(table[name][now], rel=PRINTED)
        assert points["S"][:, 2] == pytest.approx(table["S33"][now], rel=PRINTED, abs=1e-3)
        assert points["PE"][:, 2] == pytest.approx(table["PE33"][now], rel=PRINTED)
        volume, damage = file["points/volume"][:][row], points["DAMAGET"][:]
        found = [
            {"at_least": level, "volume": pytest.approx(volume[damage >= level - 1e-9].sum())}
            for level in (0.1, 0.5, 0.9)
        ]
    for mine, part in zip(found, run.json["damage"]["damaged_volume"], strict=True):
        assert {"at_least": part["at_least"], "volume": part["volume"]} == mine
    assert run.json["damage"]["DAMAGET"]["value"] == pytest.approx(
        table["DAMAGET"].max(), rel=PRINTED
    )


def test_nodes_and_cells_of_the_picture(run):
    grid = last_frame(run)
    damage, largest = grid.point_data["DAMAGET"], run.json["damage"]["DAMAGET"]["value"]
    # Sections: the weak layer, defined first, rules its eight nodes.
    assert damage[8:16].min() > 0.5 * largest
    assert damage.max() <= largest * (1 + PRINTED)
    assert np.delete(damage, range(8, 16)) == pytest.approx(0, abs=0)
    means = dict(zip(grid.cell_data["ELEMENT_ID"], grid.cell_data["DAMAGET_MEAN"], strict=True))
    assert means.pop(3) == pytest.approx(largest, rel=0.2)
    means.pop(6, None)
    assert set(means.values()) == {0.0}
    frames = sorted((run.folder / "bar_vtk").glob("*.vtu"))
    for frame in frames:
        grid, other = pyvista.read(frame), meshio.read(frame)
        for name in grid.point_data:
            assert np.array_equal(grid.point_data[name], other.point_data[name])
        assert all(np.isfinite(values).all() for values in other.point_data.values())


def test_energies_are_those_of_the_balance(run):
    spent, energy = run.json["damage"]["dissipated"], run.json["steps"][-1]["energy"]
    assert spent["cracking"] + spent["crushing"] == pytest.approx(energy["fracture"], rel=PRINTED)
    assert spent["crushing"] == pytest.approx(energy["crushing"], rel=PRINTED, abs=1e-15)
    # Not more than the whole crack takes.
    assert 0 < spent["cracking"] < 1.01 * FRACTURE_ENERGY * SIDE**2


def test_damage_grows(run):
    table = run.csv("damage")
    assert (np.diff(table["DAMAGET"]) >= 0).all()
    assert (np.diff(table["cracking"]) >= 0).all()
    assert table["volume_10"][-1] == pytest.approx(SIDE**3)


def test_envelope_is_the_last_damage(run):
    grid = pyvista.read(run.folder / "bar_vtk" / "bar_envelope_step1.vtu")
    last = last_frame(run)
    assert np.array_equal(grid.point_data["DAMAGET_MAX"], last.point_data["DAMAGET"])
    assert np.array_equal(grid.cell_data["DAMAGET_MEAN_MAX"], last.cell_data["DAMAGET_MEAN"])
