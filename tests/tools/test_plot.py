"""Pictures of made-up results: every kind appears, is named and is not blank."""

import matplotlib.image
import numpy as np
import plot
import pytest
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.results_reader import Results, find_jobs
from synthetic_results import write_results

KINDS = {
    "envelope_s1",
    "envelope_s3",
    "envelope_u",
    "envelope_opening",
    "envelope_opening_joints",
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


def kinds_of(names, job="job"):
    return {name.split("/")[-1].removeprefix(f"{job}_").removesuffix(".png") for name in names}


def test_every_picture_of_a_dam_is_made_and_named(dam_results, capsys):
    assert plot.main([str(dam_results)]) == 0
    names = capsys.readouterr().out.split()
    assert kinds_of(names) == KINDS
    for name in names:
        image = matplotlib.image.imread(name)[..., :3]
        assert image.shape[0] > 200
        assert image.std() > 0.02


def test_faces_show_colours(dam_results):
    image = matplotlib.image.imread(dam_results / "job_envelope_s1.png")[..., :3]
    is_coloured = np.ptp(image, axis=2) > 0.2
    assert is_coloured.mean() > 0.02


def test_dam_is_told_from_rock(dam_results):
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
