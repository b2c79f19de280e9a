"""The harness of the deck tests: which values pass, and which keys a case must have."""

import json

import pytest
from harness import Run, fault_of, find_value, read_case

TABLE = "step,time,node,U1\n1,0.5,7,1.0\n1,1.0,7,-3.0\n1,1.0,9,2.0\n"


@pytest.fixture
def run(tmp_path):
    summary = {"program": {}, "status": "finished", "steps": [{"energy": {"error": 1e-4}}]}
    (tmp_path / "dam.json").write_text(json.dumps(summary))
    (tmp_path / "dam_node_TIP.csv").write_text(TABLE)
    return Run(tmp_path, "dam", 0, "", "")


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ({"json": "status"}, "finished"),
        ({"json": "steps.0.energy.error"}, 1e-4),
        ({"csv": "node_TIP", "column": "U1", "row": {"time": 1.0, "node": 9}}, 2.0),
        ({"csv": "node_TIP", "column": "U1", "extreme": "maxabs"}, 3.0),
        ({"csv": "node_TIP", "column": "U1", "extreme": "min", "row": {"node": 7}}, -3.0),
        ({"csv": "node_TIP", "column": "U1", "extreme": "last"}, 2.0),
    ],
)
def test_values_are_found(run, place, expected):
    assert find_value(run, place) == expected


def test_places_that_are_not_there(run):
    with pytest.raises(KeyError, match="no 'steps"):
        find_value(run, {"json": "steps.1.energy"})
    with pytest.raises(AssertionError, match="no row"):
        find_value(run, {"csv": "node_TIP", "column": "U1", "row": {"node": 8}})
    with pytest.raises(AssertionError, match="2 rows"):
        find_value(run, {"csv": "node_TIP", "column": "U1", "row": {"node": 7}})


@pytest.mark.parametrize(
    ("found", "value", "is_right"),
    [
        (1.0, {"expected": 1.1, "relative": 0.1}, True),
        (1.0, {"expected": 1.2, "relative": 0.1}, False),
        (1.0, {"expected": 1.05, "absolute": 0.06}, True),
        (float("nan"), {"expected": 1.0, "absolute": 1e9}, False),
        (float("nan"), {"at_most": 1.0}, False),
        (0.5, {"at_most": 1.0, "at_least": 0.5}, True),
        (0.5, {"at_least": 0.6}, False),
        ("finished", {"expected": "finished"}, True),
        ("stopped", {"expected": "finished"}, False),
    ],
)
def test_values_are_judged(found, value, is_right):
    assert (fault_of(found, {"name": "x", **value}) == "") == is_right


def test_a_tolerance_without_reason_is_refused(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text('[[value]]\nname = "x"\nexpected = 1\nrelative = 0.1\nsource = "here"\n')
    with pytest.raises(AssertionError, match="no reason"):
        read_case(path)
