"""Which time stepping serves joint forces? Five schemes on a bar that hits a wall and on a
prestressed column on a shaken joint, in one dimension, where every scheme can be written in full.

    python docs/studies/joint_forces_in_time.py [--plot FILE.png]

Bar (docs/theory.md): L 10 m, E 25 GPa, rho 2400 kg/m3, 1 m/s; the closed form has 6.19677 ms of
contact at 7.74597 MPa, after which the bar leaves with all its energy.
Schemes: M a + F(u) + J(d) = f with the bulk force F and the joint force J.
  trapezoidal   Newmark 1/4, 1/2, everything at both ends of the step
  HHT           alpha -0.05, joint forces weighted like the bulk
  HHT, end      alpha -0.05, joint forces of the end of the step only
  HHT, implicit alpha -0.05, joint impulse of the step = dt times the joint force at its end:
                M a1 = bulk + J*, J* = (J1 - (1 - gamma) J0*)/gamma (docs/theory.md)
  implicit      bulk trapezoidal, joint forces fully implicit (Kane et al. 1999)
  stabilised    the same with the predictor projected on the contact constraint
                (Deuflhard, Krause & Ertel 2008)
  conserving    bulk trapezoidal, joint force (U1 - U0)/(d1 - d0) (after Armero & Petoecz 1998)
"""

import argparse
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import brentq

LENGTH, YOUNG, DENSITY, SPEED = 10.0, 25e9, 2400.0, 1.0
SCHEMES = (
    "trapezoidal",
    "HHT",
    "HHT, end",
    "HHT, implicit",
    "implicit",
    "stabilised",
    "conserving",
)


@dataclass
class Column:
    """Linear bar elements along x, unit area; node 0 faces a wall at distance `gap` [m]."""

    elements: int
    stiffness: float  # of the joint, k_n [Pa/m]
    gap: float = 0.0  # [m]
    held_top: bool = False
    mass: np.ndarray = field(init=False)
    bulk: np.ndarray = field(init=False)

    def __post_init__(self):
        n, h = self.elements, LENGTH / self.elements
        self.mass, self.bulk = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
        for e in range(n):
            s = np.ix_([e, e + 1], [e, e + 1])
            self.mass[s] += DENSITY * h / 6 * np.array([[2, 1], [1, 2]])
            self.bulk[s] += YOUNG / h * np.array([[1, -1], [-1, 1]])

    def joint_force(self, u):
        """Force on node 0, positive away from the wall [N]."""
        return self.stiffness * max(-(u + self.gap), 0.0)

    def joint_energy(self, u):
        return 0.5 * self.stiffness * max(-(u + self.gap), 0.0) ** 2

    def energy(self, u, v):
        return 0.5 * v @ self.mass @ v + 0.5 * u @ self.bulk @ u + self.joint_energy(u[0])


def solve_contact(column, matrix, rhs, guess, force):
    """matrix u = rhs + e0 force(u0): condensed on u0, a monotone equation in one unknown."""
    factor = matrix
    free = cho_solve(factor, rhs)
    unit = np.zeros_like(rhs)
    unit[0] = 1.0
    column_of = cho_solve(factor, unit)
    compliance = column_of[0]

    def residual(x):
        return x - free[0] - compliance * force(x)

    reach = 1e-9
    while residual(guess - reach) > 0 or residual(guess + reach) < 0:
        reach *= 10.0
    x = brentq(residual, guess - reach, guess + reach, xtol=1e-19, rtol=1e-15, maxiter=500)
    return free + column_of * force(x), force(x)


def march(column, scheme, dt, steps, u, v, load=None):
    """Histories of joint force, of energy less the work of `load`, and of energy alone."""
    m, k = column.mass, column.bulk
    load = load or (lambda t: np.zeros_like(u))
    alpha = -0.05 if scheme.startswith("HHT") else 0.0
    beta, gamma = (1 - alpha) ** 2 / 4, 0.5 - alpha
    momentum = scheme in ("implicit", "stabilised", "conserving")
    weight = {"HHT, end": 1.0, "HHT, implicit": 1 / gamma}.get(scheme, 1 + alpha)
    system = cho_factor(m / (beta * dt**2) + (1 + alpha) * k)
    mass = cho_factor(m)
    e0 = np.zeros_like(u)
    e0[0] = 1.0
    joint = column.joint_force(u[0])
    f = load(0.0)
    a = cho_solve(mass, f - k @ u + e0 * joint)
    filtered = joint
    forces, energies, work = [joint], [column.energy(u, v)], 0.0
    stored = energies.copy()
    for n in range(1, steps + 1):
        f1 = load(n * dt)
        if momentum:
            start = u + dt * v
            if scheme == "stabilised" and start[0] + column.gap < 0:
                # M-orthogonal projection of the predictor on u0 >= -gap (or the closure it had)
                target = min(-column.gap, max(u[0], start[0]))
                c = cho_solve(mass, e0)
                start = start + c * (target - start[0]) / c[0]
            rhs = m @ start * 4 / dt**2 - k @ u + f + f1
            u0, scale = u[0], 2.0

            def force(x, u0=u0, scale=scale):
                if scheme != "conserving":
                    return scale * column.joint_force(x)
                closed, closed0 = min(x + column.gap, 0.0), min(u0 + column.gap, 0.0)
                share = (closed - closed0) / (x - u0) if x != u0 else float(closed0 < 0)
                return -scale * column.stiffness * 0.5 * (closed + closed0) * share

            u1, twice = solve_contact(column, system, rhs, u[0], force)
            impulse = 0.5 * (f + f1) - 0.5 * k @ (u + u1) + e0 * twice / 2
            v1 = v + dt * cho_solve(mass, impulse)
            joint = column.joint_force(u1[0]) if scheme != "conserving" else twice / 2
        else:
            predictor = u + dt * v + dt**2 * (0.5 - beta) * a
            rhs = m @ predictor / (beta * dt**2) + (1 + alpha) * f1 - alpha * f + alpha * k @ u
            old = {"HHT, end": 0.0, "HHT, implicit": -(1 - gamma) / gamma * filtered}.get(
                scheme, -alpha * joint
            )
            u1, _ = solve_contact(
                column, system, rhs + e0 * old, u[0], lambda x: weight * column.joint_force(x)
            )
            a1 = (u1 - predictor) / (beta * dt**2)
            v1 = v + dt * ((1 - gamma) * a + gamma * a1)
            a, joint = a1, column.joint_force(u1[0])
            filtered = weight * joint + old
        work += 0.5 * (f + f1) @ (u1 - u)
        u, v, f = u1, v1, f1
        forces.append(joint)
        stored.append(column.energy(u, v))
        energies.append(stored[-1] - work)
    return np.array(forces), np.array(energies), np.array(stored)


