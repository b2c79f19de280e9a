"""Runs a plan as an array of jobs of Slurm."""

from __future__ import annotations

import math
import shlex
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .cases import BatchError
from .plan import Forecast, Plan, forecast

# What is asked for, over the forecast: it is that of an idle machine, perhaps a faster one.
TIME_FACTOR, TIME_MORE = 3.0, 600.0  # [s]
MEMORY_FACTOR, MEMORY_MORE = 1.5, 200.0  # [MB]


@dataclass(frozen=True)
class Request:
    """What each job of the array gets."""

    threads: int
    minutes: int | None  # None: the limit of the partition
    memory: int | None  # [MB]; None: what the partition gives


def request_for(plan: Plan, numbers: list[int], threads: int, minutes: int | None,
                memory: int | None) -> Request:  # fmt: skip
    """Time and memory as given, else from the largest forecast of different meshes."""
    if minutes is not None and memory is not None:
        return Request(threads, minutes, memory)
    said = [one for one in (forecast(plan, number) for number in numbers) if one]
    if not said:
        return Request(threads, minutes, memory)
    most = Forecast(max(one.time for one in said), max(one.memory for one in said))
    if minutes is None:
        minutes = math.ceil((TIME_FACTOR * most.time + TIME_MORE) / 60.0)
    if memory is None:
        memory = math.ceil(MEMORY_FACTOR * most.memory + MEMORY_MORE)
    return Request(threads, minutes, memory)


def script_of(plan_file: Path, numbers: list[int], at_a_time: int, request: Request,
              more: list[str]) -> str:  # fmt: skip
    """The script of the array: a task of the plan for each index."""
    folder = plan_file.parent.resolve()
    lines = [
        "#!/bin/sh",
        f"#SBATCH --job-name={_word(folder.name)}",
        f"#SBATCH --array={ranges_of(numbers)}%{at_a_time}",
        f"#SBATCH --output={_word(str(folder / 'slurm_%A_%a.out'))}",
        "#SBATCH --ntasks=1",
        f"#SBATCH --cpus-per-task={request.threads}",
        *([] if request.minutes is None else [f"#SBATCH --time={request.minutes}"]),
        *([] if request.memory is None else [f"#SBATCH --mem={request.memory}M"]),
        *(f"#SBATCH {option}" for option in more),
    ]
    words = [sys.executable, "-m", "keyway.batch.task", str(plan_file.resolve())]
    path = shlex.quote(str(Path(__file__).resolve().parents[2]))
    lines += [
        f"PYTHONPATH={path}${{PYTHONPATH:+:$PYTHONPATH}}",
        "export PYTHONPATH",
        f'exec {" ".join(map(shlex.quote, words))} "$SLURM_ARRAY_TASK_ID"',
    ]
    return "\n".join(lines) + "\n"


def _word(text: str) -> str:
    """A value for a line of #SBATCH: quoted where it holds blanks."""
    return f'"{text}"' if " " in text else text


def ranges_of(numbers: list[int]) -> str:
    """[0, 1, 2, 5] as '0-2,5'."""
    parts: list[list[int]] = []
    for number in sorted(numbers):
        if parts and number == parts[-1][-1] + 1:
            parts[-1][1:] = [number]
        else:
            parts.append([number])
    return ",".join("-".join(map(str, part)) for part in parts)


def run_on_slurm(plan: Plan, file: Path, script: str, say: Callable[[str], None]) -> bool:
    """Submit the script and wait for the end of the array; False if interrupted.

    Raises BatchError where sbatch is missing or refuses the script.
    """
    plan.write(file)
    path = file.with_name("batch.sbatch")
    path.write_text(script, encoding="utf-8")
    say(f"submitting {path}")
    try:
        done = subprocess.run(["sbatch", "--wait", str(path)], stdin=subprocess.DEVNULL)
    except FileNotFoundError as error:
        raise BatchError("--on slurm: there is no sbatch in the PATH") from error
    except KeyboardInterrupt:
        say("batch: interrupted; the jobs of the array go on: scancel ends them")
        return False
    # sbatch --wait gives the largest exit code of the jobs: 1 is a run that did not finish.
    if done.returncode > 1:
        raise BatchError(f"sbatch ended with exit code {done.returncode}")
    return True
