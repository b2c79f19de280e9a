"""Limits: memory, threads, devices, a standard output that is closed or full."""

from __future__ import annotations

import os
import resource
import subprocess
from pathlib import Path

import pytest

BLOCK = Path(__file__).parent / "errors" / "base" / "block.inp"
SYSTEM_FAILED = 3
DECK_IS_WRONG = 2


def run(program: Path, folder: Path, *arguments: str, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(program.resolve()), *arguments],
        cwd=folder,
        text=True,
        stderr=subprocess.PIPE,
        timeout=60,
        **more,
    )


@pytest.mark.parametrize("options", [["--check", str(BLOCK)], ["--version"], ["--keywords"]])
@pytest.mark.parametrize("is_closed", [False, True])
def test_output_that_takes_nothing(program_path, tmp_path, options, is_closed) -> None:
    with Path("/dev/full").open("w") as full:
        done = run(
            program_path,
            tmp_path,
            *options,
            stdout=full,
            preexec_fn=(lambda: os.close(1)) if is_closed else None,
        )
    assert done.returncode == SYSTEM_FAILED
    assert "cannot write to the standard output" in done.stderr


@pytest.mark.parametrize("name", ["/dev/zero", "pipe", "folder"])
def test_deck_that_is_no_file(program_path, tmp_path, name) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    done = run(program_path, tmp_path, "--check", name)
    assert done.returncode == DECK_IS_WRONG
    expected = "it is a folder" if name == "folder" else "it is a device or a pipe, not a file"
    assert done.stderr.strip() == f"{name}: cannot read '{name}': {expected} [unreadable-file]"


def test_record_that_is_no_file(program_path, tmp_path) -> None:
    deck = BLOCK.read_text(encoding="utf-8")
    deck = deck.replace("*STEP\n", "*AMPLITUDE, NAME=A, INPUT=/dev/zero\n*STEP\n", 1)
    (tmp_path / "deck.inp").write_text(deck, encoding="utf-8")
    done = run(program_path, tmp_path, "--check", "deck.inp")
    assert done.returncode == DECK_IS_WRONG
    assert "cannot read '/dev/zero': it is a device or a pipe" in done.stderr


@pytest.mark.parametrize("megabytes", [150, 250, 340, 350, 360, 450, 600])
def test_little_memory(program_path, tmp_path, megabytes) -> None:
    """Either the run finishes, or the part that asked for memory is named; nothing hangs."""
    size = megabytes * 2**20
    done = run(
        program_path,
        tmp_path,
        *("-q", "-j", "2", str(BLOCK)),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
    )
    assert done.returncode in (0, SYSTEM_FAILED), done.stderr
    if done.returncode == SYSTEM_FAILED:
        assert "not enough memory in part '" in done.stderr


@pytest.mark.parametrize("megabytes", [300, 330, 345])
def test_openblas_does_not_wait_for_memory(program_path, tmp_path, megabytes) -> None:
    """A mesh takes the memory that OpenBLAS wants later; OpenBLAS would ask for it for ever."""
    size = megabytes * 2**20
    deck = BLOCK.parents[3] / "input" / "xingbiling_matching" / "xingbiling_matching.inp"
    done = run(
        program_path,
        tmp_path,
        *("--check", "-j", "1", str(deck)),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)),
        stdout=subprocess.DEVNULL,
    )
    assert done.returncode in (0, SYSTEM_FAILED), done.stderr
    if done.returncode == SYSTEM_FAILED:
        assert "not enough memory in part '" in done.stderr


def test_more_state_variables_than_memory(program_path, tmp_path) -> None:
    """A count that no machine has room for is refused with its place."""
    deck = BLOCK.read_text(encoding="utf-8")
    elastic, user = "*ELASTIC\n22e9, 0.2\n", "*USER MATERIAL, CONSTANTS=1\n1.\n"
    deck = deck.replace(elastic, f"{user}*DEPVAR\n2000000000\n")
    (tmp_path / "deck.inp").write_text(deck, encoding="utf-8")
    done = run(program_path, tmp_path, "--check", "deck.inp")
    assert done.returncode == DECK_IS_WRONG
    assert "*DEPVAR: found '2000000000'" in done.stderr
