#!/usr/bin/env python3
"""Runs both dams of the paper and writes one page: keyway_tools.paper_study."""

import sys

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway_tools.paper_study.__main__ import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
