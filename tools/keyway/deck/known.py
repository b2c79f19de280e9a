"""The keywords that the program knows, with the names of their parameters."""

from __future__ import annotations

import json
from functools import cache
from importlib import resources

from .fields import squeezed


def parameters_of(keyword: str) -> frozenset[str] | None:
    """The parameters of a keyword without its star; None where the program does not know it."""
    return _known().get(squeezed(keyword))


@cache
def _known() -> dict[str, frozenset[str]]:
    """The parameters by keywords without blanks; tools/make_keywords.py writes the file."""
    text = resources.files(__package__).joinpath("parameters.json").read_text(encoding="utf-8")
    return {squeezed(name): frozenset(own) for name, own in json.loads(text).items()}
