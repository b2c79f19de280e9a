"""Whose results a batch shows: those of its own runs, and none of an earlier deck or run."""

from __future__ import annotations

import csv
import fcntl
import json
from concurrent.futures import ThreadPoolExecutor, TimeoutError
from pathlib import Path

import pytest
from keyway.commands import batch
from keyway_tools import job_folder
from keyway_tools.deck_runs import DeckRunner
from made_up_program import write_program

BRICK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=BRICK
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=CONCRETE
*ELASTIC
{E}, 0.2
*SOLID SECTION, ELSET=BRICK, MATERIAL=CONCRETE
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
*STEP
*STATIC
1., 1.
*CLOAD
7, 3, {FORCE}
*ENVELOPE
U, S1, S3
*END STEP
"""


@pytest.fixture
def made_up(tmp_path, monkeypatch) -> Path:
    """A folder with the made-up program."""
    write_program(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def bricks(tmp_path, monkeypatch, program_path):
    """Runs the brick with a stiffness and a force as the case `dam`; the row of batch.csv."""
    monkeypatch.chdir(tmp_path)
    Path("brick.inp").write_text(BRICK)

    def row(stiffness: str, force: str) -> dict[str, str]:
        Path("values.csv").write_text(f"case,E,FORCE\ndam,{stiffness},{force}\n")
        words = ["brick.inp", "--table", "values.csv", "--program", str(program_path)]
        batch.main([*words, "--json", "table.json"])
        with Path("results/batch.csv").open(encoding="utf-8") as file:
            (found,) = csv.DictReader(file)
        return found

    return row


def record() -> dict:
    """The only record of the table."""
    (found,) = json.loads(Path("table.json").read_text())
    return found


def run(*arguments: str) -> int:
    return batch.main([*arguments, "--program", "keyway", "--json", "table.json"])


def test_a_run_that_fails_has_no_results_of_an_earlier_run(made_up):
    (made_up / "dam.inp").write_text("** ok 2.5\n*STEP\n")
    assert run("dam.inp") == 0
    assert record()["extremes"]["S1"] == 2.5
    (made_up / "results/is_full").touch()  # the deck is the same: an included file may differ
    assert run("dam.inp", "--again") == 1
    assert [record()[name] for name in ("status", "extremes", "message")] == [
        "system failed",
        {},
        "keyway: the disk is full",
    ]
    (header, _) = csv.reader((made_up / "results/batch.csv").read_text().splitlines())
    assert header[-1] == "message"  # no column of a result
    (made_up / "results/is_full").unlink()
    (made_up / "dam.inp").write_text("** fail 3\n*STEP\n")
    assert run("dam.inp") == 1
    assert record()["message"] == "keyway: the end"
    assert not record()["has_results"]


def test_a_folder_in_use_gives_no_results(bricks, monkeypatch):
    """The deck had errors meanwhile: its mark in job.json is no message of the last run."""
    assert float(bricks("25e9", "-200.")["S3"]) < 0.0
    assert bricks("-5", "-200.")["status"] == "bad deck"
    monkeypatch.setattr(job_folder, "PATIENCE", 0.3)
    with Path("results/dam/dam.lock").open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        row = bricks("25e9", "-300.")
    assert (row["status"], row["exit_code"]) == ("system failed", "3")
    assert row["message"].endswith("[folder-in-use]")
    assert "S3" not in row
    assert float(bricks("25e9", "-300.")["S3"]) < 0.0


def test_a_run_that_is_left_over_is_waited_for(made_up):
    deck, folder, calls = (made_up / name for name in ("dam.inp", "results", "calls.txt"))
    deck.write_text("** ok 2.5\n*STEP\n")
    folder.mkdir()
    runner = DeckRunner(made_up / "keyway", [])
    with (folder / "dam.lock").open("w") as file, ThreadPoolExecutor() as pool:
        fcntl.flock(file, fcntl.LOCK_EX)
        waiting = pool.submit(runner.run, deck, folder)
        with pytest.raises(TimeoutError):
            waiting.result(1.0)
        assert not calls.exists()
        fcntl.flock(file, fcntl.LOCK_UN)
        assert waiting.result().status == "finished"


def test_a_finished_run_without_its_results_runs_again(bricks):
    place = Path("results/dam")
    assert bricks("25e9", "-200.")["status"] == "finished"
    for name, is_kept in (("dam.pvd", True), ("dam.h5", False), ("dam.json", False)):
        (place / name).unlink(missing_ok=True)
        assert bricks("25e9", "-200.")["status"] == "finished"
        assert record()["was_kept"] == is_kept, name
    assert (place / "dam.h5").exists()
