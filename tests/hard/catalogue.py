"""All hard cases, and docs/hard_cases.md, the page that is made of their runs."""

from __future__ import annotations

import textwrap
from itertools import groupby
from pathlib import Path

from block_cases import BLOCKS
from concrete_cases import CONCRETE
from crossing_cases import CROSSINGS
from dam_cases import DAMS
from hard_case import Finding, HardCase
from solid_cases import SOLIDS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "hard_cases.md"
CHAPTERS = (BLOCKS, CROSSINGS, CONCRETE, SOLIDS, DAMS)
CASES = [case for chapter in CHAPTERS for case in chapter.cases]
HEAD = """# Hard cases

What is hard for a program that computes dams with joints and cracks, and does Keyway solve it? Each
case is judged by one number. The case *holds* if its runs end and its number is at most the limit.
Below each table a list says what is hard in a case, and what its number means.

- *Iterations* are the most in one increment, *cuts* are all cut-backs.
- *Time* is the seconds of all runs of the case on one thread.
- Number, iterations, cuts and time depend on the machine and on the kernels of its BLAS.
- `tools/test --full` alone runs the cases with (full).

The decks are in `tests/hard`; `python tools/make_hard_cases.py` runs them and writes this page.
"""
COLUMNS = "| case | unknowns | result | number | limit | iterations | cuts | time |"
HOLDS, FAILS, NOT_RUN = "holds", "does not hold", "not run yet"


def full_name(case: HardCase) -> str:
    return case.name + (" (full)" if case.full else "")


def meaning_of(cases: list[HardCase]) -> str:
    """What is hard in cases that differ by a value alone, and what the number is: an item."""
    names = "; ".join(f"*{case.name}*" for case in cases)
    text = f"{names}: {cases[0].hard}. Number: {cases[0].criterion}."
    if cases[0].waits_for:
        text += f" Waits for: {cases[0].waits_for}."
    return textwrap.fill(text, 118, initial_indent="- ", subsequent_indent="  ")


def meanings_of(cases: tuple[HardCase, ...]) -> list[str]:
    """One item for neighbours with the same description."""
    groups = groupby(cases, key=lambda case: (case.hard, case.criterion, case.waits_for))
    return [meaning_of(list(group)) for _, group in groups]


def row_of(case: HardCase, finding: Finding | None) -> str:
    """A row of the page; without a finding the runs did not end."""
    cells = [full_name(case), "", FAILS, "", f"{case.limit:g}", "", "", ""]
    if finding:
        cells[1] = str(finding.unknowns)
        cells[2] = HOLDS if finding.holds else FAILS
        cells[3] = f"{finding.value:.1e}"
        cells[5:] = [str(finding.iterations), str(finding.cuts), f"{finding.seconds:.1f}"]
    return "| " + " | ".join(cells) + " |"


def empty_row(case: HardCase) -> str:
    return f"| {full_name(case)} |  | {NOT_RUN} |  | {case.limit:g} |  |  |  |"


def rows_of_page() -> dict[str, str]:
    """Rows of the page by the name of their case."""
    if not PAGE.exists():
        return {}
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = {line.split(" | ")[0][2:]: line for line in lines if line.startswith("| ")}
    return {case.name: rows[full_name(case)] for case in CASES if full_name(case) in rows}


def page_of(rows: dict[str, str]) -> str:
    text = HEAD
    for chapter in CHAPTERS:
        text += f"\n## {chapter.title}\n\n{COLUMNS}\n|{'---|' * 8}\n"
        text += "".join(rows.get(case.name, empty_row(case)) + "\n" for case in chapter.cases)
        text += "\n" + "".join(item + "\n" for item in meanings_of(chapter.cases))
    return text
