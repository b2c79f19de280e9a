"""Runs decks for the tests and reads what they leave; checks the values of a case.toml."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from keyway_tools.result_files import Table
from keyway_tools.results import Results

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Run:
    """A finished run of the program: exit code, output and results."""

    folder: Path
    job: str
    code: int
    stdout: str
    stderr: str

    @cached_property
    def results(self) -> Results:
        return Results(self.folder, self.job)

    @property
    def json(self) -> dict[str, Any]:
        """The summary."""
        return self.results.summary

    def csv(self, name: str) -> Table:
        """Columns of a table, as in csv('node_TIP')['U3']."""
        return self.results.table(name)


class Program:
    """The program under test, with a folder for what it writes."""

    def __init__(self, path: Path, folder: Path, threads: int, limit: float = 600.0):
        self.path = path
        self.folder = folder
        self.threads = threads
        self.limit = limit  # time limit of a run [s]

    def __call__(
        self, deck: Path | str, *options: str, code: int = 0, name: str = "job", files=None
    ) -> Run:
        """Runs a deck (a path, or the text of one) and asserts its exit code.

        `files` maps names to texts of further files beside a deck given as text.
        """
        if isinstance(deck, str):
            source = self.folder / f"{name}.inp"
            source.write_text(deck, encoding="utf-8")
            for other, text in (files or {}).items():
                (self.folder / other).write_text(text, encoding="utf-8")
            deck = source
        out = self.folder / f"results_{deck.stem}"
        threads = [] if "-j" in options else ["-j", str(self.threads)]
        done = self.call("-o", str(out), *threads, *options, str(deck))
        run = Run(out, deck.stem, done.returncode, done.stdout, done.stderr)
        assert run.code == code, f"exit code {run.code}, expected {code}\n{run.stderr[-4000:]}"
        return run

    def call(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """The program with any arguments, in its folder."""
        return subprocess.run(
            [str(self.path), *arguments],
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            cwd=self.folder,
            timeout=self.limit,
        )


def blas_kernels(*command: Path | str) -> list[str]:
    """Kernels that each OpenBLAS of a command reports, as HASWELL; none without an OpenBLAS."""
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
        env={**os.environ, "OPENBLAS_VERBOSE": "2"},
    )
    found = (line.partition("Core: ")[2] for line in done.stderr.splitlines())
    return [name.upper() for name in found if name]


@dataclass(frozen=True)
class Case:
    """A folder of tests/decks: a deck and the values it must give."""

    folder: Path
    content: dict[str, Any]

    @property
    def deck(self) -> Path:
        return (self.folder / self.content.get("deck", "deck.inp")).resolve()

    @property
    def is_long(self) -> bool:
        return self.content.get("full", False)


def read_case(path: Path) -> Case:
    """Reads a case.toml; a value without source or reason is refused."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    for value in content.get("value", []):
        lacking = {"name", "source"} - value.keys()
        if {"absolute", "relative"} & value.keys():
            lacking |= {"reason"} - value.keys()
        assert not lacking, f"{path}: value {value.get('name')}: no {', '.join(sorted(lacking))}"
    return Case(path.parent, content)


def find_value(run: Run, value: dict[str, Any]) -> Any:
    """What the results hold at a value's place: `json = PATH`, or `csv`, `column` and a row."""
    if "json" in value:
        return run.results.find(value["json"])
    table = run.csv(value["csv"])
    chosen = np.ones(len(next(iter(table.values()))), dtype=bool)
    for name, wanted in value.get("row", {}).items():
        chosen &= np.isclose(table[name], wanted, rtol=1e-9, atol=1e-9)
    column = table[value["column"]][chosen]
    assert column.size, f"{value['csv']}: no row with {value.get('row')}"
    how = value.get("extreme", "only")
    if how == "only":
        assert column.size == 1, f"{value['csv']}: {column.size} rows with {value.get('row')}"
        return column[0]
    pick = {"max": np.max, "min": np.min, "maxabs": lambda c: np.max(np.abs(c)),
            "first": lambda c: c[0], "last": lambda c: c[-1], "mean": np.mean}[how]  # fmt: skip
    return pick(column)


def fault_of(found: Any, value: dict[str, Any]) -> str:
    """Empty when a value is as expected, else what is wrong."""
    name = value["name"]
    bounds = [
        f"{name}: {found} is not {word.replace('_', ' ')} {value[word]}"
        for word, holds in (
            ("at_most", lambda limit: found <= limit),
            ("at_least", lambda limit: found >= limit),
        )
        if word in value and not holds(value[word])
    ]
    if bounds or "expected" not in value:
        return "; ".join(bounds)
    expected = value["expected"]
    if isinstance(expected, str | bool):
        return "" if found == expected else f"{name}: {found!r}, expected {expected!r}"
    allowed = value.get("absolute", 0.0) + value.get("relative", 0.0) * abs(expected)
    apart = abs(found - expected)
    if apart <= allowed:
        return ""
    return (
        f"{name}: {found:.9g}, expected {expected:.9g} (apart {apart:.3g}, allowed {allowed:.3g})"
    )


def check_case(case: Case, program: Program) -> None:
    """Runs a case and asserts each of its values."""
    options = case.content.get("options", [])
    run = program(case.deck, *options, code=case.content.get("code", 0))
    faults = [fault_of(find_value(run, v), v) for v in case.content.get("value", [])]
    assert not any(faults), "\n".join(f for f in faults if f)
