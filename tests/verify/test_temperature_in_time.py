"""*TEMPERATURE over time: slow and sudden heating, files, and what steps keep (theory.md, 16.3)."""

from __future__ import annotations

import numpy as np
import pytest
from heat_decks import (
    ALPHA,
    DENSITY,
    OUTPUT,
    YOUNG,
    balances,
    brick,
    law,
    model,
    statically,
)
from stage_decks import step
from tied_blocks import node_set

WARMER = 20.0  # from 10 to 30 degrees
STRAIN = ALPHA * WARMER
ALL_HELD = "*BOUNDARY\nALL, 1, 3\n"


def rod(steps: str, element: str = "C3D8") -> str:
    """A rod along x that is free at its end."""
    blocks = brick((4, 1, 1), (4.0, 1.0, 1.0))
    left = node_set("LEFT", blocks.side("A", "X0")) + node_set("END", blocks.side("A", "X1"))
    supports = left + "*BOUNDARY\nLEFT, 1\nALL, 2, 3\n"
    ramp = "*AMPLITUDE, NAME=RAMP\n0., 10., 10., 30.\n"
    return model(blocks, supports + ramp, law(0.0), element) + steps


def test_slow_heating_in_time_is_the_static_one(keyway):
    """Over 900 periods the rod follows its temperature, and all energies balance."""
    period = 4.0 * 4.0 / (YOUNG / DENSITY) ** 0.5
    run = keyway(
        rod(
            "*STEP\n*DYNAMIC, DIRECT\n0.05, 5.\n*TEMPERATURE, AMPLITUDE=RAMP\nALL, 1.\n"
            f"{OUTPUT}*END STEP\n"
        )
    )
    table = run.csv("node_ALL")
    end = table["node"] == 5 * 4
    exact = 4.0 * ALPHA * 2.0 * table["time"][end]
    assert 900 * period < 5.0
    # A ramp leaves vibrations of the rate times period/(2 pi).
    allowed = 2 * 4.0 * ALPHA * 2.0 * period
    assert np.abs(table["U1"][end] - exact).max() < allowed
    assert allowed < 0.01 * exact.max()
    balances(run, 1e-9)


def test_sudden_heating_in_time(keyway):
    """A jump acts in the first increment; the rod swings to twice its static expansion.

    The wave of a rod that is warmed at once: its end moves at constant speed to 2 alpha dT L in
    half of its period 4 L/c, and back.
    """
    period = 4.0 * 4.0 / (YOUNG / DENSITY) ** 0.5
    run = keyway(
        rod(
            f"*STEP\n*DYNAMIC, DIRECT, ALPHA=0\n{period / 200!r}, {period!r}\n"
            f"*TEMPERATURE\nALL, 30.\n{OUTPUT}*END STEP\n"
        )
    )
    table = run.csv("node_ALL")
    end = table["node"] == 5 * 4
    largest = table["U1"][end].max()
    assert largest == pytest.approx(2 * STRAIN * 4.0, rel=0.05)  # four elements
    balances(run, 1e-10)
    energy = run.json["steps"][0]["energy"]
    # The energy of the rod that is held in all directions, but for its motion in an increment.
    held = 3 * 0.5 * YOUNG * STRAIN**2 * 4.0
    assert energy["temperature"] == pytest.approx(held, rel=2e-3)


