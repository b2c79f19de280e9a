#!/usr/bin/env python3
"""Compares results; the command keyway-compare of the package."""

import sys

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway.commands.compare import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
