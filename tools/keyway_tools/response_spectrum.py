"""Response of oscillators to ground motion, exact for an acceleration of straight pieces.

Recurrence of Nigam and Jennings (1969): u(n+1), v(n+1) from u(n), v(n), a(n), a(n+1) through the
exact solution of u'' + 2 z w u' + w^2 u = -a(t) over one step. The two-state recurrence is run as
a digital filter of second order, one call an oscillator.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

GRAVITY = 9.81  # [m/s2], by which peaks and spectra are divided for g
POINTS_A_PERIOD = 24  # of the response, so that its peaks are found within 1 %


def recurrence(period: float, ratio: float, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Matrices A and B (2 x 2) of [u, v](n+1) = A [u, v](n) + B [a(n), a(n+1)]."""
    w = 2.0 * np.pi / period
    root = np.sqrt(1.0 - ratio**2)
    decay = np.exp(-ratio * w * dt)
    sine, cosine = decay * np.sin(w * root * dt), decay * np.cos(w * root * dt)
    a = np.array(
        [
            [ratio / root * sine + cosine, sine / (w * root)],
            [-w / root * sine, cosine - ratio / root * sine],
        ]
    )
    # particular solution for a(t) = a0 + s t: u = -(a0 + s t)/w^2 + 2 z s/w^3, v = -s/w^2
    b = np.empty((2, 2))
    for column, (start, end) in enumerate(((1.0, 0.0), (0.0, 1.0))):
        slope = (end - start) / dt
        lag = 2.0 * ratio * slope / w**3
        velocity = -slope / w**2
        first = np.array([lag - start / w**2, velocity])
        b[:, column] = np.array([lag - end / w**2, velocity]) - a @ first
    return a, b


def absolute_acceleration(ground: np.ndarray, dt: float, period: float, ratio: float) -> np.ndarray:
    """Absolute acceleration of one oscillator, at rest at the start, at each time."""
    a, b = recurrence(period, ratio, dt)
    w = 2.0 * np.pi / period
    observe = -np.array([w**2, 2.0 * ratio * w])
    trace, determinant = np.trace(a), np.linalg.det(a)
    turned = observe @ (a - trace * np.eye(2))
    numerator = [observe @ b[:, 1], observe @ b[:, 0] + turned @ b[:, 1], turned @ b[:, 0]]
    start = np.array([-observe @ b[:, 1], -turned @ b[:, 1]]) * ground[0]
    return lfilter(numerator, [1.0, -trace, determinant], ground, zi=start)[0]


def refine(acceleration: np.ndarray, factor: int) -> np.ndarray:
    """The same straight pieces with `factor` steps in each."""
    steps = len(acceleration) - 1
    return np.interp(np.arange(steps * factor + 1) / factor, np.arange(steps + 1), acceleration)


def response_spectrum(acceleration, dt: float, period, ratio: float = 0.05) -> np.ndarray:
    """Largest absolute acceleration of oscillators of the given periods [unit of the input]."""
    period = np.asarray(period, dtype=float)
    ground = np.asarray(acceleration, dtype=float)
    wanted = np.maximum(1.0, POINTS_A_PERIOD * dt / period)
    factor = (2.0 ** np.ceil(np.log2(wanted))).astype(int)
    spectrum = np.empty(period.size)
    for steps in np.unique(factor):
        motion = refine(ground, int(steps))
        for k in np.flatnonzero(factor == steps):
            response = absolute_acceleration(motion, dt / steps, period[k], ratio)
            spectrum[k] = np.abs(response).max()
    return spectrum
