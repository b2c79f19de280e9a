"""The section through an extreme: whole also where the extreme lies at an end of the dam; where it
is, its sides and the joints on it are named."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista as pv
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.colour_scale import Scales
from keyway_tools.dam_views import Faces
from keyway_tools.pictures_sections import _cut, plot_section
from keyway_tools.render_dam import View
from keyway_tools.si_results import SiResults
from synthetic_results import write_results

SIZE = 100.0  # [m] length of the wall; it is 10 m thick and 20 m high


@pytest.mark.parametrize("angle", [0.0, 1.0, -1.0])
@pytest.mark.parametrize("x", [0.0, 50.0, SIZE])
def test_section_is_whole(angle, x):
    """The plane is turned a little against the end, as normals of curved faces are."""
    wall = pv.ImageData(dimensions=(11, 3, 5), spacing=(SIZE / 10, 5.0, 5.0))
    turn = np.radians(angle)
    view = View.from_direction(np.array([np.cos(turn), np.sin(turn), 0.0]), 0.0)
    for y in (0.0, 10.0):
        cut = _cut(wall.cast_to_unstructured_grid(), view, np.array([x, y, 20.0]), SIZE)
        assert cut.area == pytest.approx(10.0 * 20.0 / np.cos(turn), rel=1e-3)


@pytest.fixture(scope="module")
def dam(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dam")
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=2, num_bottom=2, rock=None)
    )
    write_results(folder, mesh)
    return SiResults(folder)


def section_through(dam, node):
    """The figure of the section where the extreme is at a node."""
    (step,) = [step for step in dam.steps() if "S1" in step.envelopes]
    step.envelopes["S1"][:] = 0.0
    step.envelopes["S1"][node] = 1e6
    sheet = SimpleNamespace(save=lambda figure: figure)
    return plot_section(Faces(dam), step, "S1", Scales(), sheet)


def test_a_section_says_where_it_is(dam):
    """From face to face through a node of the crown's upstream face; upstream is on the left."""
    crown = np.flatnonzero(dam.face_flags("upstream") & (np.abs(dam.x[:, 0]) < 1e-6))
    figure = section_through(dam, crown[0])
    found = re.search(r"from \(x, y\) = \((.*), (.*)\) to \((.*), (.*)\) m", figure.get_suptitle())
    x_up, y_up, x_down, y_down = (float(word) for word in found.groups())
    assert [x_up, x_down] == pytest.approx([0.0, 0.0], abs=0.1)
    assert y_up == pytest.approx(dam.x[dam.face_flags("upstream") > 0, 1].min(), abs=1.0)
    assert y_down > y_up + 5.0
    at = {text.get_text(): text.get_position()[0] for text in figure.axes[0].texts}
    assert at["upstream"] < 0.0
    assert at["downstream"] > 1.0
    assert "black" not in figure.get_suptitle()


def test_a_joint_on_the_section_is_named(dam):
    """The plane across the dam at a node of a joint leaves the joint: colours jump there."""
    joint = dam.joint_faces("JOINT1").facets.ravel()
    on_face = joint[dam.face_flags("upstream")[joint] > 0]
    low = on_face[dam.x[on_face, 2].argmin()]
    assert "black: JOINT1, between blocks" in section_through(dam, low).get_suptitle()
