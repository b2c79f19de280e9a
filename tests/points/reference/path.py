"""A point led along a path: legs of given strains and nominal stresses, any mixture of the two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .concrete import Concrete
from .rates import PULL, Rates, rates_of, strain_rate

RELATIVE, ABSOLUTE = 1e-9, 1e-13  # tolerances of the integration; strains are 1e-5 to 1e-2
NOISE = 1e-9  # of F over the strength, below which it is zero

# The state: strain, plastic strain, tensile and compressive plastic strain, then per volume [J/m3]
# work done and energy dissipated.
STRAIN, PLASTIC, HISTORY, ENERGY = slice(0, 6), slice(6, 12), slice(12, 14), slice(14, 16)
SIZE = 16


@dataclass(frozen=True)
class Leg:
    """Ends of six components, reached linearly from where they are; strains where `is_strain`."""

    is_strain: np.ndarray
    end: np.ndarray

    @classmethod
    def of(cls, kinds: str, end: Sequence[float]) -> Leg:
        """From letters, E for a strain and S for a stress, as in 'ESSEEE'."""
        return cls(np.array([k == "E" for k in kinds]), np.array(end, dtype=float))


@dataclass(frozen=True)
class History:
    """What a point went through; one row per moment in all arrays."""

    strain: np.ndarray
    stress: np.ndarray  # nominal [Pa]
    plastic: np.ndarray  # plastic strain (rows, 6)
    hardening: np.ndarray  # tensile and compressive plastic strain (rows, 2)
    damage: np.ndarray  # d_t, d_c, d (rows, 3)
    work: np.ndarray  # [J/m3]
    dissipated: np.ndarray  # [J/m3]


class Point:
    """A point of concrete and its state."""

    def __init__(self, law: Concrete):
        self.law = law
        self.state = np.zeros(SIZE)
        self._latest: tuple[bytes, Rates] | None = None

    def rates(self, state: np.ndarray) -> Rates:
        """Rates at a state; the latest are kept, as one state is asked for several times."""
        key = state.tobytes()
        if self._latest is None or self._latest[0] != key:
            found = rates_of(self.law, state[STRAIN] - state[PLASTIC], state[HISTORY])
            self._latest = key, found
        return self._latest[1]

    def stress(self, state: np.ndarray) -> np.ndarray:
        """Nominal stress, Eq. 14 [Pa]."""
        rates = self.rates(state)
        return (1.0 - rates.damage) * rates.stress

    def follow(self, leg: Leg, moments: np.ndarray) -> np.ndarray:
        """States at moments of a leg (0 to 1); the point is left at the end of it."""
        start = np.where(leg.is_strain, self.state[STRAIN], self.stress(self.state))
        rate = leg.end - start
        found, now = [], 0.0
        flows = self._begins_to_flow(leg, rate)
        while now < 1.0:
            part = self._follow_phase(leg, start, rate, now, flows)
            inside = (moments >= now) & (moments < part.t[-1])
            if np.any(inside):
                found.append(part.sol(moments[inside]).T)
            now, flows = part.t[-1], not flows
            self.state = part.y[:, -1]
        found.append(np.repeat(self.state[None, :], np.sum(moments >= 1.0), axis=0))
        return np.vstack(found)

    def _begins_to_flow(self, leg: Leg, rate: np.ndarray) -> bool:
        rates = self.rates(self.state)
        strength = self.law.compression.effective(self.state[HISTORY][1])
        if rates.value < -NOISE * strength:
            return False
        return rates.multiplier(strain_rate(rates, True, leg.is_strain, rate)) > 0.0

    def _follow_phase(self, leg: Leg, start, rate, now: float, flows: bool):
        """From `now` to the end of the leg, or until the flow begins or rests."""

        def wanted(time, state, rates):
            stress = (1.0 - rates.damage) * rates.stress
            behind = np.where(leg.is_strain, 0.0, start + rate * time - stress)
            return strain_rate(rates, flows, leg.is_strain, rate + PULL * behind)

        def change(time, state):
            rates = self.rates(state)
            strain = wanted(time, state, rates)
            return state_rate(
                rates, strain, rates.multiplier(strain) + rates.drift if flows else 0.0
            )

        first = self.rates(self.state).value
        strength = self.law.compression.effective(self.state[HISTORY][1])

        def turns(time, state):
            rates = self.rates(state)
            if flows:
                return rates.multiplier(wanted(time, state, rates))
            return rates.value - max(first, 0.0) - NOISE * strength

        turns.terminal, turns.direction = True, -1.0 if flows else 1.0
        part = solve_ivp(
            change,
            (now, 1.0),
            self.state,
            method="LSODA",  # flow is stiff near the apex, where its direction turns fast
            rtol=RELATIVE,
            atol=np.where(np.arange(SIZE) < ENERGY.start, ABSOLUTE, 1e-6),
            events=turns,
            dense_output=True,
            max_step=0.05,
        )
        if not part.success:
            raise ArithmeticError(part.message)
        return part


def state_rate(rates: Rates, strain: np.ndarray, multiplier: float) -> np.ndarray:
    """Rate of the whole state."""
    whole = 1.0 - rates.damage
    stored = 0.5 * rates.stress @ np.linalg.solve(rates.law.stiffness, rates.stress)
    by_flow = whole * rates.stress @ rates.flow
    lost = (by_flow + stored * np.sum(rates.damage_by_multiplier)) * multiplier
    energy = [whole * rates.stress @ strain, lost]
    return np.concatenate([strain, rates.flow * multiplier, rates.growth * multiplier, energy])


def run(law: Concrete, legs: Sequence[Leg], rows: int = 50) -> History:
    """Leads a virgin point along legs, with `rows` moments in each; the first row is the start."""
    point = Point(law)
    moments = np.arange(1, rows + 1) / rows
    states = np.vstack([point.state, *(point.follow(leg, moments) for leg in legs)])
    damages = [
        (law.tension.at(state[HISTORY][0])[1], law.compression.at(state[HISTORY][1])[1])
        for state in states
    ]
    losses = [[point.rates(state).damage] for state in states]
    return History(
        strain=states[:, STRAIN],
        stress=np.array([point.stress(state) for state in states]),
        plastic=states[:, PLASTIC],
        hardening=states[:, HISTORY],
        damage=np.hstack([np.array(damages), np.array(losses)]),
        work=states[:, ENERGY][:, 0],
        dissipated=states[:, ENERGY][:, 1],
    )
