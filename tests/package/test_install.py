"""`cmake --install` into a prefix: what stands there is used from outside of the checkout."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from harness import ROOT

CONSUMER = Path(__file__).parent / "consumer"


def call(*words: Path | str, folder: Path, environment: dict[str, str] | None = None) -> str:
    """Output of a command that must succeed."""
    done = subprocess.run(
        [str(word) for word in words], cwd=folder, text=True, timeout=280,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        env={**os.environ, **(environment or {})},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-4000:]
    return done.stdout


def test_the_installed_program_runs(prefix, tmp_path):
    shutil.copy(ROOT / "input/cantilever.inp", tmp_path)
    program = prefix / "bin/keyway"
    call(program, "-q", "-j", "1", "-o", "results", "cantilever.inp", folder=tmp_path)
    summary = json.loads((tmp_path / "results/cantilever.json").read_text(encoding="utf-8"))
    assert summary["status"] == "finished"


def test_another_project_links_the_library(prefix, tmp_path):
    umat = ROOT / "input/umat/elastic.for"
    call("cmake", "-S", CONSUMER, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
         f"-DUMAT={umat}", "-DCMAKE_BUILD_TYPE=Release", folder=tmp_path)  # fmt: skip
    call("cmake", "--build", tmp_path / "build", folder=tmp_path)
    words = call(tmp_path / "build/consumer", folder=tmp_path).split()
    # Three equal displacements, and the principal stresses 1, 0, -1 of pure shear 1.
    assert [float(word) for word in words] == [1.0, 1.0, 1.0, 1.0, 0.0, -1.0]
    deck = ROOT / "input/umat/elastic.inp"
    call(prefix / "bin/keyway", "-q", "--umat", tmp_path / "build/steel.so", deck, folder=tmp_path)


def test_what_umats_need(prefix, tmp_path):
    """The include file is the one that the program writes; ours compiles and runs alone."""
    include = (prefix / "include/keyway/ABA_PARAM.INC").read_text(encoding="utf-8")
    source = (ROOT / "src/materials/umat/umat_build.f90").read_text(encoding="utf-8")
    for line in include.splitlines():
        assert f"'{line}'//nl" in source
    umat = prefix / "share/keyway/umat"
    call(prefix / "bin/keyway", "--umat", umat / "umat_concrete.f90", "--umat-library",
         tmp_path / "concrete.so", folder=tmp_path)  # fmt: skip
    assert (tmp_path / "concrete.so").stat().st_size > 10_000
    call(prefix / "bin/keyway", "-q", "--umat", umat / "plastic_j2.f90", umat / "plastic_j2.inp",
         folder=tmp_path)  # fmt: skip


def test_all_options_are_in_help_completion_and_manual(prefix, tmp_path):
    program = prefix / "bin/keyway"
    options = set(re.findall(r"^  (-[-a-z0-9]+)", call(program, "--help", folder=tmp_path), re.M))
    manual = (prefix / "share/man/man1/keyway.1").read_text(encoding="utf-8").replace("\\-", "-")
    described = set(re.findall(r"^\.B (-[-a-z0-9]+)", manual, re.M))
    assert described == options
    assert set(complete(prefix, tmp_path, "-")) == options


def complete(prefix: Path, folder: Path, word: str, before: str = "keyway") -> list[str]:
    """What bash completes for a word."""
    file = prefix / "share/bash-completion/completions/keyway"
    script = f'source "{file}"; _keyway "{prefix}/bin/keyway" "{word}" "{before}" 2>/dev/null; '
    script += 'printf "%s\\n" "${COMPREPLY[@]}"'
    return call("bash", "--norc", "-c", script, folder=folder).splitlines()


def test_completion(prefix, tmp_path):
    (tmp_path / "dam.inp").touch()
    (tmp_path / "dam.txt").touch()
    (tmp_path / "data").mkdir()
    assert sorted(complete(prefix, tmp_path, "da")) == ["dam.inp", "data"]
    assert complete(prefix, tmp_path, "da", "-o") == ["data"]
    assert complete(prefix, tmp_path, "base", "--keywords") == ["BASE\\ MOTION"]
    assert complete(prefix, tmp_path, "OPEN", "--fields") == ["OPENING"]
    assert complete(prefix, tmp_path, "no-s", "--explain") == ["no-support"]
    assert complete(prefix, tmp_path, "--che") == ["--check"]


def test_the_syntax_of_editors_knows_all_keywords(prefix, program_path, tmp_path):
    text = call(program_path, "--keywords", folder=tmp_path)
    keywords = {word.strip() for word in re.findall(r"^  \*([A-Z ]+?)  ", text, re.M)}
    assert len(keywords) > 50
    grammar = json.loads(
        (prefix / "share/keyway/vscode/syntaxes/keyway.tmLanguage.json").read_text(encoding="utf-8")
    )
    control, unknown = (
        re.compile(next(p["match"] for p in grammar["patterns"] if p["name"].startswith(name)))
        for name in ("keyword", "invalid")
    )
    assert [word for word in keywords if not control.search(f"*{word}, NAME=A")] == []
    assert control.search("*BASEMOTION")
    assert control.search("*END STEP")
    assert control.search("*ELASTICITY") is None
    assert unknown.search("*ELASTICITY")
    package = json.loads((prefix / "share/keyway/vscode/package.json").read_text(encoding="utf-8"))
    for contribution in package["contributes"].values():
        assert contribution


@pytest.mark.skipif(shutil.which("vim") is None, reason="no vim")
def test_vim_colours_a_deck(prefix, tmp_path):
    deck = "** note\n*NODE, NSET=ALL\n1, 0.5\n*BASE MOTION, DOF=1\n*NODES\n"
    (tmp_path / "dam.inp").write_text(deck)
    folder = prefix / "share/keyway/vim"
    ask = "echo synIDattr(synIDtrans(synID(%d, %d, 1)), 'name')"
    places = [(1, 1), (2, 2), (2, 8), (3, 4), (4, 6), (5, 2)]
    blanks = str(folder).replace(" ", "\\ ")
    commands = [f"set rtp^={blanks}", "filetype on", "syntax on", "edit", "redir! > found.txt"]
    commands += [ask % place for place in places]
    (tmp_path / "ask.vim").write_text("\n".join([*commands, "redir END", "qall!"]))
    call("vim", "-N", "-u", "NONE", "-i", "NONE", "-es", "-S", "ask.vim", "dam.inp",
         folder=tmp_path)  # fmt: skip
    found = (tmp_path / "found.txt").read_text().split()
    assert found == ["Comment", "Statement", "Identifier", "Constant", "Statement", "Error"]


@pytest.mark.skipif(shutil.which("dpkg") is None, reason="no dpkg")
def test_the_package_of_debian(build, tmp_path):
    """Built by cpack, installed by dpkg below another root, run from there, and removed."""
    call("cpack", "--config", build / "CPackConfig.cmake", "-B", tmp_path, folder=tmp_path)
    (package,) = tmp_path.glob("keyway_*.deb")
    control = call("dpkg-deb", "--field", package, folder=tmp_path)
    version = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
    assert f"Version: {version}" in control
    assert re.search(r"^Depends: .*libgfortran5.*libhdf5", control, re.M)
    root = tmp_path / "root"
    for name in ("info", "updates"):
        (root / "var/lib/dpkg" / name).mkdir(parents=True)
    for name in ("status", "available"):
        (root / "var/lib/dpkg" / name).touch()
    # This root has no other packages: those that the package needs are in the system's root.
    dpkg = ["dpkg", f"--root={root}", f"--log={tmp_path}/log", "--force-not-root"]
    call(*dpkg, "--force-depends", "--force-bad-path", "-i", package, folder=tmp_path)
    assert f"ii  keyway         {version}" in call(*dpkg, "-l", folder=tmp_path)
    deck = ROOT / "input/cantilever.inp"
    call(root / "usr/bin/keyway", "-q", "-j", "1", "-o", "results", deck, folder=tmp_path)
    assert (root / "usr/share/man/man1/keyway.1").exists()
    call(*dpkg, "--force-bad-path", "-r", "keyway", folder=tmp_path)
    assert not (root / "usr/bin/keyway").exists()


def test_the_syntax_tool_says_what_it_needs(tmp_path):
    done = subprocess.run(
        [sys.executable, ROOT / "tools/make_syntax.py"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "--vim DIR or --vscode DIR" in done.stderr
