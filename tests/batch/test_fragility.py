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


@pytest.fixture
def cluster(tmp_path):
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


def test_records_on_a_cluster_that_loses_a_worker(cluster, program_path, tmp_path):
    for file in EXAMPLE.iterdir():
        shutil.copy(file, tmp_path)
    call = {"cwd": tmp_path, "env": cluster.environment, "check": True, "timeout": 280}
    subprocess.run([sys.executable, "records.py", "4"], **call)
    page = (ROOT / "docs/fragility.md").read_text(encoding="utf-8")
    subprocess.run(re.search(r"^sed .*$", page, re.M)[0], shell=True, **call)
    command = [sys.executable, ROOT / "tools/batch.py", "dam.inp", "--table", "values.csv"]
    command += ["-o", "results", "--program", program_path.resolve(), "--threads", "1"]
    command += ["--on", cluster.address.replace("tcp://", "dask://"), "--", "-q"]
    child = subprocess.Popen(command, cwd=tmp_path, env=cluster.environment)
    cluster.wait_for(lambda: len(list(tmp_path.glob("results/*/r*.lock"))) > 0, 120.0)
    cluster.workers[0].send_signal(signal.SIGKILL)
    assert child.wait(timeout=280) == 0
    table = pd.read_parquet(tmp_path / "results/batch.parquet")
    assert list(table["status"]) == ["finished"] * 4
    assert list(table["PGA"]) == [0.05, 0.15, 0.3, 0.4]
    assert table["OPENING"].iloc[0] < table["OPENING"].iloc[-1]
    numbers = pd.read_csv(tmp_path / "results/batch.csv")
    assert list(numbers["OPENING"]) == pytest.approx(list(table["OPENING"]), rel=1e-12)
    subprocess.run([sys.executable, "fragility.py", "results/batch.parquet"], **call)
    assert (tmp_path / "fragility.png").stat().st_size > 10_000
