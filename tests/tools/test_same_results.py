"""same_results.py with made-up programs: what differs, what is missing, what is ignored."""

import json
import stat
from pathlib import Path

import h5py
import numpy as np
import pytest
import same_results
from keyway_tools.written_values import compare_written


def write_run(folder: Path, factor: float = 1.0) -> None:
    """Results of a run whose displacements are multiplied by a factor."""
    (folder / "job_vtk").mkdir(parents=True)
    (folder / "job_node_TIP.csv").write_text(f"time,U1,U2\n0,0,0\n1,{2.0 * factor!r},1e-9\n")
    energy = {"external": 8.0, "numerical": 1e-15 * factor, "error": 1e-16 * factor}
    summary = {"status": "finished", "ledger": {"wall_s": factor}, "steps": [{"energy": energy}]}
    (folder / "job.json").write_text(json.dumps(summary))
    (folder / "job.log").write_text(f"took {factor} s")
    with h5py.File(folder / "job.h5", "w") as file:
        fields = file.create_dataset("fields", data=np.array([[1e6 * factor, 0.1], [3.0, 0.2]]))
        fields.attrs["columns"] = "S11,DAMAGET"
        file["modes/shape"] = factor * np.ones((2, 4, 3))
        file["mesh/names"] = np.array([b"DAM  "])


def sizes(before: Path, after: Path) -> dict[str, float]:
    return {d.place: d.size for d in compare_written(before, after) if d.size > 0}


@pytest.fixture
def runs(tmp_path):
    write_run(tmp_path / "before")
    return tmp_path / "before", tmp_path / "after"


def test_differences_are_relative_to_the_largest_value(runs):
    before, after = runs
    write_run(after, 1 + 1e-9)
    found = sizes(before, after)
    assert found.pop("job.json: steps.0.energy.numerical") < 1e-24
    assert found.pop("job.json: steps.0.energy.error") < 1e-24
    places = {"job_node_TIP.csv: U1", "job.h5: fields.S11", "job.h5: modes/shape"}
    assert found.keys() == places
    assert all(size == pytest.approx(1e-9, rel=1e-3) for size in found.values())


def test_what_one_side_lacks_is_a_difference(runs):
    before, after = runs
    write_run(after)
    (after / "job_energy.csv").write_text("time\n1\n")
    with h5py.File(after / "job.h5", "a") as file:
        del file["mesh/names"]
        file["mesh/more"] = [1.0]
    lacking = {"job_energy.csv", "job.h5: mesh/names", "job.h5: mesh/more"}
    assert sizes(before, after) == dict.fromkeys(lacking, np.inf)


def test_words_and_shapes_count(runs):
    before, after = runs
    write_run(after)
    (after / "job_node_TIP.csv").write_text("time,U1,U2\n0,0,0\n")
    with h5py.File(after / "job.h5", "a") as file:
        file["mesh/names"][:] = b"ROCK"
    places = {*(f"job_node_TIP.csv: {name}" for name in ("time", "U1", "U2")), "job.h5: mesh/names"}
    assert sizes(before, after) == dict.fromkeys(places, np.inf)


def test_the_sign_of_a_mode_is_free(runs):
    before, after = runs
    write_run(after)
    with h5py.File(after / "job.h5", "a") as file:
        file["modes/shape"][1] *= -1
    assert not sizes(before, after)


def make_program(path: Path, displacement: str) -> Path:
    """A program that writes one history into its folder, the argument after -o."""
    path.write_text(f'#!/bin/sh\nprintf "time,U1\\n1,{displacement}\\n" > "$3/job_node_TIP.csv"\n')
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


@pytest.mark.parametrize(
    ("displacement", "options", "code"),
    [
        ("2.0", [], 0),
        ("2.0000000000001", [], 0),
        ("2.00001", [], 1),
        ("2.00001", ["--tolerance", "1e-4"], 0),
        ("2.00001", ["--ignore", "*TIP.csv: U?"], 0),
    ],
)
def test_two_programs(tmp_path, capsys, displacement, options, code):
    deck = tmp_path / "mine" / "block.inp"
    deck.parent.mkdir()
    deck.write_text("*STEP\n*END STEP\n")
    before = make_program(tmp_path / "before", "2.0")
    after = make_program(tmp_path / "after", displacement)
    arguments = [str(before), str(after), str(deck), "--only", "mine_block", *options]
    assert same_results.main(arguments) == code
    shown = capsys.readouterr().out
    assert f"{1 - code} of 1 decks the same" in shown
    assert ("job_node_TIP.csv: U1: 2 before, 2.00001 after" in shown) == (code == 1)


def test_kept_results_are_not_computed_again(tmp_path, capsys):
    deck = tmp_path / "block.inp"
    deck.write_text("*STEP\n*END STEP\n")
    before = make_program(tmp_path / "before", "2.0")
    after = make_program(tmp_path / "after", "2.00")
    options = ["--only", deck.stem, "--keep", str(tmp_path / "kept")]
    for _ in range(2):
        assert same_results.main([str(before), str(after), str(deck), *options]) == 0
    assert "kept and kept" in capsys.readouterr().out
    deck.with_suffix(".for").write_text("      SUBROUTINE UMAT\n      END\n")  # now with a UMAT
    assert same_results.main([str(before), str(after), str(deck), *options]) == 0
    lines = capsys.readouterr().out.splitlines()
    (line,) = (line for line in lines if same_results.name_of(deck) in line)
    assert not line.endswith("kept and kept")


def test_a_missing_program_is_a_fault_of_usage(tmp_path, capsys):
    missing = str(tmp_path / "nothing")
    assert same_results.main([missing, missing]) == 2
    assert "there is no program" in capsys.readouterr().err
