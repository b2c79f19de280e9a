"""The files of a job: its tables (CSV), the one of a set or a joint, the job of a file."""

from __future__ import annotations

import contextlib
import glob
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .deck_bytes import capitals
from .result_files import as_file_word, load_json

if TYPE_CHECKING:
    from .results import Results

_KINDS = {"node": "sets/nodes", "el": "sets/elements", "joint": "joints"}  # groups of job.h5
_COLUMNS = {"node": ["node"], "el": ["element"], "joint": ["x", "y", "z"]}
_DIGITS = 1e-11  # tables have 13 significant digits


def tables_of(folder: Path, job: str) -> list[str]:
    """Names of the tables JOB_NAME.csv in the order of job.json.

    The tables of a job `dam_node` begin with `dam_`, too: job.json lists those of `dam`. Without
    such a list all tables count that belong to no other job of the folder.
    """
    start = f"{job}_"
    names = _listed(folder, job)
    if names is None:
        names = [path.name for path in sorted(folder.glob(f"{glob.escape(start)}*.csv"))]
        others = [path.stem for path in folder.glob(f"{glob.escape(start)}*.json")]
        names = [name for name in names if not any(_is_of(name, folder, job) for job in others)]
    return [
        name.removeprefix(start).removesuffix(".csv")
        for name in names
        if name.startswith(start) and name.endswith(".csv") and (folder / name).is_file()
    ]


def job_of_file(path: Path) -> tuple[Path, str] | None:
    """The folder of the results that a file belongs to, and the job; None where no job has it."""
    for folder in (path.parent, path.parent.parent):
        name = path.relative_to(folder).as_posix()
        for summary in sorted(folder.glob("*.json")):
            job = summary.stem
            if name in (_listed(folder, job) or []) or name.startswith(f"{job}_vtk/"):
                return folder, job
    return None


def _listed(folder: Path, job: str) -> list[str] | None:
    """The files that job.json lists; None without a list."""
    try:
        names = load_json(folder / f"{job}.json")["files"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return [str(name) for name in names]


def _is_of(name: str, folder: Path, job: str) -> bool:
    """Whether a table belongs to a job."""
    names = _listed(folder, job)
    return name.startswith(f"{job}_") if names is None else name in names


def table_of(results: Results, kind: str, name: str) -> str:
    """The table of a set or a joint; `kind` is node, el or joint.

    Names that differ in letters which files do not have share a word: of `K R` and `K_R` the
    second table gets its position behind the word, twice where the first result is the name of
    a set. The members, from job.h5, then tell which table is whose. Raises LookupError without a
    table, and where nothing tells.
    """
    own = capitals(name)
    word = as_file_word(own)
    first = f"{kind}_{word}"
    known = tables_of(results.folder, results.job)
    if first not in known:
        there = ", ".join(sorted(known)) or "none"
        raise LookupError(f"no table '{first}' in {results.folder}; there are: {there}")
    numbered = [table for table in known if re.fullmatch(rf"{re.escape(first)}(_\d+)+", table)]
    if "_" not in word:  # all letters stand in the name of the file
        return first
    try:
        group = results.file.get(_KINDS[kind], {})
    except OSError:  # while the run writes job.h5
        if not numbered:
            return first
        what = f"'{name}' may be {' or '.join([first, *numbered])}: job.h5, which tells, cannot be"
        raise LookupError(f"{what} read; take the table by its own name") from None
    if len([other for other in group if as_file_word(other) == word]) < 2:
        return first
    link = own.replace("/", "_")
    fitting = [t for t in (first, *numbered) if link in group and _fits(results, kind, t, link)]
    if len(fitting) == 1:
        return fitting[0]
    what = "no table has" if not fitting else f"{', '.join(fitting)} have"
    raise LookupError(f"{what} the members of '{name}' in {results.folder}; "
                      "take a table by its own name")  # fmt: skip


def name_of_table(results: Results, kind: str, word: str, names: Iterable[str]) -> str | None:
    """The name whose table is KIND_WORD, where several names share a word in files; else None."""
    alike = [name for name in names if f"{word}_".startswith(f"{as_file_word(name)}_")]
    for name in alike if len(alike) > 1 else ():
        with contextlib.suppress(LookupError):
            if table_of(results, kind, name) == f"{kind}_{word}":
                return name
    return None


def _fits(results: Results, kind: str, table: str, link: str) -> bool:
    """Whether a table is of the members that job.h5 has below a name."""
    columns = results.table(table)
    rows = np.unique(np.column_stack([columns[c] for c in _COLUMNS[kind]]), axis=0)
    place = results.file[f"{_KINDS[kind]}/{link}"]
    members = np.array(place["x"] if kind == "joint" else place, dtype=float)
    members = np.unique(members.reshape(len(members), -1), axis=0)
    return rows.shape == members.shape and np.allclose(rows, members, rtol=_DIGITS, atol=_DIGITS)
