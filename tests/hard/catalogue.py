"""All hard cases, and docs/hard_cases.md, the page that is made of their runs."""

from __future__ import annotations

import textwrap
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

What is hard for a program of jointed and cracking dams, and how this one does. `tests/hard` holds
the decks; `python tools/make_hard_cases.py` runs them and writes this page. A case *holds* where
its runs end and its number is at most the limit. Cases with (full) are run by `tools/test --full`
only.

Iterations are the most in one increment; cuts are all cut-backs. Times are seconds of all runs of
the case on one thread. Number, iterations, cuts and time depend on the machine and on the kernels
of its BLAS.
"""
COLUMNS = "| case | unknowns | result | number | limit | iterations | cuts | time |"
HOLDS, FAILS, NOT_RUN = "holds", "does not hold", "not run yet"


def full_name(case: HardCase) -> str:
    return case.name + (" (full)" if case.full else "")


def meaning_of(case: HardCase) -> str:
    """What is hard and what the number is, as an item of a list."""
    text = f"*{case.name}*: {case.hard}. Number: {case.criterion}."
    if case.waits_for:
        text += f" Waits for: {case.waits_for}."
    return textwrap.fill(text, 118, initial_indent="- ", subsequent_indent="  ")


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
        text += "\n" + "".join(meaning_of(case) + "\n" for case in chapter.cases)
    return text
