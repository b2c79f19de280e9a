"""UMATs that write outside of their arrays, crash, take all memory or change the folder.

The run stops with its results, job.json says "stopped" and why. The bar of
test_umat_in_a_structure is pulled; the UMAT misbehaves beyond a strain of 0.5e-3.
"""

from __future__ import annotations

import resource
import subprocess
from pathlib import Path

import pytest
from test_umat_in_a_structure import HERE, YOUNG, deck

MEMORY = 2 * 2**30  # bytes: a run of the bar needs less, and the UMAT reaches it at once


@pytest.mark.parametrize(
    ("manner", "word"),
    [
        (1, "the routine writes outside of its array STRESS, behind the end"),
        (2, "the routine writes outside of its array DDSDDE, behind the end"),
        (3, "the routine writes outside of its 2 state variables (STATEV)"),
        (4, "the routine writes outside of its 3 constants (PROPS)"),
        (5, "the routine writes outside of its array COORDS, behind the end"),
        (6, "the routine changes the working folder"),
        (7, "CALL ABORT"),
        (8, "the routine has crashed: Segmentation fault"),
        (9, "the routine has crashed: Error allocating 1048576 bytes"),
        (10, "GETPROPERTYTABLE is not provided"),
        (11, "the routine has crashed: Segmentation fault"),
        (12, "the routine has crashed: Error allocating 1048576 bytes"),
    ],
)
def test_run_stops_and_says_why(keyway, monkeypatch, manner, word) -> None:
    limit_memory(monkeypatch)
    text = deck(f"{YOUNG}, 0.25, {manner}.", 2)
    run = keyway(text, "--umat", str(HERE / "misbehaves.for"), code=1)
    assert word in run.stderr
    assert run.json["status"] == "stopped"
    assert word in run.json["message"]
    assert 0.0 < run.csv("el_BAR")["time"][-1] <= 0.5 + 1e-9, "the results so far are there"


def limit_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits the memory of the programs that the test starts."""
    start = subprocess.run

    def limited(*arguments, **more):
        return start(
            *arguments,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
            **more,
        )

    monkeypatch.setattr(subprocess, "run", limited)


def test_flags_do_not_pass_through_a_shell(keyway, tmp_path: Path) -> None:
    """A command in --umat-flags is a wrong flag of the compiler, nothing else."""
    made = tmp_path / "made_by_a_shell"
    flags = f"-O1; touch {made} $(touch {made}) `touch {made}`"
    umat = str(HERE / "misbehaves.for")
    run = keyway(deck(f"{YOUNG}, 0.25, 0."), "--umat", umat, "--umat-flags", flags, code=2)
    assert "cannot compile the UMAT" in run.stderr
    assert not made.exists()


def test_quotes_keep_the_words_of_a_flag(keyway, tmp_path: Path) -> None:
    """A folder with a blank in its name, given in quotes."""
    folder = tmp_path / "two words"
    folder.mkdir()
    (folder / "more.inc").write_text("      PARAMETER (TWO=2.D0)\n", encoding="utf-8")
    source = (HERE / "misbehaves.for").read_text(encoding="utf-8")
    source = source.replace(
        "  include 'aba_param.inc'\n", "  include 'aba_param.inc'\n  include 'more.inc'\n"
    )
    (tmp_path / "law.for").write_text(source, encoding="utf-8")
    keyway(
        deck(f"{YOUNG}, 0.25, 0."),
        *("--umat", str(tmp_path / "law.for"), "--umat-flags", f"-O1 -I'{folder}'"),
    )
