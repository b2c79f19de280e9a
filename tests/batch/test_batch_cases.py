"""Templates with tables of values: the cases, the faults that are named, the table of results."""

from __future__ import annotations

import csv
import json
import signal
import subprocess

import numpy as np
import pandas as pd
import pytest
from harness import ROOT
from keyway.batch.cases import BatchError, cases_of_table
from keyway.batch.fractiles import write_fractiles
from keyway.batch.lock import lock_of
from keyway.batch.table import ResultTable, result_table
from keyway.commands import batch
from keyway_tools.deck_runs import Record, send

TEMPLATE = """** A block, friction {FRICTION}, unknown {here}
*INCLUDE, INPUT=parts/mesh.inp
*JOINT LAW, NAME=CONTACT, FRICTION={FRICTION}
*AMPLITUDE, NAME=MOTION, INPUT=records/{RECORD}.txt
*STEP
"""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/mesh.inp").write_text("*NODE\n1, 0.\n")
    (tmp_path / "dam.inp").write_text(TEMPLATE)
    return tmp_path


def cases(place, table: str):
    (place / "values.csv").write_text(table)
    return cases_of_table(place / "dam.inp", place / "values.csv", place / "out")


def test_each_row_is_a_deck_with_its_values_and_files(place):
    found = cases(place, "FRICTION,RECORD\n0.6, a\n\n0.8,b\n")
    assert [case.name for case in found] == ["dam_001", "dam_002"]
    text = found[1].deck.read_text()
    assert "friction 0.8, unknown {here}" in text
    assert "*INCLUDE, INPUT=../../parts/mesh.inp\n" in text
    assert "FRICTION=0.8\n" in text
    assert "INPUT=../../records/b.txt\n" in text


def test_a_column_names_the_cases(place):
    found = cases(place, "case,FRICTION,RECORD\nlow,0.6,a\nhigh,0.8,a\n")
    assert [case.deck.name for case in found] == ["low.inp", "high.inp"]


def test_a_template_in_latin1(place):
    """Its cases are read as the template is: names and files keep their letters."""
    text = TEMPLATE.replace("A block", "Stärke").replace("records/", "Stöße/")
    (place / "dam.inp").write_bytes(text.encode("latin-1"))
    (case,) = cases(place, "FRICTION,RECORD\n0.6,Süd\n")
    text = case.deck.read_text(encoding="utf-8")
    assert "** Stärke, friction 0.6" in text
    assert "INPUT=../../Stöße/Süd.txt\n" in text


@pytest.mark.parametrize(
    ("table", "fault"),
    [
        ("FRICTION\n0.6\n", r"dam\.inp:4: \{RECORD\} is no column of .*one of FRICTION"),
        ("FRICTION,RECORD,E\n1,a,2\n", r"no line of .*dam\.inp has \{E\}"),
        ("FRICTION,RECORD\n0.6\n", r"values\.csv:2: 1 values; expected 2: FRICTION, RECORD"),
        ("FRICTION,RECORD\n0.6,\n", r"values\.csv:2: 1 values; expected 2: FRICTION, RECORD"),
        (
            "FRICTION,FRICTION\n1,2\n",
            r"values\.csv:1: found 'FRICTION,FRICTION'; expected",
        ),
        ("FRICTION;RECORD\n1;a\n", r"values\.csv:1: found 'FRICTION;RECORD'; expected .* commas"),
        ("FRICTION,RECORD\n\n1,a\n2,\n", r"values\.csv:4: 1 values"),
        ("FRICTION,RECORD\n", "expected a header line and a line for each case"),
        ("\0", r"values\.csv' is no CSV file|expected a header line"),
        ("case,FRICTION,RECORD\na,1,x\na,2,x\n", "the case 'a' is there twice"),
        ("case,FRICTION,RECORD\n../a,1,x\n", r"'\.\./a' is no name of a case"),
    ],
)
def test_faults_are_named(place, table, fault):
    with pytest.raises(BatchError, match=fault):
        cases(place, table)


def test_a_table_runs_and_goes_on(program_path, tmp_path, monkeypatch, capsys):
    """Three frictions of a block on a joint; the second call runs nothing again."""
    monkeypatch.chdir(tmp_path)
    deck = (ROOT / "input/block_on_joint.inp").read_text()
    (tmp_path / "block.inp").write_text(deck.replace("FRICTION=0.6", "FRICTION={FRICTION}"))
    (tmp_path / "values.csv").write_text("case,FRICTION\nlow,0.1\nusual,0.6\nhigh,0.8\n")
    words = ["block.inp", "--table", "values.csv", "-o", "out", "-j", "2",
             "--program", str(program_path)]  # fmt: skip
    assert batch.main(words) == 1  # the block slides away with a friction of 0.1
    frame = pd.read_csv("out/batch.csv").set_index("case")
    assert frame["status"].to_dict() == {"low": "stopped", "usual": "finished", "high": "finished"}
    assert frame["FRICTION"].to_dict() == {"low": 0.1, "usual": 0.6, "high": 0.8}
    summary = json.loads((tmp_path / "out/usual/usual.json").read_text())
    opening = summary["joints"]["BED"]["opening"]["anywhere"]["value"]
    assert frame.loc["usual", "opening_BED"] == pytest.approx(opening, rel=1e-12)
    assert frame.loc["usual", "displacement"] > 0.0
    assert pd.read_parquet("out/batch.parquet")["FRICTION"].tolist() == [0.1, 0.6, 0.8]
    capsys.readouterr()
    batch.main(words)
    text = capsys.readouterr()
    assert text.out.count("(kept)") == 2
    with (tmp_path / "out/batch.csv").open() as file:
        assert len(list(csv.reader(file))) == 4


