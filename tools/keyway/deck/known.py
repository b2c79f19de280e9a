"""The keywords that the program knows, with the names of their parameters."""

from __future__ import annotations

import json
from functools import cache
from importlib import resources

from .fields import squeezed, words


def parameters_of(keyword: str) -> frozenset[str] | None:
    """The parameters of a keyword without its star; None where the program does not know it."""
    found = _known().get(squeezed(keyword))
    return found and found[1]


def whole_name(keyword: str) -> str:
    """The keyword in capitals with the blanks of its words: EL FILE of elfile."""
    found = _known().get(squeezed(keyword))
    return found[0] if found else words(keyword)


@cache
def _known() -> dict[str, tuple[str, frozenset[str]]]:
    """Names and parameters by keywords without blanks; tools/make_keywords.py writes the file."""
    text = resources.files(__package__).joinpath("parameters.json").read_text(encoding="utf-8")
    return {squeezed(name): (name, frozenset(own)) for name, own in json.loads(text).items()}
