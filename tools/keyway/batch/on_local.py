"""Runs a plan on this machine."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from keyway_tools.deck_runs import Record

from .plan import Plan

REQUESTS = (signal.SIGINT, signal.SIGTERM)  # to end the runs


def interrupt(*_: object) -> None:
    """Interrupts once: timeout sends its signal to the process and then to its group, too.

    Further signals do nothing here. They are not ignored, for a run that starts now would ignore
    them, too.
    """
    for number in REQUESTS:
        signal.signal(number, lambda *_: None)
    raise KeyboardInterrupt


def run_locally(
    plan: Plan, at_a_time: int, say: Callable[[str], None]
) -> tuple[list[Record], bool]:
    """Run all tasks, `at_a_time` at once; their records, and whether they were interrupted."""
    runner = plan.runner()
    usual = {number: signal.getsignal(number) for number in REQUESTS}
    for number in REQUESTS:
        if usual[number] != signal.SIG_IGN:  # as SIGINT in a background job of a shell
            signal.signal(number, interrupt)
    done = 0
    with ThreadPoolExecutor(at_a_time) as pool:
        futures = [
            pool.submit(runner.run, Path(deck), Path(folder), plan.again)
            for deck, folder in plan.tasks
        ]
        try:
            for future in futures:
                record = future.result()
                done += 1
                kept = " (kept)" if record.was_kept else ""
                name = Path(record.folder).name
                say(f"{done}/{len(futures)} {name}: {record.status}{kept}")
        except KeyboardInterrupt:
            print("batch: interrupted, ending the runs", file=sys.stderr)
            runner.end()
    for number in REQUESTS:
        signal.signal(number, usual[number])
    return [future.result() for future in futures], runner.is_ending
