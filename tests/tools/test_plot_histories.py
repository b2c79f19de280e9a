"""Pictures of histories: which curves are drawn, their names, and their gaps."""

import json
from types import SimpleNamespace

import h5py
import matplotlib
import numpy as np
import pytest
from keyway.commands import plot
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.picture_style import Sheet
from keyway_tools.pictures_curves import (
    NodeCurve,
    Span,
    choose_curves,
    plot_damage_growth,
    plot_energy,
    plot_nodes,
    plot_openings,
)
from keyway_tools.report import __main__ as report
from keyway_tools.report.curves import plots
from keyway_tools.result_files import as_file_word
from keyway_tools.si_results import SiResults, Units
from synthetic_results import write_results

ENERGIES = [
    "external",
    "kinetic",
    "strain",
    "damping",
    "friction",
    "fracture",
    "crushing",
    "numerical",
    "stages",
    "temperature",
]


@pytest.fixture
def folder(tmp_path):
    """Results of a column."""
    mesh, _ = box_mesh((1, 1, 4), stretched((1.0, 1.0, 4.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh)
    (tmp_path / "job_node_CROWN_CREST.csv").unlink()
    return tmp_path


def words_of(plot, results, folder):
    """The SVG of a picture, its letters as text."""
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        (file,) = plot(results, Sheet(folder / "picture", ("svg",)))
    return file.read_text()


def write_nodes(folder, name, moved, num_times=5):
    """A *NODE PRINT: nodes whose U2 grows to `moved` [m]."""
    rows = [
        f"1,{n},{n},{node},0,{n / num_times * size},0"
        for n in range(1, num_times + 1)
        for node, size in moved.items()
    ]
    text = "\n".join(["step,increment,time,node,U1,U2,U3", *rows]) + "\n"
    (folder / f"job_node_{name}.csv").write_text(text)


def write_energies(folder, values, num_times):
    """The history of energies; those that are not named are zero."""
    names = ["step", "increment", "time", *ENERGIES, "error"]
    table = np.zeros((num_times, len(names)))
    table[:, 2] = np.arange(1.0, num_times + 1.0)
    for name, value in values.items():
        table[:, names.index(name)] = value * table[:, 2]
    with h5py.File(folder / "job.h5", "a") as file:
        del file["history/energy"]
        file.create_dataset("history/energy", data=table).attrs["columns"] = ",".join(names)


def write_openings(folder, name, rows, columns="opening"):
    text = [f"step,increment,time,point,x,y,z,{columns}"]
    text += [f"{step},1,{time},1,0,0,0,{value}" for step, time, value in rows]
    (folder / f"job_joint_{name}.csv").write_text("\n".join(text) + "\n")


def test_nodes_that_move_are_drawn(folder):
    """The base has the lower numbers and rests; the crest moves, and so does a node below it."""
    write_nodes(folder, "BASE", dict.fromkeys(range(1, 10), 0.0))
    write_nodes(folder, "CREST", {40 + k: 0.01 + 0.001 * k for k in range(9)})
    write_nodes(folder, "MIDDLE", {30: 0.002})
    text = words_of(plot_nodes, SiResults(folder), folder)
    for node in range(44, 49):
        assert f"CREST, node {node}" in text
    assert "MIDDLE, node 30" in text
    assert "CREST, node 43" not in text
    assert "BASE" not in text


def test_directions_without_motion_are_not_drawn(folder):
    """U1 and U3 are zero: their panels would be empty."""
    write_nodes(folder, "CREST", {40: 0.01})
    text = words_of(plot_nodes, SiResults(folder), folder)
    assert "U2 [mm]" in text
    assert "U1 [mm]" not in text and "U3 [mm]" not in text
    assert "U1 and U3 not drawn: less than 1e-06 of the largest displacement" in text
    write_nodes(folder, "CREST", {40: 0.0})
    text = words_of(plot_nodes, SiResults(folder), folder)
    assert all(f"U{k} [mm]" in text for k in "123") and "not drawn" not in text


def test_round_off_is_no_signal(folder, monkeypatch):
    """U1 is round-off of 1e-12 m in the static steps, and moves in the earthquake."""
    with h5py.File(folder / "job.h5", "a") as file:
        file.move("steps/0001", "steps/0003")
        file.copy("steps/0003", "steps/0001")
        file["steps/0001"].attrs["procedure"] = "STATIC"
    rows = [f"1,{n},{n},40,{(-1) ** n * 1e-12},{n * 1e-3},0" for n in range(1, 6)]
    rows += [f"3,{n},{5 + 0.01 * n},40,{(-1) ** n * 2e-3},{n * 1e-3},0" for n in range(1, 6)]
    text = "\n".join(["step,increment,time,node,U1,U2,U3", *rows]) + "\n"
    (folder / "job_node_CREST.csv").write_text(text)
    kept = []
    monkeypatch.setattr(Sheet, "save", lambda _, figure: kept.append(figure) or [])
    plot_nodes(SiResults(folder), Sheet(folder / "picture"))
    static, motion = kept[0].axes[:2]
    assert static.get_ylim() == pytest.approx((-0.25, 0.25))  # [mm] a twentieth of 5 mm
    assert motion.get_ylim()[1] > 2.0


def test_equal_energies_of_one_increment_are_both_seen(folder, monkeypatch):
    """External and strain energy of a static step: one mark lay over the other."""
    write_energies(folder, {"external": 1.0, "strain": 1.0}, 1)
    kept = []
    monkeypatch.setattr(Sheet, "save", lambda _, figure: kept.append(figure) or [])
    plot_energy(SiResults(folder), Sheet(folder / "picture"))
    external, strain = kept[0].axes[0].lines[:2]
    assert external.get_markersize() > 2.0 * strain.get_markersize()
    assert external.get_linewidth() > 2.0 * strain.get_linewidth()


def curves(name, motions):
    return [NodeCurve(name, n, {}, np.zeros(0, int), motion) for n, motion in motions.items()]


def test_each_set_that_moves_has_a_curve():
    """Also where there are more sets than six; a node of two sets is drawn once."""
    sets = [curves(f"S{k}", {10 * k: 1.0 / k, 10 * k + 1: 2.0 / k}) for k in range(1, 9)]
    chosen = [(one.name, one.node) for one in choose_curves(sets)]
    assert chosen == [(f"S{k}", 10 * k + 1) for k in range(1, 9)]
    crest, crown = curves("CREST", {1: 1.0, 2: 3.0, 3: 2.0}), curves("CROWN", {2: 3.0})
    chosen = [(one.name, one.node) for one in choose_curves([crest, crown])]
    assert chosen == [("CREST", 1), ("CREST", 3), ("CROWN", 2)]
    same = [curves("A", {1: 1.0}), curves("B", {1: 1.0})]
    assert [one.name for one in choose_curves(same)] == ["A", "B"]


def test_where_nothing_moves_the_first_nodes_are_drawn():
    chosen = choose_curves([curves("BASE", dict.fromkeys(range(1, 10), 0.0))])
    assert [one.node for one in chosen] == [1, 2, 3, 4, 5, 6]
    assert choose_curves([]) == []


def test_all_energies_that_are_not_zero_are_drawn(folder):
    """Stages and temperature too, in the picture and in the report."""
    write_energies(folder, {"strain": 3.0, "temperature": 2.0, "stages": 1.0}, 4)
    results = SiResults(folder)
    text = words_of(plot_energy, results, folder)
    report = next(plot for plot in plots(results) if plot["title"] == "Energies")
    assert {one["name"] for one in report["curves"]} == {"strain", "temperature", "stages"}
    for name in ENERGIES:
        assert (f">{name}</text>" in text) == (name in ("strain", "temperature", "stages"))


def test_ten_energies_have_ten_curves(folder):
    """More than there are colours."""
    write_energies(folder, dict.fromkeys(ENERGIES, 1.0), 4)
    text = words_of(plot_energy, SiResults(folder), folder)
    assert all(f">{name}</text>" in text for name in ENERGIES)


def test_energies_of_stages_and_temperature_have_the_unit_of_energy(folder):
    """In a deck in mm and MPa: N mm."""
    write_energies(folder, {"stages": 1.0, "temperature": 2.0}, 4)
    table = SiResults(folder, units=Units.parse("mm,MPa")).history("energy")
    assert table["stages"][0] == pytest.approx(1e-3)
    assert table["temperature"][0] == pytest.approx(2e-3)


@pytest.mark.parametrize("num_times", [1, 2])
def test_few_increments_are_drawn(folder, num_times):
    write_nodes(folder, "TOP", {1: 0.01}, num_times)
    write_energies(folder, {"external": 1.0}, num_times)
    with h5py.File(folder / "job.h5", "a") as file:
        names, table = file["history/damage"].attrs["columns"], file["history/damage"][:]
        del file["history/damage"]
        short = file.create_dataset("history/damage", data=table[-num_times:])
        short.attrs["columns"] = names
    results = SiResults(folder)
    assert "TOP, node 1" in words_of(plot_nodes, results, folder)
    assert ">external</text>" in words_of(plot_energy, results, folder)
    assert "cracking" in words_of(plot_damage_growth, results, folder)
    figure = plot_nodes(results, SimpleNamespace(save=lambda figure: figure))
    one_time = list(figure.axes[-1].get_xticks()) == [results.table("node_TOP")["time"][0]]
    assert one_time == (num_times == 1)
    titles = {plot["title"] for plot in plots(results)}
    assert titles >= {"Energies", "Damaged volume", "Displacements of TOP, relative to the base"}


def test_a_run_without_energies_has_no_picture_of_them(folder):
    write_energies(folder, {}, 4)
    assert plot_energy(SiResults(folder), Sheet(folder / "picture")) == []


def test_openings_have_the_name_of_the_joint(folder):
    """Names of files have letters a to z, digits, '_', '-' and '.' alone, byte by byte."""
    assert as_file_word("FUGE Ü 1") == "FUGE____1"
    write_openings(folder, "FUGE____1", [(1, 0.1 * k, 1e-3) for k in range(4)])
    write_openings(folder, "A_B", [(1, 0.1 * k, 1e-3) for k in range(4)])
    summary = json.loads((folder / "job.json").read_text())
    summary["joints"] = {"FUGE Ü 1": {}, "A B": {}, "A_B": {}}
    (folder / "job.json").write_text(json.dumps(summary))
    results = SiResults(folder)
    text = words_of(plot_openings, results, folder)
    assert "Opening of joint FUGE Ü 1" in text
    assert "Opening of joint A_B" in text  # two joints could have this name
    assert "Opening of joint FUGE Ü 1" in {plot["title"] for plot in plots(results)}


def test_displacements_have_the_name_of_the_set(folder):
    write_nodes(folder, "K__RPER_CREST", {40: 0.01})
    with h5py.File(folder / "job.h5", "a") as file:
        file["sets/nodes/KÖRPER CREST"] = np.array([40])
    results = SiResults(folder)
    assert "KÖRPER CREST, node 40" in words_of(plot_nodes, results, folder)
    titles = {plot["title"] for plot in plots(results)}
    assert "Displacements of KÖRPER CREST, relative to the base" in titles


def test_joints_without_openings_are_left_out(folder):
    """*JOINT PRINT of tractions alone."""
    write_openings(folder, "J1", [(1, 0.1 * k, 1e5) for k in range(4)], "tn")
    results = SiResults(folder)
    assert plot_openings(results, Sheet(folder / "picture")) == []
    assert not any("J1" in plot["title"] and plot["curves"] for plot in plots(results))


def test_points_without_a_value_come_last(folder):
    """A joint that is not there yet has no opening."""
    rows = [(1, 0.1 * k, "") for k in range(4)]
    write_openings(folder, "J1", rows)
    text = (folder / "job_joint_J1.csv").read_text()
    more = [
        f"1,1,{0.1 * k},{point},0,0,0,{1e-3 * point}" for k in range(4) for point in range(2, 9)
    ]
    (folder / "job_joint_J1.csv").write_text(text + "\n".join(more) + "\n")
    found = words_of(plot_openings, SiResults(folder), folder)
    assert "point 8 " in found
    assert "point 1 " not in found


def test_a_static_step_between_motions_is_a_gap(folder):
    """Steps: a motion, natural modes, a motion, a static step, a motion."""
    procedures = ("DYNAMIC", "FREQUENCY", "DYNAMIC", "STATIC", "DYNAMIC")
    with h5py.File(folder / "job.h5", "a") as file:
        for number, procedure in enumerate(procedures, start=1):
            step = file.require_group(f"steps/{number:04d}")
            step.attrs["name"], step.attrs["procedure"] = f"S{number}", procedure
    step = np.array([1, 1, 3, 3, 4, 4, 5, 5])
    table = {"step": step, "time": np.arange(8.0)}
    rows = np.arange(8)
    time, values = Span(SiResults(folder), {1, 3, 5}).curve(table, rows, 10.0 * rows)
    assert time == pytest.approx([0, 1, 2, 3, np.nan, 6, 7], nan_ok=True)
    assert values == pytest.approx([0, 10, 20, 30, np.nan, 60, 70], nan_ok=True)
    time, _ = Span(SiResults(folder), {4}).curve(table, rows, 10.0 * rows)
    assert time.tolist() == [4.0, 5.0]


def test_a_table_that_is_not_whole_is_named(folder, capsys):
    """No traceback, by plot and by report."""
    write_openings(folder, "J1", [(1, 0.1, 1e-3)])
    with (folder / "job_joint_J1.csv").open("a") as file:
        file.write("1,2,0.2\n")
    for main in (plot.main, report.main):
        assert main([str(folder)]) == 2
        assert "job_joint_J1.csv:3: 3 values, expected 8" in capsys.readouterr().err


def test_fields_that_are_not_whole_are_named(folder, capsys):
    """Zeros over the names of a group."""
    content = (folder / "job.h5").read_bytes()
    (folder / "job.h5").write_bytes(content.replace(b"HEAP", b"\0\0\0\0"))
    assert plot.main([str(folder)]) == 2
    assert "job.h5" in capsys.readouterr().err


def test_energies_of_one_increment_begin_at_zero(folder):
    """Work and strain differ by round-off alone: that is not the scale."""
    write_energies(folder, {"external": 0.426, "strain": 0.426 * (1.0 + 1e-13)}, 1)
    text = words_of(plot_energy, SiResults(folder), folder)
    assert ">0.0</text>" in text
