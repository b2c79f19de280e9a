"""Recorded motions: every kind of file, units, what is done to a record, what is refused."""

import json

import make_dam
import make_motion
import numpy as np
import pytest
from keyway_tools.design_spectrum import DesignSpectrum
from keyway_tools.ground_motion import final_motion
from keyway_tools.records.read_record import read_record
from keyway_tools.records.record import Record, RecordError, unit_named_in
from keyway_tools.records.treatment import cut, factor_to_spectrum, resample, settle
from keyway_tools.response_spectrum import response_spectrum

VALUES = np.array([0.01, -0.02, 0.03, -0.04, 0.05, -0.06, 0.07, -0.08, 0.09])


def rows(values, width, digits, columns=8):
    """Values in columns of a width, without blanks between them where they fill it."""
    words = [f"{value:{width}.{digits}f}" for value in values]
    return "\n".join("".join(words[k : k + columns]) for k in range(0, len(words), columns))


def at2(values, heading="NPTS=  9, DT= .0050 SEC"):
    return (
        "PEER STRONG MOTION DATABASE RECORD\nSOMEWHERE 1/2/34 05:06, STATION, 090\n"
        f"ACCELERATION TIME SERIES IN UNITS OF G\n{heading}\n" + rows(values, 15, 7, 5) + "\n"
    )


def cosmos(values):
    """Two channels of acceleration, each with its velocity."""
    reals = np.zeros(100)
    reals[61] = 10.0  # time between values [ms]
    channel = (
        "Corrected acceleration    (Format v01.20 with 13 text lines) Src: 047n1234\n"
        + "text of the header\n" * 12
        + " 100 Integer-header values follow on 10 lines, Format= (10I8)\n"
        + rows(np.zeros(100), 8, 0, 10)
        + "\n 100 Real-header values follow on 17 lines, Format= (6F13.6)\n"
        + rows(reals, 13, 6, 6)
        + '\n   1 Comment line(s) follow, each starting with a "|":\n| none\n'
    )
    data = (
        f"{values.size:8d} acceleration pts, approx  1 secs, units=cm/sec2(04), Format=(8F10.5)\n"
        + rows(values, 10, 5)
        + "\nEnd-of-data for Chan 1 acceleration\n"
    )
    speed = data.replace("acceleration", "velocity").replace("cm/sec2(04)", "cm/sec (05)")
    return 2 * (channel + data + speed)


def csmip(values):
    return (
        "CORRECTED ACCELEROGRAM\nSOMEWHERE\nChan  3:  90 Deg\n"
        + f"{values.size:5d} points of accel data equally spaced at   .020 sec, in cm/sec2."
        + f"    (8f10.3)\n{rows(values, 10, 3)}\n"
        + f"{values.size:5d} points of veloc data equally spaced at   .020 sec, in cm/sec."
        + f"     (8f10.3)\n{rows(values, 10, 3)}\n"
    )


def kyoshin(counts):
    facts = {
        "Origin Time": "2011/03/11 14:46:00",
        "Lat.": "38.1",
        "Long.": "142.9",
        "Depth. (km)": "24",
        "Mag.": "9.0",
        "Station Code": "ABC001",
        "Station Lat.": "39.0",
        "Station Long.": "141.0",
        "Station Height(m)": "10",
        "Record Time": "2011/03/11 14:46:15",
        "Sampling Freq(Hz)": "100Hz",
        "Duration Time(s)": "1",
        "Dir.": "E-W",
        "Scale Factor": "3920(gal)/6182761",
        "Max. Acc. (gal)": "1.0",
        "Last Correction": "2011/03/11 14:46:00",
        "Memo.": "",
    }
    text = "".join(f"{name:<18s}{value}\n" for name, value in facts.items())
    return text + " ".join(str(c) for c in counts) + "\n"