def test_usage(tmp_path, capsys, program_path):
    (tmp_path / "a.inp").write_text("*STEP\n")
    (tmp_path / "v.csv").write_text("A\n1\n")
    path = str(tmp_path / "a.inp")
    with pytest.raises(SystemExit):
        batch.main([path, path, "--table", str(tmp_path / "v.csv")])
    with pytest.raises(SystemExit):
        batch.main([path, "--on", "moon"])
    words = [path, "--table", str(tmp_path / "v.csv"), "-o", str(tmp_path / "o")]
    assert batch.main([*words, "--program", str(program_path)]) == 2
    assert "no line of" in capsys.readouterr().err


def test_a_column_of_numbers_and_words(program_path, tmp_path, monkeypatch, capsys):
    """One case has a word where a number belongs: it fails alone, and both tables hold it."""
    monkeypatch.chdir(tmp_path)
    deck = (ROOT / "input/block_on_joint.inp").read_text()
    (tmp_path / "block.inp").write_text(deck.replace("FRICTION=0.6", "FRICTION={FRICTION}"))
    (tmp_path / "values.csv").write_text("FRICTION\r\nnone\r\n0.6\r\n")
    words = ["block.inp", "--table", "values.csv", "-o", "out", "--program", str(program_path)]
    assert batch.main([*words, "--", "-q"]) == 1
    for table in (pd.read_csv("out/batch.csv"), pd.read_parquet("out/batch.parquet")):
        assert list(table["status"]) == ["bad deck", "finished"]
        assert list(table["FRICTION"]) == ["none", "0.6"]
    text = capsys.readouterr()
    assert "block_001.inp:" in text.out
    assert "wrote out/batch.csv" in text.err
    # A case that has become bad has no results, although those of the earlier deck are there.
    (tmp_path / "values.csv").write_text("FRICTION\n0.6\nnone\n")
    assert batch.main([*words, "--", "-q"]) == 1
    table = pd.read_csv("out/batch.csv")
    assert list(table["status"]) == ["finished", "bad deck"]
    assert np.isfinite(table["displacement"][0]) and np.isnan(table["displacement"][1])
    assert "found 'none'" in table["message"][1]


def test_numbers_of_the_table_are_those_of_a_deck(program_path, tmp_path, monkeypatch):
    """1_2 was written as 12 and nan as an empty field; 2.D-1 made a column of texts."""
    monkeypatch.chdir(tmp_path)
    deck = (ROOT / "input/block_on_joint.inp").read_text()
    deck = deck.replace("FRICTION=0.6", "FRICTION={FRICTION}")
    (tmp_path / "block.inp").write_text(f"*HEADING\nrecord {{RECORD}} of {{WHO}}\n{deck}")
    (tmp_path / "values.csv").write_text("FRICTION,RECORD,WHO\n6.D-1,1_2,nan\n0.6,1_3,nan\n")
    words = ["block.inp", "--table", "values.csv", "-o", "out", "--program", str(program_path)]
    assert batch.main([*words, "--", "-q"]) == 0
    table = pd.read_csv("out/batch.csv", keep_default_na=False)
    assert list(table["FRICTION"]) == [0.6, 0.6]
    assert list(table["RECORD"]) == ["1_2", "1_3"]
    assert list(table["WHO"]) == ["nan", "nan"]


def test_fractiles_of_the_finished_cases(tmp_path):
    """0, 1, .. 10 of the cases that finished: fractiles are those of a uniform distribution."""
    rows = [[f"c{k}", "finished", float(k), 1.0] for k in range(11)] + [
        ["c11", "stopped", 99.0, 1.0]
    ]
    table = ResultTable(["case", "status", "U", "same"], rows, ["U", "same"])
    files = write_fractiles(table, tmp_path)
    assert [file.name for file in files] == ["batch_fractiles.csv", "batch_fractiles.png"]
    found = pd.read_csv(files[0]).set_index("result")
    wanted = [11, 0.0, 1.6, 5.0, 8.4, 10.0]
    assert found.loc["U"].tolist() == pytest.approx(wanted, rel=1e-12)
    assert found.loc["same"].tolist()[1:] == [1.0] * 5
    assert files[1].stat().st_size > 5000
    assert write_fractiles(ResultTable(table.columns, rows[:3], ["U"]), tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_values_with_names_of_results_have_their_own_columns(place):
    (place / "dam.inp").write_text("*STEP, NAME={status}{U}\n")
    found = cases(place, "status,U\na,1\nb,2\n")
    records = [Record(str(c.deck), str(c.folder), "not run") for c in found]
    records[0].has_results = True
    found[0].folder.mkdir(exist_ok=True)
    summary = {
        "program": {},
        "status": "finished",
        "envelopes": {"U": {"anywhere": {"value": 7.0}}},
    }
    (found[0].folder / f"{found[0].name}.json").write_text(json.dumps(summary))
    table = result_table(found, records)
    assert table.columns[:4] == ["case", "status_given", "U_given", "status"]
    assert table.rows[0][1:3] == ["a", 1.0]
    assert [row[table.columns.index("U")] for row in table.rows] == [7.0, None]


def test_two_batches_in_one_folder(tmp_path, capsys):
    with lock_of(tmp_path / "out"):
        assert batch.main([str(tmp_path / "a.inp"), "-o", str(tmp_path / "out")]) == 2
        assert "another batch runs in" in capsys.readouterr().err
    batch.main([str(tmp_path / "a.inp"), "-o", str(tmp_path / "out")])
    assert "there is no deck" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_signal_to_a_run_that_has_just_ended(tmp_path):
    """Between the end of a child and its removal from the list there is a moment."""
    child = subprocess.Popen(["true"], start_new_session=True)
    child.wait()
    send(child, signal.SIGTERM)
