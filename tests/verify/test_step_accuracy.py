"""*CONTROLS, ACCURACY: increments follow the estimated error in time.

A damped oscillator, and a column of 8 elements, under motions of the base: steady, quiet with a
strong part in the middle, and noise. The truth has a 32nd of the first increment.
"""

import csv
import json
import math
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest
from brick_decks import brick_deck, elastic
from joint_decks import Block
from keyway_tools.box_mesh import box_mesh, stretched

FIRST = 0.04  # s, also of the motions
DURATION = 24.0
RATIO = 0.05
ASKED = (0.05, 0.02, 0.01)
STRONG = (8.0, 14.0)  # s
WEIGHT = "*DLOAD\nBLOCK, GRAV, 9.81, 0., 0., -1.\n"


def motion_of(name: str) -> np.ndarray:
    times = np.arange(0.0, DURATION + FIRST, FIRST)
    if name == "noise":
        noise = np.random.default_rng(3).normal(size=times.size)
        return 2.0 * np.convolve(noise, np.ones(3) / 3.0, "same")
    steady = np.sin(1.7 * times) + np.sin(6.0 * times) + 0.7 * np.sin(11.0 * times + 1.0)
    if name == "steady":
        return steady
    return steady * np.where((times < STRONG[0]) | (times > STRONG[1]), 0.02, 1.0)


def column(bricks: int, motion: str, increment: float, controls: str = "", more: str = "") -> str:
    """An upright column, held sideways, under its weight; its lowest frequency is 1 Hz."""
    mesh, number = box_mesh((1, 1, bricks), stretched((1.0, 1.0, 1.0)))
    mesh.node_sets["ALL"] = number.ravel()
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:1, :1, -1].ravel()
    omega = 2.0 * math.pi
    # One brick: k = E, m = rho/3. Many: omega = (pi/2) sqrt(E/rho).
    law = elastic(omega**2, 0.0, 3.0 if bricks == 1 else (0.5 * math.pi) ** 2)
    damping = f"ALPHA={1.2 * RATIO * omega!r}, BETA={0.8 * RATIO / omega!r}"
    law = law.replace("*ELASTIC", f"*DAMPING, {damping}\n*ELASTIC")
    values = "".join(f"{value:.10g}\n" for value in motion_of(motion))
    cards = f"*AMPLITUDE, NAME=LOAD, FORMAT=VALUES, DT={FIRST}\n{values}{law}"
    cards += "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n*STEP\n*STATIC\n*DLOAD\n"
    cards += "BODY, GRAV, 1., 0., 0., -1.\n*END STEP\n*STEP, INC=1000000\n"
    cards += "*DYNAMIC" if controls else "*DYNAMIC, DIRECT"
    cards += f"\n{increment!r}, {DURATION}\n{controls}"
    cards += "*BASE MOTION, DOF=3, AMPLITUDE=LOAD, SCALE=1.\n"
    return brick_deck(mesh, "C3D8", f"{cards}*NODE PRINT, NSET=TOP\nU\n{more}*END STEP\n")


def history(run) -> tuple[np.ndarray, np.ndarray]:
    """Times and displacements of the top in the dynamic step."""
    table = run.csv("node_TOP")
    return table["time"], table["U3"]


def factors_of(run) -> int:
    return sum(p["calls"] for p in run.json["ledger"]["parts"] if p["name"] == "factor structure")


def sizes_of(run) -> dict[float, int]:
    """Increments of each size, over the first increment."""
    (found,) = run.json["accuracy"]["increments"].values()
    return {s["size"] / FIRST: s["increments"] for s in found["sizes"]}


@pytest.mark.parametrize("motion", ["steady", "burst", "noise"])
@pytest.mark.parametrize(("bricks", "name"), [(1, "oscillator"), (8, "column")])
def test_true_error(keyway, documented, bricks, name, motion):
    """The error of the top at any time stays below what was asked for; a quarter of it is the least
    that sizes in powers of two can promise, and the estimate keeps some more."""
    fine, exact = history(keyway(column(bricks, motion, FIRST / 32)))
    for asked in ASKED:
        run = keyway(column(bricks, motion, FIRST, f"*CONTROLS, ACCURACY={asked}\n"))
        times, u = history(run)
        error = np.abs(u - np.interp(times, fine, exact)).max() / np.abs(exact).max()
        assert 0.1 * asked < error < asked
        documented("accuracy asked", (name, motion), f"{asked}", error)
        sizes = sizes_of(run)
        assert len(sizes) <= 5
        assert all(math.log2(size) % 1.0 < 1e-6 for size in sizes)
        assert factors_of(run) == len(sizes) + 1  # each size once, and the static step


def test_quiet_strong_quiet(keyway):
    run = keyway(column(1, "burst", FIRST, "*CONTROLS, ACCURACY=0.02\n"))
    times, _ = history(run)
    size = np.diff(times) / FIRST
    time = times[1:] - 1.0

    def mean(first: float, last: float) -> float:
        return size[(time > first) & (time < last)].mean()

    assert mean(4.0, STRONG[0]) > 1.9 * mean(STRONG[0] + 1.0, STRONG[1])
    assert mean(19.0, DURATION) > 1.9 * mean(STRONG[0] + 1.0, STRONG[1])


