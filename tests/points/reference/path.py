"""A point on a path: legs of given strains and nominal stresses, in any combination.

The rates jump where flow begins or ends, and at each row of the tables. The integration stops there
and starts again with the rates of the other side. No evaluation of the rates crosses the jump: a
phase is elastic or plastic, and uses one segment of each table, extended. An integration that steps
over a jump would depend on round-off: LSODA may then never end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from .concrete import Concrete
from .rates import PULL, Rates, rates_of, strain_rate

RELATIVE, ABSOLUTE = 1e-9, 1e-13  # tolerances of the integration; strains are 1e-5 to 1e-2
NOISE = 1e-9  # of F over the strength, below which it is zero
AT_ROW = 1e-12  # of the plastic strain of a row: round-off of the moment at which it is attained
# Limits of a leg: the tests need at most 10 phases and 25 000 evaluations.
MOST_PHASES, MOST_EVALUATIONS = 100, 80_000

# The state: strain, plastic strain, tensile and compressive plastic strain, then per volume [J/m3]
# work done and energy dissipated.
STRAIN, PLASTIC, HISTORY, ENERGY = slice(0, 6), slice(6, 12), slice(12, 14), slice(14, 16)
SIZE = 16


@dataclass(frozen=True)
class Leg:
    """Final values of six components, linear in time; strains where `is_strain`."""

    is_strain: np.ndarray
    end: np.ndarray

    @classmethod
    def of(cls, kinds: str, end: Sequence[float]) -> Leg:
        """From letters, E for a strain and S for a stress, as in 'ESSEEE'."""
        return cls(np.array([k == "E" for k in kinds]), np.array(end, dtype=float))


@dataclass(frozen=True)
class History:
    """History of a point; one row per time in all arrays."""

    strain: np.ndarray
    stress: np.ndarray  # nominal [Pa]
    plastic: np.ndarray  # plastic strain (rows, 6)
    hardening: np.ndarray  # tensile and compressive plastic strain (rows, 2)
    damage: np.ndarray  # d_t, d_c (rows, 2)
    work: np.ndarray  # [J/m3]
    dissipated: np.ndarray  # [J/m3]


@dataclass
class Effort:
    """Phases and evaluations of a leg, with a limit: an endless integration is an error."""

    phases: int = 0
    evaluations: int = 0

    def count_phase(self, time: float) -> None:
        self.phases += 1
        if self.phases > MOST_PHASES:
            raise ArithmeticError(
                f"flow starts and stops without end at {time:.9g} of the leg: "
                f"more than {MOST_PHASES} phases"
            )

    def count_evaluation(self, time: float) -> None:
        self.evaluations += 1
        if self.evaluations > MOST_EVALUATIONS:
            raise ArithmeticError(
                f"the integration does not proceed at {time:.9g} of the leg: "
                f"more than {MOST_EVALUATIONS} evaluations"
            )


class Point:
    """A point of concrete and its state."""

    def __init__(self, law: Concrete):
        self.law = law
        self.state = np.zeros(SIZE)
        self._segments = [law.tension.segment_at(0.0), law.compression.segment_at(0.0)]
        self._limit()

    def rates(self, state: np.ndarray) -> Rates:
        """Rates at a state, with the present segments of the tables.

        The latest rates are kept: integration and events want those of the same state.
        """
        key = state.tobytes()
        if self._latest is None or self._latest[0] != key:
            found = rates_of(self._limited, state[STRAIN] - state[PLASTIC], state[HISTORY])
            self._latest = key, found
        return self._latest[1]

    def stress(self, state: np.ndarray) -> np.ndarray:
        """Nominal stress [Pa], of whole tables: damage has no jump at their rows."""
        effective = self.law.stiffness @ (state[STRAIN] - state[PLASTIC])
        return self.law.nominal(effective, *damages(self.law, state))

    def follow(self, leg: Leg, moments: np.ndarray) -> np.ndarray:
        """States at moments of a leg (0 to 1); the point is left at the end of it."""
        start = np.where(leg.is_strain, self.state[STRAIN], self.stress(self.state))
        rate = leg.end - start
        found, now = [], 0.0
        flows = self._begins_to_flow(leg, rate)
        effort = Effort()
        while now < 1.0:
            part = self._follow_phase(leg, start, rate, now, flows, effort)
            inside = (moments >= now) & (moments < part.t[-1])
            if np.any(inside):
                found.append(part.sol(moments[inside]).T)
            if np.any(part.y[HISTORY, -1] < self.state[HISTORY] - ABSOLUTE):
                raise ArithmeticError(f"plastic strain decreases before {part.t[-1]:.9g} of a leg")
            now, self.state = part.t[-1], part.y[:, -1]
            switch, *rows = (times.size > 0 for times in part.t_events)
            flows = flows != switch
            self._advance(rows)
        found.append(np.repeat(self.state[None, :], np.sum(moments >= 1.0), axis=0))
        return np.vstack(found)

    def _advance(self, attained: Sequence[bool]) -> None:
        """Selects the next segments of tables at an attained row; never previous segments."""
        segments = [s + a for s, a in zip(self._segments, attained, strict=True)]
        for sign, curve in enumerate((self.law.tension, self.law.compression)):
            while self.state[HISTORY][sign] >= (1.0 - AT_ROW) * curve.end_of(segments[sign]):
                segments[sign] += 1
        if segments != self._segments:
            self._segments = segments
            self._limit()

    def _limit(self) -> None:
        """Limits the tables to their present segments."""
        tension, compression = self._segments
        self._limited = replace(
            self.law,
            tension=self.law.tension.limited(tension),
            compression=self.law.compression.limited(compression),
        )
        self._latest: tuple[bytes, Rates] | None = None

    def _begins_to_flow(self, leg: Leg, rate: np.ndarray) -> bool:
        rates = self.rates(self.state)
        strength = self.law.compression.effective(self.state[HISTORY][1])
        if rates.value < -NOISE * strength:
            return False
        return rates.multiplier(strain_rate(rates, True, leg.is_strain, rate)) > 0.0

    def _follow_phase(self, leg: Leg, start, rate, now: float, flows: bool, effort: Effort):
        """From `now` to the end of the leg, the next row of a table, or where flow starts or stops.

        The events of the result are: flow starts or stops, row of tension, row of compression.
        """
        effort.count_phase(now)

        def wanted(time, state, rates):
            behind = np.where(leg.is_strain, 0.0, start + rate * time - rates.nominal)
            return strain_rate(rates, flows, leg.is_strain, rate + PULL * behind)

        def change(time, state):
            effort.count_evaluation(time)
            rates = self.rates(state)
            strain = wanted(time, state, rates)
            return state_rate(
                rates, strain, rates.multiplier(strain) + rates.drift if flows else 0.0
            )

        first = self.rates(self.state).value
        strength = self.law.compression.effective(self.state[HISTORY][1])

        tension, compression = self._segments
        ends = self.law.tension.end_of(tension), self.law.compression.end_of(compression)

        def turns(time, state):
            rates = self.rates(state)
            if flows:
                return rates.multiplier(wanted(time, state, rates))
            return rates.value - max(first, 0.0) - NOISE * strength

        def tensile_row(time, state):
            return state[HISTORY][0] - ends[0]

        def compressive_row(time, state):
            return state[HISTORY][1] - ends[1]

        turns.direction = -1.0 if flows else 1.0
        tensile_row.direction = compressive_row.direction = 1.0
        turns.terminal = tensile_row.terminal = compressive_row.terminal = True
        part = solve_ivp(
            change,
            (now, 1.0),
            self.state,
            method="LSODA",  # flow is stiff near the apex, where its direction turns fast
            rtol=RELATIVE,
            atol=np.where(np.arange(SIZE) < ENERGY.start, ABSOLUTE, 1e-6),
            events=(turns, tensile_row, compressive_row),
            dense_output=True,
            max_step=0.05,
        )
        if not part.success:
            raise ArithmeticError(part.message)
        return part


def state_rate(rates: Rates, strain: np.ndarray, multiplier: float) -> np.ndarray:
    """Rate of the whole state."""
    lost = (rates.nominal @ rates.flow + rates.lost_by_multiplier) * multiplier
    energy = [rates.nominal @ strain, lost]
    return np.concatenate([strain, rates.flow * multiplier, rates.growth * multiplier, energy])


def damages(law: Concrete, state: np.ndarray) -> tuple[float, float]:
    """Tensile and compressive damage, d_t and d_c."""
    tensile, compressive = state[HISTORY]
    return law.tension.at(tensile)[1], law.compression.at(compressive)[1]


def run(law: Concrete, legs: Sequence[Leg], rows: int = 50) -> History:
    """Moves a virgin point along legs, with `rows` times in each; the first row is the start."""
    point = Point(law)
    moments = np.arange(1, rows + 1) / rows
    states = np.vstack([point.state, *(point.follow(leg, moments) for leg in legs)])
    return History(
        strain=states[:, STRAIN],
        stress=np.array([point.stress(state) for state in states]),
        plastic=states[:, PLASTIC],
        hardening=states[:, HISTORY],
        damage=np.array([damages(law, state) for state in states]),
        work=states[:, ENERGY][:, 0],
        dissipated=states[:, ENERGY][:, 1],
    )
