"""A program in place of keyway, which acts by the first line of a deck."""

from __future__ import annotations

import sys
from pathlib import Path

# The first line is `ok VALUE`, `fail CODE`, `sleep SECONDS`, `deaf SECONDS` or `crash`.
PROGRAM = """import hashlib, json, os, signal, sys, time
from pathlib import Path
if sys.argv[1] == "--version":
    print("fake 1"); sys.exit()
if "--check" in sys.argv:
    print("Cost on this machine\\n  time  about 100 s\\n  memory  about 1000 MB"); sys.exit()
deck, folder = Path(sys.argv[-1]), Path(sys.argv[2])
with open(folder.parent / "calls.txt", "a") as calls:
    print(deck.stem, *sys.argv[3:-1], file=calls)
with open(folder.parent / "processes.txt", "a") as processes:
    print(os.getpid(), file=processes)
verb, _, value = deck.read_text().splitlines()[0].removeprefix("** ").partition(" ")
if verb == "sleep":
    time.sleep(float(value))
if verb == "deaf":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(float(value))
if verb == "crash":
    os.kill(os.getpid(), signal.SIGSEGV)
if verb == "fail":
    print("deck:1: wrong\\nkeyway: the end"); sys.exit(int(value))
if (folder.parent / "is_full").exists():
    print("keyway: the disk is full"); sys.exit(3)
summary = {"program": {}, "status": "finished", "message": "",
    "deck": {"sha256": hashlib.sha256(deck.read_bytes()).hexdigest()},
    "envelopes": {"S1": {"anywhere": {"value": float(value or 0)}}}}
(folder / (deck.stem + ".json")).write_text(json.dumps(summary))
"""


def write_program(folder: Path) -> Path:
    """The program folder/keyway."""
    script, program = folder / "fake.py", folder / "keyway"
    script.write_text(PROGRAM)
    # Not as the script's first line: the interpreter's path may hold blanks.
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{script}" "$@"\n')
    program.chmod(0o755)
    return program