@pytest.fixture
def write(tmp_path):
    def write_text(text, name="record.txt"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write_text


@pytest.mark.parametrize(
    "heading",
    [
        "NPTS=  9, DT= .0050 SEC",
        "   9   0.0050   NPTS, DT",
        "9 .005 NPTS, DT (SEC)",
        "NPTS=9, DT=.005 s, 200 SPS",
        "NPTS=9, DT= 5.D-3 SEC",
        "NPTS: 9 DT: .005",
    ],
)
def test_peer_file(write, heading):
    (record,) = read_record(write(at2(VALUES, heading), "a.AT2"))
    assert record.dt == 0.005
    assert record.name == "090"
    assert record.acceleration == pytest.approx(9.81 * VALUES, rel=1e-12)


def test_peer_title_that_names_a_unit(write):
    """The line that says what the record is has the unit of its values."""
    text = at2(VALUES).replace("SOMEWHERE", "IN UNITS OF CM/S2")
    (record,) = read_record(write(text, "a.AT2"))
    assert record.acceleration == pytest.approx(9.81 * VALUES, rel=1e-12)


def test_peer_line_that_names_two_units(write):
    """The unit that is given says which of them it is."""
    text = at2(VALUES).replace("OF G", "OF G, PEAK 40 CM/S2")
    (record,) = read_record(write(text, "a.AT2"), unit="G")
    assert record.acceleration == pytest.approx(9.81 * VALUES, rel=1e-12)


def test_cosmos_file_has_its_channels_of_acceleration(write):
    values = np.array([-234.56789, *VALUES[1:], -234.56789, 1.0])  # fills its column
    records = read_record(write(cosmos(values), "a.v2"))
    assert [record.dt for record in records] == [0.01, 0.01]
    for record in records:
        assert record.acceleration == pytest.approx(0.01 * values, rel=1e-12)


def test_csmip_file_without_blanks_between_values(write):
    values = np.array([-12345.678, -12345.678, 1.5])
    (record,) = read_record(write(csmip(values), "a.v2"))
    assert record.dt == 0.02
    assert record.name == "channel 3 90 Deg"
    assert record.acceleration == pytest.approx(0.01 * values, rel=1e-12)


def test_kyoshin_counts_become_an_acceleration_without_mean(write):
    counts = np.array([1000, 1200, 800, 1000])
    (record,) = read_record(write(kyoshin(counts), "ABC001.EW"))
    assert record.dt == 0.01
    assert record.name == "E-W"
    expected = 0.01 * 3920.0 / 6182761.0 * (counts - 1000.0)
    assert record.acceleration == pytest.approx(expected, rel=1e-12)


def test_columns_with_names_and_a_unit(write):
    text = "# a dam\ntime [s]; stream [cm/s^2]; up [cm/s^2]\n" + "".join(
        f"{0.02 * k:.2f}; {value}; {2.0 * value}\n" for k, value in enumerate(VALUES)
    )
    stream, up = read_record(write(text))
    assert stream.dt == pytest.approx(0.02, rel=1e-9)
    assert [stream.name, up.name] == ["stream [cm/s^2]", "up [cm/s^2]"]
    assert up.acceleration == pytest.approx(0.02 * VALUES, rel=1e-12)


@pytest.mark.parametrize(
    ("heading", "factor"),
    [
        ("time [s], a [g]", 1.0),
        ("Time (sec.)  a (g)", 1.0),
        ("# time series [g], t_min = 0", 1.0),
        ("time [ms], a [g]", 0.001),
        ("Time (msec)  a (g)", 0.001),
        ("time_ms, a_g", 0.001),
        ("# Zeit in ms, a in units of g", 0.001),
        ("t/ms; a [g]", 0.001),
    ],
)
def test_unit_of_the_times(write, heading, factor):
    text = heading + "\n" + "".join(f"{10 * k} {value}\n" for k, value in enumerate(VALUES))
    (record,) = read_record(write(text))
    assert record.dt == pytest.approx(10.0 * factor, rel=1e-9)


def test_channels_have_the_names_of_their_own_headers(write):
    """The last line of a channel names it too, and stands above the header of the next one."""
    one, two = cosmos(VALUES).split("Corrected acceleration ")[1:]
    text = "Corrected acceleration ".join(
        ["", one.replace("text of the header", "Chan 1: 360 Deg"),
         two.replace("text of the header", "Chan 2: Up").replace("for Chan 1", "for Chan 2")]
    )  # fmt: skip
    assert [r.name for r in read_record(write(text))] == ["channel 1 360 Deg", "channel 2 Up"]
    end = "/&  ----------  End of data for channel  3  ----------\n"
    text = csmip(VALUES) + end + csmip(VALUES).replace("Chan  3:  90 Deg", "Chan  4: Up")
    assert [r.name for r in read_record(write(text))] == ["channel 3 90 Deg", "channel 4 Up"]


def test_cosmos_file_with_many_comments(write):
    text = cosmos(VALUES).replace("   1 Comment", "  50 Comment")
    records = read_record(write(text.replace("| none\n", "| none\n" * 50)))
    assert [record.dt for record in records] == [0.01, 0.01]


@pytest.mark.parametrize("between", ["; ", ";", "\t", "  "])
def test_decimal_commas(write, between):
    rows = (f"{0.02 * k:.2f}{between}{v:.6f}\n" for k, v in enumerate(VALUES))
    (record,) = read_record(write("Zeit Beschleunigung [g]\n" + "".join(rows).replace(".", ",")))
    assert record.dt == pytest.approx(0.02, rel=1e-9)
    assert record.acceleration == pytest.approx(9.81 * VALUES, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("acceleration [m/s^2]", "M/S2"),
        ("acc (m/s/s)", "M/S2"),
        ("units: cm/sec**2", "CM/S2"),
        ("in gal", "CM/S2"),
        ("mm/s2", "MM/S2"),
        ("The units are (g)", "G"),
        ("ACCELERATION TIME SERIES IN UNITS OF G", "G"),
        ("time, acc [g]", "G"),
        ("velocity in cm/sec", None),
        ("Kobe, galvanic gauge", None),
        ("[g] or [m/s2]", None),
    ],
)
def test_unit_in_a_heading(text, unit):
    assert unit_named_in(text) == unit


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("0.0 1.0\n0.1 2.0\n", {}, "names no unit; its largest value is 2"),
        ("# g\n1.0\n2.0\n", {"unit": "G"}, "one column without times"),
        ("0. 1.\n.1 2.\n.3 3.\n", {"unit": "G"}, "from 0.1 to 0.2 s; expected equal times"),
        ("0. 1.\n.1 2.\n.1 3.\n", {"unit": "G"}, "time 0.1 after 0.1"),
        ("0. 1.\n.1 2. 3.\n", {"unit": "G"}, ":2: 3 numbers; expected 2"),
        ("0. 1.\nand so on\n", {"unit": "G"}, ":2: found 'and so on'; expected numbers"),
        ("0 1 2 3 4\n1 2 3 4 5\n", {"unit": "G"}, "5 columns"),
        ("no numbers\n", {"unit": "G"}, "no record"),
        ("", {"unit": "G"}, "no record"),
        ("nan\n1\n2\n", {"unit": "G", "dt": 0.1}, ":1: found 'nan'; expected finite numbers"),
        ("# g\n0. 1.\n.1 inf\n", {"unit": "G"}, ":3: found '.1 inf'; expected finite numbers"),
        ("0. 1.\nnan 2.\n", {"unit": "G"}, ":2: found 'nan 2.'; expected finite numbers"),
        (at2(VALUES).replace(at2(VALUES).split()[-1], "NaN"), {}, "expected finite numbers"),
        (at2(VALUES).replace(at2(VALUES).split()[-1], "1e999"), {}, "expected finite numbers"),
        (at2(VALUES).replace(at2(VALUES).split()[-1], "******"), {}, "expected finite numbers"),
        (at2(VALUES).replace(".005", ".000"), {}, "time between values '.0000'; expected a number"),
        (at2(VALUES, "NPTS= 0, DT= .005"), {}, "its header says 0 values; expected a record"),
        (
            at2(VALUES, "NPTS= 9, DT= 5. MSEC"),
            {},
            ":4: found 'MSEC'; expected NPTS= and DT= in sec",
        ),
        (at2(VALUES, "9 .005 NPTS, DT, SPS"), {}, ":4: found 'SPS'; expected NPTS= and DT= in sec"),
        (cosmos(VALUES).replace("100 Real", " 10 Real"), {}, "10 real headers; expected 62"),
        (kyoshin([1, "nan"]), {}, "expected finite numbers"),
        (kyoshin([1, 2]).replace("100Hz", "0Hz"), {}, "expected Sampling Freq(Hz)"),
        (kyoshin([1, 2]).replace("/6182761", "/0"), {}, "expected Sampling Freq(Hz)"),
        ("# [m/s2]\n0. 1.\n.1 2.\n", {"unit": "G"}, "names the unit M/S2"),
        (at2(VALUES[:4]), {}, "4 values; its header says 9"),
        (at2(VALUES, "NPTS= 5, DT= .005"), {}, "9 values; its header says 5"),
        ("time [min], a [g]\n0 1\n1 2\n", {}, "found 'time [min]' in the heading; expected times"),
        ("time [ms] [g]\n# t in s\n0 1\n1 2\n", {}, "found 'time [ms]' and 't in s' in the head"),
        (
            at2(VALUES).replace("OF G", "OF G, PEAK 40 CM/S2"),
            {},
            "names the units CM/S2 and G; give",
        ),
        (at2(VALUES).replace("ACCELERATION", "VELOCITY"), {}, "expected an acceleration"),
        (cosmos(VALUES).replace("Real-header", "Some"), {}, "no real header"),
        (kyoshin([1, 2]).replace("Scale Factor", "Other Factor"), {}, "Scale Factor"),
    ],
)
def test_what_is_no_record(write, text, options, message):
    with pytest.raises(RecordError, match=r"record\.txt") as fault:
        read_record(write(text), **options)
    assert message in str(fault.value)


