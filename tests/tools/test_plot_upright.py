"""Pictures of a dam whose height is along another axis than z."""

import h5py
import matplotlib.image
import numpy as np
import pytest
from keyway.commands import plot
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.colour_scale import Scales
from keyway_tools.dam_views import Faces
from keyway_tools.pictures_joints import JointView
from keyway_tools.report.scene import scene
from keyway_tools.shared_scales import shared_scales
from keyway_tools.si_results import SiResults
from synthetic_results import write_results

LENGTH, THICKNESS, HEIGHT = 30.0, 4.0, 20.0


def wall(folder, shift, has_water):
    """Results of a wall, upstream at y = 0; then x, y, z are turned by `shift` places."""
    mesh, _ = box_mesh((6, 2, 5), stretched((LENGTH, THICKNESS, HEIGHT)))
    mesh.brick_sets["DAM"] = np.arange(len(mesh.bricks))
    if has_water:
        cells = np.arange(len(mesh.bricks)).reshape(6, 2, 5)
        mesh.surfaces = {
            "UPSTREAM": [(int(b), 3) for b in cells[:, 0].ravel()],
            "DOWNSTREAM": [(int(b), 5) for b in cells[:, -1].ravel()],
        }
    write_results(folder, mesh)
    with h5py.File(folder / "job.h5", "r+") as file:
        file["mesh/x"][:] = np.roll(file["mesh/x"][:], shift, axis=1)
        file["mesh"].attrs["up"] = (2 + shift) % 3 + 1
        for step in file["steps"].values():
            for saved in step.get("increments", {}).values():
                saved["U"][:] = np.roll(saved["U"][:], shift, axis=1)
            if "modes" in step:
                step["modes/shape"][:] = np.roll(step["modes/shape"][:], shift, axis=2)
    return SiResults(folder)


@pytest.mark.parametrize("has_water", [True, False])
@pytest.mark.parametrize("shift", [1, 2])
def test_views_turn_with_the_dam(tmp_path, shift, has_water):
    usual = Faces(wall(tmp_path / "usual", 0, has_water)).with_above()
    turned = Faces(wall(tmp_path / "turned", shift, has_water)).with_above()
    assert list(turned) == list(usual)
    for title, view in usual.items():
        for name in ("right", "up", "towards"):
            expected = np.roll(getattr(view, name), shift)
            assert getattr(turned[title], name) == pytest.approx(expected, abs=1e-12)


def test_all_pictures_are_those_of_the_dam_with_z_up(tmp_path, capsys):
    """Upstream along the axis z (2 places): a view from a side would look from above."""
    images = []
    for shift in (0, 2):
        folder = tmp_path / str(shift)
        wall(folder, shift, True)
        assert plot.main([str(folder)]) == 0
        capsys.readouterr()
        names = ("envelope_s1", "section_s1", "deformed", "modes")
        images.append([matplotlib.image.imread(folder / f"job_{name}.png") for name in names])
    for usual, turned in zip(*images, strict=True):
        assert usual.shape[0] == pytest.approx(turned.shape[0], abs=3)
        # places in the headlines and letters of axes differ, edges by a pixel
        rows = min(usual.shape[0], turned.shape[0])
        apart = np.abs(usual[:rows, :, :3] - turned[:rows, :, :3]).max(axis=2) > 0.3
        assert apart.mean() < 0.02


def test_the_report_turns_its_camera(tmp_path):
    results = wall(tmp_path, 2, True)
    found = scene(results, shared_scales([results], Scales()))
    assert found["up"] == 1
    usual = scene(wall(tmp_path / "usual", 0, True), Scales())
    assert usual["up"] == 2
    eye = [found["eye"][name] for name in "xyz"]
    assert eye == pytest.approx(np.roll([usual["eye"][name] for name in "xyz"], 2).tolist())


def test_a_joint_is_drawn_along_its_height(tmp_path):
    corners = np.array([[0.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 20.0, 9.0], [0.0, 0.0, 9.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    usual, turned = JointView(corners, triangles), JointView(corners[:, [1, 2, 0]], triangles, 1)
    assert turned.is_upright
    assert turned.labels == ("along [m]", "height y [m]")
    assert turned.up == pytest.approx(usual.up)
    assert turned.along == pytest.approx(usual.along)
