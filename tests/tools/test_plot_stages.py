"""Pictures of a dam that is built in stages: absent elements are not drawn."""

from __future__ import annotations

import h5py
import matplotlib.image
import numpy as np
import pytest
from keyway.commands import plot
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.dam_views import Faces
from keyway_tools.picture_style import Sheet
from keyway_tools.pictures_stages import changing_steps, plot_stages
from keyway_tools.si_results import SiResults
from synthetic_results import write_results

LEVEL = 80.0  # [m] the upper lift begins


@pytest.fixture
def staged(tmp_path):
    """A dam whose upper lift is absent in the first of two steps; its lower joints are grouted."""
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=1, num_bottom=2, rock=None)
    )
    write_results(tmp_path, mesh)
    with h5py.File(tmp_path / "job.h5", "a") as file:
        count = len(file["mesh/element_id"])
        upper = np.zeros(count, dtype=bool)
        upper[: len(mesh.bricks)] = mesh.x[mesh.bricks, 2].mean(axis=1) > LEVEL
        file["steps/0001/stage"] = np.where(upper, 0, 1)
        file["steps/0002/stage"] = np.where(upper, 2, 1)
        for group in file["steps/0001/increments"].values():
            for name in group["joints"]:
                z = file[f"joints/{name}/x"][:, 2]
                group[f"joints/{name}/grouted"] = np.where(z > LEVEL, 0, 2)
    return tmp_path


def test_absent_elements_are_not_drawn(staged):
    results = SiResults(staged, "job")
    whole, lower = Faces(results), Faces(results, 1)
    assert results.x[whole.nodes, 2].max() == 135.5
    assert results.x[lower.nodes, 2].max() < 100.0
    assert lower.joint_lines().points[:, 2].max() < 100.0
    assert list(lower.views) == list(whole.views)
    assert len(Faces(results, 2).elements) == len(whole.elements)
    assert lower.at("/steps/0002/increments/000001/U").nodes.size == whole.nodes.size


def test_every_picture_is_made_with_absent_elements(staged, capsys):
    assert plot.main([str(staged)]) == 0
    names = capsys.readouterr().out.split()
    assert any(name.endswith("job_stages.png") for name in names)
    assert any(name.endswith("job_damage.png") for name in names)


def test_stages_show_grouted_joints(staged):
    results = SiResults(staged, "job")
    assert changing_steps(results) == [1, 2]
    file = plot_stages(Faces(results), Sheet(staged / "stages"))[0]
    image = matplotlib.image.imread(file)[..., :3]
    orange = (image[..., 0] > 0.7) & (image[..., 2] < 0.2) & (image[..., 1] < 0.5)
    assert orange.sum() > 50


def test_a_run_without_stages_has_no_such_picture(tmp_path):
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=1, num_bottom=2, rock=None)
    )
    write_results(tmp_path, mesh)
    results = SiResults(tmp_path, "job")
    assert results.stage(1) is None
    assert plot_stages(Faces(results), Sheet(tmp_path / "stages")) == []
