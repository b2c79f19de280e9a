#!/usr/bin/env python3
"""Write the studies of decks in docs/accuracy.md from the data that tools/accuracy has left.

    tools/accuracy input/xingbiling_matching/xingbiling_matching.inp --threads 1 --budget 20m
    tools/make_accuracy.py --take xingbiling_matching_accuracy
    tools/make_accuracy.py                  # writes page and pictures again
    tools/make_accuracy.py --check          # exit code 1 if page and data differ

The data of each study is docs/studies/accuracy/DECK.json; the page has them between two comments,
the pictures are docs/pictures/accuracy_of_DECK.png.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway_tools.command import Parser
from keyway_tools.study.facts import NAMES
from keyway_tools.study.measured import time_in_words
from keyway_tools.study.pictures import draw
from keyway_tools.study.words import (
    percent,
    sentence_of_check,
    sentence_of_choice,
    sentence_of_place,
    signed,
)

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "docs/studies/accuracy"
PAGE = ROOT / "docs/accuracy.md"
PICTURES = ROOT / "docs/pictures"
# Heads of tables; S1 is that which 1 % of the volume exceed
SHORT = {
    "displacement": "displacement", "stress": "S1", "opening": "opening", "damage": "cracking",
    "frequency": "frequency",
}  # fmt: skip
BEGIN = "<!-- studies: written by tools/make_accuracy.py -->"
END = "<!-- end of studies -->"


def rows_of_check(check: dict[str, Any]) -> list[str]:
    """Errors that were said and those that the finer run shows, variant by variant."""
    known = list(dict.fromkeys(row["quantity"] for row in check["rows"]))
    names = list(dict.fromkeys(row["name"] for row in check["rows"]))
    found = {(row["name"], row["quantity"]): row for row in check["rows"]}
    lines = ["| error said, found |" + "".join(f" {SHORT[one]} |" for one in known)]
    lines += ["|---|" + "---|" * len(known)]
    for name in names:
        cells = (found.get((name, one)) for one in known)
        texts = (
            "" if c is None else f"{percent(c['promised'])}, {percent(c['found'])}" for c in cells
        )
        lines += [f"| {name} |" + "".join(f" {text} |" for text in texts)]
    return lines


def studies() -> list[dict[str, Any]]:
    """The data of all studies, by the names of their decks."""
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(DATA.glob("*.json"))]


def name_of(facts: dict[str, Any]) -> str:
    """The deck, and the duration of a study of its first seconds: 'gmsh_arch_0.3s'."""
    found = re.search(r"first (\S+) s", dict(facts["header"]).get("Duration", ""))
    return Path(facts["deck"]).stem + (f"_{found[1]}s" if found else "")


def model_of(header: dict[str, str]) -> str:
    """'1,368 unknowns, 41 increments: the first 0.4 s of each dynamic step'."""
    return header["Model"] + (f": {header['Duration']}" if "Duration" in header else "")


def section(facts: dict[str, Any]) -> str:
    """A study as Markdown."""
    header = dict(facts["header"])
    lines = [
        f"### {name_of(facts)}",
        "",
        wrapped(f"{model_of(header)}. {facts['what_seconds_are']}"),
        "",
        "| quantity | deck | its error | increment | mesh | iteration | limit |",
        "|---|---|---|---|---|---|---|",
        *(row_of(one) for one in facts["quantities"]),
        "",
        f"The deck takes {time_in_words(facts['seconds'])}. What to choose:",
        "",
        *(choice for one in facts["quantities"] for choice in choices_of(one)),
    ]
    if check := facts["verified"]:
        text = sentence_of_check(check)
        lines += ["", wrapped(text[0].upper() + text[1:]), "", *rows_of_check(check)]
    if place := facts["singular"]:
        lines += ["", wrapped(sentence_of_place(place))]
    if facts["changes"]:
        heads = "".join(f" {SHORT[one['quantity']]} |" for one in facts["quantities"])
        lines += ["", f"| other variants | time |{heads}", "|---|---|" + "---|" * heads.count("|")]
    lines += [row_of_change(change, facts) for change in facts["changes"]]
    if any(one["error"] is not None for one in facts["quantities"]):
        picture = f"pictures/accuracy_of_{name_of(facts)}.png"
        lines += ["", f"![Errors over seconds of the variants of {name_of(facts)}]({picture})"]
    return "\n".join(lines) + "\n"


def wrapped(text: str) -> str:
    """Prose in lines of the usual length."""
    return textwrap.fill(text, 118, break_long_words=False, break_on_hyphens=False)


def row_of(one: dict[str, Any]) -> str:
    """A quantity with its error and the parts of the error."""
    start = f"| {SHORT[one['quantity']]} | {one['value']:.4g}"
    if one["error"] is None:
        parts = " | ".join(percent(one[key]) for key in ("increment", "mesh"))
        return f"{start} | not known | {parts} | | |"
    if one["error"] > 1.0:
        return f"{start} | does not converge | | | | |"
    parts = " | ".join(percent(one[key]) for key in ("error", "increment", "mesh", "iteration"))
    return f"{start} | {parts} | {one['limit']:.4g} ± {percent(one['uncertainty'])} |"


def choices_of(one: dict[str, Any]) -> list[str]:
    """'- largest opening. 10 %: ..' A quantity that does not converge has no choices."""
    if not one["choices"] or one["error"] > 1.0:
        return []
    return [f"- {NAMES[one['quantity']]}", *(f"  - {sentence_of_choice(c)}" for c in
            one["choices"])]  # fmt: skip


def row_of_change(change: dict[str, Any], facts: dict[str, Any]) -> str:
    if "why_not" in change:
        return f"| {change['name']} | {change['why_not']} |" + " |" * len(facts["quantities"])
    cells = [change["changes"].get(one["quantity"]) for one in facts["quantities"]]
    words = " | ".join("" if cell is None else signed(cell) for cell in cells)
    return f"| {change['name']} | {change['time']:.2g} times | {words} |"


def page_with(text: str) -> str:
    """The page with the sections between the two comments."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, mark, after = rest.partition(END)
    if not mark:
        raise SystemExit(f"make_accuracy: {PAGE} lacks '{BEGIN}' and '{END}'")
    return f"{before}{BEGIN}\n{text}{END}{after}"


def main(arguments: list[str]) -> int:
    parser = Parser(
        prog="make_accuracy.py", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--check", action="store_true", help="write nothing, compare")
    parser.add_argument("--take", type=Path, nargs="+", default=[], metavar="DIR",
                        help="folders of studies whose data is kept here")  # fmt: skip
    given = parser.parse_args(arguments)
    for folder in given.take:
        facts = json.loads((folder / "accuracy.json").read_text(encoding="utf-8"))
        facts["header"] = [
            [name, Path(text).name if name == "Deck" else text] for name, text in facts["header"]
        ]
        text = json.dumps(facts, indent=1) + "\n"
        DATA.mkdir(parents=True, exist_ok=True)
        (DATA / f"{name_of(facts)}.json").write_text(text, encoding="utf-8")
    found = studies()
    page = page_with("\n".join(section(facts) for facts in found))
    if given.check:
        return int(page != PAGE.read_text(encoding="utf-8"))
    PAGE.write_text(page, encoding="utf-8")
    for facts in found:
        if picture := draw(facts):
            (PICTURES / f"accuracy_of_{name_of(facts)}.png").write_bytes(picture)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
