"""docs/fragility.md on a cluster of Dask that loses one of its two workers."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys

import pandas as pd
import pytest
from dask_cluster import Cluster
from harness import ROOT

EXAMPLE = ROOT / "input" / "fragility"
PEAKS = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5]  # [g]


@pytest.fixture
def cluster(tmp_path):
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


@pytest.mark.parametrize("count", [4, pytest.param(200, marks=pytest.mark.full)])
def test_records_on_a_cluster_that_loses_a_worker(cluster, program_path, tmp_path, count):
    for file in EXAMPLE.iterdir():
        shutil.copy(file, tmp_path)
    limit = 280 if count == 4 else 3000
    call = {"cwd": tmp_path, "env": cluster.environment, "check": True, "timeout": limit}
    subprocess.run([sys.executable, "records.py", str(count)], **call)
    page = (ROOT / "docs/fragility.md").read_text(encoding="utf-8")
    subprocess.run(re.search(r"^sed .*$", page, re.M)[0], shell=True, **call)
    command = [sys.executable, ROOT / "tools/batch.py", "dam.inp", "--table", "values.csv"]
    command += ["-o", "results", "--program", program_path.resolve(), "--threads", "1"]
    command += ["--on", cluster.address.replace("tcp://", "dask://"), "--", "-q"]
    child = subprocess.Popen(command, cwd=tmp_path, env=cluster.environment)
    started = count // 4  # when the worker is lost
    cluster.wait_for(lambda: len(list(tmp_path.glob("results/*/r*.log"))) >= started, limit)
    cluster.workers[0].send_signal(signal.SIGKILL)
    assert child.wait(timeout=limit) == 0
    table = pd.read_parquet(tmp_path / "results/batch.parquet")
    assert list(table["status"]) == ["finished"] * count
    assert list(table["PGA"]) == [PEAKS[n * len(PEAKS) // count] for n in range(count)]
    assert table["OPENING"].iloc[0] < table["OPENING"].iloc[-1]
    assert (tmp_path / "results/batch_fractiles.png").stat().st_size > 10_000
    numbers = pd.read_csv(tmp_path / "results/batch.csv")
    assert list(numbers["OPENING"]) == pytest.approx(list(table["OPENING"]), rel=1e-12)
    subprocess.run([sys.executable, "fragility.py", "results/batch.parquet"], **call)
    assert (tmp_path / "fragility.png").stat().st_size > 10_000
    if count == 200:
        medians = [float(x) for x in re.findall(r"^\| +\d+ mm \| ([\d.]+)", page, re.M)]
        found = pd.read_csv(tmp_path / "fragility.csv")["median_g"]
        assert list(found) == pytest.approx(medians, abs=0.001)  # the page gives three digits


def test_a_limit_without_a_curve_is_explained(tmp_path):
    """Four records of each peak: 5 mm are between two peaks, 1 mm below and 1 m above them all."""
    script = (EXAMPLE / "fragility.py").read_text(encoding="utf-8")
    limits = 'LIMITS = {0.001: "C2", 0.005: "C0", 0.01: "C1", 1.0: "C3"}'
    script = re.sub(r"^LIMITS = .*?}", limits, script, flags=re.M)
    (tmp_path / "fragility.py").write_text(script, encoding="utf-8")
    openings = {0.1: [2, 3, 3, 4], 0.15: [6, 7, 7, 8], 0.2: [9, 9, 11, 12], 0.3: [9, 15, 16, 18]}
    rows = [(peak, 1e-3 * one) for peak, values in openings.items() for one in values]
    table = pd.DataFrame(rows, columns=["PGA", "OPENING"]).assign(case="r", status="finished")
    table.to_csv(tmp_path / "batch.csv", index=False)
    done = subprocess.run(
        [sys.executable, "fragility.py", "batch.csv"],
        cwd=tmp_path, capture_output=True, text=True, check=True, timeout=100,
    )  # fmt: skip
    text = done.stdout
    assert "opening > 1 mm: no curve, all records exceed it: take smaller peaks" in text
    assert (
        "opening > 5 mm: no curve, no record up to 0.1 g exceeds it, all from 0.15 g on do: take "
        "closer peaks" in text
    )
    assert "opening > 10 mm: no curve" not in text
    assert "opening > 1000 mm: no curve, no record exceeds it: take larger peaks" in text
    assert "NaN" not in text
