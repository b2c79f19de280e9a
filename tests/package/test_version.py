"""One version: of the program, of the package, of the citation."""

from __future__ import annotations

import json
import re
import subprocess

from harness import ROOT

VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def test_the_program_has_the_version_of_the_file(program_path):
    text = subprocess.run(
        [program_path, "--version"], capture_output=True, text=True, check=True
    ).stdout
    assert text.splitlines()[0].split()[-1] == VERSION, json.dumps(text)


def test_the_citation_has_the_version():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", text, re.MULTILINE)[1] == VERSION
