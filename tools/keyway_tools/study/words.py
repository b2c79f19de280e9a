"""A study in plain sentences."""

from __future__ import annotations

from typing import Any

from .effects import change_in_words
from .facts import NAMES
from .ladder import Outcome
from .measured import time_in_words


def sentences(facts: dict[str, Any]) -> list[str]:
    """What to choose, what other variants change, and what has no number."""
    found = []
    for quantity in facts["quantities"]:
        found += sentences_of_quantity(quantity, facts["seconds"])
    found += [sentence_of_change(change) for change in facts["changes"]]
    if check := facts["verified"]:
        found.append(sentence_of_check(check))
    if place := facts["singular"]:
        found.append(sentence_of_place(place))
    return found


def sentences_of_quantity(found: dict[str, Any], seconds: float) -> list[str]:
    """Where the deck stands, and what to choose for each accuracy."""
    name = NAMES[found["quantity"]]
    if found["error"] is None:
        return [f"{name}: {what_is_unknown(found)}"]
    if found["error"] > 1.0:
        return [f"{name}: does not converge on this ladder, so no number is given."]
    parts = ", ".join(f"{part} {percent(found[part])}" for part in ("increment", "mesh",
                                                                    "iteration"))  # fmt: skip
    lines = [
        f"{name}: your deck has an error of about {percent(found['error'])} ({parts}) and takes "
        f"{time_in_words(seconds)}. The limit {found['limit']:.4g} itself is known to "
        f"{percent(found['uncertainty'])}."
    ]
    return lines + [f"— {sentence_of_choice(choice)}" for choice in found["choices"]]


def what_is_unknown(found: dict[str, Any]) -> str:
    """Which errors have no number, and the one that has."""
    parts = ("increment", "mesh")
    missing = [part for part in parts if found[part] is None]
    text = f"the error of the {' and that of the '.join(missing)} is not known, as no run with "
    text += f"another {' or '.join(missing)} is there."
    for part in parts:
        if found[part]:
            text += f" The {part} alone leaves {percent(found[part])}."
    return text


def sentence_of_choice(choice: dict[str, Any]) -> str:
    """'5 %: increment x 0.5 with C3D8B, about 23 s (predicted).'"""
    target = f"{100 * choice['target']:g} %"
    if choice["choice"] is None:
        return f"{target}: beyond this ladder."
    if choice["is_extrapolated"]:
        from_what = "two refinements" if choice.get("num_refined") == 2 else "one refinement"
        how = f" (extrapolated from {from_what}, of first order)"
    else:
        how = "" if choice["was_run"] else " (predicted)"
    return f"{target}: {choice['choice']}, about {time_in_words(choice['seconds'])}{how}."


def sentence_of_change(change: dict[str, Any]) -> str:
    """What a variant changes that is not ordered by its accuracy."""
    if "why_not" in change:
        return f"{change['name']}: {change['why_not']}."
    parts = [f"{NAMES[name]} {signed(value)}" for name, value in change["changes"].items()]
    what = ", ".join(parts) if parts else "nothing that is compared"
    return f"with {change['name']}: {what}; {change['time']:.2g} times the time."


def sentence_of_check(check: dict[str, Any]) -> str:
    """Whether the promised errors hold against a finer run."""
    if "why_not" in check:
        return f"check against a finer run ({check['name']}): {check['why_not']}."
    return (
        f"against a run finer than the ladder ({check['name']}, {check['unknowns']} unknowns, "
        f"{time_in_words(check['seconds'])}) {check['kept']} of {len(check['rows'])} errors are "
        "not larger than said."
    )


def sentence_of_place(place: dict[str, Any]) -> str:
    x = ", ".join(f"{value:.4g}" for value in place["x"])
    return (
        f"The largest S1 anywhere, at ({x}), grows by {100 * (place['growth'] - 1):.0f} % when the "
        "mesh is refined: a singular place, as in a re-entrant corner. No mesh gives its value."
    )


def percent(share: float | None) -> str:
    """Two digits: '7.7 %'; what is smaller than 0.005 % is 0."""
    if share is None:
        return "not known"
    size = 100.0 * share
    return "0 %" if abs(size) < 0.005 else f"{size:.0f} %" if size >= 9.95 else f"{size:.2g} %"


def signed(share: float) -> str:
    size = 100.0 * share
    return "0 %" if abs(size) < 0.005 else f"{size:+.2g} %" if abs(size) < 10 else f"{size:+.0f} %"


def effect_sentences(outcomes: list[Outcome]) -> list[str]:
    """What each effect changes in the results, and what it costs."""
    base = outcomes[0].measured
    assert base
    lines = []
    for outcome in outcomes[1:]:
        if not outcome.measured:
            lines.append(f"{outcome.name}: {outcome.why_not}.")
            continue
        changes = {
            name: outcome.measured.values.get(name, 0.0) / value - 1.0
            for name, value in base.values.items() if value
        }  # fmt: skip
        lines.append(
            change_in_words(outcome.name, changes, 1.0 - outcome.measured.seconds / base.seconds)
        )
    return lines
