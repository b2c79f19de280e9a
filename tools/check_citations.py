"""Checks that every citation has a target.

Pages are cited by name, with a section or, in brackets, an equation: `theory.md, 8` and
`theory.md, (8.1)`. The numbered notes on the paper are `paper_notes.md, 8`. `Eq. 9` and
`Eqs. 14-25` are equations of the paper. Links in Markdown lead to files and headings that exist.
Comments and docstrings of sources and decks are read, and texts of the program in Fortran (help,
messages), where pages and bare notes count as citations. Other texts are not citations.

usage: check_citations.py [ROOT]
"""

from __future__ import annotations

import io
import re
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

EQUATIONS_OF_THE_PAPER = 25
READ = {".md", ".py", ".f90", ".for", ".inp", ".toml", ".cmake", ".sh", ".txt", ""}
LARGEST = 300_000  # bytes; larger files are meshes and records, without citations
# Texts of the program, and files that programs of the repository write.
TEXTS = re.compile(r"docs/keywords\.md|tests/errors/[^/]+/expected\.txt")
WRITTEN = {"tables.md"}

NUMBER = r"\d+(?:\.\d+)*[a-z]?"
ITEM = rf"\(?{NUMBER}\)?(?:-\(?{NUMBER}\)?)?"
PAGE = re.compile(r"(?<![\w{*<])([\w./-]*\w\.md)\b(?!\()")
MORE = rf"(?:,| and)\s{ITEM}(?![\w.]*\s?[%a-zA-Z])"
CITED = re.compile(rf"\b([\w-]+\.md)\)?,\s({ITEM}(?:{MORE})*)")
EQUATION = re.compile(r"\bEqs?\.\s(\d+)(?:(?:-|\sand\s)(\d+))?")
BARE_NOTE = (re.compile(r"\bNOTES\s\d"), "paper_notes.md, 8")
OLD = (
    BARE_NOTE,
    (re.compile(r"\bEqs?\s\d"), "Eq. 9 or Eqs. 14-25"),
    (re.compile(r"\btheory,?\s\(?\d+(?:\.\d+[a-z]?)?\b(?![-e])"), "theory.md, 8 or (8.1)"),
    (re.compile(r"\.md,?\ssections?\s\d"), "theory.md, 8"),
)
# An equation of the page itself.
OWN = re.compile(r"\((\d{1,2}\.\d{1,2}(?:\.\d)?[a-z]?)\)")
LINK = re.compile(r"!?\[[^\]\n]*\]\(([^)\s]+)\)")
# Marks at the start of a line of a comment.
MARKS = re.compile(r"^\s*(?:!>|!<|!|#:?|\*\*|//)?\s*")


@dataclass
class Page:
    """A page of the documentation, with its headings, notes and equations."""

    path: Path
    sections: set[str] = field(default_factory=set)
    equations: set[str] = field(default_factory=set)
    anchors: set[str] = field(default_factory=set)


def anchor_of(heading: str) -> str:
    """The anchor GitHub gives to a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def without_code(text: str) -> str:
    """Markdown without its blocks of code; their lines stay, empty."""
    text = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.M | re.S)
    return re.sub(r"^ {4}(?! *[-*+] ).*$", "", text, flags=re.M)


def read_page(path: Path) -> Page:
    """The headings, numbered notes and equations of a page."""
    text = without_code(path.read_text(encoding="utf-8"))
    page, seen = Page(path), {}
    for heading in re.findall(r"^#+ +(.*)$", text, flags=re.M):
        name = anchor_of(heading)
        page.anchors.add(name if name not in seen else f"{name}-{seen[name]}")
        seen[name] = seen.get(name, 0) + 1
        if found := re.match(rf"({NUMBER})\.? ", heading):
            page.sections.add(found[1])
    page.sections |= set(re.findall(r"^(\d+)\. ", text, flags=re.M))
    page.equations = set(re.findall(rf"\\tag\{{({NUMBER})\}}", text))
    page.anchors |= set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))
    return page


def tracked_files(root: Path) -> list[Path]:
    """Files of the repository that may cite something."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode == 0:
        paths = [root / name for name in listed.stdout.splitlines()]
    else:
        paths = [p for p in root.rglob("*") if not any(x.startswith(".") for x in p.parts)]
    return sorted(
        p for p in paths if p.is_file() and p.suffix in READ and p.stat().st_size <= LARGEST
    )


def comments_of_python(text: str) -> list[str]:
    """The lines of a Python source, of which only comments and docstrings are left."""
    lines = [""] * (text.count("\n") + 1)
    before = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        begins = before in {tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and begins):
            for number, line in enumerate(token.string.split("\n"), token.start[0] - 1):
                lines[number] = line.strip('"')
        if token.type not in {tokenize.COMMENT, tokenize.NL}:
            before = token.type
    return lines


def split_fortran(line: str) -> tuple[str, str]:
    """The texts in quotes and the comment of a line of Fortran."""
    quote, texts = "", ""
    for place, letter in enumerate(line):
        if quote:
            quote = "" if letter == quote else quote
            texts += letter if quote else ""
        elif letter in "'\"":
            quote = letter
        elif letter == "!":
            return texts, line[place:]
    return texts, ""


def joined(lines: list[str]) -> tuple[str, list[int]]:
    """Lines joined by blanks, and the start of each line."""
    starts, place = [], 0
    for line in lines:
        starts.append(place)
        place += len(line) + 1
    return " ".join(lines), starts


