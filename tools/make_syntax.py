"""Writes syntax highlighting of decks for Vim and VS Code, from the keywords of the program.

usage: make_syntax.py [--program PATH] [--vim DIR] [--vscode DIR]

DIR of --vim is a folder of Vim's runtime path, that of --vscode becomes an extension: a folder to
be copied into ~/.vscode/extensions. `cmake --install` calls this tool.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from make_keywords import ROOT, ask, read_families, read_keywords

PARAMETER = re.compile(r"[A-Z][A-Z0-9 ]*")


@dataclass
class Names:
    """What a deck may hold: names of keywords and of parameters, and the values of choices."""

    keywords: list[str] = field(default_factory=list)
    parameters: list[str] = field(default_factory=list)
    values: list[str] = field(default_factory=list)


def read_names(program: Path) -> Names:
    """The names, each once, the longest first: patterns take the first that fits."""
    found = Names()
    for _, names in read_families(ask(program)):
        for name in dict.fromkeys(names):
            found.keywords.append(name)
            for keyword in read_keywords(ask(program, name)):
                for title, rows in keyword.blocks:
                    if not title.startswith("Data"):
                        take_parameters(rows, found)
    for names in (found.keywords, found.parameters, found.values):
        names[:] = sorted(set(names), key=lambda name: (-len(name), name))
    return found


def take_parameters(rows: list[tuple[str, str]], found: Names) -> None:
    """Names of parameters and the values of those that are a choice."""
    for name, text in rows:
        if not PARAMETER.fullmatch(name):
            continue
        found.parameters.append(name)
        if choices := re.search(r"one of ((?:[A-Z][A-Z0-9 -]*(?:, )?)+)", text):
            found.values += [word.strip() for word in choices[1].split(",") if word.strip()]


def any_of(names: list[str], blank: str) -> str:
    """An expression for one of the names; `blank` is one for the blanks in a name."""
    return "|".join(blank.join(map(re.escape, name.split())) for name in names)


def write_vim(names: Names, folder: Path, version: str) -> None:
    """syntax/keyway.vim and ftdetect/keyway.vim."""
    keyword, parameter = (
        any_of(part, r"\s*").replace("|", r"\|").replace("\\-", "-")
        for part in (names.keywords, names.parameters)
    )
    value = any_of(names.values, r"\s+").replace("|", r"\|").replace("\\-", "-")
    value = value.replace(r"\s+", r"\s\+")
    text = f"""\" Vim syntax of decks of Keyway {version}; written by tools/make_syntax.py.
if exists("b:current_syntax")
  finish
endif
syntax case ignore
syntax match keywayNumber /\\v[-+]?(\\d+\\.?\\d*|\\.\\d+)([ed][-+]?\\d+)?/
syntax match keywayUnknown /^\\s*\\*[^*,].\\{{-}}\\ze\\(,\\|$\\)/
syntax match keywayKeyword /^\\s*\\*\\s*\\({keyword}\\)\\s*\\ze\\(,\\|$\\)/
syntax match keywayParameter /,\\s*\\zs\\({parameter}\\)\\ze\\s*\\(=\\|,\\|$\\)/
syntax match keywayParameter /^\\s*\\zs\\({parameter}\\)\\ze\\s*=/
syntax match keywayValue /=\\s*\\zs\\({value}\\)\\ze\\s*\\(,\\|$\\)/
syntax region keywayText start=/"/ end=/"/ oneline
syntax match keywayComment /^\\s*\\*\\*.*$/
highlight default link keywayComment Comment
highlight default link keywayKeyword Statement
highlight default link keywayNumber Number
highlight default link keywayParameter Identifier
highlight default link keywayText String
highlight default link keywayUnknown Error
highlight default link keywayValue Constant
let b:current_syntax = "keyway"
"""
    write(folder / "syntax/keyway.vim", text)
    # Vim itself takes *.inp for Abaqus: this line replaces the type.
    line = "autocmd BufNewFile,BufRead *.inp set filetype=keyway\n"
    write(folder / "ftdetect/keyway.vim", line)


def grammar(names: Names) -> dict[str, Any]:
    """The TextMate grammar of decks."""
    keyword = any_of(names.keywords, r"\s*")
    parameter = any_of(names.parameters, r"\s+")
    value = any_of(names.values, r"\s+")

    def rule(scope: str, expression: str) -> dict[str, Any]:
        return {"name": f"{scope}.keyway", "match": expression}

    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "Keyway",
        "scopeName": "source.keyway",
        "patterns": [
            rule("comment.line", r"^\s*\*\*.*$"),
            rule("keyword.control", rf"(?i)^\s*\*\s*(?:{keyword})(?=\s*(?:,|$))"),
            rule("invalid.illegal", r"^\s*\*[^*,][^,]*"),
            rule("variable.parameter", rf"(?i)(?<=,)\s*(?:{parameter})(?=\s*(?:=|,|$))"),
            rule("variable.parameter", rf"(?i)^\s*(?:{parameter})(?=\s*=)"),
            rule("constant.language", rf"(?i)(?<==)\s*(?:{value})(?=\s*(?:,|$))"),
            rule("string.quoted", '"[^"]*"'),
            rule(
                "constant.numeric", r"(?i)(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[ed][-+]?\d+)?(?!\w)"
            ),
        ],
    }


def write_vscode(names: Names, folder: Path, version: str) -> None:
    """An extension: package.json, the grammar, and the signs of comments."""
    language = {
        "id": "keyway",
        "aliases": ["Keyway"],
        "extensions": [".inp"],
        "configuration": "./language-configuration.json",
    }
    tokens = {
        "language": "keyway",
        "scopeName": "source.keyway",
        "path": "./syntaxes/keyway.tmLanguage.json",
    }
    package = {
        "name": "keyway",
        "displayName": "Keyway",
        "description": "Decks of Keyway",
        "version": version,
        "publisher": "keyway",
        "license": "BSD-3-Clause",
        "engines": {"vscode": "^1.60.0"},
        "categories": ["Programming Languages"],
        "contributes": {"languages": [language], "grammars": [tokens]},
    }
    write(folder / "package.json", as_json(package))
    write(folder / "language-configuration.json", as_json({"comments": {"lineComment": "**"}}))
    write(folder / "syntaxes/keyway.tmLanguage.json", as_json(grammar(names)))


def as_json(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=2) + "\n"


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    print(path)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("--vim", type=Path, metavar="DIR", help="folder of Vim's runtime path")
    parser.add_argument("--vscode", type=Path, metavar="DIR", help="folder of the extension")
    given = parser.parse_args(arguments)
    if not (given.vim or given.vscode):
        parser.error("expected --vim DIR or --vscode DIR")
    command = [str(given.program), "--version"]
    answer = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    version = answer.splitlines()[0].split()[-1]
    names = read_names(given.program)
    if given.vim:
        write_vim(names, given.vim, version)
    if given.vscode:
        write_vscode(names, given.vscode, version)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
