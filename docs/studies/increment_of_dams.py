"""What the size of the increment does to maxima and to histories of openings of a jointed dam.

    python docs/studies/increment_of_dams.py PROGRAM FOLDER

The dam of tests/dam_trials.py (135.5 m, 3000 unknowns, massless rock, two joints of k_n 1e11
Pa/m) under 2.5 s of motion that fits a design spectrum and 1.5 s of free vibration. Reference:
increments of 0.00125 s. S1, S3, U, OPENING: difference of the largest value anywhere, over it.
Histories: the largest difference of the opening of a crest point at one time, over the largest
opening of that point; the smallest and the largest of four points.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tools")]

from dam_trials import UNDAMPED, run_trial, trial_of  # noqa: E402
from harness import Program, Run  # noqa: E402

DAMPED = (0.05, 2.0, 10.0)
TRIALS = ((0.5, DAMPED), (1.0, DAMPED), (2.0, DAMPED), (1.0, UNDAMPED))
REFERENCE, INCREMENTS = 0.00125, (0.01, 0.005, 0.0025)  # [s]
FIELDS = ("S1", "S3", "U", "OPENING")


def largest(run: Run) -> np.ndarray:
    """The largest values of FIELDS."""
    return np.array([run.json["envelopes"][name]["anywhere"]["value"] for name in FIELDS])


def openings(run: Run) -> list[tuple[np.ndarray, np.ndarray]]:
    """Times and openings of each printed point of a joint."""
    histories = []
    for file in sorted(run.folder.glob("*_joint_*.csv")):
        table = np.genfromtxt(file, delimiter=",", names=True, dtype=None, encoding="utf-8")
        for point in np.unique(table["point"]):
            rows = table[table["point"] == point]
            histories.append((rows["time"], rows["opening"]))
    return histories


def errors_of_histories(run: Run, reference: Run) -> list[float]:
    found = []
    for (time, opening), (fine, exact) in zip(openings(run), openings(reference), strict=True):
        wrong = np.abs(opening - np.interp(time, fine, exact)).max()
        found.append(float(wrong / np.abs(exact).max()))
    return found


def main(program: str, folder: str) -> None:
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    print("motion  damping  increment     S1     S3      U  OPENING  histories")
    for size, damping in TRIALS:
        runs = {}
        for dt in (REFERENCE, *INCREMENTS):
            trial = trial_of(size, 1e11, dt, damping)
            runs[dt] = run_trial(Program(Path(program), place, 1, 3600.0), trial, name=f"dam{dt}")
        exact = largest(runs[REFERENCE])
        for dt in INCREMENTS:
            share = 100.0 * np.abs(largest(runs[dt]) / exact - 1.0)
            histories = 100.0 * np.array(errors_of_histories(runs[dt], runs[REFERENCE]))
            row = "".join(f"{value:6.2f}%" for value in share)
            span = f"{histories.min():.1f} to {histories.max():.1f}%"
            print(f"{size:6.1f} {damping[0]:8.2f} {dt:10.4f} {row}  {span}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
