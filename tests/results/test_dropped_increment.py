"""A signal in an increment of long iterations: the increment is dropped, and done again later."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from restart_case import LAST, deck, differences, kill_at, start

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
RESTART = "*RESTART, WRITE, FREQUENCY=4\n"
# The steel yields, in 10 to 12 iterations of one increment.
STILL = """*STEP, NAME=STILL
*STATIC
1., 1.
*CLOAD
TOP, 3, -1.2e4
*END STEP
"""
SLOW_PART = """  implicit none
  interface
    integer(4) function usleep(microseconds) bind(c, name='usleep')
      integer(4), value :: microseconds
    end function usleep
  end interface
  integer(4) :: status_of_sleep
  logical :: is_slow
"""
SLEEP = """  inquire (file='slow', exist=is_slow)
  if (kinc == 1 .and. .not. is_slow) then
    inquire (file='slow_'//achar(iachar('0') + kstep(1)), exist=is_slow)
  end if
  if (is_slow) status_of_sleep = usleep(100000)
  if (is_slow) open (unit=77, file='was_slow')
  if (is_slow) close (77)
"""


@pytest.fixture(scope="module")
def slow_umat(program_path: Path, tmp_path_factory) -> Path:
    """The UMAT of the deck; where a file 'slow' is in the folder of the run, a call takes 0.1 s.

    With a file 'slow_3' this holds for the first increment of step 3.
    """
    folder = tmp_path_factory.mktemp("umat")
    text = UMAT.read_text()
    first = text.index("  implicit none\n")
    place = re.compile(r"^  [a-z]\w* = ", re.MULTILINE).search(text, first).start()
    text = (
        text[:first]
        + SLOW_PART
        + text[first + len("  implicit none\n") : place]
        + SLEEP
        + text[place:]
    )
    (folder / "slow_j2.f90").write_text(text)
    library = folder / "j2.so"
    subprocess.run(
        [program_path, "--umat", folder / "slow_j2.f90", "--umat-library", library], check=True
    )
    return library


@pytest.mark.parametrize(
    "controls", ["", "*CONTROLS, TANGENT=CONSISTENT\n"], ids=["auto", "tangent"]
)
def test_a_long_increment_is_dropped(program_path, slow_umat, tmp_path, controls):
    path, out, whole = tmp_path / "job.inp", tmp_path / "out", tmp_path / "whole"
    path.write_text(deck(controls=controls))
    arguments = ["-q", "-j", "1", "--umat", slow_umat]
    subprocess.run([program_path, *arguments, "-o", whole, path], check=True, cwd=tmp_path)
    table = out / "job_energy.csv"
    num_dropped = 0
    more: list[str] = []
    for row in (5, 30, 60, 90):
        process = start(program_path, *arguments, *more, "-o", out, path, cwd=tmp_path)
        kill_at(process, table, row, 0, 0.0)
        (tmp_path / "slow").touch()
        time.sleep(0.5)  # an iteration has begun
        process.send_signal(signal.SIGTERM)
        _, text = process.communicate(timeout=60)
        (tmp_path / "slow").unlink()
        assert process.returncode == 1, text
        summary = json.loads((out / "job.json").read_text())
        assert summary["status"] == "stopped"
        assert "stopped by SIGTERM" in summary["message"]
        num_dropped += "the next increment is dropped" in summary["message"]
        more = ["--continue"]
    assert num_dropped >= 2
    subprocess.run(
        [program_path, *arguments, "--continue", "-o", out, path], check=True, cwd=tmp_path
    )
    assert differences(whole, out) == []


@pytest.mark.parametrize(
    ("step", "name"), [(1, "WEIGHT"), (3, "QUAKE"), (4, "AFTER"), (5, "STILL")]
)
def test_a_signal_in_the_first_increment(program_path, slow_umat, tmp_path, step, name):
    """Without *RESTART: the checkpoint is that of the start of the step."""
    path, out, whole = tmp_path / "job.inp", tmp_path / "out", tmp_path / "whole"
    path.write_text(deck(last=LAST.format(force=100) + STILL).replace(RESTART, ""))
    arguments = ["-q", "-j", "1", "--umat", slow_umat]
    subprocess.run([program_path, *arguments, "-o", whole, path], check=True, cwd=tmp_path)
    (tmp_path / f"slow_{step}").touch()
    process = start(program_path, *arguments, "-o", out, path, cwd=tmp_path)
    # The laws are called before the files of the run are opened, too.
    while not ((tmp_path / "was_slow").exists() and (out / "job.json").exists()):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, text = process.communicate(timeout=60)
    (tmp_path / f"slow_{step}").unlink()
    assert process.returncode == 1, text
    message = json.loads((out / "job.json").read_text())["message"]
    places = ("at the start", "after increment 1")  # an iteration that converges is not dropped
    assert any(f"stopped by SIGTERM {place} of step '{name}'" in message for place in places)
    arguments += ["--continue", "-o", out, path]
    subprocess.run([program_path, *arguments], check=True, cwd=tmp_path)
    assert differences(whole, out) == []


def test_a_step_that_has_not_begun_may_be_changed(program_path, slow_umat, tmp_path):
    """With *RESTART the checkpoint of the end of the step before is kept."""
    path, out = tmp_path / "job.inp", tmp_path / "out"
    cards = deck(last=LAST.format(force=100) + STILL)
    path.write_text(cards)
    arguments = ["-q", "-j", "1", "--umat", slow_umat]
    (tmp_path / "slow_5").touch()
    process = start(program_path, *arguments, "-o", out, path, cwd=tmp_path)
    while not (tmp_path / "was_slow").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, text = process.communicate(timeout=60)
    (tmp_path / "slow_5").unlink()
    assert "stopped by SIGTERM at the start of step 'STILL'" in text
    path.write_text(cards.replace("TOP, 3, -1.2e4", "TOP, 3, -1.1e4"))
    subprocess.run(
        [program_path, *arguments, "--continue", "-o", out, path], check=True, cwd=tmp_path
    )
    assert json.loads((out / "job.json").read_text())["status"] == "finished"
