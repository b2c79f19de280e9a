"""batch.py with a made-up program in place of keyway: what is run, kept, ended and reported."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from harness import ROOT
from keyway.commands import batch
from made_up_program import write_program

BATCH = ROOT / "tools/batch.py"


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with the program, decks made by `deck(name, line)`, and the calls it saw."""
    write_program(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def deck(place: Path, name: str, line: str, more: str = "") -> str:
    path = place / f"{name}.inp"
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"** {line}\n{more}*STEP\n")
    return str(path)


def run(*arguments: str) -> int:
    return batch.main([*arguments, "--program", "keyway", "--json", "table.json"])


def table(place: Path) -> dict[str, dict]:
    records = json.loads((place / "table.json").read_text())
    return {Path(r["folder"]).name: r for r in records}


def calls(place: Path) -> list[str]:
    path = place / "results/calls.txt"
    return path.read_text().splitlines() if path.exists() else []


def test_table_and_exit_codes(place, capsys):
    good, bad = deck(place, "good", "ok 2.5e6"), deck(place, "bad", "fail 2")
    stopped, crash = deck(place, "stopped", "fail 1"), deck(place, "crash", "crash")
    assert run(good, "-j", "2") == 0
    assert run(good, bad, stopped, crash, "-j", "2") == 1
    found = table(place)
    assert {name: r["status"] for name, r in found.items()} == {
        "good": "finished",
        "bad": "bad deck",
        "stopped": "stopped",
        "crash": "killed by SIGSEGV",
    }
    assert found["good"]["was_kept"]
    assert found["good"]["extremes"]["S1"] == 2.5e6
    assert found["good"]["peak_memory_mb"] > 0
    text = capsys.readouterr().out
    assert "2.5e+06" in text
    assert "bad: deck:1: wrong" in text


def test_finished_deck_is_not_run_again(place):
    (place / "mesh.inp").write_text("*NODE\n")
    dam = deck(place, "dam", "ok 1", "*INCLUDE, INPUT=mesh.inp\n")
    for _ in range(2):
        assert run(dam) == 0
    assert len(calls(place)) == 1
    (place / "mesh.inp").write_text("*NODE\n1, 0, 0, 0\n")
    assert run(dam) == 0
    assert len(calls(place)) == 2
    assert run(dam, "--again") == 0
    assert len(calls(place)) == 3
    assert batch.main([dam, "--program", "keyway", "--threads", "3", "--", "-q"]) == 0
    assert calls(place)[-1] == "dam -j 3 -q"
    assert len(calls(place)) == 4


AMPLITUDES = {
    "continued": "*AMPLITUDE, NAME=M, FORMAT=VALUES,\n INPUT=my rec.txt\n",
    "blanks in the name": "*AMPLITUDE, NAME=M, INPUT = my rec.txt\n",
    "single quotes": "*AMPLITUDE, INPUT='my rec.txt', NAME=M\n",
    "below a file": "*INCLUDE,\nINPUT=part.inc\n",
}


@pytest.mark.parametrize("card", AMPLITUDES.values(), ids=AMPLITUDES)
def test_a_deck_runs_again_where_a_file_of_it_has_changed(place, card):
    """The files are those of keyway.deck: a pattern of its own kept results of another record."""
    (place / "part.inc").write_text("*Amplitude, name=M,\n** remark\n input=my rec.txt\n")
    (place / "my rec.txt").write_text("0.\n1.\n")
    dam = deck(place, "dam", "ok 1", card)
    for _ in range(2):
        assert run(dam) == 0
    assert len(calls(place)) == 1
    (place / "my rec.txt").write_text("0.\n2.\n")
    assert run(dam) == 0
    assert len(calls(place)) == 2


UMAT = {
    "law.for": "      SUBROUTINE UMAT\n      include 'law.inc'\n      END\n",
    "law.inc": '#include "deep/more.h"\n',
    "deep/more.h": "      INCLUDE 'far.inc'\n",
    "far/far.inc": "      X = 1.0\n#include <angle.inc>\n      include 'a.inc'\n",
    "far/angle.inc": "      include 'b.inc'\n      include 'c.inc'\n",
    "one dir/a.inc": "      X = 2.0\n",
    "two dir/b.inc": "      X = 3.0\n",
    "last dir/c.inc": "      X = 4.0\n",
}
UMAT_FLAGS = "-O1 -Ifar -I\"one dir\" -I 'two dir' -Ilast\\ dir"