def test_undamped_steps_share_the_error(keyway):
    """Without damping errors add up over the whole step."""
    fine, exact = history(keyway(undamped(FIRST / 32, "")))
    times, u = history(keyway(undamped(FIRST, "*CONTROLS, ACCURACY=0.05\n")))
    error = np.abs(u - np.interp(times, fine, exact)).max() / np.abs(exact).max()
    assert error < 0.05


def undamped(increment: float, controls: str) -> str:
    lines = column(1, "burst", increment, controls).splitlines()
    return "\n".join(line for line in lines if not line.startswith("*DAMPING")) + "\n"


def test_limits_of_the_data_line(keyway):
    """The smallest and the largest increment that the deck names bound the sizes."""
    deck = column(1, "burst", FIRST, "*CONTROLS, ACCURACY=0.005\n")
    data = f"{FIRST!r}, {DURATION}\n"
    limited = deck.replace(data, f"{FIRST!r}, {DURATION}, {0.3 * FIRST!r}, {2.0 * FIRST!r}\n")
    assert limited != deck
    run = keyway(limited)
    assert min(sizes_of(run)) == pytest.approx(0.5)
    # The smallest increment keeps the accuracy from being met.
    assert run.json["accuracy"]["increments"]["STEP-2"]["estimated_error"] > 0.005
    assert any("ACCURACY is not met" in text for text in run.json["warnings"])
    still = limited.replace("ACCURACY=0.005", "ACCURACY=0.5")
    run = keyway(still)
    assert max(sizes_of(run)) == pytest.approx(2.0)
    assert run.json["warnings"] == []


def test_a_first_increment_longer_than_the_samples(keyway):
    """No increment is longer than the samples, unless the deck names the largest. A jump of a load
    is no sample."""
    still = "*CONTROLS, ACCURACY=0.5\n"
    deck = column(1, "noise", 4.0 * FIRST, still)
    jump = f"*AMPLITUDE, NAME=JUMP\n0., 0., 5., 0., 5.00001, 1., {DURATION}, 1.\n*BOUNDARY\n"
    push = "*CLOAD, AMPLITUDE=JUMP\nTOP, 3, 1e-3\n*BASE MOTION"
    deck = deck.replace("*BOUNDARY\n", jump, 1).replace("*BASE MOTION", push, 1)
    assert max(sizes_of(keyway(deck))) == pytest.approx(1.0)
    data = f"{4.0 * FIRST!r}, {DURATION}\n"
    named = deck.replace(data, f"{data.strip()}, , {4.0 * FIRST!r}\n")
    assert named != deck
    assert max(sizes_of(keyway(named, name="named"))) == pytest.approx(4.0)


def test_regular_output(keyway):
    """FREQUENCY counts first increments: output comes at regular times."""
    more = "*NODE PRINT, NSET=BASE, FREQUENCY=5\nRF\n"
    run = keyway(column(1, "burst", FIRST, "*CONTROLS, ACCURACY=0.02\n", more))
    times = np.unique(run.csv("node_BASE")["time"]) - 1.0
    assert times == pytest.approx(5.0 * FIRST * np.arange(1, 121), abs=1e-9)


def test_two_threads(make_program, program_path):
    deck = column(8, "burst", FIRST, "*CONTROLS, ACCURACY=0.02\n")
    program = make_program(program_path)
    one, two = (history(program(deck, "-j", n, name=f"job{n}")) for n in ("1", "2"))
    assert one[0] == pytest.approx(two[0], rel=1e-12)
    assert one[1] == pytest.approx(two[1], abs=1e-9 * np.abs(one[1]).max())


def test_killed_and_continued(program_path: Path, tmp_path: Path):
    """The run that goes on has the sizes and the displacements of the run that was not killed."""
    more = "*RESTART, WRITE, FREQUENCY=7\n"
    deck = tmp_path / "job.inp"
    deck.write_text(column(8, "burst", FIRST, "*CONTROLS, ACCURACY=0.02\n", more))
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    subprocess.run([program_path, "-q", "-o", whole, deck], check=True)
    process = subprocess.Popen([program_path, "-q", "-o", parts, deck])
    table = parts / "job_energy.csv"
    while process.poll() is None and (not table.exists() or table.read_bytes().count(b"\n") < 600):
        pass
    process.send_signal(signal.SIGKILL)
    process.wait()
    subprocess.run([program_path, "-q", "-o", parts, "--continue", deck], check=True)
    tables = []
    for folder in (whole, parts):
        with (folder / "job_node_TOP.csv").open() as file:
            tables.append(list(csv.reader(file)))
    assert tables[0] == tables[1]
    found = [json.loads((folder / "job.json").read_text())["accuracy"] for folder in (whole, parts)]
    assert found[0]["increments"] == found[1]["increments"]


