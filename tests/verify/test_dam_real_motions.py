"""The jointed dam under recorded ground motions: all runs end without cutback.

The motions lie outside the project, in ../shared/data; the tests skip where they are absent.
"""

import dataclasses

import numpy as np
import pytest
from dam_trials import DeckOptions, Trial, deck_of, measure
from harness import ROOT

DATA = ROOT.parent / "shared" / "data"
MOST_ITERATIONS = 15
TAPER = 0.5  # at both ends [s]


def tapered(values: np.ndarray, dt: float) -> np.ndarray:
    """The record with cosine tapers, because some records begin with a jump."""
    length = max(2, round(TAPER / dt))
    ramp = 0.5 * (1.0 - np.cos(np.pi * np.arange(length) / length))
    shape = np.ones(len(values))
    shape[:length] = ramp
    shape[-length:] = ramp[::-1]
    return values * shape


def three_components(name: str, columns: tuple[int, int, int], unit: float):
    """dt [s] and accelerations across, along the stream and up [m/s2]."""
    table = np.loadtxt(DATA / name, delimiter=",", comments="#")
    return table[1, 0] - table[0, 0], [unit * table[:, column] for column in columns]


def one_component(name: str):
    """The same record in the three directions, 2/3 of it upwards."""
    table = np.loadtxt(DATA / name, delimiter=",", comments="#")
    return table[1, 0] - table[0, 0], [table[:, 1], table[:, 1], 2.0 / 3.0 * table[:, 1]]


RECORDS = {
    "tsankov_kamak_3comp.csv": lambda name: three_components(name, (3, 1, 2), 0.01),
    "fdlv112_3comp.csv": lambda name: three_components(name, (1, 2, 3), 1.0),
    "friuli_sdnv138.csv": one_component,
}


def shaken_dam(record: str, increment: float, trial: Trial) -> tuple[str, dict[str, str]]:
    """Deck of a trial with a record in place of its motion, to half a second after its end."""
    dt, components = RECORDS[record](record)
    duration = round(dt * (len(components[0]) - 1) + 0.5, 3)
    options = dataclasses.replace(trial.options, motion_dt=round(dt, 6), increment=increment)
    text, files = deck_of(dataclasses.replace(trial, options=options, duration=duration))
    for axis, values in enumerate(components):
        lines = (f"{value:.9e}\n" for value in tapered(values, dt))
        files[f"motion_{axis}.txt"] = "".join(lines)
    return text, files


QUICK = "fdlv112_3comp.csv"


@pytest.mark.parametrize(
    "record", [QUICK, *(pytest.param(r, marks=pytest.mark.full) for r in RECORDS if r != QUICK)]
)
def test_record(keyway, record):
    if not (DATA / record).exists():
        pytest.skip(f"../shared/data/{record} is not here")
    trial = Trial(is_coarse=True, options=DeckOptions())
    text, files = shaken_dam(record, 0.01, trial)
    dt, components = RECORDS[record](record)
    result = measure(keyway(text, files=files), dt * (len(components[0]) - 1))
    assert result.most_iterations <= MOST_ITERATIONS
    assert result.cutbacks == 0
    assert result.growth <= 1e-6
    assert result.unbalance <= 1e-6


def test_peer_record(keyway):
    """El Centro, read as it is (*AMPLITUDE, FORMAT=AT2), for two seconds of its strong part."""
    path = DATA / "el_centro_ns.AT2"
    if not path.exists():
        pytest.skip("../shared/data/el_centro_ns.AT2 is not here")
    text, files = deck_of(Trial(is_coarse=True, options=DeckOptions(), duration=4.0))
    old = "*AMPLITUDE, NAME=MOTION_Y, INPUT=motion_1.txt, FORMAT=VALUES, DT=0.01"
    assert old in text
    text = text.replace(old, "*AMPLITUDE, NAME=MOTION_Y, INPUT=record.AT2, FORMAT=AT2, UNIT=G")
    run = keyway(text, files={**files, "record.AT2": path.read_text(encoding="utf-8")})
    assert run.json["steps"][1]["cutbacks"] == 0
    assert run.json["envelopes"]["OPENING"]["anywhere"]["value"] > 1e-3
