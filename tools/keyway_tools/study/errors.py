"""Errors of the rungs of a ladder, and what to choose for a given accuracy.

Increment: where three sizes converge regularly, Richardson's extrapolation with the order that they
show gives the limit; else the finest run is the limit, and its distance to the next one is added.
No increment has a smaller error than a finer one.
Mesh and element: one refinement or two. The limit lies between the extrapolations of first order
(corners) and of second order (smooth stresses) from the two finest meshes, and of the order that
three meshes show where they converge regularly; the error is the distance to the farthest one.
Another element may agree with the limit by chance. It is recommended only after a run on the
refined mesh, and its error is the larger one of both meshes.
Errors of time, mesh and iteration are added, and their sum is multiplied by the safety factor of
Roache (1994), Journal of Fluids Engineering 116, 405-413: 1.25 for limits that three sizes or two
orders support.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from .ladder import Outcome
from .measured import QUANTITIES
from .rungs import BASE, ELEMENT_CHECK, ONCE, TWICE

ORDERS = (0.5, 3.0)  # observed orders in time that count as regular
GROWTH = 1.1  # a largest stress that grows by more with one refinement is at a singular place
SAFETY = 1.25
REFINEMENTS = (2, 3, 4)  # of meshes that are extrapolated
TARGETS = (0.10, 0.05, 0.02, 0.01)


@dataclass
class Error:
    """Errors of one quantity, relative to its limit, by the name of the rung."""

    quantity: str
    limit: float
    uncertainty: float  # of the limit, relative
    time: dict[str, float]
    mesh: dict[str, float]
    iteration: float  # of the deck as it is
    unchecked: set[str] = field(default_factory=set)  # elements without a run on the refined mesh

    def total(self, increment: str, mesh: str) -> float | None:
        """Error of a combination with the safety factor; None where a part is not known."""
        if increment not in self.time or mesh not in self.mesh:
            return None
        return SAFETY * (self.time[increment] + self.mesh[mesh] + self.iteration)


@dataclass
class Choice:
    """The cheapest combination for an accuracy."""

    quantity: str
    target: float
    increment: str
    mesh: str
    seconds: float  # predicted where the combination was not run
    error: float
    # Where it is finer than all that was run: refinements of the finest mesh that was; else 0
    num_refined: int = 0

    @property
    def is_extrapolated(self) -> bool:
        return self.num_refined > 0


def errors_of(outcomes: list[Outcome]) -> list[Error]:
    """Errors of all quantities that the deck has."""
    base = outcomes[0]
    assert base.measured
    return [
        error_of(quantity, outcomes) for quantity in QUANTITIES
        if base.measured.values.get(quantity)
    ]  # fmt: skip


def error_of(quantity: str, outcomes: list[Outcome]) -> Error:
    """Errors of one quantity."""
    base = outcomes[0]
    found = values_of("increment", quantity, outcomes)
    time_limit, time = time_errors(found)
    if len(found) == 1 and any(outcome.rung.axis == "increment" for outcome in outcomes):
        time = {}  # other increments were not run: nothing is known
    start = base.measured.values[quantity]  # type: ignore[union-attr]
    limits = mesh_limits(start, values_of("mesh", quantity, outcomes))
    mesh: dict[str, float] = {}
    if limits:
        for axis in ("base", "mesh", "element"):
            for outcome, value in values_of(axis, quantity, outcomes):
                mesh[outcome.name] = max(abs(value - limit) for limit in limits)
    unchecked = {outcome.name for outcome, _ in values_of("element", quantity, outcomes)}
    for outcome, value in values_of(ELEMENT_CHECK, quantity, outcomes):
        kind = element_of(outcome)
        unchecked.discard(kind)
        if kind in mesh:
            mesh[kind] = max(mesh[kind], *(abs(value - limit) for limit in limits))
    tight = [value for outcome, value in values_of("tolerance", quantity, outcomes)
             if outcome.rung.size < 1e-6]  # fmt: skip
    iteration = abs(tight[0] - start) if tight else 0.0
    limit = time_limit + (np.mean(limits) - start if limits else 0.0)
    scale = abs(limit)
    spread = (max(limits) - min(limits)) / scale if limits else float("nan")
    return Error(
        quantity,
        float(limit),
        float(spread),
        {name: error / scale for name, error in time.items()},
        {name: error / scale for name, error in mesh.items()},
        iteration / scale,
        unchecked,
    )


def element_of(check: Outcome) -> str:
    """The element that a run on the refined mesh checks."""
    return check.name.partition(",")[0]


def element_to_check(outcomes: list[Outcome]) -> str | None:
    """An element that would be recommended and has no run on the refined mesh yet."""
    tried = {element_of(one) for one in outcomes if one.rung.axis == ELEMENT_CHECK}
    for error in errors_of(outcomes):
        open_to = replace(error, unchecked=error.unchecked & tried)
        for choice in choices_of(open_to, outcomes):
            if choice and choice.mesh in error.unchecked:
                return choice.mesh
    return None


def values_of(axis: str, quantity: str, outcomes: list[Outcome]) -> list[tuple[Outcome, float]]:
    """Rungs of an axis with their value; the deck as it is belongs to 'increment' too."""
    axes = ("base", "increment") if axis == "increment" else (axis,)
    return [
        (outcome, outcome.measured.values[quantity]) for outcome in outcomes
        if outcome.rung.axis in axes and outcome.measured
        and quantity in outcome.measured.values
    ]  # fmt: skip


def time_errors(found: list[tuple[Outcome, float]]) -> tuple[float, dict[str, float]]:
    """The limit over the increment, and the distance of each rung to it."""
    found = sorted(found, key=lambda item: -item[0].rung.size)
    values = np.array([value for _, value in found])
    if len(values) == 1:  # no dynamic step: no error in time
        return values[0], {found[0][0].name: 0.0}
    limit, doubt = values[-1], abs(values[-1] - values[-2])
    order = observed_order(values[-3:])
    if order is not None:
        limit += (values[-1] - values[-2]) / (2.0**order - 1.0)
        doubt = 0.0
    errors = {
        outcome.name: abs(value - limit) + doubt
        for (outcome, _), value in zip(found, values, strict=True)
    }
    if order is None:
        errors[found[-1][0].name] = doubt
    # A larger increment that is nearer to the limit is a coincidence: nobody can choose it.
    largest = 0.0
    for outcome, _ in reversed(found):
        largest = max(largest, errors[outcome.name])
        errors[outcome.name] = largest
    return float(limit), errors


def observed_order(values: np.ndarray) -> float | None:
    """Order of convergence of three values at sizes that halve; None where it is irregular."""
    if len(values) < 3:
        return None
    first, second = values[1] - values[0], values[2] - values[1]
    if first * second <= 0.0:
        return None
    order = float(np.log2(first / second))
    return order if ORDERS[0] <= order <= ORDERS[1] else None


def mesh_limits(start: float, found: list[tuple[Outcome, float]]) -> list[float]:
    """Extrapolations from the two finest meshes, of first and second order and of the order that
    three meshes show; empty without a refinement."""
    by_size = {outcome.rung.size: value for outcome, value in found}
    values = [start]
    while (size := 0.5 ** len(values)) in by_size:
        values.append(by_size[size])
    if len(values) == 1:
        return []
    orders = [1.0, 2.0]
    if (order := observed_order(np.array(values))) is not None:
        orders.append(order)
    last, before = values[-1], values[-2]
    return [last + (last - before) / (2.0**order - 1.0) for order in orders]


def singular_place(outcomes: list[Outcome]) -> tuple[list[float], float] | None:
    """Place of the largest stress and its growth, where refinement lets it grow without end."""
    base = outcomes[0].measured
    fine = next((o.measured for o in outcomes if o.rung.axis == "mesh" and o.measured), None)
    if not base or not fine or base.peak <= 0.0:
        return None
    growth = fine.peak / base.peak
    return (fine.peak_place, growth) if growth > GROWTH else None


def choices_of(error: Error, outcomes: list[Outcome]) -> list[Choice | None]:
    """The cheapest combination of increment and mesh for each of TARGETS; None: beyond all."""
    base = outcomes[0].measured
    assert base
    seconds = {outcome.name: outcome.measured.seconds for outcome in outcomes if outcome.measured}
    found = []
    for increment, mesh in product(error.time, error.mesh):
        if mesh in error.unchecked:
            continue
        total = error.total(increment, mesh)
        cost = seconds[mesh] * seconds[increment] / base.seconds
        if total is not None:
            found.append(Choice(error.quantity, total, increment, mesh, cost, total))
    chosen: list[Choice | None] = []
    for target in TARGETS:
        good = [choice for choice in found if choice.error <= target]
        if not good:
            good = [c for c in finer_choices(error, seconds, base.seconds) if c.error <= target]
        best = min(good, key=lambda choice: choice.seconds, default=None)
        chosen.append(best and replace(best, target=target))
    return chosen


def finer_choices(error: Error, seconds: dict[str, float], base: float) -> list[Choice]:
    """Meshes that are refined more often than any that was run: an error of first order is halved
    each time, and the time grows by the same factor."""
    meshes = [name for name in (BASE, ONCE, TWICE) if name in error.mesh and name in seconds]
    if meshes[:2] != [BASE, ONCE]:
        return []
    ratio = seconds[meshes[-1]] / seconds[meshes[-2]]
    num_run = len(meshes) - 1  # refinements of the finest mesh
    found = []
    for times, (increment, in_time) in product(REFINEMENTS, error.time.items()):
        more = times - num_run
        if more < 1:
            continue
        in_space = error.mesh[meshes[-1]] / 2.0**more
        total = SAFETY * (in_time + in_space + error.iteration)
        cost = seconds[increment] / base * seconds[meshes[-1]] * ratio**more
        name = f"mesh refined {times} times"
        found.append(Choice(error.quantity, 0.0, increment, name, cost, total, num_run))
    return found
