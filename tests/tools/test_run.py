"""tools/run with stand-ins for its parts: where results go, and whose they are."""

import shutil
import subprocess
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"
# Writes the name of the deck, its last word, into the folder after -o.
PROGRAM = """#!/usr/bin/env bash
while (($# > 1)); do
  [[ $1 == -o ]] && folder=$2
  shift
done
mkdir -p "$folder" && echo "$1" >"$folder/ran"
"""


@pytest.fixture
def call(tmp_path):
    """Runs tools/run of a checkout of stand-ins from a folder: exit code and error output."""
    root = tmp_path / "keyway"
    parts = {"build/release/keyway": PROGRAM}
    parts |= dict.fromkeys(("tools/setup", "tools/report", ".venv/bin/python"), "#!/bin/sh\n")
    for name, text in parts.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    for name in ("run", "common.sh"):
        shutil.copy(TOOLS / name, root / "tools" / name)
    main = root / "input/xingbiling/xingbiling.inp"
    main.parent.mkdir(parents=True)
    main.write_text("")

    def run(folder, *words):
        done = subprocess.run(
            [root / "tools/run", *words], cwd=folder, capture_output=True, text=True, timeout=60
        )
        return done.returncode, done.stderr

    return run


def make_deck(folder):
    folder.mkdir(parents=True)
    (folder / "dam.inp").write_text("")
    return folder


def test_results_go_where_the_user_stands(tmp_path, call):
    folder = make_deck(tmp_path / "mine")
    assert call(folder, "dam.inp") == (0, "")
    assert (folder / "results/dam/ran").read_text() == "dam.inp\n"
    assert call(folder, "dam.inp", "-o", "other")[0] == 0
    assert (folder / "other/ran").exists()
    assert call(folder) == (0, "keyway: making the mesh of " + str(
        tmp_path / "keyway/input/xingbiling/xingbiling.inp") + "\n")  # fmt: skip
    assert (tmp_path / "keyway/results/xingbiling/ran").exists()


def test_decks_of_one_name_do_not_overwrite_each_other(tmp_path, call):
    for name in ("one", "two"):
        make_deck(tmp_path / name)
    assert call(tmp_path, "one/dam.inp")[0] == 0
    assert call(tmp_path, "one/dam.inp")[0] == 0
    code, told = call(tmp_path, "two/dam.inp")
    assert code == 2
    assert f"results/dam has the results of '{tmp_path}/one/dam.inp'" in told
    assert (tmp_path / "results/dam/ran").read_text() == "one/dam.inp\n"
    assert call(tmp_path, "two/dam.inp", "-o", "results/two")[0] == 0
    (tmp_path / "one/dam.inp").unlink()
    assert call(tmp_path, "two/dam.inp")[0] == 0  # the deck was moved
