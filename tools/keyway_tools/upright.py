"""Which axis of a model points up, for pictures and heights; axes count from 0."""

from __future__ import annotations

import numpy as np

Z = 2  # the usual upward axis


def axes_with_up_last(up_axis: int) -> list[int]:
    """Both horizontal axes and the upward one, right-handed.

    >>> axes_with_up_last(2), axes_with_up_last(1)
    ([0, 1, 2], [2, 0, 1])
    """
    return [(up_axis + 1) % 3, (up_axis + 2) % 3, up_axis]


def horizontal(vector: np.ndarray, upward: np.ndarray) -> np.ndarray:
    """The horizontal part of a vector; `upward` is the unit vector of an axis.

    >>> horizontal(np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.0, 0.0])).tolist()
    [1.0, 0.0, 3.0]
    """
    return vector - (vector @ upward) * upward
