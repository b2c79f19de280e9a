"""Checks the layers of the sources.

A module uses its own room (folder) and lower ones; no two modules use each other; file and module
have the same name; the lists sources.cmake name every file and no other.

usage: check_layers.py [ROOT]
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

from fortran_source import parent_name, sources_under, unit_name, uses

# The rooms of src (folders of sources), lowest first.
ROOMS = (
    "base",
    "base/text",
    "base/math",
    "base/products",
    "base/system",
    "base/files",
    "base/messages",
    "base/report",
    "base/ranks",
    "equations/distributed",
    "equations/elimination",
    "equations",
    "equations/spectrum",
    "equations/low_rank",
    "equations/supernodes",
    "deck",
    "model/mesh",
    "model/constraints",
    "model/steps",
    "guests/history",
    "materials/law",
    "materials/concrete",
    "materials/concrete_blocks",
    "materials/metal",
    "materials/umat",
    "materials/at_a_point",
    "joints/law",
    "elements",
    "guests",
    "joints/points",
    "interfaces/facets",
    "interfaces/mortar",
    "interfaces/couplings",
    "loads",
    "assembly",
    "assembly/parts",
    "joints/compliance",
    "joints/iteration",
    "analysis/state",
    "analysis/system",
    "analysis/heat",
    "analysis/stages",
    "diagnosis",
    "analysis/solids",
    "analysis/modes",
    "analysis/reduced",
    "analysis/integrators",
    "analysis/steps",
    "results/stresses",
    "results/quantities",
    "results/errors",
    "results/fields",
    "results/record",
    "results/summary",
    "results/writers",
    "results/checkpoints",
    "results",
    "keywords/assembly",
    "keywords/draft",
    "keywords/mesh",
    "keywords/heat",
    "keywords/materials",
    "keywords/point",
    "keywords/joints",
    "keywords/stages",
    "keywords/steps",
    "keywords/contact",
    "keywords/loads",
    "keywords/checks",
    "keywords/magnitudes",
    "keywords",
    "app/summary",
    "app/forecast",
    "app",
)
# The folders right under src; each has one list of sources.
FOLDERS = tuple(dict.fromkeys(room.split("/")[0] for room in ROOMS))
# Modules of the compiler and of the libraries.
FOREIGN = {"iso_fortran_env", "iso_c_binding", "omp_lib", "hdf5", "h5lt", "ieee_arithmetic"}
# Modules with this ending are copies that CMake makes (cmake/WideCopies.cmake).
COPY = "_wide"
# CMake fills these in (cmake/BuildInfo.cmake).
TEMPLATES = "*.f90.in"


@dataclass(frozen=True)
class Source:
    """A file, its room, and the modules that it defines and uses."""

    path: Path
    room: str
    unit: str
    parent: str | None
    uses: tuple[tuple[int, str], ...]


def read_sources(root: Path) -> tuple[list[Source], list[str]]:
    """All files under src, and the faults of their places and names."""
    found, faults = [], []
    folder = root / "src"
    for path in sources_under(folder) + sorted(folder.rglob(TEMPLATES)):
        place = path.relative_to(root)
        room = path.parent.relative_to(folder).as_posix()
        if room not in ROOMS:
            faults.append(f"{place}: '{room}' is no room; add it to ROOMS of check_layers.py")
            continue
        text = path.read_text(encoding="utf-8")
        unit = unit_name(text) or ""
        stem = path.name.split(".")[0]
        if unit != stem and not (room == "app" and stem == "main"):
            faults.append(f"{place}: holds '{unit}'; file and module must have the same name")
        used = tuple((line, name.removesuffix(COPY)) for line, name in uses(text))
        found.append(Source(place, room, unit, parent_name(text), used))
    return found, faults


def check_directions(sources: list[Source]) -> list[str]:
    """Uses of higher rooms and of modules that do not exist."""
    room_of = {s.unit: s.room for s in sources}
    faults = []
    for source in sources:
        for line, name in source.uses:
            if name in FOREIGN:
                continue
            if name not in room_of:
                faults.append(f"{source.path}:{line}: there is no module '{name}'")
            elif ROOMS.index(room_of[name]) > ROOMS.index(source.room):
                faults.append(
                    f"{source.path}:{line}: room '{source.room}' uses '{name}' of the higher "
                    f"room '{room_of[name]}'"
                )
    return faults


def check_cycles(sources: list[Source]) -> list[str]:
    """Circles of modules that use each other; a submodule counts as a part of its module."""
    part_of = {s.unit: s.parent or s.unit for s in sources}
    graph: dict[str, set[str]] = {}
    for source in sources:
        targets = graph.setdefault(part_of[source.unit], set())
        targets |= {part_of[n] for _, n in source.uses if n in part_of} - {part_of[source.unit]}
    faults, state = [], {}

    def visit(module: str, trail: list[str]) -> None:
        state[module] = "open"
        for target in sorted(graph.get(module, ())):
            if state.get(target) == "open":
                ring = [*trail, module][[*trail, module].index(target) :]
                faults.append("modules use each other: " + " -> ".join([*ring, target]))
            elif target not in state:
                visit(target, [*trail, module])
        state[module] = "done"

    for module in sorted(graph):
        if module not in state:
            visit(module, [])
    return faults


def check_lists(root: Path) -> list[str]:
    """Differences between the lists sources.cmake and the files."""
    faults = []
    for folder in FOLDERS:
        list_file = root / "src" / folder / "sources.cmake"
        if not list_file.is_file():
            faults.append(f"src/{folder}: has no sources.cmake")
            continue
        text = re.sub(r"#.*", "", list_file.read_text(encoding="utf-8"))
        listed = re.findall(r"[\w./-]+\.(?:f90|c)\b", text)
        present = {
            str(p.relative_to(list_file.parent))
            for p in list_file.parent.rglob("*")
            if p.suffix in {".f90", ".c"}
        }
        place = f"src/{folder}/sources.cmake"
        faults += [
            f"{place}: '{n}' is listed but does not exist" for n in sorted({*listed} - present)
        ]
        faults += [f"{place}: '{n}' is not listed" for n in sorted(present - {*listed})]
        faults += [
            f"{place}: '{n}' is listed twice" for n in sorted({*listed}) if listed.count(n) > 1
        ]
    return faults


def check(root: Path) -> list[str]:
    """Every fault found under ROOT/src."""
    sources, faults = read_sources(root)
    return faults + check_directions(sources) + check_cycles(sources) + check_lists(root)


def main(arguments: list[str]) -> int:
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    faults = check(root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
