"""The section through an extreme: whole also where the extreme lies at an end of the dam."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv
from keyway_tools.pictures_sections import _cut
from keyway_tools.render_dam import View

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
