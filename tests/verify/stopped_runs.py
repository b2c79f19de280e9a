"""Runs that are stopped and go on from their last checkpoint, for the tests."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from collections.abc import Iterable
from pathlib import Path


def stop_after(program, folder, deck, increments: int) -> bool:
    """Stops a run by SIGTERM once its table of energies has so many rows; whether in time."""
    process = subprocess.Popen([program, "-q", "-j", "1", "-o", folder, deck])
    table = folder / "job_energy.csv"
    while process.poll() is None:
        if table.exists() and table.read_text().count("\n") > increments:
            process.send_signal(signal.SIGTERM)
            break
        time.sleep(0.001)  # leaves the processor to the run
    process.wait()
    return json.loads((folder / "job.json").read_text())["status"] == "stopped"


def stops_that_go_on(program, place: Path, deck: Path, increments: Iterable[int]) -> int:
    """Stops a run after each number of increments and continues it: all tables are the whole run's.

    Returns how many of the runs were stopped in time.
    """

    def tables(name: str, *options: str) -> dict[str, str]:
        folder = place / name
        subprocess.run([program, "-q", "-j", "1", "-o", folder, *options, deck], check=True)
        return {path.name: path.read_text() for path in folder.glob("*.csv")}

    whole = tables("whole")
    stopped = 0
    for number in increments:
        stopped += stop_after(program, place / f"stop{number}", deck, number)
        assert tables(f"stop{number}", "--continue") == whole
    return stopped
