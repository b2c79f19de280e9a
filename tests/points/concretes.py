"""The concretes of the point tests: tables as a deck gives them, and the reference's law."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from reference.concrete import Concrete
from reference.curves import Curve, curve_of_tables

# Table 1 of the paper: tensile strength [Pa], inelastic strain, tensile damage.
TABLE_1 = np.array(
    [
        [2.480e6, 0.000e-3, 0.000],
        [0.858e6, 0.175e-3, 0.359],
        [0.545e6, 0.324e-3, 0.620],
        [0.415e6, 0.469e-3, 0.756],
        [0.294e6, 0.757e-3, 0.876],
        [0.234e6, 1.044e-3, 0.924],
        [0.198e6, 1.330e-3, 0.949],
        [0.169e6, 1.664e-3, 0.964],
    ]
)


@dataclass(frozen=True)
class Material:
    """A concrete as its keywords give it. Tables hold rows (ordinate, inelastic strain)."""

    young: float = 25e9  # [Pa], section 4.2 of the paper
    poisson: float = 0.167
    dilation: float = 32.5  # [deg]
    offset: float = 0.01
    biaxial_ratio: float = 1.125  # alpha 0.10, paper_notes.md, 9
    meridian_ratio: float = 2.0 / 3.0  # gamma 3
    viscosity: float = 0.0  # [s]
    recovery: str = "LEE-FENVES"
    tension_recovery: float = 0.0
    compression_recovery: float = 1.0
    stiffening: str = "STRAIN"  # or DISPLACEMENT: tables of tension against the opening [m]
    tension: np.ndarray = field(default_factory=lambda: TABLE_1[:, :2])
    tension_damage: np.ndarray = field(default_factory=lambda: TABLE_1[:, [2, 1]])
    compression: np.ndarray = field(default_factory=lambda: np.array([[30e6, 0.0]]))
    compression_damage: np.ndarray = field(default_factory=lambda: np.array([[0.0, 0.0]]))

    @property
    def tension_curve(self) -> Curve:
        return curve_of_tables(self.young, self.tension, self.tension_damage)

    @property
    def compression_curve(self) -> Curve:
        return curve_of_tables(self.young, self.compression, self.compression_damage)

    def law(self) -> Concrete:
        """The reference's law."""
        return Concrete(
            young=self.young,
            poisson=self.poisson,
            tension=self.tension_curve,
            compression=self.compression_curve,
            dilation=self.dilation,
            offset=self.offset,
            biaxial_ratio=self.biaxial_ratio,
            meridian_ratio=self.meridian_ratio,
            tension_recovery=self.tension_recovery,
            compression_recovery=self.compression_recovery,
            recovery=self.recovery,
        )


JINPING = Material()  # the paper's: Table 1, constant compression strength (paper_notes.md, 12)

# Crushing that hardens, softens and damages, of round numbers of our own: a concrete with every
# part of the law at work.
CRUSHING = {
    "compression": np.array([[20e6, 0.0], [30e6, 1e-3], [5e6, 6e-3]]),
    "compression_damage": np.array([[0.0, 0.0], [0.2, 1e-3], [0.8, 6e-3]]),
}
