"""Runs from Python: histories as frames, fields as meshes, errors as exceptions."""

from __future__ import annotations

import fcntl
import os
import re
import shutil
import subprocess

import keyway as package
import numpy as np
import pytest
from harness import ROOT
from keyway.commands.plot import main as plot
from keyway_tools.report.__main__ import main as report

INPUT = ROOT / "input"


@pytest.fixture(scope="module")
def dam(program_path, tmp_path_factory):
    """A block on a joint: static and dynamic, with openings and fields."""
    folder = tmp_path_factory.mktemp("dam")
    deck = INPUT / "block_on_joint.inp"
    return package.run(deck, threads=1, results=folder, program=program_path)


def test_a_run_is_opened_by_folder_file_and_name(dam):
    for path in (dam.folder, dam.folder / "block_on_joint.h5", dam.folder / "block_on_joint"):
        assert package.open(path).job == "block_on_joint"
    with pytest.raises(FileNotFoundError, match="no results of Keyway"):
        package.open(dam.folder / "other")
    assert dam.status == "finished"
    assert dam.why_incomplete == ""


def test_histories_are_those_of_the_files(dam):
    results = dam._results
    openings = dam.openings
    assert list(openings.columns) == ["step", "increment", "time", "BED"]
    largest = dam.summary["joints"]["BED"]["opening"]["anywhere"]["value"]
    assert openings["BED"].max() == pytest.approx(largest, rel=1e-12)
    assert np.array_equal(dam.energies["kinetic"], results.table("energy")["kinetic"])
    assert dam.node("heel")["node"].dtype == "int64"
    assert set(dam.prints) == {"energy", "joint_BED", "node_HEEL", "node_TOE"}
    assert list(dam.joint_extremes("BED").columns)[3:] == ["opening", "slip", "pressure"]
    assert len(dam.increments) == len(dam.energies) == len(openings)
    for wrong in (lambda: dam.node("NONE"), lambda: dam.joint_extremes("NONE")):
        with pytest.raises(LookupError, match=r"HEEL|BED"):
            wrong()


def test_extremes(dam):
    found = dam.joints.set_index(["joint", "field", "place"])
    given = dam.summary["joints"]["BED"]["pressure"]["anywhere"]
    row = found.loc[("BED", "pressure", "anywhere")]
    assert [row.value, row.time] == [given["value"], given["time"]]
    assert [row.x, row.y, row.z] == given["x"]
    assert set(dam.envelopes["field"]) == {"OPENING", "U"}
    assert list(dam.displacement["field"].unique()) == ["U"]


def test_a_run_that_is_not_at_its_end(dam, tmp_path, capsys):
    """The program holds the lock of job.h5 while it runs: tables can be read, fields cannot."""
    shutil.copytree(dam.folder, tmp_path / "dam")
    with (tmp_path / "dam/block_on_joint.h5").open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        run = package.open(tmp_path / "dam")
        assert len(run.energies) == len(dam.energies)
        for ask in (run.fields, run.mesh, lambda: run.openings):
            with pytest.raises(OSError, match="the run is not at its end yet"):
                ask()
        for command in (plot, report):
            assert command([str(tmp_path / "dam")]) == 2
            assert "block_on_joint.h5: the run is not at its end yet" in capsys.readouterr().err
    assert len(run.openings) == len(dam.openings)
    run.close()
    (tmp_path / "dam/block_on_joint.h5").write_bytes(b"lost")
    with pytest.raises(OSError, match=r"block_on_joint\.h5 cannot be read"):
        package.open(tmp_path / "dam").fields()


def test_pictures_and_pages_that_cannot_be_written(dam, tmp_path, capsys):
    (tmp_path / "file").touch()
    for command, target in ((plot, "file/pictures"), (report, "file/page.html")):
        assert command([str(dam.folder), "-o", str(tmp_path / target)]) == 2
        text = capsys.readouterr().err
        assert re.search(rf"^(plot|report): '{tmp_path}/file.*': (Not a|File exists)", text, re.M)


def test_fields_are_those_that_the_vtk_files_show(dam):
    """Both are written by the program by separate paths; VTK files hold single precision."""
    import pyvista

    grid = dam.fields(time=1.42)
    assert grid.field_data["TIME"][0] == 1.4
    reader = pyvista.PVDReader(str(dam.folder / "block_on_joint.pvd"))
    reader.set_active_time_value(1.4)
    shown = reader.read()[0]
    assert grid.n_cells == shown.n_cells
    assert np.allclose(grid.points, shown.points)
    assert np.array_equal(grid.point_data["NODE_ID"], shown.point_data["NODE_ID"])
    assert np.allclose(grid.point_data["U"], shown.point_data["U"], rtol=1e-6, atol=1e-12)
    order = [0, 1, 2, 3, 5, 4]  # VTK has 23 before 13
    assert np.allclose(grid.point_data["S"][:, order], shown.point_data["S"], rtol=1e-6, atol=1.0)
    assert np.array_equal(grid.cell_data["ELEMENT_ID"], shown.cell_data["ELEMENT_ID"])
    assert np.array_equal(grid.cell_data["MATERIAL"], shown.cell_data["MATERIAL"])


