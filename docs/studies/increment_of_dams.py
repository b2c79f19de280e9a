"""What the size of the increment does to maxima and to histories of openings of a jointed dam.

    python docs/studies/increment_of_dams.py PROGRAM FOLDER [accuracy]

With `accuracy` the increments follow their estimated error (*CONTROLS, ACCURACY).

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

from dam_trials import UNDAMPED, deck_of, run_trial, trial_of  # noqa: E402
from harness import Program, Run  # noqa: E402

DAMPED = (0.05, 2.0, 10.0)
TRIALS = ((0.5, DAMPED), (1.0, DAMPED), (2.0, DAMPED), (1.0, UNDAMPED))
REFERENCE, INCREMENTS = 0.00125, (0.01, 0.005, 0.0025)  # [s]
ASKED = (0.1, 0.05, 0.02)
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
            runs[dt] = run_trial(
                Program(Path(program).resolve(), place, 1, 3600.0), trial, name=f"dam{dt}"
            )
        exact = largest(runs[REFERENCE])
        for dt in INCREMENTS:
            share = 100.0 * np.abs(largest(runs[dt]) / exact - 1.0)
            histories = 100.0 * np.array(errors_of_histories(runs[dt], runs[REFERENCE]))
            row = "".join(f"{value:6.2f}%" for value in share)
            span = f"{histories.min():.1f} to {histories.max():.1f}%"
            print(f"{size:6.1f} {damping[0]:8.2f} {dt:10.4f} {row}  {span}", flush=True)


def with_accuracy(program: str, folder: str) -> None:
    """One dam whose increments follow their error."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    own = Program(Path(program).resolve(), place, 1, 3600.0)
    reference = run_trial(own, trial_of(1.0, 1e11, REFERENCE, DAMPED), name="fine")
    exact = largest(reference)
    text, files = deck_of(trial_of(1.0, 1e11, 0.01, DAMPED))
    print("| ACCURACY | increments | max S1 | max U | max opening | openings at one time |")
    for asked in ASKED:
        cards = f"0.01, 4\n*CONTROLS, ACCURACY={asked}\n"
        deck = text.replace("*DYNAMIC, DIRECT", "*DYNAMIC").replace("0.01, 4\n", cards)
        run = own(deck, name=f"asked{asked}", files=files)
        share = 100.0 * np.abs(largest(run) / exact - 1.0)
        histories = 100.0 * max(errors_of_histories(run, reference))
        (found,) = run.json["accuracy"]["increments"].values()
        sizes = sorted(found["sizes"], key=lambda item: -item["size"])
        steps = ", ".join(f"{item['increments']} of {item['size']:g} s" for item in sizes)
        row = f"| {asked} | {steps} | {share[0]:.2f} % | {share[2]:.2f} % | {share[3]:.2f} % |"
        print(f"{row} {histories:.1f} % |", flush=True)


if __name__ == "__main__":
    if sys.argv[3:] == ["accuracy"]:
        with_accuracy(*sys.argv[1:3])
    else:
        main(*sys.argv[1:])