def a_record(values, dt):
    return Record(np.asarray(values, float), dt, "x", "file", "columns", "M/S2")


def test_shorter_steps_keep_the_straight_lines():
    found = resample(a_record([0.0, 1.0, -1.0], 0.02), 0.01)
    assert found.acceleration == pytest.approx([0.0, 0.5, 1.0, 0.0, -1.0])


def test_longer_steps_keep_a_slow_wave():
    """A wave of 1 s at steps of 0.05 instead of 0.02 s; the filter passes it within 1 %."""
    t = 0.02 * np.arange(501)
    found = resample(a_record(np.sin(2.0 * np.pi * t), 0.02), 0.05)
    middle = slice(20, -20)
    expected = np.sin(2.0 * np.pi * 0.05 * np.arange(found.acceleration.size))
    assert found.dt == 0.05
    assert found.acceleration[middle] == pytest.approx(expected[middle], abs=0.01)


def test_settled_record_ends_at_rest():
    record = a_record(np.random.default_rng(1).normal(size=1000) + 0.1, 0.01)
    settled = settle(record)
    assert abs(final_motion(record.acceleration, record.dt)[1]) > 1.0  # drifts by metres
    assert final_motion(settled.acceleration, settled.dt) == pytest.approx([0.0, 0.0], abs=1e-10)


