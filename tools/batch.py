#!/usr/bin/env python3
"""Runs many decks, several at a time; the command keyway-batch of the package."""

import sys

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway.commands.batch import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
