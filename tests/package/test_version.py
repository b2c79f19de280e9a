"""One version: of the program, of the package, of the citation."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest
from harness import ROOT
from tag_text import TagError, tag_text

VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def test_the_program_has_the_version_of_the_file(program_path):
    text = subprocess.run(
        [program_path, "--version"], capture_output=True, text=True, check=True
    ).stdout
    assert text.splitlines()[0].split()[-1] == VERSION, json.dumps(text)


def test_the_citation_has_the_version():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", text, re.MULTILINE)[1] == VERSION


def test_the_changelog_has_the_version():
    done = subprocess.run(
        [sys.executable, ROOT / "tools/tag_text.py", "--draft"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"Keyway {VERSION}, ")
    assert "\nAdded:\n" in done.stdout
    assert re.search(r"^#", done.stdout, re.M) is None  # git would drop the line


def test_the_text_of_a_tag(tmp_path):
    (tmp_path / "VERSION").write_text("1.2.0\n")
    (tmp_path / "CITATION.cff").write_text("title: K\nversion: 1.2.0\n")
    changes = tmp_path / "CHANGELOG.md"
    changes.write_text(
        "# C\n\n## [1.2.0] - 2027-01-02\n\n### Deprecated\n\n- a\n\n## [1.1.0]\n- b\n"
    )
    assert tag_text(tmp_path, False) == "Keyway 1.2.0, 2027-01-02\n\nDeprecated:\n\n- a\n"
    (tmp_path / "CITATION.cff").write_text("version: 1.1.0\n")
    with pytest.raises(TagError, match=r"CITATION\.cff: expected the line 'version: 1\.2\.0'"):
        tag_text(tmp_path, False)
    changes.write_text("## [1.2.0] - not released\n")
    with pytest.raises(TagError, match="found 'not released'; expected YYYY-MM-DD"):
        tag_text(tmp_path, False)
    changes.write_text("## [1.1.0] - 2027-01-02\n")
    with pytest.raises(TagError, match=r"expected a section '## \[1\.2\.0\]"):
        tag_text(tmp_path, True)
