"""The pages of a study: HTML that needs no other file, in the style of the reports of runs."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from keyway_tools.report.templates import render

from .facts import NAMES
from .ladder import Outcome
from .pictures import draw
from .words import (
    effect_sentences,
    percent,
    sentence_of_check,
    sentence_of_place,
    sentences_of_quantity,
    signed,
)

HERE = Path(__file__).parent
OWN_SECONDS = (
    "Seconds are processor seconds of whole runs with one thread, without output: they hardly "
    "depend on what else the machine does."
)
WALL_SECONDS = (
    "Seconds are those of the clock for whole runs without output, as busy as the machine was."
)

BUSY_SECONDS = (
    "The machine was busy: the clock showed {ratio:.2g} times the seconds that these runs had a "
    "processor. Times of variants do not compare; with --threads 1 they are processor seconds."
)
MOST_WAITING = 1.5  # clock over processor: a run that waits for nothing has at most 1


def what_seconds_are(threads: int, outcomes: list[Outcome]) -> tuple[str, bool]:
    """What the seconds of a study mean, and whether the machine was too busy for them."""
    if threads == 1:
        return OWN_SECONDS, False
    runs = [one.measured for one in outcomes if one.measured and one.measured.processor]
    worked = sum(run.processor for run in runs)
    ratio = sum(run.seconds for run in runs) / worked if worked else 0.0
    if ratio <= MOST_WAITING:
        return WALL_SECONDS, False
    return f"{WALL_SECONDS} {BUSY_SECONDS.format(ratio=ratio)}", True


def accuracy_page(deck: Path, facts: dict[str, Any]) -> str:
    """The page of a ladder."""
    in_words = []
    for quantity in facts["quantities"]:
        first, *rest = sentences_of_quantity(quantity, facts["seconds"])
        known = quantity["error"] is not None and quantity["error"] <= 1.0
        in_words.append({"kind": "good" if known else "fair", "first": first, "rest": rest})
    return render(
        HERE / "accuracy.html",
        title=f"What accuracy costs: {deck.name}",
        facts=facts,
        names=NAMES,
        percent=percent,
        signed=signed,
        in_words=in_words,
        place=sentence_of_place(facts["singular"]) if facts["singular"] else "",
        checked=sentence_of_check(facts["verified"]) if facts["verified"] else "",
        picture=base64.b64encode(draw(facts)).decode(),
    )


def effects_page(
    deck: Path, header: list[list[str]], what_seconds_are: str, outcomes: list[Outcome]
) -> str:
    """The page of the effects."""
    known = {name for one in outcomes if one.measured for name in one.measured.values}
    return render(
        HERE / "effects.html",
        title=f"What each effect changes: {deck.name}",
        header=header,
        sentences=effect_sentences(outcomes),
        outcomes=outcomes,
        quantities=[name for name in NAMES if name in known],
        names=NAMES,
        what_seconds_are=what_seconds_are,
    )
