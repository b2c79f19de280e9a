"""Target spectra.

The Chinese standard for hydraulic structures (NB 35047-2015, the same in GB 51247-2018) draws the
5 % spectrum of the horizontal acceleration over its peak ground acceleration as

    beta(T) = 1 + (beta_max - 1) T / 0.1 s         0     <= T <= 0.1 s
    beta(T) = beta_max                             0.1 s <= T <= T_g
    beta(T) = beta_max (T_g / T)^0.6               T_g   <= T

with beta not below 0.2 beta_max; beta_max is 2.5 for arch dams (2.0 for gravity dams). T_g is
0.20 s on hard rock (class I0) and 0.25 s on rock (class I1), before the adjustment for the seismic
zone. The vertical motion takes the same shape with 2/3 of the acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PLATEAU_START = 0.1  # [s]
FLOOR_SHARE = 0.2  # of the plateau
VERTICAL_SHARE = 2.0 / 3.0


@dataclass(frozen=True)
class DesignSpectrum:
    """Spectral acceleration over peak ground acceleration, 5 % damping."""

    plateau: float = 2.5  # beta_max, arch dams
    corner: float = 0.2  # T_g [s]
    decay: float = 0.6

    def __call__(self, period) -> np.ndarray:
        """beta at some periods [s]."""
        t = np.asarray(period, dtype=float)
        rising = 1.0 + (self.plateau - 1.0) * np.minimum(t, PLATEAU_START) / PLATEAU_START
        falling = self.plateau * (self.corner / np.maximum(t, self.corner)) ** self.decay
        falling = np.maximum(falling, FLOOR_SHARE * self.plateau)
        return np.where(t < PLATEAU_START, rising, falling)