def texts_of_fortran(path: Path) -> tuple[str, list[int]]:
    """Texts in quotes, and the start of each line."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    return joined([split_fortran(line)[0].strip() for line in lines])


def prose(path: Path) -> tuple[str, list[int]]:
    """Text without marks of comments, lines joined by blanks, and the start of each line."""
    text = path.read_text(encoding="utf-8", errors="replace")
    lines = text.splitlines()
    if path.suffix == ".f90":
        lines = [split_fortran(line)[1] for line in lines]
    elif path.suffix == ".py":
        lines = comments_of_python(text)
    elif path.suffix == ".inp":
        lines = [line if line.startswith("**") else "" for line in lines]
    if path.suffix != ".md":
        lines = [MARKS.sub("", line) for line in lines]
    return joined([line.strip() for line in lines])


def line_of(starts: list[int], place: int) -> int:
    return sum(1 for start in starts if start <= place)


def line_of_text(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1


def numbers_in(cited: str) -> list[tuple[str, bool]]:
    """Numbers of '7.1-7.2' or '(11.13), 12', and whether each is an equation."""
    return [(n.strip("()"), n[0] == "(") for n in re.findall(rf"\(?{NUMBER}\)?", cited)]


def check_prose(path: Path, root: Path, pages: dict[str, Page]) -> list[str]:
    """Faults of the citations in one file."""
    text, starts = prose(path)
    place = path.relative_to(root)
    found = [*wrong_spellings(text), *lost_pages(text, path, root, pages)]
    found += [*wrong_equations(text), *wrong_numbers(text, pages)]
    faults = [f"{place}:{line_of(starts, at)}: {fault}" for at, fault in found]
    if path.suffix == ".f90":
        text, starts = texts_of_fortran(path)
        found = [*wrong_spellings(text, (BARE_NOTE,)), *wrong_numbers(text, pages)]
        faults += [f"{place}:{line_of(starts, at)}: {fault}" for at, fault in found]
    return faults


def wrong_spellings(text: str, patterns: tuple = OLD) -> Iterator[tuple[int, str]]:
    """Citations in an old spelling."""
    for pattern, better in patterns:
        for found in pattern.finditer(text):
            yield found.start(), f"'{found[0]}': citations are spelt {better}"


def wrong_equations(text: str) -> Iterator[tuple[int, str]]:
    """Equations that the paper does not have."""
    for found in EQUATION.finditer(text):
        if any(int(n) > EQUATIONS_OF_THE_PAPER for n in found.groups() if n):
            yield found.start(), f"'{found[0]}': the paper has no such equation"


def lost_pages(
    text: str, path: Path, root: Path, pages: dict[str, Page]
) -> Iterator[tuple[int, str]]:
    """Pages that do not exist."""
    for found in PAGE.finditer(text):
        name = found[1]
        near = (path.parent / name, root / name, root / "docs" / name)
        is_known = Path(name).name in WRITTEN | pages.keys()
        if not is_known and not any(p.exists() for p in near):
            yield found.start(), f"there is no page '{name}'"


def wrong_numbers(text: str, pages: dict[str, Page]) -> Iterator[tuple[int, str]]:
    """Sections and equations that a page does not have."""
    for found in CITED.finditer(text):
        page = pages.get(found[1])
        for number, is_equation in numbers_in(found[2]) if page else ():
            if number not in (page.equations if is_equation else page.sections):
                kind = "equation" if is_equation else "section"
                yield found.start(), f"{found[1]} has no {kind} {number}"


def check_own_equations(page: Page, root: Path, known: set[str]) -> list[str]:
    """Numbers in brackets, on a page with equations, without an equation."""
    if not page.equations:
        return []
    text = without_code(page.path.read_text(encoding="utf-8"))
    text = re.sub(r"^\|.*$", "", text, flags=re.M)
    return [
        f"{page.path.relative_to(root)}:{line_of_text(text, found.start())}: no equation {found[0]}"
        for found in OWN.finditer(text)
        if found[1] not in known
    ]


def check_links(path: Path, root: Path, pages: dict[Path, Page]) -> list[str]:
    """Faults of the relative links of a page."""
    faults = []
    text = without_code(path.read_text(encoding="utf-8"))
    for found in LINK.finditer(text):
        target, _, anchor = found[1].partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        line = text.count("\n", 0, found.start()) + 1
        goal = (path.parent / target).resolve() if target else path.resolve()
        if not goal.exists():
            faults.append(f"{path.relative_to(root)}:{line}: the link '{found[1]}' has no target")
        elif anchor and goal in pages and anchor not in pages[goal].anchors:
            faults.append(f"{path.relative_to(root)}:{line}: no heading '#{anchor}' in {goal.name}")
    return faults


def check(root: Path) -> list[str]:
    """Every fault found under ROOT."""
    root = root.resolve()
    files = tracked_files(root)
    markdown = [read_page(p) for p in files if p.suffix == ".md"]
    of_path = {page.path.resolve(): page for page in markdown}
    # Of two pages with one name, the citation means the page directly in docs/.
    named = {page.path.name: page for page in sorted(markdown, key=lambda p: -len(p.path.parts))}
    own = {Path(__file__).resolve(), root / "tests" / "tools" / "test_check_citations.py"}
    faults = []
    for path in files:
        if path.resolve() in own or TEXTS.fullmatch(path.relative_to(root).as_posix()):
            continue
        faults += check_prose(path, root, named)
    equations = set().union(*(page.equations for page in markdown))
    for page in markdown:
        faults += check_links(page.path, root, of_path)
        faults += check_own_equations(page, root, equations)
    return faults


def main(arguments: list[str]) -> int:
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    faults = check(root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