def test_cut_starts_at_zero():
    found = cut(a_record(np.arange(11.0), 0.1), 0.2, 0.5)
    assert found.acceleration.tolist() == [2.0, 3.0, 4.0, 5.0]
    with pytest.raises(RecordError, match="it has 0 to 1 s"):
        cut(a_record(np.arange(11.0), 0.1), 0.2, 1.5)


def test_factor_to_the_spectrum():
    """A record whose spectrum is known to be a third of the target is raised by three."""
    record = a_record(np.random.default_rng(2).normal(size=800), 0.01)
    periods = np.geomspace(0.1, 1.0, 60)
    own = response_spectrum(record.acceleration, record.dt, periods)

    def target(at):
        return 3.0 * np.exp(np.interp(np.log(at), np.log(periods), np.log(own))) / 9.81

    assert factor_to_spectrum([record], target, 1.0, (0.1, 1.0)) == pytest.approx(3.0, rel=1e-6)


def test_command_writes_files_and_a_summary(write, tmp_path, capsys):
    file = write(at2(VALUES), "a.AT2")
    prefix = tmp_path / "quake"
    options = ["--axes", "y", "--pga", "0.3", "-o", str(prefix)]
    assert make_motion.main(["--record", str(file), *options]) == 0
    values = np.loadtxt(tmp_path / "quake_y.txt")
    assert values == pytest.approx(0.3 * 9.81 * VALUES / 0.09, rel=1e-9)
    facts = json.loads((tmp_path / "quake.json").read_text())
    assert facts["components"]["y"]["peak_g"] == pytest.approx(0.3)
    assert facts["components"]["y"]["unit_of_the_file"] == "G"
    assert (tmp_path / "quake_spectra.png").stat().st_size > 1000
    assert "FORMAT=VALUES, DT=0.005" in capsys.readouterr().out


