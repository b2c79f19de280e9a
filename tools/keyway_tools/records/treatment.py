"""What is done to records before a run: cut, resampled, base line, scale."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from scipy.signal import resample_poly

from ..ground_motion import correct_baseline
from ..response_spectrum import GRAVITY, response_spectrum
from .record import Record, RecordError

TAPER = 0.05  # of the duration, at both ends of a corrected record
LARGEST_FRACTION = 1000
MOST_VALUES = 1e6  # of a record: files of some 20 MB


def cut(record: Record, start: float, end: float) -> Record:
    """The values from one time to another [s]; the record then begins at 0."""
    first, last = round(start / record.dt), round(end / record.dt)
    if not 0 <= first < last < record.acceleration.size:
        longest = record.dt * (record.acceleration.size - 1)
        raise RecordError(
            f"{record.source}: cut from {start:g} to {end:g} s; it has 0 to {longest:g} s"
        )
    return record.with_values(record.acceleration[first : last + 1])


def resample(record: Record, dt: float) -> Record:
    """Values at other times [s]: straight lines to shorter steps, a filter to longer ones."""
    if abs(dt / record.dt - 1.0) < 1e-9:
        return record
    duration = record.dt * (record.acceleration.size - 1)
    longest = min(duration, LARGEST_FRACTION * record.dt)
    if not duration / MOST_VALUES <= dt <= longest:
        raise RecordError(
            f"{record.source}: {dt:g} s between values; expected {duration / MOST_VALUES:g} to "
            f"{longest:g} s"
        )
    if dt < record.dt:
        times = dt * np.arange(int(duration / dt + 1e-9) + 1)
        own = record.dt * np.arange(record.acceleration.size)
        return record.with_values(np.interp(times, own, record.acceleration), dt)
    ratio = Fraction(record.dt / dt).limit_denominator(LARGEST_FRACTION)
    values = resample_poly(record.acceleration, ratio.numerator, ratio.denominator)
    return record.with_values(values[: int(duration / dt + 1e-9) + 1], dt)


def same_times(records: dict[str, Record], dt: float | None) -> dict[str, Record]:
    """All components with one time step, as long as the shortest."""
    step = dt or min(record.dt for record in records.values())
    records = {axis: resample(record, step) for axis, record in records.items()}
    count = min(record.acceleration.size for record in records.values())
    return {a: r.with_values(r.acceleration[:count]) for a, r in records.items()}


def settle(record: Record) -> Record:
    """A corrected base line: at rest at both ends, without slow drift between."""
    count = record.acceleration.size
    time = np.linspace(0.0, 1.0, count)
    edge = np.minimum(time, 1.0 - time) / TAPER
    shape = 0.5 * (1.0 - np.cos(np.pi * np.minimum(1.0, edge)))
    tapered = record.acceleration * shape
    try:
        return record.with_values(correct_baseline(tapered, record.dt, shape))
    except np.linalg.LinAlgError:
        raise RecordError(
            f"{record.source}: a record of {count} values is too short for --baseline"
        ) from None


def factor_to_peak(horizontal: list[Record], peak: float) -> float:
    """The factor that gives the larger of the horizontal components a peak [g]."""
    return peak * GRAVITY / max(record.peak for record in horizontal)


def factor_to_spectrum(
    horizontal: list[Record],
    target: Callable[[np.ndarray], np.ndarray],
    peak: float,
    periods: tuple[float, float],
) -> float:
    """The factor that brings the geometric mean of the spectra to a target over some periods.

    The mean is that of the logarithms of target over spectrum (ASCE/SEI 7-16, 16.2.3.2, scales to a
    target over a range of periods in the same way). `target` is that over its peak [g].
    """
    at = np.geomspace(*periods, 60)
    step = max(record.dt for record in horizontal)
    if periods[0] < step:
        raise RecordError(
            f"--fit: periods from {periods[0]:g} s; expected at least the time between values, "
            f"{step:g} s"
        )
    spectra = [response_spectrum(r.acceleration, r.dt, at) for r in horizontal]
    if min(spectrum.min() for spectrum in spectra) <= 0.0:
        raise RecordError(f"--fit: the spectrum is zero at periods up to {periods[1]:g} s")
    spectra = [np.log(spectrum) for spectrum in spectra]
    return float(np.exp(np.mean(np.log(peak * GRAVITY * target(at)) - np.mean(spectra, axis=0))))


def strong_duration(record: Record) -> float:
    """Time between 5 and 95 % of the integral of the squared acceleration (Arias) [s]."""
    energy = np.cumsum(record.acceleration**2)
    first, last = np.searchsorted(energy, [0.05 * energy[-1], 0.95 * energy[-1]])
    return float(record.dt * (last - first))