@pytest.mark.parametrize("name", UMAT)
def test_a_deck_runs_again_where_its_umat_has_changed(place, name):
    """Also where a file that the source includes has; the library is written by the run itself."""
    for file, text in UMAT.items():
        (place / file).parent.mkdir(exist_ok=True)
        (place / file).write_text(text)
    dam = deck(place, "dam", "ok 1")
    options = ["--umat", "law.for", "--umat-flags", UMAT_FLAGS, "--umat-library", "law.so"]

    def num_calls() -> int:
        assert batch.main([dam, "--program", "keyway", "--", *options]) == 0
        return len(calls(place))

    assert num_calls() == 1
    (place / "law.so").write_text("new")
    assert num_calls() == 1
    (place / name).write_text(UMAT[name] + "! changed\n")
    assert num_calls() == 2
    assert num_calls() == 2


@pytest.mark.parametrize("flags", ["-O2 " * 100, "-D" + 400 * "N", "-I'" + 400 * "n"])
def test_flags_longer_than_a_name_of_a_file(place, flags):
    """Nor is a folder of such a name, or a quote that nothing closes, an end of all runs."""
    (place / "law.for").write_text("      include 'law.inc'\n")
    options = ["--umat-flags", flags, "--umat", "law.for", "n" * 400]
    assert batch.main([deck(place, "dam", "ok 1"), "--program", "keyway", "--", *options]) == 0
    assert len(calls(place)) == 1


def test_failed_deck_is_run_again(place):
    dam = deck(place, "dam", "fail 1")
    assert run(dam) == 1
    assert run(dam) == 1
    assert len(calls(place)) == 2


def test_folders_and_decks_of_one_name(place):
    for folder in ("low", "high"):
        deck(place, f"{folder}/dam", "ok 1")
        (place / folder / "mesh.inp").write_text("*NODE\n")
    assert run("low", "high") == 0
    assert set(table(place)) == {"low_dam", "high_dam"}


def test_timeout(place):
    assert run(deck(place, "slow", "sleep 30"), "--timeout", "0.5") == 1
    assert table(place)["slow"]["status"] == "timed out"


def test_interruption_ends_the_children_and_goes_on_later(place):
    decks = [
        deck(place, "first", "ok 1"),
        deck(place, "slow", "sleep 60"),
        deck(place, "c", "ok 3"),
    ]
    command = [sys.executable, str(BATCH), *decks, "--program", "keyway", "--json", "table.json"]
    # A shell lets its background jobs ignore SIGINT, and children inherit that.
    heard = ["env", "--default-signal=INT", *command]
    child = subprocess.Popen(heard, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(200):
        if len(calls(place)) == 2:
            break
        time.sleep(0.05)
    os.kill(child.pid, signal.SIGINT)
    assert child.wait(timeout=15) == batch.EXIT_INTERRUPTED
    found = {name: r["status"] for name, r in table(place).items()}
    assert found == {"first": "finished", "slow": "interrupted", "c": "not run"}
    deck(place, "slow", "ok 2")
    assert run(*decks) == 0
    assert [line.split()[0] for line in calls(place)] == ["first", "slow", "slow", "c"]


def test_a_second_signal_while_the_runs_end(place):
    """The command `timeout` sends its signal twice; the child here ends a second after it."""
    command = [sys.executable, str(BATCH), deck(place, "slow", "deaf 3"), "--program", "keyway"]
    child = subprocess.Popen([*command, "--json", "table.json"], stderr=subprocess.PIPE, text=True)
    for _ in range(200):
        if len(calls(place)) == 1:
            break
        time.sleep(0.05)
    time.sleep(0.5)  # the run does not hear the signal from here on
    for _ in range(2):
        child.send_signal(signal.SIGTERM)
        time.sleep(0.3)
    told = child.communicate(timeout=60)[1]
    assert child.returncode == batch.EXIT_INTERRUPTED
    assert "Traceback" not in told, told
    assert set(table(place)) == {"slow"}


@pytest.mark.parametrize("arguments", [["nothing.inp"], ["."], ["x.inp", "-j", "0"]])
def test_usage(place, arguments):
    try:
        code = run(*arguments)
    except SystemExit as stop:
        code = stop.code
    assert code == 2
