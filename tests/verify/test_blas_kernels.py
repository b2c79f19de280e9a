"""OPENBLAS_CORETYPE chooses the kernels of numpy, scipy and the program alike.

tools/test runs the numerical tests with two kinds of kernels: their sums differ in the last digits,
which reveals tests and procedures that depend on round-off.
"""

import os
import sys

import pytest
from harness import blas_kernels

KERNEL = os.environ.get("OPENBLAS_CORETYPE", "")


@pytest.mark.skipif(
    KERNEL not in ("HASWELL", "SKYLAKEX"),
    reason="OPENBLAS_CORETYPE chooses neither HASWELL nor SKYLAKEX",
)
def test_kernels_are_those_chosen(program_path):
    """numpy and scipy have an OpenBLAS each; the program has that of the system."""
    of_python = blas_kernels(sys.executable, "-c", "import numpy, scipy.linalg")
    of_program = blas_kernels(program_path, "--version")
    assert of_python + of_program == 3 * [KERNEL]
