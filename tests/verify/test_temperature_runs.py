"""Runs with temperatures: UMATs, threads, restarts, and a cracked dam that is shaken in winter."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from heat_decks import (
    ALPHA,
    OUTPUT,
    YOUNG,
    balances,
    brick,
    components,
    lines_of,
    model,
    statically,
    warm,
)
from stage_decks import add, remove, step
from stopped_runs import stops_that_go_on
from tied_blocks import Blocks, node_set

UMAT = Path(__file__).parents[1] / "umat" / "tells_arguments.for"
SHAKE = "*AMPLITUDE, NAME=SHAKE\n0., 0., 0.02, 20., 0.05, -20., 0.08, 10., 0.1, 0.\n"
CONCRETE = f"""*DENSITY
2400.
*ELASTIC
{YOUNG!r}, 0.2
*EXPANSION
{ALPHA!r}
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
20e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
1e6, 300.
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, 5e-4
"""


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
def test_a_umat_gets_temperatures_and_the_strain_without_them(keyway, element):
    """Elasticity as a UMAT: the stresses of the program's own, TEMP at the start, DTEMP."""
    blocks = brick((1, 1, 1), (1.0, 1.0, 1.0))
    supports = statically(blocks) + "*BOUNDARY\nALL, 1\n"
    field = lines_of(blocks, lambda x: 30.0 + 8.0 * x[:, 2])
    own = f"*ELASTIC\n{YOUNG!r}, 0.2\n*EXPANSION\n{ALPHA!r}\n"
    umat = f"*USER MATERIAL, CONSTANTS=2\n{YOUNG!r}, 0.2\n*EXPANSION\n{ALPHA!r}\n"
    steps = warm(field, "0.5, 1., 0.5, 0.5\n")
    plain = keyway(model(blocks, supports, own, element) + steps, name="own")
    other = keyway(
        model(blocks, supports, umat, element) + steps, "--umat", str(UMAT), "-j", "1", name="umat"
    )
    stress = components(plain.csv("el_BODY"), "S")
    for field_name, scale in (("S", np.abs(stress).max()), ("E", ALPHA * 28), ("THE", ALPHA * 28)):
        a = components(plain.csv("el_BODY"), field_name)
        b = components(other.csv("el_BODY"), field_name)
        assert np.abs(a - b).max() < 1e-9 * scale
    told = (other.folder / "umat.msg").read_text().splitlines()
    times = [[float(x) for x in line.split()[1:]] for line in told if line.startswith("time")]
    # time(1:2), dtime, temp, dtemp: means over the element, or values at its points with C3D8I.
    temp, dtemp = np.array([t[3:5] for t in times if t[1] == 0.5]).T
    assert temp.mean() == pytest.approx(0.5 * (10.0 + 34.0), abs=1e-4)
    assert dtemp.mean() == pytest.approx(12.0, abs=1e-4)
    assert (np.ptp(temp) > 1.0) == (element == "C3D8I")


def winter() -> str:
    """A cracking cantilever on a rigid base, cooled at its face, then shaken."""
    blocks = brick((2, 1, 6), (3.0, 1.0, 12.0))
    base = node_set("BASE", blocks.side("A", "Z0"))
    cold = lines_of(blocks, lambda x: -4.0 - 2.0 * x[:, 0])
    return (
        model(blocks, base + SHAKE + "*BOUNDARY\nBASE, 1, 3\n", CONCRETE, "C3D8I")
        + step("*DLOAD\nBODY, GRAV, 9.81, 0, 0, -1\n" + OUTPUT + "*RESTART, WRITE\n")
        + step(f"*TEMPERATURE\n{cold}", data="0.25, 1., 0.01, 0.25\n")
        + "*STEP\n*DYNAMIC, DIRECT\n0.005, 0.1\n*BASE MOTION, DOF=1, AMPLITUDE=SHAKE\n"
        "*END STEP\n"
    )


def test_a_cracked_dam_in_winter(keyway):
    """It cracks by the cold, then shakes; energies balance, and threads change nothing."""
    runs = [keyway(winter(), "-j", n, name=f"job{n}") for n in ("1", "2")]
    energies = [s["energy"] for s in runs[0].json["steps"]]
    assert energies[0]["temperature"] == 0.0
    assert energies[2]["temperature"] == energies[1]["temperature"]  # constant while it shakes
    assert energies[1]["fracture"] > 0.0
    balances(runs[0], 1e-5)  # increments that are solved to a residual of 1e-6
    for table in ("node_ALL", "el_BODY"):
        for name, column in runs[0].csv(table).items():
            assert np.array_equal(column, runs[1].csv(table)[name]), name


def lifts() -> str:
    """Two lifts with a joint of temperatures, in stages and in time."""
    blocks = Blocks()
    blocks.add("L1", (1, 0, 1), (1, 0, 1), (1, 0, 1))
    blocks.add("L2", (1, 0, 1), (1, 0, 1), (1, 1, 2))
    blocks.share("L1", "L2")
    sets = node_set("TOP", blocks.side("L2", "Z1")) + node_set("BASE", blocks.side("L1", "Z0"))
    quarter = "0.25, 1., 0.25, 0.25\n"
    clock = "*AMPLITUDE, NAME=YEAR, TIME=TOTAL TIME\n0., 10., 3., 40.\n"
    return (
        model(blocks, sets + clock + "*BOUNDARY\nBASE, 1, 3\n", element="C3D8I")
        + step(
            remove("L2") + "*TEMPERATURE, AMPLITUDE=YEAR\nALL, 1.\n" + OUTPUT + "*RESTART, WRITE\n",
            data=quarter,
        )
        + step(add("L2"), data=quarter)
        + step("*TEMPERATURE, INPUT=top.csv\n", data=quarter)
        + "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.1\n*TEMPERATURE, OP=NEW\n*END STEP\n"
    )


def test_a_run_goes_on_between_and_within_steps(program_path, tmp_path):
    """A run that is stopped in any step and continued ends with the same tables."""
    deck = tmp_path / "job.inp"
    deck.write_text(lifts())
    (tmp_path / "top.csv").write_text("node, 0, 0.3, 1\nTOP, 20, 5, 7\n")

    assert stops_that_go_on(program_path, tmp_path, deck, (2, 4, 6, 8, 10, 13, 16, 20)) >= 3


def test_another_file_of_temperatures_is_another_deck(program_path, tmp_path):
    """A continued run finds that the file has changed."""
    deck, file = tmp_path / "job.inp", tmp_path / "top.csv"
    deck.write_text(lifts())
    file.write_text("TOP, 20\n")
    command = [program_path, "-q", "-j", "1", "-o", tmp_path / "out"]
    subprocess.run([*command, deck], check=True)
    file.write_text("TOP, 21\n")
    done = subprocess.run([*command, "--continue", deck], capture_output=True, text=True)
    assert done.returncode != 0
    assert "TEMPERATURE" in done.stderr
