"""The UMAT of concrete without Keyway: compiled from the files its header names, and called."""

from __future__ import annotations

import ctypes
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from harness import ROOT

SOURCE = ROOT / "src"
INTERFACE = "materials/umat/umat_damage_plasticity.f90"
FLAGS = ["-std=f2008", "-O1", "-Wall", "-Werror", "-Wno-unused-dummy-argument", "-fcheck=all"]
NUM_STATE = 17


def compile_alone(folder: Path) -> ctypes.CDLL:
    """Links these files alone."""
    header = (SOURCE / INTERFACE).read_text().split("\nmodule ")[0]
    parts = re.findall(r"\b[a-z]+/[\w/]+\.f90", header.split("Needs")[1].split("and this file")[0])
    sources = [SOURCE / part for part in [*parts, INTERFACE]]
    library = folder / "alone.so"
    command = [
        "gfortran",
        *FLAGS,
        "-fPIC",
        "-shared",
        "-Wl,--no-undefined",
        "-J",
        folder,
        *sources,
        "-o",
        library,
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(library))


@dataclass
class Answer:
    """Result of a call."""

    stress: np.ndarray
    state: np.ndarray
    tangent: np.ndarray
    stored: float
    dissipated: float
    share: float  # PNEWDT


@dataclass
class Point:
    """One point of another program: keeps stress, state and strain between increments."""

    library: ctypes.CDLL
    constants: list[float]
    length: float = 1.0  # CELENT
    time: float = 1.0  # DTIME
    num_state: int = NUM_STATE
    num_direct: int = 3
    num_shear: int = 3
    strain: np.ndarray = field(default_factory=lambda: np.zeros(6))
    last: Answer | None = None
    increment: int = 1

    def __post_init__(self) -> None:
        size = self.num_direct + self.num_shear
        empty = np.zeros(size), np.zeros(self.num_state), np.zeros((size, size))
        self.last = Answer(*empty, 0.0, 0.0, 1e3)
        self.strain = self.strain[:size]

    def call(self, strain) -> Answer:
        """STRESS .. KINC in the order of the interface; nothing is kept."""
        size = self.num_direct + self.num_shear
        stress, state = self.last.stress.copy(), self.last.state.copy()
        tangent = np.zeros((size, size), order="F")
        energies = np.array([self.last.stored, self.last.dissipated, 0.0, 0.0])
        scratch, one, share = np.zeros(size), np.zeros(1), np.array([1e3])
        increment = np.asarray(strain, dtype=float)[:size] - self.strain
        unit = np.eye(3, order="F")
        name = ctypes.create_string_buffer(b"CONCRETE".ljust(80), 80)
        step = (ctypes.c_int * 4)(1, 0, 0, 0)
        props = np.array(self.constants)

        def real(values: np.ndarray, at: int = 0):
            return ctypes.byref(ctypes.c_double.from_buffer(values, 8 * at))

        def whole(value: int):
            return ctypes.byref(ctypes.c_int(value))

        kept = self.strain.copy()
        room = np.zeros(max(1, len(state)))
        room[: len(state)] = state
        self.library.umat_(
            *(real(stress), real(room), ctypes.c_void_p(tangent.ctypes.data)),
            *(real(energies, i) for i in range(4)),
            *(real(scratch), real(scratch), real(one)),
            *(real(kept), real(increment), real(np.zeros(2)), real(np.array([self.time]))),
            *(real(one), real(one), real(one), real(one), name),
            *(whole(n) for n in (self.num_direct, self.num_shear, size, self.num_state)),
            *(real(props), whole(len(props)), real(np.zeros(3))),
            *(ctypes.c_void_p(unit.ctypes.data), real(share), real(np.array([self.length]))),
            *(ctypes.c_void_p(unit.ctypes.data), ctypes.c_void_p(unit.ctypes.data)),
            *(whole(7), whole(3), whole(1), whole(1), step, whole(self.increment)),
            ctypes.c_long(80),
        )
        state = room[: self.num_state]
        return Answer(stress, state, tangent, energies[0], energies[1], share[0])

    def keep(self, strain) -> Answer:
        """A converged increment."""
        self.last = self.call(strain)
        self.strain = np.array(strain, dtype=float)[: len(self.strain)]
        self.increment += 1
        return self.last

    def keep_uniaxial(self, axial: float, free=(1, 2)) -> Answer:
        """E11 given, the stresses of `free` zero, by Newton with DDSDDE."""
        free = list(free)
        strain = self.strain.copy()
        start = self.last.tangent if self.increment > 1 else self.call(strain).tangent
        coupling = start[free, 0] * (axial - strain[0])
        strain[free] -= np.linalg.solve(start[np.ix_(free, free)], coupling)
        strain[0] = axial
        for _ in range(30):
            answer = self.call(strain)
            scale = max(np.abs(answer.stress).max(), 1.0)
            if np.abs(answer.stress[free]).max() <= 1e-10 * scale:
                break
            strain[free] -= np.linalg.solve(answer.tangent[np.ix_(free, free)], answer.stress[free])
        else:
            raise AssertionError(f"no balance at {axial}")
        return self.keep(strain)
