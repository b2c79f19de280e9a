"""Decks for the point driver from a material and legs, and what the driver leaves, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from concretes import Material
from harness import Program, Run
from reference.path import Leg

COMPONENTS = ("11", "22", "33", "12", "13", "23")


def rows_of(table: np.ndarray) -> str:
    return "".join(", ".join(repr(float(v)) for v in row) + "\n" for row in table)


def material_cards(name: str, material: Material) -> str:
    """The keywords of a concrete."""
    m = material
    surface = (m.dilation, m.offset, m.biaxial_ratio, m.meridian_ratio, m.viscosity)
    return (
        f"*MATERIAL, NAME={name}\n*ELASTIC\n{m.young!r}, {m.poisson!r}\n"
        f"*CONCRETE DAMAGED PLASTICITY, RECOVERY={m.recovery}\n{rows_of(np.array([surface]))}"
        f"*CONCRETE COMPRESSION HARDENING\n{rows_of(m.compression)}"
        f"*CONCRETE COMPRESSION DAMAGE, TENSION RECOVERY={m.tension_recovery!r}\n"
        f"{rows_of(m.compression_damage)}"
        f"*CONCRETE TENSION STIFFENING, TYPE={m.stiffening}\n{rows_of(m.tension)}"
        f"*CONCRETE TENSION DAMAGE, TYPE={m.stiffening}, "
        f"COMPRESSION RECOVERY={m.compression_recovery!r}\n"
        f"{rows_of(m.tension_damage)}"
    )


def test_cards(name: str, material: str, legs: Sequence[Leg], increments: int, time: float) -> str:
    """A test along legs, all with as many increments and as much time."""
    head = f"*MATERIAL TEST, NAME={name}, MATERIAL={material}, TYPE=GENERAL"
    lines = [f"{head}, INCREMENTS={increments}, TIME={time!r}\n"]
    for leg in legs:
        letters = "".join("E" if strain else "S" for strain in leg.is_strain)
        lines.append(", ".join([letters, *(repr(float(v)) for v in leg.end)]) + "\n")
    return "".join(lines)


test_cards.__test__ = False  # a name that pytest would collect


@dataclass(frozen=True)
class Curve:
    """What a point went through, a row for the start and for each increment."""

    time: np.ndarray  # [s]
    strain: np.ndarray  # (rows, 6)
    stress: np.ndarray  # (rows, 6) [Pa]
    plastic: np.ndarray  # (rows, 6)
    damage: np.ndarray  # (rows, 2) d_t, d_c
    work: np.ndarray  # [J/m3]
    stored: np.ndarray  # [J/m3]
    dissipated: np.ndarray  # cracking and crushing [J/m3]
    crushing: np.ndarray  # of it [J/m3]

    def at_legs(self, values: np.ndarray, increments: int) -> np.ndarray:
        """Rows at the ends of the legs."""
        return values[increments::increments]


@dataclass
class PointDeck:
    """A deck of materials and tests."""

    materials: dict[str, Material] = field(default_factory=dict)
    tests: list[str] = field(default_factory=list)

    def add(
        self,
        name: str,
        material: Material,
        legs: Sequence[Leg],
        increments: int = 100,
        time: float = 1.0,
    ) -> None:
        """A test along legs, all with as many increments and as much time."""
        self.tests.append(test_cards(name, self._name_of(material), legs, increments, time))

    def add_kind(self, name: str, material: Material, kind: str, targets, increments=100) -> None:
        """A test of one of the driver's kinds, as in kind='BIAXIAL, RATIO=0.5'."""
        head = f"*MATERIAL TEST, NAME={name}, MATERIAL={self._name_of(material)}, TYPE={kind}"
        lines = "".join(f"{float(target)!r}\n" for target in targets)
        self.tests.append(f"{head}, INCREMENTS={increments}\n{lines}")

    def _name_of(self, material: Material) -> str:
        """Of a material in the deck; it is put there when it is new."""
        known = next((k for k, m in self.materials.items() if m is material), None)
        if known is None:
            known = f"M{len(self.materials) + 1}"
            self.materials[known] = material
        return known

    def text(self) -> str:
        cards = [material_cards(name, material) for name, material in self.materials.items()]
        return "".join(cards + self.tests)

    @property
    def names(self) -> list[str]:
        """Of all tests."""
        return [t.split("NAME=")[1].split(",")[0] for t in self.tests]

    def run(self, keyway: Program, name: str = "job") -> Curves:
        return Curves(keyway(self.text(), "--material", name=name))


class Curves:
    """The curves of a finished run, by the name of the test."""

    def __init__(self, run: Run):
        self._run = run

    def __getitem__(self, name: str) -> Curve:
        table = self._run.csv(f"material_{name}")

        def columns(*names: str) -> np.ndarray:
            return np.stack([table[n] for n in names], axis=1)

        return Curve(
            time=table["time"],
            strain=columns(*(f"E{c}" for c in COMPONENTS)),
            stress=columns(*(f"S{c}" for c in COMPONENTS)),
            plastic=columns(*(f"PE{c}" for c in COMPONENTS)),
            damage=columns("DAMAGET", "DAMAGEC"),
            work=table["work"],
            stored=table["stored"],
            dissipated=table["fracture"] + table["crushing"],
            crushing=table["crushing"],
        )
