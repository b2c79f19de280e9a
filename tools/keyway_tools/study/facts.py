"""What a study has found, as plain data: page, picture and sentences are made from it."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from .errors import BASE, TARGETS, Choice, Error, choices_of, singular_place
from .ladder import Outcome
from .measured import QUANTITIES

NAMES = {
    "displacement": "largest displacement", "stress": "S1 exceeded in 1 % of the dam's volume",
    "opening": "largest opening", "damage": "energy of cracking", "frequency": "first frequency",
}  # fmt: skip
COMPARED_WITH_BASE = ("tolerance", "coupling", "stiffness", "alpha", "solver")


def facts_of(outcomes: list[Outcome], errors: list[Error]) -> dict[str, Any]:
    """Quantities with their errors and choices, all rungs, and what the other variants change."""
    base = outcomes[0].measured
    assert base
    place = singular_place(outcomes)
    return {
        "seconds": base.seconds,
        "quantities": [facts_of_error(error, outcomes) for error in errors],
        "rungs": [facts_of_rung(outcome, errors) for outcome in outcomes],
        "changes": [facts_of_change(outcome, outcomes[0]) for outcome in outcomes
                    if outcome.rung.axis in COMPARED_WITH_BASE],
        "verified": facts_of_check(outcomes, errors),
        "singular": {"x": place[0], "growth": rounded(place[1])} if place else None,
    }  # fmt: skip


def facts_of_error(error: Error, outcomes: list[Outcome]) -> dict[str, Any]:
    """The error of the deck as it is, its parts, and what to choose."""
    tight = [one for one in outcomes if one.rung.axis == "tolerance"]
    is_known = not tight or any(one.measured and one.rung.size < 1e-6 for one in tight)
    found: dict[str, Any] = {
        "quantity": error.quantity,
        "value": rounded(outcomes[0].measured.values[error.quantity]),  # type: ignore[union-attr]
        "limit": rounded(error.limit),
        "increment": rounded(error.time[BASE]) if error.time else None,
        "mesh": rounded(error.mesh[BASE]) if error.mesh else None,
        "iteration": rounded(error.iteration) if is_known else None,
    }
    total = error.total(BASE, BASE)
    if total is None:
        return found | {"error": None, "choices": []}
    return found | {
        "uncertainty": rounded(error.uncertainty),
        "error": rounded(total),
        "choices": [
            {"target": target} | (facts_of_choice(choice) if choice else {"choice": None})
            for target, choice in zip(TARGETS, choices_of(error, outcomes), strict=True)
        ],
    }


def facts_of_choice(choice: Choice) -> dict[str, Any]:
    parts = [part for part in (choice.increment, choice.mesh) if part != BASE]
    return {
        "choice": " with ".join(parts) if parts else BASE,
        "seconds": rounded(choice.seconds),
        "was_run": len(parts) < 2 and not choice.is_extrapolated,
        "is_extrapolated": choice.is_extrapolated,
        "num_refined": choice.num_refined,
        "error": rounded(choice.error),
    }


def facts_of_rung(outcome: Outcome, errors: list[Error]) -> dict[str, Any]:
    """A variant with its cost, its numbers and their errors."""
    found: dict[str, Any] = {"name": outcome.name, "axis": outcome.rung.axis}
    if outcome.predicted is not None:
        found["predicted"] = rounded(outcome.predicted)
    if not outcome.measured:
        return found | {"why_not": outcome.why_not}
    run = outcome.measured
    own = {error.quantity: own_error(error, outcome) for error in errors}
    return found | {
        "seconds": rounded(run.seconds), "memory_mb": rounded(run.memory),
        "unknowns": run.unknowns, "increments": run.increments, "cutbacks": run.cutbacks,
        "values": {name: rounded(value) for name, value in run.values.items()},
        "largest_S1": rounded(run.peak),
        "errors": {name: rounded(error) for name, error in own.items() if error is not None},
    }  # fmt: skip


def facts_of_change(outcome: Outcome, base: Outcome) -> dict[str, Any]:
    """What a variant changes, relative to the deck as it is."""
    if not outcome.measured:
        return {"name": outcome.name, "why_not": outcome.why_not}
    assert base.measured
    found = outcome.measured.values
    return {
        "name": outcome.name,
        "time": rounded(outcome.measured.seconds / base.measured.seconds),
        "changes": {name: rounded(found[name] / value - 1.0)
                    for name, value in base.measured.values.items() if value and name in found},
    }  # fmt: skip


def facts_of_check(outcomes: list[Outcome], errors: list[Error]) -> dict[str, Any] | None:
    """Errors against a run that is finer than the ladder; None where there is none."""
    finer = next((one for one in outcomes if one.rung.axis == "finer"), None)
    if finer is None:
        return None
    if not finer.measured:
        return {"name": finer.name, "why_not": finer.why_not}
    rows = []
    for outcome in outcomes:
        for error in errors:
            promised = own_error(error, outcome)
            if promised is None or not outcome.measured:
                continue
            value = outcome.measured.values[error.quantity]
            true = abs(value / finer.measured.values[error.quantity] - 1.0)
            rows.append({"name": outcome.name, "quantity": error.quantity,
                         "promised": rounded(promised), "found": rounded(true)})  # fmt: skip
    return {
        "name": finer.name,
        "seconds": rounded(finer.measured.seconds),
        "unknowns": finer.measured.unknowns,
        "rows": rows,
        "kept": sum(row["found"] <= row["promised"] for row in rows),
    }


def own_error(error: Error, outcome: Outcome) -> float | None:
    """The total error of a rung: the other axes are those of the deck as it is."""
    axis = outcome.rung.axis
    if not outcome.measured:
        return None
    if axis in ("base", "increment"):
        return error.total(outcome.name, BASE)
    if axis in ("mesh", "element"):
        return error.total(BASE, outcome.name)
    return None


def rounded(number: float) -> float:
    """Five digits: pages show fewer."""
    return float(f"{number:.5g}")


def write_table(path: Path, facts: dict[str, Any]) -> None:
    """All rungs with their numbers and errors as CSV."""
    names = [found["quantity"] for found in facts["quantities"]]
    costs = ["seconds", "memory_mb", "unknowns", "increments", "cutbacks"]
    head = ["rung", "axis", "predicted", *costs, *QUANTITIES, "largest_S1",
            *[f"error_{name}" for name in names], "why_not"]  # fmt: skip
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for rung in facts["rungs"]:
            values, own = rung.get("values", {}), rung.get("errors", {})
            writer.writerow([
                rung["name"], rung["axis"], *[rung.get(key, "") for key in ["predicted", *costs]],
                *[values.get(name, "") for name in QUANTITIES], rung.get("largest_S1", ""),
                *[own.get(name, "") for name in names], rung.get("why_not", ""),
            ])  # fmt: skip
