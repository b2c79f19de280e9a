"""Times of records in columns: even, rounded, with gaps; and the time to read long records."""

from pathlib import Path

import numpy as np
import pytest
from keyway_tools.records import networks
from keyway_tools.records.read_record import read_record
from keyway_tools.records.record import Record, RecordError


def read(folder: Path, text: str) -> list[Record]:
    path = folder / "record.txt"
    path.write_text(text)
    return read_record(path)


def times_of(rate, digits, left_out=()):
    """Times of 2000 values in columns, rounded to some decimals."""
    kept = np.delete(np.arange(2000), left_out)
    return "t [s]  a [m/s2]\n" + "".join(f"{k / rate:.{digits}f} {k % 7}.\n" for k in kept)


@pytest.mark.parametrize(
    ("rate", "digits"), [(200, 3), (256, 3), (512, 3), (600, 3), (1000, 3), (1024, 4), (1024, 6)]
)
def test_even_times_may_be_rounded(tmp_path, rate, digits):
    """The ends are off by half a digit each, which the 1999 steps share."""
    (record,) = read(tmp_path, times_of(rate, digits))
    assert record.dt == pytest.approx(1.0 / rate, abs=10.0**-digits / 1999 + 1e-6 / rate)


@pytest.mark.parametrize(
    ("rate", "digits", "left_out"),
    [
        (500, 3, np.arange(5, 2000, 10)),
        (200, 3, 700),
        (500, 3, 700),
        (1000, 3, 700),
        (1000, 3, np.arange(300, 900, 200)),
        (1024, 4, 700),
    ],
)
def test_times_with_gaps_are_not_even(tmp_path, rate, digits, left_out):
    with pytest.raises(RecordError, match="expected equal times"):
        read(tmp_path, times_of(rate, digits, left_out))


def test_a_change_of_the_rate_is_not_even(tmp_path):
    """1 ms, then 3 ms: each step is within a digit of the mean of 2 ms."""
    times = np.cumsum([0.0, *[0.001] * 500, *[0.003] * 500])
    text = "".join(f"{t:.3f} 1.\n" for t in times)
    with pytest.raises(RecordError, match=r"from 0.001 to 0.003 s; expected equal times"):
        read(tmp_path, "t [s]  a [m/s2]\n" + text)


def test_each_value_is_tested_once(monkeypatch):
    """Not again with each line below it: 50 000 lines took 25 s."""
    tested = []
    monkeypatch.setattr(networks.math, "isfinite", lambda value: tested.append(value) or True)
    values = networks.numbers_in(["1. 2. 3.\n"] * 100, 300, None, Path("x.at2"), are_all=True)
    assert len(tested) == values.size == 300
