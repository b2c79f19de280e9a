"""Strength and damage of one sign against plastic strain (paper_notes.md, 11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Curve:
    """Nominal strength and damage, linear between rows, constant past the last one."""

    plastic: np.ndarray  # plastic strain of the rows
    strength: np.ndarray  # nominal [Pa]
    damage: np.ndarray

    def at(self, plastic: float) -> tuple[float, float]:
        """Nominal strength [Pa] and damage."""
        return (
            float(np.interp(plastic, self.plastic, self.strength)),
            float(np.interp(plastic, self.plastic, self.damage)),
        )

    def effective(self, plastic: float) -> float:
        """Strength of the material between the cracks [Pa], paper_notes.md, 9."""
        strength, damage = self.at(plastic)
        return strength / (1.0 - damage)

    def slopes(self, plastic: float) -> tuple[float, float]:
        """How effective strength [Pa] and damage change with growing plastic strain."""
        row = int(np.searchsorted(self.plastic, plastic, side="right")) - 1
        if row < 0 or row >= len(self.plastic) - 1:
            return 0.0, 0.0
        width = self.plastic[row + 1] - self.plastic[row]
        by_strength = (self.strength[row + 1] - self.strength[row]) / width
        by_damage = (self.damage[row + 1] - self.damage[row]) / width
        strength, damage = self.at(plastic)
        whole = 1.0 - damage
        return by_strength / whole + strength * by_damage / whole**2, by_damage


def curve_of_tables(young: float, strengths, damages=((0.0, 0.0),), length: float = 1.0) -> Curve:
    """A curve from rows (strength, inelastic strain) and (damage, inelastic strain).

    `length` divides the abscissas of tables given against an opening. The rows of both tables
    become rows of the curve; inelastic strain eps - sigma/E becomes plastic strain by taking off
    what the damage adds to the elastic strain, d/(1-d) sigma/E (paper_notes.md, 11).
    """
    strengths, damages = np.array(strengths, dtype=float), np.array(damages, dtype=float)
    inelastic = np.union1d(strengths[:, 1], damages[:, 1]) / length
    strength = np.interp(inelastic, strengths[:, 1] / length, strengths[:, 0])
    damage = np.interp(inelastic, damages[:, 1] / length, damages[:, 0])
    plastic = inelastic - damage / (1.0 - damage) * strength / young
    if np.any(np.diff(plastic) <= 0.0):
        raise ValueError(f"plastic strain does not grow: {plastic}")
    return Curve(plastic, strength, damage)
