"""Wall time and memory of a process and its children."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path


def run_timed(
    command: list[str], folder: Path, limit: float, **environment: str
) -> tuple[float, float, int]:
    """Wall time [s], largest resident size [MB] and exit code; -9 after `limit` seconds."""
    with (folder / "output.txt").open("w") as output:
        start = time.monotonic()
        process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env={**os.environ, **environment},
        )
        while True:
            done, status, usage = os.wait4(process.pid, os.WNOHANG)
            if done:
                break
            if time.monotonic() - start > limit:
                process.kill()
            time.sleep(0.02)
    process.returncode = os.waitstatus_to_exitcode(status)
    return time.monotonic() - start, usage.ru_maxrss / 1024.0, process.returncode
