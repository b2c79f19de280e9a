"""Units of base motion: an AT2 record, UNIT and SCALE; what --check prints of the peak."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

BASE = Path(__file__).parent / "errors" / "base" / "block.inp"
G = 9.81  # m/s2, docs/deck.md
PEAK = 0.3  # of the record, in its unit

RECORD = """A RECORD
{header}
{times}
 0. 0.2 -0.3 0.1 0.
"""


def peak_line(
    program: Path,
    folder: Path,
    header: str,
    amplitude: str,
    motion: str = "",
    times: str = "NPTS=   5, DT=   .0100 SEC",
) -> str:
    """The line of --check about the base motion."""
    deck = BASE.read_text(encoding="utf-8")
    deck = deck.replace(
        "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n",
        f"*AMPLITUDE, NAME=QUAKE, INPUT=record.at2, FORMAT=AT2{amplitude}\n*STEP\n"
        f"*DYNAMIC\n0.01, 1.\n*BASE MOTION, DOF=1, AMPLITUDE=QUAKE{motion}\n",
    )
    assert "*BASE MOTION" in deck
    (folder / "deck.inp").write_text(deck, encoding="utf-8")
    if "\n" not in header:
        header = "OF A STATION\n" + header
    record = RECORD.format(header=header, times=times)
    (folder / "record.at2").write_text(record, encoding="utf-8")
    done = subprocess.run(
        [str(program.resolve()), "--check", "deck.inp"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    (line,) = (x for x in done.stdout.splitlines() if x.strip().startswith("load "))
    return line


def checked(program: Path, folder: Path, deck: str) -> subprocess.CompletedProcess[str]:
    """--check of a deck without faults."""
    (folder / "deck.inp").write_text(deck, encoding="utf-8")
    command = [str(program.resolve()), "--check", "deck.inp"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)


def test_a_deck_in_millimetres(program_path, tmp_path) -> None:
    """The summary says that the deck is not in SI, and gives the peak without a unit."""
    deck = BASE.read_text(encoding="utf-8").replace("2400.", "2.4e-9").replace("22e9", "22e3")
    deck = deck.replace(
        "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n",
        "*AMPLITUDE, NAME=QUAKE, UNIT=G\n0., 0., 0.5, 0.3, 1., 0.\n*STEP\n"
        "*DYNAMIC\n0.01, 1.\n*BASE MOTION, DOF=1, AMPLITUDE=QUAKE, SCALE=1000.\n",
    )
    done = checked(program_path, tmp_path, deck)
    assert "not SI (a *DENSITY of 2.4e-9)" in done.stdout
    assert ", peak 2943 at t = 0.5 s" in done.stdout
    assert "warning" not in done.stderr


@pytest.mark.parametrize("density, young", [("2.4", "22e6"), ("2.4e-3", "22e3")], ids=["kN", "MN"])
def test_a_deck_in_metres_and_other_forces(density, young, program_path, tmp_path) -> None:
    """Gravity of 9.81 and a record in m/s2 are right in decks in t, m, s and in kt, m, s."""
    deck = BASE.read_text(encoding="utf-8").replace("2400.", density).replace("22e9", young)
    deck = deck.replace(
        "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n",
        "*AMPLITUDE, NAME=QUAKE, UNIT=G\n0., 0., 0.5, 0.3, 1., 0.\n*STEP\n"
        "*DYNAMIC\n0.01, 1.\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n"
        "*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n",
    )
    done = checked(program_path, tmp_path, deck)
    assert f"not SI (a *DENSITY of {float(density)!r})" in done.stdout
    assert ", peak 2.943 m/s2 = 0.3000 g at t = 0.5 s" in done.stdout
    assert "not in SI" not in done.stderr


MOTION = (
    "*AMPLITUDE, NAME=QUAKE{unit}\n0., 0., {half!r}, {peak!r}, {end!r}, 0.\n*STEP\n"
    "*DYNAMIC\n{increment!r}, {end!r}\n{weight}*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n"
)


def deck_in_ms(density: str, modulus: str, gravity: str, peak: float, unit: str = "") -> str:
    """The block in a motion of 1000 ms with increments of 10 ms; gravity '' for no weight."""
    weight = f"*DLOAD\nDAM, GRAV, {gravity}, 0., 0., -1.\n" if gravity else ""
    times = {"increment": 10.0, "half": 500.0, "end": 1000.0}
    motion = MOTION.format(unit=unit, peak=peak, weight=weight, **times)
    deck = BASE.read_text(encoding="utf-8")
    deck = deck.replace("*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n", motion)
    return deck.replace("2400.", density).replace("22e9", modulus)


@pytest.mark.parametrize(
    ("density", "modulus", "gravity", "peak"),
    [
        ("2400.", "22e3", "9.81e-6", "3e-6"),  # kg, m, ms
        ("2400.", "22e3", "", "3e-6"),
        ("2.4e-6", "22.", "9.81e-3", "0.003"),  # kg, mm, ms
        ("2.4e-3", "22e3", "9.81e-3", "0.003"),  # g, mm, ms
    ],
)
def test_a_deck_in_milliseconds(program_path, tmp_path, density, modulus, gravity, peak) -> None:
    """No warning of waves of 3 m/s or of a peak of 1e-7 g, and no unit beside the peak."""
    done = checked(program_path, tmp_path, deck_in_ms(density, modulus, gravity, float(peak)))
    assert "warning" not in done.stderr
    assert f", peak {peak} at t = 500" in done.stdout


@pytest.mark.parametrize(
    ("increment", "gravity"), [(0.01, ""), (0.01, "9.81"), (1.0, "9.81")], ids=str
)
def test_a_modulus_in_mpa_in_a_deck_in_seconds(program_path, tmp_path, increment, gravity) -> None:
    """The same numbers are two systems of units where weights or increments show seconds."""
    deck = deck_in_ms("2400.", "22e3", gravity, 3.0)
    deck = deck.replace("10.0, 1000.0", f"{increment}, 1000.")
    assert "give waves of 3.028 m/s" in checked(program_path, tmp_path, deck).stderr


def test_records_in_si_in_a_deck_in_milliseconds(program_path, tmp_path) -> None:
    """A record in g becomes m/s2, and a reservoir has 9.81 m/s2 by default; 1e-6 is for m/ms2."""
    water = "*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=1., BED=0.\n"
    deck = deck_in_ms("2400.", "22e3", "9.81e-6", 0.3, ", UNIT=G")
    deck = deck.replace("*BASE MOTION", water + "*BASE MOTION")
    said = checked(program_path, tmp_path, deck).stderr
    where = (
        "in a deck with a gravity of 9.81e-6, which is not in SI (kg, m, ms: water 1000, g 9.81e-6)"
    )
    assert f"GRAVITY is 9.81 by default {where}" in said
    assert f"is turned into m/s2 {where}; SCALE=1e-6 here turns it into m/ms2" in said
    assert said.count("warning") == 2
    right = deck.replace("AMPLITUDE=QUAKE\n*END", "AMPLITUDE=QUAKE, SCALE=1e-6\n*END")
    right = right.replace("BED=0.", "BED=0., GRAVITY=9.81e-6")
    assert "warning" not in checked(program_path, tmp_path, right).stderr


@pytest.mark.parametrize(
    ("header", "amplitude", "motion", "expected"),
    [
        ("ACCELERATION TIME SERIES IN UNITS OF G", "", "", PEAK * G),
        ("The units are (g)", "", "", PEAK * G),
        ("ACCELERATION IN CM/SEC/SEC", "", "", PEAK / 100),
        ("units: m/s2", "", "", PEAK),
        ("ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz", "", "", PEAK * G),
        ("Acceleration in cm/sec^2", "", "", PEAK / 100),
        ("UNITS OF M/SEC**2", "", "", PEAK),
        ("SITE VELOCITY IN ROCK 760 M/S; ACCELERATION IN UNITS OF G", "", "", PEAK * G),
        ("UNITS OF G", ", UNIT=G, SCALE=2.", "", PEAK * G * 2),
        ("UNITS OF G", ", UNIT=G", ", SCALE=0.5", PEAK * G / 2),
        ("ACCELERATION (CM/S2)\nUNITS OF G", "", "", PEAK / 100),
        ("units: cm/s2\nTIME SERIES IN UNITS OF G", "", "", PEAK * G),
        ("units: cm/s2\nUNITS OF G", ", UNIT=G", "", PEAK * G),
        ("no unit", ", UNIT=CM/S2", "", PEAK / 100),
        ("no unit", ", UNIT=M/S2, SCALE=3.", "", PEAK * 3),
        # The user's conversion is not repeated; its digits are kept.
        ("UNITS OF G", ", SCALE=9.80665", "", PEAK * 9.80665),
        ("UNITS OF G", "", ", SCALE=9.80665", PEAK * 9.80665),
        ("no unit", ", UNIT=G", ", SCALE=9.80665", PEAK * 9.80665),
        ("UNITS OF G", ", UNIT=G, SCALE=9.80665", "", PEAK * 9.80665),
    ],
)
def test_peak(program_path, tmp_path, header, amplitude, motion, expected) -> None:
    line = peak_line(program_path, tmp_path, header, amplitude, motion)
    words = line[line.index("peak ") :].split()
    assert words[2] == "m/s2"
    assert float(words[1]) == pytest.approx(expected, rel=1e-5), "six digits are printed"
    assert words[5] == "g"
    assert float(words[4]) == pytest.approx(expected / G, abs=6e-5), "four decimals are printed"
    assert words[-2:] == ["0.02", "s"]


@pytest.mark.parametrize(
    "times",
    [
        "NPTS=5, DT=.01",
        "NPTS=5 DT=.01 s",
        "5 .01 NPTS, DT (SECONDS)",
        "NPTS= 5, DT= .01 SEC, 100 SPS",
    ],
)
def test_times_in_seconds(program_path, tmp_path, times) -> None:
    line = peak_line(program_path, tmp_path, "UNITS OF G", "", times=times)
    assert line.split()[-2:] == ["0.02", "s"]


def test_peak_of_a_step_that_ends_between_two_values(program_path, tmp_path) -> None:
    """The record rises over 1 s, the step ends after 0.4 s."""
    deck = BASE.read_text(encoding="utf-8")
    deck = deck.replace(
        "*STEP\n*STATIC\n*DLOAD\nDAM, GRAV, 9.81, 0., 0., -1.\n",
        "*AMPLITUDE, NAME=QUAKE\n0., 0., 1., 2., 2., 0.\n*STEP\n*DYNAMIC\n0.01, 0.4\n"
        "*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n",
    )
    done = checked(program_path, tmp_path, deck)
    assert ", peak 0.8 m/s2 = 0.0815 g at t = 0.4 s" in done.stdout


@pytest.mark.parametrize("first", ["", "\n"], ids=["text", "an empty line"])
def test_record_in_utf16(program_path, tmp_path, first) -> None:
    """Also below an empty line, which has no zero byte in front of its end."""
    peak_line(program_path, tmp_path, "UNITS OF G", "")
    record = first + RECORD.format(header="OF A STATION\nUNITS OF G", times="NPTS= 5, DT= .01")
    (tmp_path / "record.at2").write_bytes(b"\xff\xfe" + record.encode("utf-16-le"))
    command = [str(program_path.resolve()), "--check", "deck.inp"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert "it is in UTF-16" in done.stderr
    assert done.stderr.count("[") == 1
