"""Checks sizes of files, folders, procedures and lines of pages, and leftovers.

usage: check_sizes.py [ROOT]

No linter checks these. For Python, ruff checks all but the length of files (pyproject.toml).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from fortran_source import bare, procedures, sources_under

MAX_FILE = 400
MAX_FOLDER = 15
MAX_PAGE_LINE = 120
MAX_PROCEDURE = 60
MAX_KERNEL = 100
MAX_ARGUMENTS = 8
MAX_NESTING = 4

# Kernels without branches that may have MAX_KERNEL lines; all other procedures must be split.
KERNELS: set[str] = set()
# Tables of constants, which may be long.
TABLES: set[str] = set()
# Procedures whose arguments another program fixes.
FIXED_ARGUMENTS: set[str] = {"umat"}

MARKS = ("TO" + "DO", "FIX" + "ME", "X" * 3, "HA" + "CK", "W" + "IP")
LEFTOVERS = re.compile(r"\b(?:" + "|".join(MARKS) + r")\b|^(?:<{7}|>{7}|={7})(?: |$)")


def check_lengths(place: str, text: str) -> list[str]:
    """Files that are too long."""
    count = len(text.splitlines())
    if count > MAX_FILE and place not in TABLES:
        return [f"{place}: {count} lines, at most {MAX_FILE}"]
    return []


def check_leftovers(place: str, text: str) -> list[str]:
    """Marks of unfinished work, tabs, and blanks at the end of lines."""
    faults = []
    for number, line in enumerate(text.splitlines(), 1):
        if found := LEFTOVERS.search(line):
            faults.append(f"{place}:{number}: leftover '{found[0].strip()}'")
        if line != line.rstrip():
            faults.append(f"{place}:{number}: blanks at the end of the line")
        if "\t" in line:
            faults.append(f"{place}:{number}: a tab")
    return faults


def check_fortran(place: str, text: str) -> list[str]:
    """Procedures that are too long, nest too deep or have too many arguments."""
    faults = []
    for procedure in procedures(text):
        where = f"{place}:{procedure.line}: {procedure.name}"
        limit = MAX_KERNEL if procedure.name in KERNELS else MAX_PROCEDURE
        if procedure.lines > limit:
            faults.append(f"{where} has {procedure.lines} lines, at most {limit}")
        if len(procedure.arguments) > MAX_ARGUMENTS and procedure.name not in FIXED_ARGUMENTS:
            count = len(procedure.arguments)
            faults.append(f"{where} has {count} arguments, at most {MAX_ARGUMENTS}")
        if procedure.deepest > MAX_NESTING:
            faults.append(f"{where} nests {procedure.deepest} deep, at most {MAX_NESTING}")
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"^(?:if\s*\(.*\)\s*)?stop\b", bare(line)) and "/app/" not in place:
            faults.append(f"{place}:{number}: only src/app ends the program")
    return faults


def check_folders(root: Path) -> list[str]:
    """Folders below src that hold too many files."""
    folders = sorted(p for p in (root / "src").rglob("*") if p.is_dir())
    counts = {folder: sum(p.is_file() for p in folder.iterdir()) for folder in folders}
    return [
        f"{folder.relative_to(root)}: {count} files, at most {MAX_FOLDER}"
        for folder, count in counts.items()
        if count > MAX_FOLDER
    ]


def check_pages(root: Path) -> list[str]:
    """Lines of the documentation that are too long, rows of tables included."""
    return [
        f"{path.relative_to(root)}:{number}: {len(line)} characters, at most {MAX_PAGE_LINE}"
        for path in sorted([*root.glob("*.md"), *(root / "docs").rglob("*.md")])
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if len(line) > MAX_PAGE_LINE
    ]


def files(root: Path) -> Iterator[Path]:
    """Sources of the program, its tests and its tools."""
    for folder in ("src", "tests", "tools"):
        top = root / folder
        yield from sources_under(top)
        yield from sorted(p for p in top.rglob("*.py") if "__pycache__" not in p.parts)
        yield from sorted(top.rglob("*.c"))


def check(root: Path) -> list[str]:
    """Every fault found under ROOT."""
    faults = check_folders(root) + check_pages(root)
    for path in files(root):
        place = str(path.relative_to(root))
        text = path.read_text(encoding="utf-8")
        faults += check_lengths(place, text)
        if path.suffix != ".py":
            faults += check_leftovers(place, text)
        if path.suffix == ".f90":
            faults += check_fortran(place, text)
    return faults


def main(arguments: list[str]) -> int:
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    faults = check(root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
