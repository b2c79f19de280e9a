"""Runs a plan on a cluster of Dask.

Each worker needs this package, the program at the same path, and the folders of decks and results:
a shared disk. Threads of a worker run that many tasks at a time: `dask worker --nthreads 1`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from .cases import BatchError
from .plan import Plan
from .task import run_as_process


def run_on_dask(plan: Plan, file: Path, address: str, say: Callable[[str], None]) -> bool:
    """Run the unfinished tasks of a plan, which is written to `file`; False if interrupted.

    Tasks of a worker that is lost are run by others; one that has lost several workers is given up
    (allowed-failures of the scheduler, 3). Raises BatchError without the package
    distributed, OSError where there is no scheduler at the address.
    """
    try:
        from distributed import Client, as_completed
        from distributed.scheduler import KilledWorker
    except ImportError as error:
        raise BatchError("--on dask://..: expected the package 'distributed' (pip install "
                         "'keyway[dask]')") from error  # fmt: skip
    numbers = plan.unfinished()
    plan.write(file)
    with Client(address.replace("dask://", "tcp://")) as client:
        futures = [
            client.submit(run_as_process, str(file.resolve()), number, pure=False)
            for number in numbers
        ]
        try:
            for done, future in enumerate(as_completed(futures), 1):
                try:
                    say(f"{done}/{len(futures)} {future.result()['text']}")
                except (KilledWorker, RuntimeError) as error:
                    say(f"{done}/{len(futures)} {error}")
        except KeyboardInterrupt:
            client.cancel(futures)
            say("batch: interrupted; runs that have started go on to their end")
            return False
    return True