def test_an_impact_has_no_estimate(keyway):
    """A block falls 10 mm onto a joint. Increments that have grown in its free flight stop it
    there; 0.4 % of the largest displacement were said, and the rebound was missing."""
    block = Block(size=(1.0, 1.0, 1.0), young=2e11, law="KN=1e10, FRICTION=0.3, GAP=0.01")
    step = "*STEP, INC=1000000\n*DYNAMIC\n0.0005, 0.2\n*CONTROLS, ACCURACY=0.01\n"
    run = keyway(block.deck(f"{step}{WEIGHT}*END STEP\n"))
    energy = run.json["steps"][0]["energy"]
    assert energy["numerical"] > 0.2 * energy["external"]
    (found,) = run.json["accuracy"]["increments"].values()
    assert "impacts" in found["not_known"]
    assert "estimated_error" not in found
    assert any("ACCURACY does not bound" in text for text in run.json["warnings"])


PULSE = ((0.0, 10.0), (0.50, 10.0), (0.51, 40.0), (0.52, 10.0), (24.0, 10.0))  # [s], degrees


@pytest.mark.parametrize("form", ["amplitude", "table"])
def test_increments_do_not_step_over_a_temperature(keyway, form):
    """A pulse of temperature of 20 ms on a column that is held: increments are no longer than the
    spacing of its history, given as an amplitude or as the rows of a table."""
    card, files = "*TEMPERATURE, AMPLITUDE=HEAT\nALL, 40.\n", {}
    if form == "table":
        card = "*TEMPERATURE, INPUT=pulse.csv\n"
        rows = [["node", *(f"{time}" for time, _ in PULSE)]]
        rows += [[f"{node}", *(f"{value}" for _, value in PULSE)] for node in range(1, 9)]
        files = {"pulse.csv": "".join(", ".join(row) + "\n" for row in rows)}
    deck = column(1, "burst", FIRST, "*CONTROLS, ACCURACY=0.5\n")
    deck = deck.replace("*ELASTIC", "*EXPANSION\n1e-5\n*ELASTIC")
    history = ", ".join(f"{time}, {(value - 10.0) / 30.0}" for time, value in PULSE)
    supports = "*BOUNDARY\nALL, 1, 2\nBASE, 3, 3\n"
    heat = f"*AMPLITUDE, NAME=HEAT\n{history}\n" * (form == "amplitude")
    heat += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 10.\n"
    heated = deck.replace(supports, heat + supports)
    output = "*NODE PRINT, NSET=TOP\nU"
    heated = heated.replace(output, f"{card}{output}, TEMP")
    table = keyway(heated, files=files).csv("node_TOP")
    assert np.diff(table["time"]).max() < 0.0101
    assert table["TEMP"].max() > 30.0


def shaken_wall(angle: float) -> str:
    """A wall with added mass along its normal, turned about the vertical by an angle [rad]."""
    mesh, number = box_mesh((2, 1, 4), stretched((2.0, 1.0, 8.0)))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    mesh.x[:, :2] = mesh.x[:, :2] @ turn.T
    mesh.node_sets["BASE"] = number[:, :, 0].ravel()
    mesh.node_sets["TOP"] = number[:1, :1, -1].ravel()
    mesh.surfaces["FACE"] = [(brick, 6) for brick in range(4)]
    values = "".join(f"{value:.10g}\n" for value in motion_of("steady")[:150])
    cards = f"*AMPLITUDE, NAME=LOAD, FORMAT=VALUES, DT={FIRST}\n{values}{elastic(1e8, 0.2, 2400.0)}"
    cards += "*BOUNDARY\nBASE, 1, 3\n*STEP, INC=1000000\n*DYNAMIC\n0.04, 5.\n"
    cards += "*CONTROLS, ACCURACY=0.02\n"
    cards += "*RESERVOIR, NAME=LAKE, SURFACE=FACE, LEVEL=8., BED=0., HYDROSTATIC=NO,\n"
    cards += "   ADDED MASS=WESTERGAARD, DIRECTION=NORMAL\n"
    for dof, part in ((1, math.cos(angle)), (2, math.sin(angle))):
        cards += f"*BASE MOTION, DOF={dof}, AMPLITUDE=LOAD, SCALE={part!r}\n"
    return brick_deck(mesh, "C3D8", f"{cards}*NODE PRINT, NSET=TOP\nU\n*END STEP\n")


def test_axes_of_the_deck(keyway):
    """Increments do not depend on the axes, where added mass acts along the normal of a face."""
    runs = [keyway(shaken_wall(a), name=f"turned_{k}") for k, a in enumerate((0.0, 0.6))]
    straight, turned = (run.csv("node_TOP") for run in runs)
    assert turned["time"] == pytest.approx(straight["time"], abs=1e-12)
    along = turned["U1"] * math.cos(0.6) + turned["U2"] * math.sin(0.6)
    # Two solutions of equations whose condition number is some 1e4.
    assert along == pytest.approx(straight["U1"], abs=1e-9 * np.abs(straight["U1"]).max())
