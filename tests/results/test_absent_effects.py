"""What absent effects cost: valgrind counts instructions and memory of their procedures.

Two scenes differ in the size of their mesh alone. A loop over nodes or elements takes at least one
instruction for each of them, an array at least one byte. Procedures of effects that a deck lacks
must differ by less: they ask whether there is anything to do, and return.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
from tied_blocks import Blocks, node_set
from valgrind import NEEDS_VALGRIND, SOURCES, instructions, module_of, watch

# Rooms of effects that are not in the scene: one elastic block under its weight, in motion
ABSENT_ROOMS = (
    "joints/law", "joints/points", "joints/compliance", "joints/iteration", "interfaces/couplings",
    "interfaces/facets", "interfaces/mortar", "materials/concrete", "materials/concrete_blocks",
    "materials/metal", "materials/umat", "analysis/heat", "analysis/stages", "analysis/solids",
    "analysis/modes", "analysis/reduced", "equations/spectrum", "equations/low_rank",
    "results/errors",
)  # fmt: skip
ABSENT_MODULES = (
    "load_point", "load_pressure", "load_reservoir", "load_uplift", "load_base_motion",
    "water_paths", "joint_rim", "wetted_facet", "joint_water", "thermal_strains", "thermal_work",
    "thermal_recovery", "jump_links", "link_graph", "link_order", "tie_motion",
)  # fmt: skip
# Modules of these rooms that solve the equations of every model
PRESENT = ("equilibrium", "equilibrium_linear", "equilibrium_catalogue")
pytestmark = NEEDS_VALGRIND


def scene(n: int) -> str:
    """A cube of n^3 elements on its base: ten increments of motion under its weight."""
    blocks = Blocks()
    blocks.add("A", *[(n, 0.0, 1.0)] * 3)
    law = "*DENSITY\n2400.\n*ELASTIC\n2e10, 0.2\n"
    base = node_set("BASE", blocks.side("A", "Z0")) + "*BOUNDARY\nBASE, 1, 3\n"
    return blocks.deck({"": law}, base) + (
        "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*CONTROLS, ERROR ESTIMATE=OFF\n"
        "*DLOAD\n, GRAV, 9.81, 0., 0., -1.\n*END STEP\n"
    )


def watched(program: Path, folder: Path, tool: str, n: int) -> Path:
    """The file that a tool of valgrind leaves of a run."""
    folder = folder / f"{tool}_{n}"
    folder.mkdir()
    (folder / "job.inp").write_text(scene(n))
    run = ["-q", "-j", "1", "-o", str(folder), str(folder / "job.inp")]
    return watch(program, folder, tool, run)


def allocated_bytes(path: Path) -> Counter:
    """Bytes by the module that has asked for them, or whose callee has."""
    content = json.loads(path.read_text())
    modules = [module_of(frame) for frame in content["ftbl"]]
    total: Counter = Counter()
    for point in content["pps"]:
        owner = next((modules[frame] for frame in point["fs"] if modules[frame]), "")
        total[owner] += point["tb"]
    return total


def is_absent(module: str) -> bool:
    if module in PRESENT or not module:
        return False
    return module in ABSENT_MODULES or str(SOURCES[module]) in ABSENT_ROOMS


@pytest.mark.parametrize(("tool", "read"), [("callgrind", instructions), ("dhat", allocated_bytes)])
def test_absent_effects_have_no_loop_and_no_memory(program_path, tmp_path, tool, read):
    small, large = (read(watched(program_path.resolve(), tmp_path, tool, n)) for n in (3, 6))
    assert large["matrix_pattern"] > 2 * small["matrix_pattern"] > 0, "names are found"
    more = {m: large[m] - small[m] for m in large | small if is_absent(m)}
    fewest = 6**3 - 3**3  # additional elements; there are more additional nodes
    grown = {module: number for module, number in more.items() if number >= fewest}
    assert not grown
