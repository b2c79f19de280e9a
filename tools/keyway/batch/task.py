"""One run of a plan as a process: python -m keyway.batch.task PLAN NUMBER.

The process ends its run when it is asked to end, and when the process that started it is gone: a
worker that is lost leaves no run behind. The run leaves its record in the folder of its results.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from keyway_tools.deck_runs import end_with_parent

from .plan import Plan


def main(arguments: list[str]) -> int:
    """Run a task; exit code 0 where its run has finished, now or before."""
    plan, number = Plan.read(Path(arguments[0])), int(arguments[1])
    parent = os.getppid()
    end_with_parent()
    if os.getppid() != parent:  # it ended before the request
        return 1

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, stop)
    runner = plan.runner()
    deck, folder = (Path(word) for word in plan.tasks[number])
    try:
        record = runner.run(deck, folder, plan.again)
    except KeyboardInterrupt:
        runner.stop()
        return 1
    print(f"{folder.name}: {record.status}", flush=True)
    return 0 if record.status == "finished" else 1


def run_as_process(plan: str, number: int) -> dict[str, Any]:
    """Run a task in a process of its own; on a worker of Dask. The answer names the task.

    Raises RuntimeError where the process itself fails.
    """
    command = [sys.executable, "-m", "keyway.batch.task", plan, str(number)]
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"task {number}: {done.stderr.strip()[-2000:]}")
    return {"number": number, "text": done.stdout.strip()}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
