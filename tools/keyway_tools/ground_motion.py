"""Accelerograms that fit a response spectrum.

A record starts from random phases under an intensity envelope. Then, repeatedly, Fourier amplitudes
are scaled by target over response (phases are kept), the largest acceleration is set and the
baseline corrected. The best record of a few sets of phases is kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .response_spectrum import response_spectrum

EDGE = 0.05  # level of the envelope below which corrections fade out


@dataclass(frozen=True)
class MotionOptions:
    """Times in seconds."""

    duration: float = 10.0
    dt: float = 0.01
    rise: float = 1.0  # end of the parabolic rise of the envelope
    strong: float = 6.0  # end of the level part; an exponential decay follows
    end_level: float = 0.1  # of the envelope, at the end of the record
    taper: float = 0.4  # over which the end of the record goes to zero
    shortest_period: float = 0.04  # fitted range
    longest_period: float = 3.0
    num_periods: int = 100  # logarithmically spaced over the range
    num_scalings: int = 30
    num_trials: int = 4  # sets of phases

    def periods(self) -> np.ndarray:
        """The periods at which the misfit counts [s]."""
        return np.geomspace(self.shortest_period, self.longest_period, self.num_periods)

    def times(self) -> np.ndarray:
        """Times of the record [s]."""
        return self.dt * np.arange(round(self.duration / self.dt) + 1)


@dataclass(frozen=True)
class Motion:
    """A fitted record; accelerations in units of its peak target (multiply by the PGA)."""

    acceleration: np.ndarray
    period: np.ndarray  # [s]
    spectrum: np.ndarray  # 5 %, of the record
    target: np.ndarray

    @property
    def misfit(self) -> np.ndarray:
        """Relative misfit at each period."""
        return self.spectrum / self.target - 1.0

    @property
    def mean_misfit(self) -> float:
        """Mean size of the misfit."""
        return float(np.abs(self.misfit).mean())

    @property
    def score(self) -> float:
        """Measure to minimise: the mean misfit plus a small share of the largest."""
        return self.mean_misfit + 0.1 * float(np.abs(self.misfit).max())


def envelope(options: MotionOptions) -> np.ndarray:
    """Intensity in time: parabola, level, exponential decay, cosine to zero at the end."""
    t = options.times()
    rate = -np.log(options.end_level) / max(options.duration - options.strong, options.dt)
    shape = np.minimum(1.0, (t / options.rise) ** 2) * np.exp(
        -rate * np.maximum(0.0, t - options.strong)
    )
    to_end = np.clip((options.duration - t) / options.taper, 0.0, 1.0)
    return shape * 0.5 * (1.0 - np.cos(np.pi * to_end))


def final_motion(acceleration: np.ndarray, dt: float) -> np.ndarray:
    """Velocity and displacement at the end, exact for straight pieces between the points."""
    velocity = dt * (acceleration.sum() - 0.5 * (acceleration[0] + acceleration[-1]))
    duration = dt * (len(acceleration) - 1)
    left = duration - dt * np.arange(len(acceleration))
    weight = np.full(len(acceleration), dt)
    weight[[0, -1]] = 0.5 * dt
    displacement = weight @ (left * acceleration)
    displacement += dt**2 / 6.0 * (acceleration[-1] - acceleration[0])
    return np.array([velocity, displacement])


def correct_baseline(acceleration: np.ndarray, dt: float, shape: np.ndarray) -> np.ndarray:
    """Record with zero velocity and displacement at its end and little drift before.

    First the displacement's least-squares polynomial t^2..t^6 is subtracted. Two slow waves under
    the envelope `shape` cancel the remaining end values exactly.
    """
    s = np.linspace(0.0, 1.0, len(acceleration))
    duration = dt * (len(acceleration) - 1)
    velocity = dt * np.concatenate(([0.0], np.cumsum(0.5 * (acceleration[1:] + acceleration[:-1]))))
    displacement = dt * np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))))
    powers = np.arange(2, 7)
    basis = s[:, None] ** powers
    factor = np.linalg.lstsq(basis, displacement, rcond=None)[0]
    drift = s[:, None] ** (powers - 2) @ (factor * powers * (powers - 1)) / duration**2
    corrected = acceleration - drift * np.minimum(1.0, shape / EDGE)
    waves = np.array([shape, shape * (1.0 - 2.0 * s)])
    ends = np.array([final_motion(wave, dt) for wave in waves]).T
    return corrected - np.linalg.solve(ends, final_motion(corrected, dt)) @ waves


def set_peak(acceleration: np.ndarray, dt: float, shape: np.ndarray) -> np.ndarray:
    """Record with a corrected baseline whose largest acceleration is 1 to one or two bits.

    Peaks beyond 1 are cut, a lower peak is raised over its half wave: both hardly change the
    spectrum.
    """
    record = correct_baseline(acceleration, dt, shape)
    for _ in range(4):
        place = int(np.abs(record).argmax())
        if np.abs(record[place]) < 1.0:
            signs = np.sign(record) != np.sign(record[place])
            before, after = np.flatnonzero(signs[:place]), np.flatnonzero(signs[place:])
            start = before[-1] + 1 if before.size else 0
            stop = place + after[0] if after.size else len(record)
            record[start:stop] /= np.abs(record[place])
        record = correct_baseline(np.clip(record, -1.0, 1.0), dt, shape)
    return record / np.abs(record).max()


def fit_motion(
    target: Callable[[np.ndarray], np.ndarray],
    seed: list[int],
    options: MotionOptions | None = None,
) -> Motion:
    """A record whose 5 % spectrum fits `target` and whose peak is target(0) = 1."""
    options = options or MotionOptions()
    shape = envelope(options)
    trials = [_fit_phases(target, [*seed, k], shape, options) for k in range(options.num_trials)]
    return min(trials, key=lambda motion: motion.score)


def _fit_phases(target, seed: list[int], shape: np.ndarray, options: MotionOptions) -> Motion:
    """The best record while scaling amplitudes, for one set of phases."""
    period, dt = options.periods(), options.dt
    goal = target(period)
    frequency = np.fft.rfftfreq(len(shape), dt)
    record = _first_guess(target, seed, options) * shape
    best = None
    for _ in range(options.num_scalings):
        spectrum = response_spectrum(record, dt, period)
        ratio = np.interp(frequency, 1.0 / period[::-1], (goal / spectrum)[::-1])
        change = np.fft.irfft(np.fft.rfft(record) * (ratio - 1.0), len(record))
        record = set_peak(record + change * np.minimum(1.0, shape / EDGE), dt, shape)
        found = Motion(record, period, response_spectrum(record, dt, period), goal)
        if best is None or found.score < best.score:
            best = found
    return best


def _first_guess(target, seed: list[int], options: MotionOptions) -> np.ndarray:
    """Stationary noise: amplitude falls with frequency as the spectrum's energy does."""
    count = len(options.times())
    frequency = np.fft.rfftfreq(count, options.dt)[1:]
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, frequency.size)
    period = 1.0 / frequency
    fall = np.minimum(1.0, period / options.shortest_period) ** 4
    level = target(period) * np.sqrt(period) * fall
    noise = np.fft.irfft(np.concatenate(([0.0], level * np.exp(1j * phase))), count)
    return noise / np.abs(noise).max()
