#!/usr/bin/env python3
"""Compares results; the command keyway-compare of the package."""

import sys

from keyway.commands.compare import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
