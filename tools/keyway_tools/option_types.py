"""Kinds of numbers for the options of commands; each says what it expected."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from pathlib import Path


def _number(text: str, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentTypeError(f"{text}: expected {expected}")
    return value


def finite(text: str) -> float:
    """A number, neither infinite nor NaN."""
    return _number(text, "a finite number")


def above_zero(text: str) -> float:
    """A finite number above 0."""
    expected = "a number above 0"
    value = _number(text, expected)
    if value <= 0.0:
        raise ArgumentTypeError(f"{text}: expected {expected}")
    return value


def from_zero(text: str) -> float:
    """A finite number, 0 or above."""
    expected = "a number of 0 or more"
    value = _number(text, expected)
    if value < 0.0:
        raise ArgumentTypeError(f"{text}: expected {expected}")
    return value


def _whole(text: str, least: int) -> int:
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise ArgumentTypeError(f"{text}: expected a whole number, {least} or more")
    return value


def count(text: str) -> int:
    """A whole number from 1 on."""
    return _whole(text, 1)


def count_from_zero(text: str) -> int:
    """A whole number from 0 on."""
    return _whole(text, 0)


def deck_path(text: str) -> Path:
    """The path of a deck to write; it ends in .inp also where that is left out."""
    path = Path(text)
    if not path.name:
        raise ArgumentTypeError(f"{text}: expected the name of a deck")
    return path if path.suffix.lower() == ".inp" else path.with_name(f"{path.name}.inp")
