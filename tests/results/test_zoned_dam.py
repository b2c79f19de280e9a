"""Which elements are the dam, and where its faces are, of a dam of a facing and a body."""

import h5py
import numpy as np
import pytest
from harness import Run
from keyway_tools.results import Results

WIDTHS = (0.0, 1.0, 3.0, 6.0)  # places of the planes along x: facing, core, downstream part [m]
PARTS = ("FACING", "CORE", "BACK")
HEIGHT, ROCK = 4.0, 2.0  # [m]
MASSLESS, HEAVY = "", "*DENSITY\n2600.\n"


def zoned(rock: str | None, up: int = 3) -> str:
    """One row of bricks, upstream at x = 0, each a section of its own; None: no rock below."""
    levels = (-ROCK, 0.0, HEIGHT) if rock is not None else (0.0, HEIGHT)
    number = {}
    nodes = []
    for k, z in enumerate(levels):
        for j, y in enumerate((0.0, 2.0)):
            for i, x in enumerate(WIDTHS):
                number[i, j, k] = len(number) + 1
                place = (x, y, z) if up == 3 else (y, z, x)
                nodes.append(f"{number[i, j, k]}, {place[0]}, {place[1]}, {place[2]}")
    text = ["*NODE", *nodes]
    elements = 0
    for k in range(len(levels) - 1):
        for i, part in enumerate(PARTS):
            name = part if k == len(levels) - 2 else "ROCK"
            corners = [(i, 0), (i + 1, 0), (i + 1, 1), (i, 1)]
            ids = [number[a, b, level] for level in (k, k + 1) for a, b in corners]
            elements += 1
            text += [f"*ELEMENT, TYPE=C3D8, ELSET={name}"]
            text += [f"{elements}, {', '.join(map(str, ids))}"]
    fixed = [str(n) for (_, _, k), n in number.items() if k == 0]
    text += ["*NSET, NSET=BASE", ", ".join(fixed), "*SURFACE, NAME=WET", "FACING, S6"]
    densities = dict.fromkeys(PARTS, "*DENSITY\n2400.\n") | ({} if rock is None else {"ROCK": rock})
    for name, density in densities.items():
        text += [f"*MATERIAL, NAME=OF_{name}", f"{density}*ELASTIC\n2e10, 0.2"]
        text += [f"*SOLID SECTION, ELSET={name}, MATERIAL=OF_{name}"]
    text += ["*BOUNDARY", "BASE, 1, 3", "*STEP", "*STATIC", "1., 1."]
    text += [f"*RESERVOIR, NAME=L, SURFACE=WET, LEVEL=3, BED=0, UP={up}"]
    return "\n".join([*text, "*NODE FILE", "U", "*ENVELOPE", "U", "*END STEP"]) + "\n"


def parts_of(run: Run) -> set[str]:
    """The element sets of the dam, as the tools take them."""
    results = Results(run.folder, run.job)
    numbers = set(results.element_id[results.dam].tolist())
    sets = results.file["sets/elements"]
    return {name for name in sets if numbers & set(sets[name][:].tolist())}


@pytest.mark.parametrize("rock", [MASSLESS, None])
def test_the_dam_is_more_than_its_facing(keyway, rock):
    """On massless rock all with a mass; without rock what hides the back of the facing."""
    run = keyway(zoned(rock))
    assert parts_of(run) == set(PARTS)
    with h5py.File(run.folder / "job.h5") as file:
        back = file["mesh/x"][:][file["faces/downstream"][:] == 1]
        assert file["mesh"].attrs["up"] == 3
    assert sorted(set(back[:, 0])) == [6.0]
    assert len(back) == 4
    assert run.json["displacement"]["downstream"]["x"][0] == pytest.approx(6.0)


def test_heavy_rock_below_is_not_the_dam(keyway):
    """The rock hides the foot of the dam and nothing that points away from the water."""
    run = keyway(zoned(HEAVY))
    assert parts_of(run) == set(PARTS)


def test_the_axis_up_is_that_of_the_reservoir(keyway):
    run = keyway(zoned(None, up=2))
    results = Results(run.folder, run.job)
    assert results.up_axis == 1
    assert np.ptp(results.x[:, results.up_axis]) == HEIGHT
    assert parts_of(run) == set(PARTS)
