"""Artificial records of rising peaks and the table of their batch.

usage: records.py [COUNT]

Writes records/r001_x.txt, .. with a peak of 1 g (vertical: 2/3 of it), and values.csv. There the
records are spread over ten peaks, 0.05 g to 0.5 g. Record n is made with the seed n, and fits the
design spectrum of keyway_tools.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from keyway_tools.design_spectrum import VERTICAL_SHARE, DesignSpectrum
from keyway_tools.ground_motion import MotionOptions, fit_motion
from keyway_tools.motion_files import write_amplitude
from keyway_tools.response_spectrum import GRAVITY

PEAKS = np.linspace(0.05, 0.5, 10)  # [g]
SHARES = {"x": 1.0, "y": 1.0, "z": VERTICAL_SHARE}
# One set of phases, few scalings: the spectra of the records scatter around the target.
TIMES = MotionOptions(
    duration=8.0, rise=0.8, strong=4.8, taper=0.32, num_periods=50, num_scalings=8, num_trials=1
)


def main() -> None:
    """Write the records and the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    folder = Path("records")
    folder.mkdir(exist_ok=True)
    rows, misfits = ["case,RECORD,PGA"], []
    for number in range(1, count + 1):
        name, peak = f"r{number:03d}", PEAKS[(number - 1) * len(PEAKS) // count]
        for place, (axis, share) in enumerate(SHARES.items()):
            motion = fit_motion(DesignSpectrum(), [number, place], TIMES)
            acceleration = share * GRAVITY * motion.acceleration
            write_amplitude(folder / f"{name}_{axis}.txt", acceleration, TIMES.dt, "VALUES")
            misfits.append(motion.mean_misfit)
        rows.append(f"{name},{name},{peak:.2f}")
    Path("values.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    print(f"{count} records; mean misfit of their spectra {100.0 * np.mean(misfits):.1f} %")


if __name__ == "__main__":
    main()
