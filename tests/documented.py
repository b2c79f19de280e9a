"""Tables of docs/verification.md that tests compare with what they compute.

A comment names such a table in the line above it: `<!-- table NAME -->`. Columns are found by their
heads, rows by their first cells; an empty first cell repeats the one above.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

# A number, the digits behind its point, its exponent, and a sign of percent.
NUMBER = re.compile(r"(?<![\w.:])([-+]?\d+(?:\.(\d+))?(?:e([-+]?\d+))?)(?![\w.]|:\d)( ?%)?")
# Half a unit of the last digit is rounding; the rest is for round-off next to a half.
SLACK = 0.55


@dataclass
class Documented:
    """A page with tables; `update` writes the numbers to the page and compares nothing."""

    path: Path
    update: bool = False

    def __call__(self, table: str, row: str | tuple[str, ...], column: str, *values: float) -> None:
        """Asserts that the numbers of a cell are the values, to the digits on the page."""
        lines = self.path.read_text(encoding="utf-8").splitlines()
        at, place = find_cell(lines, table, (row,) if isinstance(row, str) else row, column)
        cells = lines[at].split("|")
        old = list(NUMBER.finditer(cells[place]))
        assert len(old) == len(values), (
            f"table {table}, {row}, {column}: '{cells[place].strip()}' is not {len(values)} numbers"
        )
        if self.update:
            for found, value in zip(reversed(old), reversed(values), strict=True):
                cell = cells[place]
                cells[place] = cell[: found.start(1)] + written(found, value) + cell[found.end(1) :]
            lines[at] = "|".join(cells)
            self.path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            return
        for found, value in zip(old, values, strict=True):
            distance = abs(scaled(found, value) - float(found[1]))
            assert distance <= SLACK * unit(found), (
                f"table {table}, {row}, {column}: the page has {found[0].strip()}, computed "
                f"{scaled(found, value):.6g}; pytest --update-tables writes the page anew"
            )


def find_cell(lines: list[str], table: str, row: tuple[str, ...], column: str) -> tuple[int, int]:
    """The line of a cell and its position among the parts between the bars."""
    mark = f"<!-- table {table} -->"
    assert lines.count(mark) == 1, f"the page has no table '{table}', or two"
    head = next(i for i in range(lines.index(mark), len(lines)) if lines[i].startswith("|"))
    heads = [cell.strip() for cell in lines[head].split("|")]
    assert heads.count(column) == 1, f"table {table} has no column '{column}', or two"
    above = [""] * len(row)
    for at in range(head + 2, len(lines)):
        if not lines[at].startswith("|"):
            break
        first = [cell.strip() for cell in lines[at].split("|")[1 : len(row) + 1]]
        above = [new or old for new, old in zip(first, above, strict=True)]
        if tuple(above) == row:
            return at, heads.index(column)
    raise AssertionError(f"table {table} has no row {row}")


def unit(number: re.Match) -> float:
    """One in the last digit of a number on the page."""
    return 10.0 ** (int(number[3] or 0) - len(number[2] or ""))


def scaled(number: re.Match, value: float) -> float:
    return 100.0 * value if number[4] else value


def written(number: re.Match, value: float) -> str:
    """A value with as many digits as the number on the page."""
    digits, value = len(number[2] or ""), scaled(number, value)
    sign = "+" if number[1].startswith("+") else ""
    if number[3] is None:
        return f"{value:{sign}.{digits}f}"
    mantissa, exponent = f"{value:{sign}.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"
