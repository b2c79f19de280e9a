"""The check of citations finds each kind of fault in a made-up tree, and none in a right one."""

from pathlib import Path

import check_citations
import pytest

THEORY = """\
# Theory

See [the notes](paper_notes.md#joints), section 2 and (2.1).

## 2 Joints

### 2.1 Law

$$t = k v \\tag{2.1}$$

$$t = 0 \\tag{2.2a}$$
"""
NOTES = """\
# Notes

## Joints

1. The chain.
2. The overlap (Eq. 8; theory.md, 2 and (2.1)).
"""
SOURCE = """\
!> A law (theory.md, 2.1; theory.md, (2.1)-(2.2a)): Eqs. 9-13 with paper_notes.md, 1-2. Its second
!> line goes on: paper_notes.md,
!> 2.
module law
  character(*), parameter :: text = 'theory 99, Eq 99' ! in words of the program
end module law
"""
SCRIPT = '"""A test of theory.md, 2."""\n\ntext = "theory 99, NOTES 99"  # Eq. 8\n'
RIGHT = {
    "docs/theory.md": THEORY,
    "docs/paper_notes.md": NOTES,
    "src/law.f90": SOURCE,
    "tests/test_law.py": SCRIPT,
    "input/bar.inp": "** A bar (paper_notes.md, 2)\n*NODE\n1, 13.2\n",
}


def plant(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def test_right_tree_has_no_faults(tmp_path: Path) -> None:
    assert check_citations.check(plant(tmp_path, RIGHT)) == []


@pytest.mark.parametrize(
    ("name", "text", "fault"),
    [
        ("src/law.f90", "! theory.md, 2.7\n", "src/law.f90:1: theory.md has no section 2.7"),
        ("src/law.f90", "x = 1 ! theory.md, (2.9)\n", "theory.md has no equation 2.9"),
        ("src/law.f90", "!> a\n!> paper_notes.md, 1,\n!> 3\n", "paper_notes.md has no section 3"),
        ("src/law.f90", "! NOTES 2\n", "citations are spelt paper_notes.md, 8"),
        ("src/law.f90", "x = 'decreases (NOTES 11)'\n", "citations are spelt paper_notes.md, 8"),
        ("src/law.f90", "x = 'see '// &\n'paper_notes.md, 3'\n", "paper_notes.md has no section 3"),
        ("src/law.f90", "! of Eq 9\n", "citations are spelt Eq. 9 or Eqs. 14-25"),
        ("src/law.f90", "! of Eqs. 24-26\n", "the paper has no such equation"),
        ("src/law.f90", "! theory, (2.1)\n", "citations are spelt theory.md, 8 or (8.1)"),
        ("src/law.f90", "!\n! see DECK.md\n", "src/law.f90:2: there is no page 'DECK.md'"),
        ("tests/test_law.py", '"""Eq 9."""\n', "tests/test_law.py:1: 'Eq 9'"),
        ("input/bar.inp", "** NOTES 2\n", "input/bar.inp:1: 'NOTES 2'"),
        ("docs/a.md", "[x](gone.md)\n", "docs/a.md:1: the link 'gone.md' has no target"),
        ("docs/a.md", "\n[x](theory.md#no)\n", "docs/a.md:2: no heading '#no' in theory.md"),
        ("docs/theory.md", THEORY + "as in (2.7)\n", "docs/theory.md:12: no equation (2.7)"),
    ],
)
def test_fault_is_found(tmp_path: Path, name: str, text: str, fault: str) -> None:
    faults = check_citations.check(plant(tmp_path, RIGHT | {name: text}))
    assert any(fault in found for found in faults), faults


def test_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = plant(tmp_path, RIGHT)
    assert check_citations.main([str(root)]) == 0
    (root / "src/law.f90").write_text("! paper_notes.md, 77\n")
    assert check_citations.main([str(root)]) == 1
    assert "77" in capsys.readouterr().out
