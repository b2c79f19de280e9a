"""Fractiles of the largest opening and fragility curves, from the table of a batch.

usage: fragility.py [batch.csv | batch.parquet]

Writes fragility.png and fragility.csv. The curves are lognormal, fitted by maximum likelihood to
the numbers of records of each peak that exceed the opening (Baker, Earthquake Spectra 31, 2015,
Eq. 11).
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.stats import norm

LIMITS = {0.005: "C0", 0.01: "C1", 0.02: "C3"}  # openings [m] and their colours
FRACTILES = (0.16, 0.5, 0.84)


def lognormal(peaks: np.ndarray, exceeds: np.ndarray) -> tuple[float, float]:
    """Median [g] and deviation of ln(peak) of the lognormal curve; NaN where none can be fitted.

    `exceeds` are the answers of all records. Where all answers of lower peaks are no and of higher
    ones yes, the deviation is not determined.
    """
    if why_no_curve(peaks, exceeds):
        return float("nan"), float("nan")

    def misfit(guess: np.ndarray) -> float:
        place = (np.log(peaks) - guess[0]) / np.exp(guess[1])
        return -norm.logcdf(np.where(exceeds, place, -place)).sum()

    start = [np.log(peaks).mean(), np.log(0.4)]
    found = minimize(misfit, start, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-9})
    return float(np.exp(found.x[0])), float(np.exp(found.x[1]))


def why_no_curve(peaks: np.ndarray, exceeds: np.ndarray) -> str:
    """Why no lognormal curve can be fitted; '' where one can."""
    if exceeds.all():
        return "all records exceed it: take smaller peaks"
    if not exceeds.any():
        return "no record exceeds it: take larger peaks"
    last, first = peaks[~exceeds].max(), peaks[exceeds].min()
    if first <= last:
        return ""
    return f"no record up to {last:g} g exceeds it, all from {first:g} g on do: take closer peaks"


def main() -> None:
    """Read the table, write the picture and the numbers."""
    path = Path(sys.argv[1] if len(sys.argv) > 1 else "results/batch.csv")
    table = pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path)
    failed = table[table["status"] != "finished"]
    if len(failed) > 0:
        sys.exit(f"{len(failed)} records have not finished: {', '.join(failed['case'][:5])} ..")
    peaks, opening = table["PGA"].to_numpy(), table["OPENING"].to_numpy()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    fractiles = table.groupby("PGA")["OPENING"].quantile(list(FRACTILES)).unstack() * 1e3
    left.plot(peaks, 1e3 * opening, ".", color="0.7", label="records")
    left.fill_between(fractiles.index, fractiles[0.16], fractiles[0.84], alpha=0.25)
    left.plot(fractiles.index, fractiles[0.5], "o-", label="median; 16 % and 84 %")
    left.set(xlabel="peak [g]", ylabel="largest opening of the joints [mm]", ylim=(0, None))
    left.legend()
    rows, remarks = [], []
    fine = np.linspace(0.01, 1.1 * peaks.max(), 200)
    for limit, colour in LIMITS.items():
        exceeds = opening > limit
        share = table.assign(exceeds=exceeds).groupby("PGA")["exceeds"].mean()
        median, deviation = lognormal(peaks, exceeds)
        rows.append({"opening_m": limit, "median_g": median, "deviation": deviation})
        label = f"> {1e3 * limit:g} mm"
        if np.isfinite(median):
            right.plot(fine, norm.cdf(np.log(fine / median) / deviation), color=colour)
        else:
            remarks.append(f"opening {label}: no curve, {why_no_curve(peaks, exceeds)}")
            label += ", no curve"
        right.plot(share.index, share, "o", color=colour, label=label)
    right.set(xlabel="peak [g]", ylabel="share of records", ylim=(-0.02, 1.02))
    right.legend(title="opening", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    figure.savefig("fragility.png", dpi=130)
    numbers = pd.DataFrame(rows)
    numbers.to_csv("fragility.csv", index=False)
    print(fractiles.round(2).to_string())
    print(numbers.round(3).to_string(index=False, na_rep="-"))
    print(*remarks, sep="\n")


if __name__ == "__main__":
    main()
