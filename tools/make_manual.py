"""Writes the manual page keyway.1 from the help of the program.

usage: make_manual.py [--program PATH] -o FILE

`cmake --install` calls this tool.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

HEAD = """\
.TH KEYWAY 1 "" "Keyway {version}" "Keyway"
.SH NAME
keyway \\- analyse concrete dams under water and earthquake
.SH SYNOPSIS
.B keyway
.RI [ options ]
.I job.inp
.SH DESCRIPTION
.B keyway
reads a deck in the style of Abaqus and CalculiX, runs the analysis and leaves its results in the
folder named with
.BR \\-o .
"""


def ask(program: Path, option: str) -> str:
    """What the program answers."""
    return subprocess.run([program, option], capture_output=True, text=True, check=True).stdout


def read_help(text: str) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Options and exit codes with their texts."""
    options: list[tuple[str, str]] = []
    codes = ""
    for line in text.splitlines():
        if found := re.match(r"  (-\S+(?: \[?[A-Z]+\]?(?: \.\.)?)?) +(\S.*)", line):
            options.append((found[1], found[2]))
        elif line.startswith("exit code: "):
            codes = line.removeprefix("exit code: ")
        elif options and line.startswith("   "):
            options[-1] = (options[-1][0], f"{options[-1][1]} {line.strip()}")
    exits = [part.strip().partition(" ") for part in codes.split(",")]
    return options, [(code, meaning) for code, _, meaning in exits]


def escaped(text: str) -> str:
    """Text for troff."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{text}" if text.startswith((".", "'")) else text


def page(text: str, version: str) -> str:
    """The manual page."""
    options, exits = read_help(text)
    lines = [HEAD.format(version=version) + ".SH OPTIONS"]
    for words, meaning in options:
        name, _, value = words.partition(" ")
        lines += [".TP", f".B {escaped(name)}" + (f" \\fI{escaped(value)}\\fR" if value else "")]
        lines.append(escaped(meaning[0].upper() + meaning[1:]) + ".")
    lines.append(".SH EXIT STATUS")
    for code, meaning in exits:
        lines += [".TP", f".B {code}", escaped(meaning[0].upper() + meaning[1:]) + "."]
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "keyway")
    parser.add_argument("-o", "--output", type=Path, required=True)
    given = parser.parse_args(arguments)
    version = ask(given.program, "--version").splitlines()[0].split()[-1]
    given.output.parent.mkdir(parents=True, exist_ok=True)
    given.output.write_text(page(ask(given.program, "--help"), version), encoding="utf-8")
    print(given.output)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
