"""Words and order in pictures: titles, places, joints, ranges, fractiles, modes."""

import h5py
import numpy as np
import pytest
from keyway_tools import pictures_curves
from keyway_tools.colour_scale import Scales
from keyway_tools.picture_style import Sheet, headline, new_figure, plt
from keyway_tools.pictures_faces import place_of
from keyway_tools.result_files import natural
from keyway_tools.results import Results
from keyway_tools.si_results import SiResults


def test_joints_are_counted_not_spelled(tmp_path):
    names = [f"JOINT{k}" for k in range(1, 12)]
    assert sorted(sorted(names), key=natural) == names
    with h5py.File(tmp_path / "job.h5", "w") as file:
        for name in names:
            file.create_group(f"joints/{name}")
    for name in names:
        (tmp_path / f"job_joint_{name}.csv").write_text("time\n0\n")
    (tmp_path / "job_2_energy.csv").write_text("")
    found = Results(tmp_path, "job")
    assert found.joint_names() == names
    assert found.tables()[1:] == [f"joint_{name}" for name in names]


def test_places_in_large_and_small_bodies():
    assert place_of(np.array([450043.4321, -1e-9, 16.6667]), 300.0) == "(450043.4, 0, 16.667) m"
    assert place_of(np.array([4e-6, -1e-14, 0.0]), 1e-5) == "(4e-06, 0, 0) m"


def test_titles_fit_their_figure(tmp_path):
    figure, _ = new_figure(width=9.0)
    height = figure.get_figheight()
    headline(figure, "Section\n" + "a step with a long name, " * 8 + "x" * 150)
    title = figure.texts[0] if figure.texts else figure._suptitle
    assert title.get_window_extent().width <= figure.bbox.width
    assert title.get_text().replace("\n", " ").split()[-1] == "x" * 150
    assert figure.get_figheight() > height
    plt.close(figure)


@pytest.mark.parametrize("height", [3.0, 30.0])  # [inches]
def test_the_note_lies_below_the_axes(tmp_path, monkeypatch, height):
    kept = []
    monkeypatch.setattr(plt, "close", kept.append)
    figure, axis = new_figure(row_height=height)
    axis.set_xlabel("along [m]" + 60 * " ")
    Sheet(tmp_path / "tall", note="deck.inp · date · Keyway").save(figure)
    monkeypatch.undo()
    (note,) = figure.texts
    assert note.get_window_extent().y1 < axis.xaxis.label.get_window_extent().y0
    assert note.get_window_extent().y0 > 0.0
    plt.close(figure)


def test_a_shared_range_is_called_shared():
    values = np.array([0.0, 5.0e6])
    assert Scales(shared={"S1": 3.0}).limits("S1", values).remark == "range shared by all runs"
    assert Scales({"S1": 2.0}, shared={"S1": 3.0}).limits("S1", values).remark == "range as given"
    assert not Scales(shared={"S1": 6.0}).limits("S1", values).remark


def test_displacements_of_months_and_of_seconds_have_own_columns(tmp_path, monkeypatch):
    with h5py.File(tmp_path / "job.h5", "w") as file:
        for number, procedure in enumerate(("STATIC", "DYNAMIC"), 1):
            group = file.create_group(f"steps/{number:04d}")
            group.attrs["name"], group.attrs["procedure"] = f"S{number}", procedure
    rows = [(1, 2.0 * k) for k in range(1, 7)] + [(2, 12.0 + 0.01 * k) for k in range(1, 31)]
    text = "\n".join(f"{step},7,{time},0.001,0.002,{time}" for step, time in rows)
    (tmp_path / "job_node_TOP.csv").write_text(f"step,node,time,U1,U2,U3\n{text}\n")
    kept = []
    monkeypatch.setattr(Sheet, "save", lambda _, figure: kept.append(figure) or [])
    pictures_curves.plot_nodes(SiResults(tmp_path, "job"), Sheet(tmp_path / "u"))
    titles = [axis.get_title(loc="left") for axis in kept[0].axes[:2]]
    assert [title.rpartition(", ")[2] for title in titles] == ["static steps", "motion"]
    spans = [np.ptp(axis.lines[0].get_xdata()) for axis in kept[0].axes[:2]]
    assert spans[0] == 10.0
    assert 0.28 < spans[1] < 0.3
    plt.close(kept[0])
