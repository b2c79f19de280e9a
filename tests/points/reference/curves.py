"""Strength and damage of one sign against plastic strain (paper_notes.md, 11)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

EXTENSION = 0.1  # of strength and of 1 - damage: the most that an extended segment loses


@dataclass(frozen=True)
class Curve:
    """Nominal strength and damage, linear between rows, constant past the last one.

    The slopes jump at the rows. A curve limited to one segment has no jump there: the segment is
    extended beyond both its rows.
    """

    plastic: np.ndarray  # plastic strain of the rows
    strength: np.ndarray  # nominal [Pa]
    damage: np.ndarray
    segment: int | None = None  # the segment after this row, extended; None: all segments

    def limited(self, segment: int) -> Curve:
        """The curve of one segment, extended: the integration stops where the segment ends."""
        return replace(self, segment=segment)

    def segment_at(self, plastic: float) -> int:
        """Row before a plastic strain; a plastic strain on a row belongs to the segment after."""
        return max(int(np.searchsorted(self.plastic, plastic, side="right")) - 1, 0)

    def end_of(self, segment: int) -> float:
        """Plastic strain at the end of a segment; the last one has none."""
        return float(self.plastic[segment + 1]) if segment + 1 < len(self.plastic) else np.inf

    def at(self, plastic: float) -> tuple[float, float]:
        """Nominal strength [Pa] and damage."""
        if self.segment is None:
            return (
                float(np.interp(plastic, self.plastic, self.strength)),
                float(np.interp(plastic, self.plastic, self.damage)),
            )
        row = self.segment
        by_strength, by_damage = self._nominal_slopes(row)
        ahead = min(plastic - self.plastic[row], self._longest(row))
        return (
            float(self.strength[row] + by_strength * ahead),
            float(self.damage[row] + by_damage * ahead),
        )

    def effective(self, plastic: float) -> float:
        """Strength of the material between the cracks [Pa], paper_notes.md, 9."""
        strength, damage = self.at(plastic)
        return strength / (1.0 - damage)

    def slopes(self, plastic: float) -> tuple[float, float]:
        """Derivatives of effective strength [Pa] and damage by plastic strain."""
        row = self.segment_at(plastic) if self.segment is None else self.segment
        if plastic > self.plastic[row] + self._longest(row):
            return 0.0, 0.0
        by_strength, by_damage = self._nominal_slopes(row)
        strength, damage = self.at(plastic)
        whole = 1.0 - damage
        return by_strength / whole + strength * by_damage / whole**2, by_damage

    def _nominal_slopes(self, row: int) -> tuple[float, float]:
        """Slopes of nominal strength [Pa] and damage after a row; zero after the last row."""
        if row + 1 >= len(self.plastic):
            return 0.0, 0.0
        width = self.plastic[row + 1] - self.plastic[row]
        return (
            (self.strength[row + 1] - self.strength[row]) / width,
            (self.damage[row + 1] - self.damage[row]) / width,
        )

    def _longest(self, row: int) -> float:
        """Length of a segment with its extension, which ends before strength or stiffness do."""
        if row + 1 >= len(self.plastic):
            return np.inf
        width = self.plastic[row + 1] - self.plastic[row]
        by_strength, by_damage = self._nominal_slopes(row)
        lengths = [width]
        if by_strength < 0.0:
            lengths.append(EXTENSION * self.strength[row + 1] / -by_strength)
        if by_damage > 0.0:
            lengths.append(EXTENSION * (1.0 - self.damage[row + 1]) / by_damage)
        return width + min(lengths)


def curve_of_tables(young: float, strengths, damages=((0.0, 0.0),), length: float = 1.0) -> Curve:
    """A curve from rows (strength, inelastic strain) and (damage, inelastic strain).

    `length` divides the abscissas of tables given against an opening. The rows of both tables
    become rows of the curve; inelastic strain eps - sigma/E becomes plastic strain by subtraction
    of d/(1-d) sigma/E, the part of damage in the elastic strain (paper_notes.md, 11).
    """
    strengths, damages = np.array(strengths, dtype=float), np.array(damages, dtype=float)
    inelastic = np.union1d(strengths[:, 1], damages[:, 1]) / length
    strength = np.interp(inelastic, strengths[:, 1] / length, strengths[:, 0])
    damage = np.interp(inelastic, damages[:, 1] / length, damages[:, 0])
    plastic = inelastic - damage / (1.0 - damage) * strength / young
    if np.any(np.diff(plastic) <= 0.0):
        raise ValueError(f"plastic strain does not grow: {plastic}")
    return Curve(plastic, strength, damage)
