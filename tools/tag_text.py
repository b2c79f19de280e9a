#!/usr/bin/env python3
"""Prints the text of the tag of a version: its section of CHANGELOG.md.

usage: tag_text.py [--draft]

    git tag -a --cleanup=whitespace v$(cat VERSION) -m "$(tools/tag_text.py)"

The version is that of VERSION. The changelog must give the day of the version, and CITATION.cff
the same version; --draft prints the text before.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class TagError(ValueError):
    """The files do not fit a version that is to be tagged."""


def tag_text(root: Path, is_draft: bool) -> str:
    """The text of the tag. Raises TagError."""
    version = (root / "VERSION").read_text(encoding="utf-8").strip()
    changes = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    pattern = rf"^## \[{re.escape(version)}\] - ([^\n]+)\n(.*?)(?=^## |\Z)"
    found = re.search(pattern, changes, re.MULTILINE | re.DOTALL)
    if found is None:
        raise TagError(f"CHANGELOG.md: expected a section '## [{version}] - YYYY-MM-DD'")
    day, text = found[1].strip(), found[2].strip()
    if not is_draft:
        if not re.fullmatch(r"\d{4}-\d{2}-\d{2}", day):
            raise TagError(f"CHANGELOG.md: [{version}]: found '{day}'; expected YYYY-MM-DD")
        citation = (root / "CITATION.cff").read_text(encoding="utf-8")
        if f"\nversion: {version}\n" not in citation:
            raise TagError(f"CITATION.cff: expected the line 'version: {version}'")
    # git takes lines that begin with # for comments.
    headings = re.sub(r"^### (.+)$", r"\1:", text, flags=re.MULTILINE)
    return f"Keyway {version}, {day}\n\n{headings}\n"


def main(arguments: list[str] | None = None) -> int:
    """Print the text."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draft", action="store_true", help="before the day is given")
    chosen = parser.parse_args(arguments)
    try:
        print(tag_text(ROOT, chosen.draft), end="")
    except TagError as error:
        print(f"tag_text: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
