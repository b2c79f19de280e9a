"""A deck that has changed is refused by --continue, whatever line has changed, with its card.

Every data line before the step of the checkpoint is changed once, in the deck, in an included file
and in a file that INPUT names: a digit of one of its numbers, or a letter of a name.
"""

from __future__ import annotations

import re
import signal
import subprocess
from pathlib import Path

import pytest
from restart_case import deck, kill_at, start

UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"
SAYS = "--continue: the checkpoint does not belong to this run: the deck has changed: "
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
AMPLITUDE = "0., 0., 0.02, 1., 0.05, -1.2, 0.09, 1., 0.12, -0.5, 0.15, 0."
BRICK = 9  # words of an element
RECORD = "0., 0.\n0.02, 1.\n0.05, -1.2\n0.09, 1.\n0.12, -0.5\n0.15, 0.\n"


def files_of_case() -> dict[str, str]:
    """The deck of the restarts with nodes in an included file, and the record in one of its own."""
    text = deck()
    nodes, rest = text.split("*ELEMENT", 1)
    rest = rest.replace(f"SHAKE\n{AMPLITUDE}", "SHAKE, INPUT=shake.txt")
    load = "ALL, GRAV, 9.81, 0, 0, -1\n"
    rest = rest.replace(load, f"{load}HEAD, P2, 2e3\n*CLOAD\nTOP, 1, 50.\n", 1)
    law = "*JOINT LAW, NAME=DRY, KN=1e11, KT=1e11, FRICTION=0.6"
    assert law in rest
    rest = rest.replace(law, f"{law}, TENSILE STRENGTH=1e4")
    return {
        "job.inp": "*INCLUDE, INPUT=mesh.inp\n*ELEMENT" + rest,
        "mesh.inp": nodes,
        "shake.txt": RECORD,
    }


def card_of(lines: list[str], row: int) -> str:
    """The keyword that a line belongs to."""
    return next(line for line in reversed(lines[: row + 1]) if line[0] == "*").partition(",")[0]


def changed(line: str) -> str:
    """Another element, set or number; without a number the first word twice."""
    words = line.split(", ")
    if len(words) == BRICK and line.replace(", ", "").isdigit():  # the nodes in another order
        return ", ".join([words[0], *words[2:5], words[1], *words[6:], words[5]])
    if len(words) > 1 and line.replace(", ", "").isdigit():
        return ", ".join(words[:-1])
    if found := list(NUMBER.finditer(line)):
        place = found[-1]
        return f"{line[: place.start()]}{float(place[0]) * 1.01 + 0.013:.6g}{line[place.end() :]}"
    return f"{line}, {words[0]}"


def changes() -> list[tuple[str, int, str]]:
    """File, row and keyword of each data line up to the step of the checkpoint, the third."""
    found = []
    for name, text in files_of_case().items():
        lines = text.split("*STEP, NAME=AFTER")[0].splitlines()
        for row, line in enumerate(lines):
            if name == "shake.txt":
                found.append((name, row, "*AMPLITUDE"))
            elif not line.startswith("*"):
                found.append((name, row, card_of(lines, row)))
    return found


@pytest.fixture(scope="module")
def stopped(program_path: Path, tmp_path_factory) -> list:
    """The command that goes on with a run that SIGTERM has stopped in the third step."""
    folder = tmp_path_factory.mktemp("stopped")
    library = folder / "j2.so"
    subprocess.run([program_path, "--umat", UMAT, "--umat-library", library], check=True)
    write(folder, files_of_case())
    arguments = ["-q", "-o", folder / "out", "-j", "1", "--umat", library]
    process = start(program_path, *arguments, folder / "job.inp")
    kill_at(process, folder / "out" / "job_energy.csv", 40, signal.SIGTERM, 0.0)
    assert process.wait() == 1
    return [program_path, *arguments, "--continue"]


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).write_text(text)


def with_change(name: str, row: int) -> dict[str, str]:
    files = files_of_case()
    lines = files[name].splitlines()
    lines[row] = changed(lines[row])
    files[name] = "\n".join(lines) + "\n"
    return files


def test_every_data_line_counts(stopped, tmp_path):
    """The message names the card of the change, or the line is wrong now for another reason."""
    refused, wrong = set(), []
    for name, row, keyword in changes():
        write(tmp_path, with_change(name, row))
        done = subprocess.run([*stopped, tmp_path / "job.inp"], capture_output=True, text=True)
        assert done.returncode == 2, (name, row, done.stderr)
        if SAYS in done.stderr:
            assert f"{keyword} is new or not as it was" in done.stderr, (name, row, done.stderr)
            refused.add(keyword)
        else:
            wrong.append(keyword)
    assert len(wrong) < 0.25 * len(changes()), wrong
    expected = {
        *("*NODE", "*ELEMENT", "*NSET", "*AMPLITUDE", "*DENSITY", "*ELASTIC", "*USER MATERIAL"),
        *("*CONCRETE TENSION STIFFENING", "*CLOAD", "*DLOAD", "*STATIC", "*DYNAMIC"),
    }
    assert expected <= refused, expected - refused


@pytest.mark.parametrize(
    ("name", "old", "new", "card"),
    [
        ("job.inp", "1, 1, 2, 4, 3, 5, 6, 8, 7", "1, 2, 4, 3, 1, 6, 8, 7, 5", "*ELEMENT"),
        ("job.inp", "STRENGTH=1e4", "STRENGTH=2e4", "*JOINT LAW"),
        ("job.inp", "TYPE=C3D8B", "TYPE=C3D8", "*ELEMENT"),
        ("job.inp", "FRICTION=0.6", "FRICTION=0.5", "*JOINT LAW"),
        ("job.inp", "SCALE=6.", "SCALE=5.", "*BASE MOTION"),
        ("job.inp", "BASE, 1, 3", "BASE, 1, 3, 0.", "*BOUNDARY"),
        ("mesh.inp", "*NODE", "*NODE, NSET=EVERY", "*NODE"),
        ("shake.txt", "-1.2", "-1.20001", "*AMPLITUDE"),
    ],
)
def test_a_changed_card(stopped, tmp_path, name, old, new, card):
    files = files_of_case()
    assert old in files[name]
    files[name] = files[name].replace(old, new, 1)
    write(tmp_path, files)
    done = subprocess.run([*stopped, tmp_path / "job.inp"], capture_output=True, text=True)
    assert done.returncode == 2
    assert SAYS in done.stderr
    assert f"{card} is new or not as it was" in done.stderr


def test_the_deck_as_it_was(stopped, tmp_path):
    """Moved into another folder, with comments, blanks and blank lines: goes on."""
    files = files_of_case()
    files["mesh.inp"] = "** nodes\n" + files["mesh.inp"].replace("\n", "  \n\n")
    write(tmp_path, files)
    done = subprocess.run([*stopped, tmp_path / "job.inp"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
