"""A cluster of Dask on this machine."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from harness import ROOT


class Cluster:
    """A scheduler of Dask and two workers, each a process."""

    def __init__(self, place: Path):
        self.place = place
        self.environment = {**os.environ, "PYTHONPATH": str(ROOT / "tools")}
        self.processes: list[subprocess.Popen[bytes]] = []
        self.start("scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard")
        self.file = place / "scheduler.json"
        self.wait_for(self.file.exists)
        self.address = json.loads(self.file.read_text())["address"]
        self.workers = [self.start("worker", "--no-nanny", "--nthreads", "1", "--no-dashboard")
                        for _ in range(2)]  # fmt: skip

    def start(self, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "dask", *words, "--scheduler-file", "scheduler.json"]
        if words[0] == "worker":
            command += ["--local-directory", str(self.place)]
        process = subprocess.Popen(
            command, cwd=self.place, env=self.environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.processes.append(process)
        return process

    def wait_for(self, condition, seconds: float = 60.0) -> None:
        until = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < until, "the cluster does not start"
            time.sleep(0.1)

    def end(self) -> None:
        for process in reversed(self.processes):
            process.kill()
            process.wait()
