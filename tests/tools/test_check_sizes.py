"""The size check measures procedures, arguments, nesting and leftovers."""

from pathlib import Path

import check_sizes
import pytest
from fortran_source import procedures


def subroutine(name: str, body: list[str], arguments: str = "a") -> str:
    return "\n".join([f"subroutine {name}({arguments})", *body, f"end subroutine {name}", ""])


def faults_of(tmp_path: Path, text: str, name: str = "src/base/x.f90") -> list[str]:
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return check_sizes.check(tmp_path)


def test_procedures_are_measured():
    text = """module m
  implicit none
  abstract interface
    subroutine declared(a)
      integer, intent(in) :: a
    end subroutine declared
  end interface
contains
  pure elemental real(kind(1.0d0)) function &
    first(a, & ! a comment with (parentheses
      b)
    real, intent(in) :: a, b
    first = merge(a, b, a > b); if (first > 0) first = -first
  end function first

  !> A text about a function nothing(x).
  recursive subroutine second
    print '(a)', 'end subroutine second'
    call inside
  contains
    subroutine inside()
      integer :: i
      do i = 1, 2
        if (i > 1) then
          block
            print *, i
          end block
        end if
      end do
    end subroutine inside
  end subroutine second
end module m
"""
    found = procedures(text)
    assert [p.name for p in found] == ["first", "second", "inside"]
    assert [p.lines for p in found] == [6, 5, 10]
    assert [p.arguments for p in found] == [["a", "b"], [], []]
    assert [p.deepest for p in found] == [0, 0, 3]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("x = 1\n" * 401, "401 lines, at most 400"),
        (subroutine("long", ["a = 1"] * 59), "long has 61 lines, at most 60"),
        (subroutine("wide", [], "a, b, c, d, e, f, g, h, i"), "wide has 9 arguments, at most 8"),
        (
            subroutine("deep", ["do i = 1, 2"] * 5 + ["end do"] * 5),
            "deep nests 5 deep, at most 4",
        ),
        (subroutine("ending", ["if (a > 0) stop 1"]), "src/base/x.f90:2: only src/app"),
        ("! TO" + "DO later\n", "src/base/x.f90:1: leftover"),
        ("<" * 7 + " HEAD\n", "leftover"),
        ("x = 1 \n", "blanks at the end of the line"),
        ("\tx = 1\n", "a tab"),
    ],
)
def test_fault_is_found(tmp_path, text, fault):
    assert any(fault in found for found in faults_of(tmp_path, text))


def test_limits_are_allowed(tmp_path):
    body = ["do i = 1, 2"] * 4 + ["a = 1"] * 50 + ["end do"] * 4
    text = subroutine("right", body, "a, b, c, d, e, f, g, h") + "error stop\n"
    assert faults_of(tmp_path, text) == []


def test_listed_kernel_may_be_longer(tmp_path, monkeypatch):
    text = subroutine("kernel", ["a = 1"] * 98)
    assert faults_of(tmp_path, text) != []
    monkeypatch.setattr(check_sizes, "KERNELS", {"kernel"})
    assert faults_of(tmp_path, text) == []


def test_files_of_a_folder_are_counted(tmp_path):
    folder = tmp_path / "src" / "base" / "text"
    folder.mkdir(parents=True)
    for number in range(15):
        (folder / f"file_{number}.f90").write_text("! nothing\n")
    assert check_sizes.check(tmp_path) == []
    (folder / "sources.cmake").write_text("")
    assert check_sizes.check(tmp_path) == ["src/base/text: 16 files, at most 15"]


def test_lines_of_pages_are_measured(tmp_path):
    row = "| " + "a" * 119 + "\n"
    assert faults_of(tmp_path, row[1:] + row, "docs/studies/x.md") == [
        "docs/studies/x.md:2: 121 characters, at most 120"
    ]


def test_python_files_are_measured(tmp_path):
    faults = faults_of(tmp_path, "a = 1\n" * 401, "tools/x.py")
    assert faults == ["tools/x.py: 401 lines, at most 400"]
