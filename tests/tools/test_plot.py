"""Pictures of made-up results: every kind appears, is named and is not blank."""

import contextlib
import io

import matplotlib.image
import numpy as np
import plot
import pytest
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.pictures_joints import JointView, range_of
from keyway_tools.results import Results, find_jobs
from synthetic_results import write_results

KINDS = {
    "envelope_s1",
    "envelope_s3",
    "envelope_u",
    "envelope_damaget",
    "envelope_damagec",
    "envelope_opening",
    "envelope_opening_joints",
    "damage",
    "damage_growth",
    "deformed",
    "modes",
    "openings",
    "displacements",
    "energy",
}


@pytest.fixture(scope="module")
def dam_results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dam")
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=2, num_bottom=2)
    )
    write_results(folder, mesh)
    return folder


@pytest.fixture(scope="module")
def names(dam_results):
    """Paths of the pictures of the dam, as the tool prints them."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert plot.main([str(dam_results)]) == 0
    return text.getvalue().split()


def kinds_of(names, job="job"):
    return {name.split("/")[-1].removeprefix(f"{job}_").removesuffix(".png") for name in names}


def test_every_picture_of_a_dam_is_made_and_named(names):
    assert kinds_of(names) == KINDS
    for name in names:
        image = matplotlib.image.imread(name)[..., :3]
        assert image.shape[0] > 200
        assert image.std() > 0.02


def test_faces_show_colours(names):
    path = next(name for name in names if name.endswith("job_envelope_s1.png"))
    image = matplotlib.image.imread(path)[..., :3]
    is_coloured = np.ptp(image, axis=2) > 0.2
    assert is_coloured.mean() > 0.02


def test_damage_is_the_mean_of_an_elements_points(dam_results):
    time, damage = Results(dam_results, "job").damage("DAMAGET")
    assert time == 0.2
    assert damage.max() <= 1.0
    assert (damage > 0.7).any()
    assert (damage == 0.0).any()
    assert Results(dam_results, "job").damage("DAMAGEC") is None


def test_dam_and_rock_are_distinguished(dam_results):
    results = Results(dam_results, "job")
    types = results.element_types[results.dam]
    assert set(types) == {"C3D8"}
    assert len(results.dam) < len(results.solids)


def test_body_without_water_or_joints(tmp_path, capsys):
    mesh, _ = box_mesh((2, 2, 10), stretched((1.0, 1.0, 10.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh, "column")
    assert plot.main([str(tmp_path), "-o", str(tmp_path / "pictures")]) == 0
    found = kinds_of(capsys.readouterr().out.split(), "column")
    assert found == KINDS - {"envelope_opening", "envelope_opening_joints", "openings"}


def test_folder_without_results_is_refused(tmp_path, capsys):
    assert plot.main([str(tmp_path)]) == 2
    assert "no job.h5" in capsys.readouterr().err
    assert find_jobs(tmp_path) == []


CURVE = "leg,increment,time,E11,S11,E12,S12,DAMAGET,work,stored,fracture,crushing,iterations\n"


def write_curve(path, peak):
    rows = [(i, 1e-5 * i, peak * min(1.0, i / 5), 0.0, 0.0, 0.04 * i) for i in range(20)]
    lines = [
        f"1,{i},{i},{e},{s},{e12},{s12},{d},{e * s},{0.5 * e * s},{d},0,1\n"
        for i, e, s, e12, s12, d in rows
    ]
    path.write_text(CURVE + "".join(lines))


def test_material_curves_beside_measured_points(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("keyway_tools.pictures_material.COMPONENTS", ("11", "12"))
    write_curve(tmp_path / "dam_material_A.csv", 2e6)
    write_curve(tmp_path / "dam_material_B.csv", 3e6)
    (tmp_path / "points.csv").write_text("# measured, 1985\nstrain,stress\n1e-4,2.5e6\n2e-4,1e6\n")
    curves = [str(tmp_path / f"dam_material_{name}.csv") for name in "AB"]
    picture = tmp_path / "pictures" / "both.png"
    points = ["-e", str(tmp_path / "points.csv")]
    assert plot.main(["material", *curves, *points, "-o", str(picture)]) == 0
    assert capsys.readouterr().out.split() == [str(picture)]
    image = matplotlib.image.imread(picture)[..., :3]
    assert image.std() > 0.02
    assert plot.main(["material", curves[0]]) == 0
    assert (tmp_path / "dam_material_A.png").exists()


def test_material_file_that_is_no_curve_is_refused(tmp_path, capsys):
    (tmp_path / "job_node_TOP.csv").write_text("time,node,U1\n0,1,2\n1,1,2\n")
    assert plot.main(["material", str(tmp_path / "job_node_TOP.csv")]) == 2
    assert "no column work" in capsys.readouterr().err


def test_upright_joints_share_one_range_of_heights():
    """Each joint is drawn from its lowest to its highest corner, a short one beside a tall one."""
    corners = np.array([[0.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 20.0, 1.0], [0.0, 0.0, 1.0]])
    tall, short = (JointView(corners * [1.0, 1.0, height]) for height in (200.0, 30.0))
    flat = JointView(corners[:, [1, 1, 0]] * [1.0, 0.5, 1.0])
    for order in ([tall, short, flat], [flat, short, tall]):
        for view in (tall, short):
            low, high = range_of(view, order)
            assert low < 0.0
            assert high > 200.0
        assert range_of(flat, order)[1] < 20.0