def bar_on_wall(scheme, stiffness, cfl, elements=100):
    """Rebound of the bar: contact time, force while closed, energy left, against closed forms."""
    column = Column(elements, stiffness, gap=1e-5)
    speed = np.sqrt(YOUNG / DENSITY)
    dt = cfl * LENGTH / elements / speed
    closed, plateau = 2 * LENGTH / speed, DENSITY * speed * SPEED
    steps = int(1.6 * closed / dt)
    u, v = np.zeros(elements + 1), np.full(elements + 1, -SPEED)
    force, energy, _ = march(column, scheme, dt, steps, u, v)
    touching = np.nonzero(force > 0)[0]
    middle = force[touching[0] + len(touching) // 4 : touching[0] + 3 * len(touching) // 4]
    return {
        "contact time": (touching[-1] - touching[0] + 1) * dt / closed - 1,
        "mean force": middle.mean() / plateau - 1,
        "oscillation": middle.std() / plateau,
        "largest gain": energy.max() / energy[0] - 1,
        "energy at end": energy[-1] / energy[0] - 1,
        "history": (np.arange(len(force)) * dt, force, energy),
    }


def shaken_column(scheme, stiffness, dt, elements=20, seconds=4.0):
    """Column prestressed onto its joint, shaken for 2 s so that it lifts; then left alone."""
    column = Column(elements, stiffness)
    n, h = elements + 1, LENGTH / elements
    weight = np.full(n, DENSITY * h)
    weight[[0, -1]] /= 2
    system = column.bulk.copy()
    system[0, 0] += stiffness
    u = np.linalg.solve(system, -9.81 * weight)

    # joint jumps are measured from the unloaded state; base motion as inertia forces
    def load(t):
        ground = 25.0 * np.sin(2 * np.pi * 20 * t) if t < 2.0 else 0.0
        return -(9.81 + ground) * weight

    force, energy, stored = march(column, scheme, dt, int(seconds / dt), u, np.zeros(n), load)
    scale = stored.max() - stored[0]
    fed = (energy - np.minimum.accumulate(energy)).max()
    return {
        "fed": fed / scale,
        "taken": (energy[0] - energy[-1]) / scale,
        "largest force": force.max() / (9.81 * weight.sum()),
    }


def report():
    print("Bar on a wall, 100 elements: relative to the closed form")
    print(
        f"{'scheme':<14}{'k_n':>8}{'CFL':>6}{'time':>9}{'force':>9}{'ripple':>9}{'gain':>9}{'left':>9}"
    )
    for stiffness in (1e11, 1e12, 1e13):
        for cfl in (0.5, 1.0, 2.0):
            for scheme in SCHEMES:
                r = bar_on_wall(scheme, stiffness, cfl)
                print(
                    f"{scheme:<14}{stiffness:8.0e}{cfl:6.1f}{r['contact time']:9.2%}"
                    f"{r['mean force']:9.2%}{r['oscillation']:9.2%}{r['largest gain']:9.2%}"
                    f"{r['energy at end']:9.2%}"
                )
    print("\nShaken column: energy fed and taken by the scheme, over the largest energy")
    print(f"{'scheme':<14}{'k_n':>8}{'dt':>8}{'fed':>10}{'taken':>10}{'force/weight':>14}")
    for stiffness in (1e10, 1e11, 1e12, 1e13):
        for dt in (0.01, 0.005, 0.002):
            for scheme in SCHEMES:
                r = shaken_column(scheme, stiffness, dt)
                print(
                    f"{scheme:<14}{stiffness:8.0e}{dt:8.3f}{r['fed']:10.2%}"
                    f"{r['taken']:10.2%}{r['largest force']:14.2f}"
                )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot", help="write the force and energy histories of the bar here")
    arguments = parser.parse_args()
    report()
    if arguments.plot:
        draw(arguments.plot)


def draw(name):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, len(SCHEMES), figsize=(18, 6), sharex=True, sharey="row")
    for column, scheme in enumerate(SCHEMES):
        time, force, energy = bar_on_wall(scheme, 1e12, 1.0)["history"]
        axes[0, column].plot(time * 1e3, force / 1e6, lw=1)
        axes[0, column].axhline(7.74597, color="0.6", lw=0.8, ls="--")
        axes[0, column].set_title(scheme)
        axes[1, column].plot(time * 1e3, energy / energy[0], lw=1)
        axes[1, column].set_xlabel("time [ms]")
    axes[0, 0].set_ylabel("pressure on the wall [MPa]")
    axes[1, 0].set_ylabel("energy / energy before")
    figure.tight_layout()
    figure.savefig(name, dpi=90)


if __name__ == "__main__":
    main()
