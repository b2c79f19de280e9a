"""Shape of a double-curvature arch dam: crown cantilever, arches, V-shaped valley.

Axes: x across the valley with 0 at the crown, y downstream, z up with 0 at the foot of the crown.
The crest's upstream edge passes through (0, 0, height).

The normals of the ends of the crest's upstream arc meet in the axis of the dam (of a circular arch
its centre). Every vertical plane through the axis is a mesh plane, so contraction joints are
vertical planes that are normal to a circular crest, and nearly so to a parabolic one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arch_curves import CURVES, ArchCurve


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
    abutment_thickening: float = 1.0  # thickness at the abutment over that at the crown, each level
    arches: str = "circular"  # or parabolic

    def __post_init__(self) -> None:
        for name in ("height", "crest_arc", "crest_thickness", "base_thickness"):
            if getattr(self, name) <= 0.0:
                raise self._fault(name, "a length above 0")
        if self.arches not in CURVES:
            raise self._fault("arches", " or ".join(CURVES))
        if not 0.5 <= self.abutment_thickening <= 3.0:
            raise self._fault("abutment_thickening", "a number of 0.5 to 3")
        if not 0.0 < self.crest_angle < 160.0:
            raise self._fault("crest_angle", "an angle above 0 and below 160 degrees")
        if not 0.0 < self.vertical_tangent <= 1.5:
            raise self._fault("vertical_tangent", "a number above 0, at most 1.5")
        if not 0.0 <= self.bottom_width < 2.0 * self.crest_half_width:
            width = f"{2.0 * self.crest_half_width:.1f} m, the width at the crest"
            raise self._fault("bottom_width", f"0 or more and below {width}")
        widest = max(self.bottom_width / 2.0, 0.0)
        if widest >= self.curve.reach(self.upstream_radius(0.0)):
            raise ValueError(
                "the arch at the base does not span the valley; expected a larger "
                "--base-radius-ratio or a smaller --bottom-width"
            )

    def _fault(self, name: str, expected: str) -> ValueError:
        """The fault of a value, by the name of its option."""
        value = getattr(self, name)
        found = value if isinstance(value, str) else f"{value:g}"
        return ValueError(f"--{name.replace('_', '-')} {found}: expected {expected}")

    @property
    def curve(self) -> ArchCurve:
        """The kind of the arches."""
        return CURVES[self.arches]

    @property
    def half_angle(self) -> float:
        """Half the central angle of the crest's upstream arc [rad]."""
        return math.radians(self.crest_angle) / 2.0

    @property
    def crest_radius(self) -> float:
        """Radius of the crest's upstream arc at the crown [m]."""
        return float(self.curve.radius(self.crest_arc, self.half_angle))

    @property
    def axis(self) -> float:
        """The y of the dam's axis [m]."""
        return float(self.curve.axis(self.crest_radius, self.half_angle))

    @property
    def crest_half_width(self) -> float:
        """Half the chord of the crest's upstream arc [m]."""
        return float(self.curve.half_chord(self.crest_radius, self.half_angle))

    def half_width(self, z):
        """Half-width of the valley at height z, where the upstream face meets the rock [m]."""
        bottom = self.bottom_width / 2.0
        return bottom + (self.crest_half_width - bottom) * np.asarray(z) / self.height

    def upstream_radius(self, z):
        """Radius of the upstream arc at height z [m]; linear between base and crest."""
        share = np.asarray(z) / self.height
        return self.crest_radius * (self.base_radius_ratio + (1.0 - self.base_radius_ratio) * share)

    def thickness(self, z, angle=0.0):
        """Thickness along a mesh plane [m]; linear between crest and base.

        From the crown to the abutment it grows with the square of the plane's angle.
        """
        depth = 1.0 - np.asarray(z) / self.height
        crown = self.crest_thickness + (self.base_thickness - self.crest_thickness) * depth
        if self.abutment_thickening == 1.0:
            return crown
        share = np.divide(angle, np.maximum(self.abutment_angle(z), 1e-12))
        return crown * (1.0 + (self.abutment_thickening - 1.0) * np.minimum(share**2, 1.0))

    def upstream_crown(self, z):
        """y of the upstream face of the crown cantilever [m]: a parabola in the depth."""
        depth = 1.0 - np.asarray(z) / self.height
        slope = self.crest_overhang * self.height
        return -slope * depth + slope / (2.0 * self.vertical_tangent) * depth**2

    def upstream_distance(self, angle, z):
        """Distance of the upstream face from the dam's axis, at an angle [rad] and z."""
        vertex = self.axis - self.upstream_crown(z)
        return self.curve.distance(angle, vertex, self.upstream_radius(z))

    def plane_angle(self, x, z):
        """Angle [rad] of the mesh plane through the point of the upstream face at x and z."""
        y = self.curve.y(x, self.upstream_crown(z), self.upstream_radius(z))
        return np.arctan2(x, self.axis - y)

    def abutment_angle(self, z):
        """Angle [rad] of the mesh plane in which the upstream face meets the valley at height z."""
        x = self.half_width(z)
        if np.any(x >= self.curve.reach(self.upstream_radius(z))):
            raise ValueError(
                "an arch does not span the valley; expected a larger --base-radius-ratio or a "
                "smaller --bottom-width"
            )
        return self.plane_angle(x, z)

    def crest_position(self, angle):
        """Length of the crest's upstream arc from the crown to a mesh plane [m]."""
        x = self.upstream_distance(angle, self.height) * np.sin(angle)
        return self.curve.arc(x, self.crest_radius)

    def point(self, angle, z, share):
        """Point of the dam; share goes from 0 (downstream face) to 1 (upstream face)."""
        far = self.upstream_distance(angle, z)
        distance = far - (1.0 - np.asarray(share)) * self.thickness(z, angle)
        x = distance * np.sin(angle)
        y = self.axis - distance * np.cos(angle)
        return np.stack(np.broadcast_arrays(x, y, np.asarray(z, dtype=float)), axis=-1)