def test_times_of_fields(dam):
    assert dam.saved["time"].tolist() == pytest.approx([1.2, 1.4, 1.7, 2.0], rel=1e-12)
    assert dam.fields().field_data["TIME"][0] == 2.0
    assert dam.fields(step=2, time=0.0).field_data["TIME"][0] == 1.2
    with pytest.raises(LookupError, match="no fields are saved in step 1"):
        dam.fields(step=1)


def test_envelopes_joints_and_modes(dam, program_path, tmp_path):
    envelope = dam.envelope_mesh()
    largest = dam.summary["envelopes"]["U"]["anywhere"]["value"]
    assert envelope.point_data["U_MAX"].max() == pytest.approx(largest, rel=1e-12)
    points = dam.joint_points("BED")
    last = dam.joint("BED").query("time == 2.0")
    assert np.allclose(points.point_data["opening"], last["opening"], rtol=1e-9, atol=1e-15)
    with pytest.raises(LookupError, match="the model has: BED"):
        dam.joint_points("OTHER")
    with pytest.raises(LookupError, match="FREQUENCY"):
        dam.modes()
    deck = INPUT / "monolith_frequencies.inp"
    with package.run(deck, threads=1, results=tmp_path, program=program_path) as modal:
        assert np.allclose(modal.modes().field_data["HZ"], modal.frequencies["hz"], rtol=1e-12)
        assert modal.modes().point_data["MODE_05"].shape == (modal.mesh().n_points, 3)


def test_a_changed_deck_runs_from_the_folder_of_its_results(program_path, tmp_path):
    deck = package.Deck(INPUT / "monolith_frequencies.inp")
    deck.card("FREQUENCY").data[0][0] = 2
    run = package.run(deck, threads=1, results=tmp_path / "r", program=program_path)
    assert len(run.frequencies) == 2
    assert (tmp_path / "r/monolith_frequencies.inp").is_file()


def test_errors_have_the_message_and_the_exit_code(program_path, tmp_path, monkeypatch):
    deck = tmp_path / "bad.inp"
    deck.write_text("*MATERIAL, NAME=A\n*ELASTIC\n31 GPa, 0.2\n")
    with pytest.raises(package.RunError, match=r"bad\.inp:3: \*ELASTIC: found '31 GPa'") as caught:
        package.run(deck, results=tmp_path, program=program_path)
    assert caught.value.code == 2
    (fault,) = caught.value.faults
    assert (fault.file, fault.line, fault.kind) == (str(deck), 3, "wrong-value")
    assert str(fault).startswith(f"{deck}:3: *ELASTIC: found '31 GPa'; expected Young's modulus")
    assert caught.value.run is None
    with pytest.raises(FileNotFoundError, match="there is no deck"):
        package.run(tmp_path / "none.inp", program=program_path)
    monkeypatch.setenv("KEYWAY", str(tmp_path / "none"))
    with pytest.raises(FileNotFoundError, match=r"KEYWAY=.*: there is no such program"):
        package.run(deck)


def test_a_run_that_is_too_long_is_ended_and_keeps_its_results(program_path, tmp_path):
    deck = package.Deck(INPUT / "sliding_block.inp")
    deck.card("DYNAMIC").data[0][0] = 1e-6  # more increments than any processor takes in 3 s
    deck.card("STEP", NAME="SHAKING").parameters["INC"] = 10_000_000
    with pytest.raises(subprocess.TimeoutExpired):
        package.run(deck, threads=1, results=tmp_path, program=program_path, timeout=3.0)
    run = package.open(tmp_path)
    assert run.status == "stopped"
    assert len(run.energies) > 1


def test_the_program_is_found_in_the_path(program_path, tmp_path, monkeypatch):
    monkeypatch.delenv("KEYWAY", raising=False)
    monkeypatch.setattr("keyway_tools.program.BUILT", tmp_path / "none")
    (tmp_path / "keyway").symlink_to(program_path)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert package.find_program() == program_path.resolve()
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))
    with pytest.raises(FileNotFoundError, match="KEYWAY is not set"):
        package.find_program()
