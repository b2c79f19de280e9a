"""The examples of docs/python.md, run from top to bottom."""

from __future__ import annotations

import re
import shutil
import textwrap

from harness import ROOT


def examples() -> str:
    """The indented blocks of the page as one script."""
    page = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"(?:^    .*\n(?:\n(?=    ))?)+", page, re.MULTILINE)
    return "\n".join(textwrap.dedent(block) for block in blocks)


def test_the_page_runs(program_path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("KEYWAY", str(program_path))
    shutil.copy(ROOT / "input/block_on_joint.inp", "dam.inp")
    names: dict = {}
    exec(compile(examples(), "docs/python.md", "exec"), names)
    text = capsys.readouterr().out
    assert "2 " in text
    assert "expected" in text  # the message of the wrong law
    assert names["warped"].n_points == names["grid"].n_points
    # The block does not slide with any of these (the head of the deck has the forces).
    assert all(opening > 0.0 for _, opening in names["rows"])
