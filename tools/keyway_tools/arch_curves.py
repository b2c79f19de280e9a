"""The curves of horizontal arches: circles and parabolas.

A curve starts at its vertex, the crown, and is symmetric about it. Lengths in m, angles in rad.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np


class ArchCurve(Protocol):
    """What an arch dam needs of its horizontal curve; `radius` is that at the vertex."""

    def radius(self, arc: float, half_angle: float) -> float:
        """Radius of a curve of the length `arc` whose ends are turned by `half_angle`."""

    def half_chord(self, radius: float, half_angle: float) -> float:
        """Half the distance of the ends."""

    def axis(self, radius: float, half_angle: float) -> float:
        """Distance from the vertex to the axis in which the normals of both ends meet."""

    def reach(self, radius: float) -> float:
        """Half the widest span."""

    def y(self, x, vertex, radius):
        """The y of the points at +-x of the curve whose vertex has the y `vertex`."""

    def distance(self, angle, vertex, radius):
        """Distance from the axis to the curve at an angle from the crown, `vertex` at angle 0."""

    def arc(self, x, radius):
        """Length of the curve from the vertex to the point at x."""


class Circle:
    """A circular arch."""

    def radius(self, arc: float, half_angle: float) -> float:
        return arc / (2.0 * half_angle)

    def half_chord(self, radius: float, half_angle: float) -> float:
        return radius * math.sin(half_angle)

    def axis(self, radius: float, half_angle: float) -> float:
        return radius

    def reach(self, radius: float) -> float:
        return radius

    def y(self, x, vertex, radius):
        return vertex + radius - np.sqrt(radius**2 - x**2)

    def distance(self, angle, vertex, radius):
        offset = vertex - radius
        return offset * np.cos(angle) + np.sqrt(radius**2 - (offset * np.sin(angle)) ** 2)

    def arc(self, x, radius):
        return radius * np.arcsin(x / radius)


class Parabola:
    """The arch y = x^2 / (2 R), R the radius of curvature at its vertex."""

    def radius(self, arc: float, half_angle: float) -> float:
        return arc / (2.0 * self.arc(np.tan(half_angle), 1.0))

    def half_chord(self, radius: float, half_angle: float) -> float:
        return radius * np.tan(half_angle)

    def axis(self, radius: float, half_angle: float) -> float:
        """R + x^2 / (2 R): the projection of a parabola's normal on its axis is R."""
        return radius * (1.0 + 0.5 * np.tan(half_angle) ** 2)

    def reach(self, radius: float) -> float:
        return np.inf

    def y(self, x, vertex, radius):
        return vertex + x**2 / (2.0 * radius)

    def distance(self, angle, vertex, radius):
        """Positive root of D^2 sin^2 / (2 R) + D cos = vertex."""
        c, s = np.cos(angle), np.sin(angle)
        return 2.0 * vertex / (c + np.sqrt(c**2 + 2.0 * vertex * s**2 / radius))

    def arc(self, x, radius):
        t = x / radius
        return 0.5 * radius * (t * np.sqrt(1.0 + t**2) + np.arcsinh(t))


CURVES: dict[str, ArchCurve] = {"circular": Circle(), "parabolic": Parabola()}