def test_command_fits_the_design_spectrum(write, tmp_path):
    values = np.random.default_rng(5).normal(size=600)
    text = "time acc[m/s2]\n" + "".join(f"{0.01 * k:.2f} {v}\n" for k, v in enumerate(values))
    prefix = tmp_path / "fitted"
    options = ["--fit", "0.1", "1.0", "--pga", "0.2", "--no-pictures", "-o", str(prefix)]
    assert make_motion.main(["--record", str(write(text)), *options]) == 0
    found = np.loadtxt(tmp_path / "fitted_x.txt")
    periods = np.geomspace(0.1, 1.0, 60)
    ratio = response_spectrum(found, 0.01, periods) / (0.2 * 9.81 * DesignSpectrum()(periods))
    assert np.mean(np.log(ratio)) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--record", "nowhere"], "nowhere: No such file"),
        (["--baseline"], "--baseline has no effect without --record"),
        (["--record", "FILE", "--axes", "x", "y"], "1 components"),
        (["--record", "FILE", "--pga", "0.3", "--factor", "2"], "one way to scale"),
        (["--record", "FILE", "--fit", "1", "0.1"], "two periods T1 < T2"),
        (["--record", "FILE", "--fit", "1e-9", "1"], "from 1e-09 s; expected at least the time"),
        (["--record", "FILE", "--fit", "1", "1e12"], "the spectrum is zero at periods up to 1e+12"),
        (["--record", "FILE", "--resample", "9"], "9 s between values; expected 4e-08 to 0.04 s"),
        (["--record", "FILE", "--resample", "1e-9"], "1e-09 s between values; expected 4e-08"),
        (["--record", "FILE", "--cut", "0", "0.005", "--baseline"], "2 values is too short for"),
    ],
)
def test_command_refuses(write, capsys, arguments, message):
    file = str(write(at2(VALUES), "a.AT2"))
    assert make_motion.main([file if word == "FILE" else word for word in arguments]) == 2
    assert message in capsys.readouterr().err


def test_dt_is_for_files_of_one_column(write, tmp_path, capsys):
    """Values in rows of four are no time with three components."""
    four, one = write("# [g]\n.1 .2 .3 .4\n.5 .6 .7 .8\n"), write("# [g]\n.1\n.2\n", "a.txt")
    peer = write(at2(VALUES), "a.AT2")
    options = ["--dt", "0.01", "--no-pictures", "-o", str(tmp_path / "quake"), "--record"]
    assert make_motion.main([*options, str(four)]) == 2
    assert "--dt beside a file of several columns" in capsys.readouterr().err
    assert make_motion.main([*options, str(peer)]) == 2
    assert "--dt has no effect: the files say the time between" in capsys.readouterr().err
    assert make_motion.main([*options, str(one), str(peer)]) == 0


def test_dam_takes_any_record(write, tmp_path):
    text = "t, a (g), b (g)\n" + "".join(f"{0.01 * k:.2f}, {v}, 0\n" for k, v in enumerate(VALUES))
    deck = tmp_path / "dam" / "dam.inp"
    small = ["--arc", "10", "--levels", "4", "--bottom", "2", "--thick", "1"]
    file = str(write(text, "quake.csv"))
    assert make_dam.main(["-o", str(deck), *small, "--motion", file, "--duration", "1"]) == 0
    assert "INPUT=dam_motion_y.txt, FORMAT=VALUES, DT=0.01" in deck.read_text()
    values = np.loadtxt(deck.parent / "dam_motion_x.txt")
    assert values == pytest.approx(9.81 * VALUES, rel=1e-9)
