"""compare.py on made-up results: what is equal, what differs, and where."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from keyway.commands import compare
from keyway_tools import comparison

HEADER = "step,increment,time,node,U1,U2,state\n"
ROWS = ["1,1,0.5,7,1.0e-3,2.0e-9,open\n", "1,1,0.5,9,-4.0,0,stick\n", "1,2,1.0,7,3,nan,slip\n"]
SUMMARY = {
    "program": {"name": "keyway", "version": "1"},
    "status": "finished",
    "steps": [{"energy": {"error": 1e-9}, "iterations": 3, "cutbacks": None}],
    "ledger": {"wall_s": 12.0},
}


def make_results(folder: Path, job="dam", rows=ROWS, header=HEADER, summary=SUMMARY) -> Path:
    folder.mkdir()
    (folder / f"{job}.json").write_text(json.dumps(summary))
    (folder / f"{job}_node_TIP.csv").write_text(header + "".join(rows))
    with h5py.File(folder / f"{job}.h5", "w") as file:
        file["mesh/nodes"] = np.arange(12.0).reshape(4, 3)
        file["mesh/title"] = "dam"
    return folder


@pytest.fixture
def a(tmp_path):
    return make_results(tmp_path / "a")


def run(capsys, *arguments) -> tuple[int, str]:
    code = compare.main([str(x) for x in arguments])
    captured = capsys.readouterr()
    return code, captured.out + captured.err


def test_a_folder_equals_itself(capsys, a):
    code, text = run(capsys, a, a)
    assert code == 0
    assert "equal within the tolerances" in text


def test_another_name_and_another_order_of_rows_are_equal(capsys, tmp_path):
    def named(job: str) -> dict:
        files = [f"{job}.h5", f"{job}_node_TIP.csv", f"{job}_vtk/{job}_0001.vtu"]
        return SUMMARY | {"files": files, "warnings": [f"decks/{job}.inp:3: *TIE: warning"]}

    a = make_results(tmp_path / "a", summary=named("dam"))
    b = make_results(tmp_path / "b", job="copy", rows=ROWS[::-1], summary=named("copy"))
    assert run(capsys, a, b)[0] == 0


def test_the_time_grows_no_faster_than_the_rows(monkeypatch, tmp_path, a):
    """A set of all keys for each row took minutes for two tables of 1e4 rows."""
    built = []

    def counted(*members):
        built.append(members)
        return set(*members)

    monkeypatch.setattr(comparison, "set", counted, raising=False)
    rows = [f"1,1,0.5,{node},0,0,open\n" for node in range(1, 101)]
    folder = make_results(tmp_path / "many", rows=rows)
    assert compare.main([str(folder), str(folder)]) == 0
    assert len(built) < 10


def test_place_of_the_largest_difference_is_reported(capsys, tmp_path, a):
    rows = [ROWS[0].replace("1.0e-3", "1.1e-3"), ROWS[1].replace("-4.0", "-5.0"), ROWS[2]]
    code, text = run(capsys, a, make_results(tmp_path / "b", rows=rows))
    assert code == 1
    assert "DIFFERS node_TIP: U1: 2 of 3 past the tolerance" in text
    assert "step=1, increment=1, node=9, time=0.5: -4 against -5 (apart 1, 0.2 of it" in text


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ([], 1),
        (["--rel", "0.02"], 0),
        (["--abs", "1.1e-5"], 0),
        (["--tol", "U1=0.02"], 0),
        (["--tol", "node_TIP:U?=0,2e-5"], 0),
        (["--tol", "U2=0.02"], 1),
        (["--ignore", "U1"], 0),
        (["--by-column"], 1),
        (["--by-column", "--rel", "1e-5"], 0),
    ],
)
def test_tolerances(capsys, tmp_path, a, options, code):
    b = make_results(tmp_path / "b", rows=[ROWS[0].replace("1.0e-3", "1.01e-3"), *ROWS[1:]])
    assert run(capsys, a, b, *options)[0] == code


def test_tolerances_from_a_file(capsys, tmp_path, a):
    b = make_results(tmp_path / "b", rows=[ROWS[0].replace("1.0e-3", "1.01e-3"), *ROWS[1:]])
    file = tmp_path / "tolerances.toml"
    file.write_text('relative = 1e-9\n[column."U*"]\nrelative = 0.1\n')
    assert run(capsys, a, b, "--tolerances", file)[0] == 0
    file.write_text('[column."U*"]\nrelativ = 0.1\n')
    assert run(capsys, a, b, "--tolerances", file)[0] == 2


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("dam_node_TIP.csv", "nan", "0", "1 of 3 past"),
        ("dam_node_TIP.csv", ",3,", ",nan,", "1 of 3 past"),
        ("dam_node_TIP.csv", ",3,", ",inf,", "1 of 3 past"),
        ("dam_node_TIP.csv", "slip", "open", "1 texts differ, as at step=1, increment=2, node=7"),
        ("dam_node_TIP.csv", ROWS[1], "", "1 rows missing in the second, as step=1, increment=1"),
        ("dam_node_TIP.csv", "U2", "V2", "U2: column missing in the second"),
        ("dam.json", "finished", "stopped", "'finished' against 'stopped'"),
        ("dam.json", "null", "0", "None against 0"),
        ("dam.json", "1e-09", "1.0005e-09", None),
        ("dam.json", '"iterations": 3', '"iterations": 4', "steps.0.iterations"),
        ("dam.json", "12.0", "13.0", None),
    ],
)
def test_kinds_of_difference(capsys, tmp_path, a, file, old, new, message):
    b = make_results(tmp_path / "b")
    change(b / file, old, new)
    code, text = run(capsys, a, b)
    assert code == (1 if message else 0)
    assert (message or "equal") in text


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("options", [["--rel", "1e9", "--by-column"], ["--rel", "1e308"]])
def test_a_tolerance_beyond_all_numbers_allows_all_but_nan(capsys, tmp_path, a, options):
    """Without a warning of numpy."""
    b = make_results(tmp_path / "b")
    for folder in (a, b):
        change(folder / "dam_node_TIP.csv", "-4.0", "1.7e308")
    assert run(capsys, a, b, *options)[0] == 0
    change(b / "dam_node_TIP.csv", ",3,", ",nan,")
    assert run(capsys, a, b, *options)[0] == 1


def test_differences_of_hdf5(capsys, tmp_path, a):
    b = make_results(tmp_path / "b")
    with h5py.File(b / "dam.h5", "a") as file:
        file["mesh/nodes"][2, 1] = 9.0
        file["extra"] = 1.0
    code, text = run(capsys, a, b)
    assert code == 1
    assert "hdf5: mesh/nodes: 1 of 12 past the tolerance; largest at [2, 1]: 7 against 9" in text
    assert "hdf5: extra: missing in the first" in text
    with h5py.File(b / "dam.h5", "w") as file:
        file["mesh/nodes"] = np.zeros((3, 3))
    assert "shape (4, 3) against (3, 3)" in run(capsys, a, b)[1]


def test_missing_table_and_missing_file(capsys, tmp_path, a):
    b = make_results(tmp_path / "b")
    (b / "dam_node_TIP.csv").unlink()
    (b / "dam.h5").unlink()
    code, text = run(capsys, a, b)
    assert code == 1
    assert "node_TIP: table missing in the second" in text
    assert "hdf5: missing in the second" in text
    assert run(capsys, a, b, "--subset")[0] == 0
    assert run(capsys, b, a, "--subset")[0] == 1


def test_references(capsys, tmp_path, a):
    table = tmp_path / "reference_node_TIP.csv"
    table.write_text("node,increment,U1\n7,1,1.0e-3\n9,1,-4.0\n7,2,3.0\n")
    assert run(capsys, a, table)[0] == 0
    table.write_text("node,increment,U1\n7,2,3.0\n")
    assert run(capsys, a, table)[0] == 1
    assert run(capsys, a, table, "--subset")[0] == 0
    summary = tmp_path / "reference.json"
    summary.write_text('{"steps": [{"iterations": 3}]}')
    assert run(capsys, a, summary)[0] == 0
    with h5py.File(tmp_path / "reference.h5", "w") as file:
        file["mesh/nodes"] = np.arange(12.0).reshape(4, 3)
    assert run(capsys, a, tmp_path / "reference.h5")[0] == 0
    assert run(capsys, a / "dam.h5", tmp_path / "reference.h5")[0] == 1


def test_rows_without_names_go_by_order(capsys, tmp_path):
    for name, text in (("a.csv", "t,x\n0,1\n1,2\n"), ("b.csv", "t,x\n0,1\n1,2\n2,3\n")):
        (tmp_path / name).write_text(text)
    code, text = run(capsys, tmp_path / "a.csv", tmp_path / "b.csv")
    assert code == 1
    assert "2 rows against 3" in text


def test_findings_as_json(capsys, tmp_path, a):
    b = make_results(tmp_path / "b", rows=[ROWS[0].replace("1.0e-3", "2e-3"), *ROWS[1:]])
    run(capsys, a, b, "--json", tmp_path / "found.json")
    found = json.loads((tmp_path / "found.json").read_text())
    assert not found["equal"]
    assert found["differences"][0]["place"] == "node_TIP: U1"


@pytest.mark.parametrize(
    "arguments",
    [("nothing", "nothing"), ("a", "a.txt"), ("a", "a", "--tol", "U1"), ("a", "a", "--rel", "x")],
)
def test_usage(capsys, tmp_path, monkeypatch, a, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.txt").write_text("")
    try:
        code = compare.main(list(arguments))
    except SystemExit as stop:
        code = stop.code
    assert code == 2


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('relative = "a"', "relative = 'a': expected a number of 0 or more"),
        ("absolute = -1", "absolute = -1: expected a number of 0 or more"),
        ("relativ = 1", "unknown 'relativ'; expected relative, absolute, by_column, column"),
        ("by_column = 1", "by_column = 1: expected true or false"),
        ('[column."U1"]\nrel = 1', "column.\"U1\": unknown 'rel'; expected relative, absolute"),
        ("column = 1", 'column = 1: expected tables [column."PATTERN"]'),
        ("relative = ", "expected TOML"),
    ],
)
def test_tolerance_files_that_cannot_be_used(capsys, tmp_path, a, text, expected):
    file = tmp_path / "t.toml"
    file.write_text(text)
    assert compare.main([str(a), str(a), "--tolerances", str(file)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"compare: {file}: ")
    assert expected in told


def test_options_without_effect_are_named(capsys, a):
    options = ["--tol", "NOSUCH=1", "--tol", "U*=1", "--ignore", "NONE", "--ignore", "node_TIP:U1"]
    assert compare.main([str(a), str(a), *options]) == 0
    assert capsys.readouterr().err.splitlines() == [
        "compare: --tol NOSUCH=1: no effect, nothing that was compared has the name 'NOSUCH'",
        "compare: --ignore NONE: no effect, nothing that was compared has the name 'NONE'",
    ]
    assert compare.main([str(a), str(a), "--tol", "U1=x"]) == 2
    assert "--tol U1=x: expected COLUMN=REL[,ABS], numbers of 0 or more" in capsys.readouterr().err


def test_a_table_of_two_folders_is_refused(capsys, tmp_path, a):
    assert compare.main([str(a), str(a), "--table", "nope"]) == 2
    assert "--table belongs to a reference in CSV" in capsys.readouterr().err
