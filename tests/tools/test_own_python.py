"""Scripts of tools/ find the Python of the checkout, or say how to get it."""

import sys
from pathlib import Path

import pytest
from keyway_tools import own_python

TOOLS = Path(__file__).resolve().parents[2] / "tools"


def test_a_python_without_packages_is_replaced(tmp_path, monkeypatch):
    called = []
    monkeypatch.setattr(own_python.os, "execv", lambda *words: called.append(words))
    monkeypatch.setattr(sys, "argv", ["tools/plot.py", "out"])
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    python.write_text("")
    own_python.run_with_own_python(tmp_path, ("json",))
    assert not called
    with pytest.raises(SystemExit):  # here, where execv returns
        own_python.run_with_own_python(tmp_path, ("json", "no_such_package"))
    assert called == [(python, [str(python), "tools/plot.py", "out"])]


def test_without_a_venv_one_line_says_what_to_do(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["tools/plot.py"])
    with pytest.raises(SystemExit) as stop:
        own_python.run_with_own_python(tmp_path, ("no_such_package",))
    assert stop.value.code == 3
    told = capsys.readouterr().err
    assert told.startswith(f"plot: {sys.executable} has no package no_such_package; call tools/set")
    assert told.endswith(f"{tmp_path}/bin/python tools/plot.py\n")


def test_scripts_for_users_can_be_executed():
    for name in ("batch", "compare", "make_dam", "make_jinping", "make_motion", "make_temperature",
                 "paper_study", "plot", "same_results"):  # fmt: skip
        script = TOOLS / f"{name}.py"
        assert script.stat().st_mode & 0o100, script
        assert "import keyway_tools.own_python" in script.read_text()
