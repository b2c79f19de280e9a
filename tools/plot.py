#!/usr/bin/env python3
"""Draws the pictures of runs; the command keyway-plot of the package."""

import sys

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway.commands.plot import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