def test_files_say_what_data_lines_say(keyway):
    """Rows and data lines; a table of times between and outside of them."""
    blocks = brick((2, 1, 1))
    field = lambda x: 12.0 + x[:, 0] + 3.0 * x[:, 2]  # noqa: E731
    values = field(blocks.x).tolist()
    plain = "".join(f"{i}, {v!r}\n" for i, v in enumerate(values, 1))
    columns = "# a comment\nnode, 0.25, 0.75\n"
    columns += "".join(f"{i}, 10., {v!r}\n" for i, v in enumerate(values, 1))
    sheet = "\ufeff" + plain.replace("\n", "\r\n")  # as spreadsheets write UTF-8
    # Comments and quotes as in a deck; the set of one node has a name with a comma.
    quoted = "  ** a comment\n\t# another one\n" + plain.replace("1, ", ' "1" , ', 1)
    quoted = quoted.replace("2, ", "'last,  but one' , ", 1).replace("\n3, ", ",\n3, ", 1)
    files = {"plain.csv": plain, "columns.csv": columns, "sheet.csv": sheet, "quoted.csv": quoted}
    deck = model(blocks, statically(blocks), law(0.0))
    deck = deck.replace("*BOUNDARY", "*NSET, NSET='last,  but one'\n2\n*BOUNDARY", 1)

    def step_with(card: str) -> str:
        return f"*STEP\n*STATIC, DIRECT\n0.25, 1.\n{card}{OUTPUT}*END STEP\n"

    runs = {
        name: keyway(deck + step_with(card), name=name, files=files).csv("node_ALL")
        for name, card in {
            "lines": f"*TEMPERATURE\n{plain}",
            "plain": "*TEMPERATURE, INPUT=plain.csv\n",
            "sheet": "*TEMPERATURE, INPUT=sheet.csv\n",
            "quoted": "*TEMPERATURE, INPUT=quoted.csv\n",
            "columns": "*TEMPERATURE, INPUT=columns.csv\n",
            "total": "*TEMPERATURE, INPUT=columns.csv, TIME=TOTAL TIME\n",
        }.items()
    }
    for name in ("plain", "sheet", "quoted"):
        assert (runs["lines"]["TEMP"] == runs[name]["TEMP"]).all()
    for name in ("columns", "total"):
        table = runs[name]
        for time, share in ((0.25, 0.0), (0.5, 0.5), (0.75, 1.0), (1.0, 1.0)):
            found = table["TEMP"][table["time"] == time]
            assert found == pytest.approx(10.0 + share * (np.array(values) - 10.0), rel=1e-12)
    assert (runs["columns"]["U1"] == runs["total"]["U1"]).all()


def test_a_history_from_a_spreadsheet(keyway):
    """A file of *AMPLITUDE with a byte order mark, CRLF and a comment behind blanks says what data
    lines say."""
    blocks = brick((1, 1, 1))
    text = model(blocks, statically(blocks), law(0.0))
    pairs = "0., 10.\n  ** a comment\n1., 40.\n"
    warmed = "*STEP\n*STATIC, DIRECT\n0.25, 1.\n*TEMPERATURE, AMPLITUDE=YEAR\nALL, 1.\n"
    tables = [
        keyway(
            text + f"*AMPLITUDE, NAME=YEAR{card}" + warmed + OUTPUT + "*END STEP\n",
            name=name,
            files={"year.csv": "\ufeff" + pairs.replace("\n", "\r\n")},
        ).csv("node_ALL")["TEMP"]
        for name, card in {"lines": f"\n{pairs}", "file": ", INPUT=year.csv\n"}.items()
    ]
    assert (tables[0] == tables[1]).all() and tables[0].max() == 40.0


def test_steps_keep_change_and_restore_temperatures(keyway):
    """OP=MOD keeps what a step does not name, OP=NEW restores it; total time goes on."""
    blocks = brick((1, 1, 1))
    sets = node_set("LOW", blocks.side("A", "Z0")) + node_set("TOP", blocks.side("A", "Z1"))
    clock = "*AMPLITUDE, NAME=YEAR, TIME=TOTAL TIME\n0., 10., 10., 20.\n"
    run = keyway(
        model(blocks, sets + clock + ALL_HELD)
        + step("*TEMPERATURE\nLOW, 30.\n*TEMPERATURE, AMPLITUDE=YEAR\nTOP, 1.\n" + OUTPUT)
        + step()
        + step("*TEMPERATURE\nLOW, 0.\n")
        + step("*TEMPERATURE, OP=NEW\nTOP, 7.\n")
        + step("*TEMPERATURE, OP=NEW\n")
    )
    table = run.csv("node_ALL")
    low, top = blocks.side("A", "Z0")[0] + 1, blocks.side("A", "Z1")[0] + 1
    for number, expected in enumerate([(30, 11), (30, 12), (0, 13), (10, 7), (10, 10)], 1):
        ends = table["step"] == number
        ends &= table["increment"] == table["increment"][ends].max()
        for node, value in zip((low, top), expected, strict=True):
            found = table["TEMP"][ends & (table["node"] == node)]
            assert found == pytest.approx(value, rel=1e-13)
    balances(run)


def test_a_deck_without_temperatures_has_nothing_of_them(keyway):
    """No line in the log, no column, no key."""
    deck = model(brick(), statically(brick()), "*ELASTIC\n2e10, 0.2\n")
    deck = deck.replace("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 10.\n", "")
    run = keyway(deck + step("*CLOAD\nALL, 3, 1e3\n*EL PRINT, ELSET=BODY\nS\n"))
    log = (run.folder / "job.log").read_text().lower()
    assert "temperature" not in log and "expan" not in log
    assert "temperature" not in (run.folder / "job_energy.csv").read_text()
    assert "temperature" not in (run.folder / "job.json").read_text()
