"""Shape of a double-curvature arch dam: crown cantilever, circular arches, V-shaped valley.

Axes: x across the valley with 0 at the crown, y downstream, z up with 0 at the foot of the crown.
The crest's upstream edge passes through (0, 0, height).

Every vertical plane through the centre axis of the crest's upstream arc is a mesh plane, so
contraction joints are vertical planes that are radial at the crest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ArchShape:
    """Lengths in metres; defaults: the dam of paper_notes.md, 14 with assumed curvatures."""

    height: float = 135.5
    crest_arc: float = 444.86  # along the upstream edge of the crest
    crest_thickness: float = 8.0
    base_thickness: float = 35.0
    crest_angle: float = 100.0  # central angle of the crest's upstream arc [deg]
    base_radius_ratio: float = 0.6  # upstream radius at the base over that at the crest
    crest_overhang: float = 0.25  # slope of the upstream crown at the crest, upstream with depth
    vertical_tangent: float = 0.65  # depth / height where the upstream crown is vertical
    bottom_width: float = 40.0  # of the valley at z = 0, along x

    def __post_init__(self) -> None:
        for name in ("height", "crest_arc", "crest_thickness", "base_thickness"):
            if getattr(self, name) <= 0.0:
                raise ValueError(f"{name} must be > 0, found {getattr(self, name)}")
        if not 0.0 < self.crest_angle < 160.0:
            raise ValueError(f"crest_angle must lie in 0..160 degrees, found {self.crest_angle}")
        if not 0.0 < self.vertical_tangent <= 1.5:
            raise ValueError(f"vertical_tangent must lie in 0..1.5, found {self.vertical_tangent}")
        if not 0.0 <= self.bottom_width < 2.0 * self.crest_half_width:
            raise ValueError(
                f"bottom_width must lie in 0..{2.0 * self.crest_half_width:.1f} m "
                f"(the width at the crest), found {self.bottom_width}"
            )
        widest = max(self.bottom_width / 2.0, 0.0)
        if widest >= self.upstream_radius(0.0):
            raise ValueError(
                "the arch at the base does not span the valley: raise base_radius_ratio"
            )

    @property
    def crest_radius(self) -> float:
        """Radius of the crest's upstream arc [m]; also the y of its centre axis."""
        return self.crest_arc / math.radians(self.crest_angle)

    @property
    def crest_half_width(self) -> float:
        """Half the chord of the crest's upstream arc [m]."""
        return self.crest_radius * math.sin(math.radians(self.crest_angle) / 2.0)

    def half_width(self, z):
        """Half-width of the valley at height z, where the upstream face meets the rock [m]."""
        bottom = self.bottom_width / 2.0
        return bottom + (self.crest_half_width - bottom) * np.asarray(z) / self.height

    def upstream_radius(self, z):
        """Radius of the upstream arc at height z [m]; linear between base and crest."""
        share = np.asarray(z) / self.height
        return self.crest_radius * (self.base_radius_ratio + (1.0 - self.base_radius_ratio) * share)

    def thickness(self, z):
        """Thickness along a mesh plane at height z [m]; linear between crest and base."""
        depth = 1.0 - np.asarray(z) / self.height
        return self.crest_thickness + (self.base_thickness - self.crest_thickness) * depth

    def upstream_crown(self, z):
        """y of the upstream face of the crown cantilever [m]: a parabola in the depth."""
        depth = 1.0 - np.asarray(z) / self.height
        slope = self.crest_overhang * self.height
        return -slope * depth + slope / (2.0 * self.vertical_tangent) * depth**2

    def upstream_distance(self, angle, z):
        """Distance of the upstream face from the crest's centre axis, at an angle [rad] and z."""
        radius = self.upstream_radius(z)
        offset = self.crest_radius - self.upstream_crown(z) - radius
        return offset * np.cos(angle) + np.sqrt(radius**2 - (offset * np.sin(angle)) ** 2)

    def abutment_angle(self, z):
        """Angle [rad] of the mesh plane in which the upstream face meets the valley at height z."""
        radius = self.upstream_radius(z)
        x = self.half_width(z)
        if np.any(x >= radius):
            raise ValueError("an arch does not span the valley: raise base_radius_ratio")
        y = self.upstream_crown(z) + radius - np.sqrt(radius**2 - x**2)
        return np.arctan2(x, self.crest_radius - y)

    def point(self, angle, z, share):
        """Point of the dam; share goes from 0 (downstream face) to 1 (upstream face)."""
        far = self.upstream_distance(angle, z)
        distance = far - (1.0 - np.asarray(share)) * self.thickness(z)
        x = distance * np.sin(angle)
        y = self.crest_radius - distance * np.cos(angle)
        return np.stack(np.broadcast_arrays(x, y, np.asarray(z, dtype=float)), axis=-1)
