"""Pictures of a dam that is built in stages: absent elements are not drawn."""

from __future__ import annotations

from types import SimpleNamespace

import h5py
import matplotlib.image
import numpy as np
import pytest
from keyway.commands import plot
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.dam_views import Faces
from keyway_tools.picture_style import Sheet
from keyway_tools.pictures_joints import plot_joint_states
from keyway_tools.pictures_stages import changing_steps, plot_stages
from keyway_tools.si_results import SiResults
from synthetic_results import write_results

LEVEL = 80.0  # [m] the upper lift begins


@pytest.fixture
def staged(tmp_path):
    """A dam whose upper lift is absent in the first of two steps; its joints are bonded."""
    return write_stages(tmp_path, 1.0)


def write_stages(folder, scale):
    """Its results; the heights are scaled."""
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=1, num_bottom=2, rock=None)
    )
    mesh.x[:, 2] *= scale
    write_results(folder, mesh)
    with h5py.File(folder / "job.h5", "a") as file:
        count = len(file["mesh/element_id"])
        upper = np.zeros(count, dtype=bool)
        upper[: len(mesh.bricks)] = mesh.x[mesh.bricks, 2].mean(axis=1) > scale * LEVEL
        file["steps/0001/stage"] = np.where(upper, 0, 1)
        file["steps/0002/stage"] = np.where(upper, 2, 1)
        for group in file["steps/0001/increments"].values():
            for name in group["joints"]:
                z = file[f"joints/{name}/x"][:, 2]
                group[f"joints/{name}/grouted"] = np.where(z > scale * LEVEL, 0, 2)
    return folder


def wait_for_grout(folder):
    """The upper points of the joints wait for their grout in the first step."""
    with h5py.File(folder / "job.h5", "a") as file:
        for group in file["steps/0001/increments"].values():
            for joint in group["joints"].values():
                joint["grouted"][:] = np.maximum(joint["grouted"][:], 1)


def test_absent_elements_are_not_drawn(staged):
    results = SiResults(staged, "job")
    whole, lower = Faces(results), Faces(results, 1)
    assert results.x[whole.nodes, 2].max() == 135.5
    assert results.x[lower.nodes, 2].max() < 100.0
    assert lower.joint_lines().points[:, 2].max() < 100.0
    assert list(lower.views) == list(whole.views)
    assert len(Faces(results, 2).elements) == len(whole.elements)
    assert lower.at("/steps/0002/increments/000001/U").nodes.size == whole.nodes.size


def test_every_picture_is_made_with_absent_elements(staged, capsys):
    assert plot.main([str(staged)]) == 0
    names = capsys.readouterr().out.split()
    assert any(name.endswith("job_stages.png") for name in names)
    assert any(name.endswith("job_damage.png") for name in names)


def figure_of(folder):
    """The figure of the stages, drawn."""
    sheet = SimpleNamespace(save=lambda figure: figure)
    figure = plot_stages(Faces(SiResults(folder, "job")), sheet)
    figure.canvas.draw()
    return figure


def test_stages_show_grouted_joints(staged):
    wait_for_grout(staged)
    results = SiResults(staged, "job")
    assert changing_steps(results) == [1, 2]
    file = plot_stages(Faces(results), Sheet(staged / "stages"))[0]
    image = matplotlib.image.imread(file)[..., :3]
    orange = (image[..., 0] > 0.7) & (image[..., 2] < 0.2) & (image[..., 1] < 0.5)
    assert orange.sum() > 50


def write_grouting(folder, log):
    """Three steps: the points of all joints wait, wait, are bonded; modes between the last two."""
    with h5py.File(folder / "job.h5", "a") as file:
        del file["steps/0001/stage"]
        file.move("steps/0002", "steps/0003")
        del file["steps/0003/stage"]
        names = list(file["joints"])
        for key in ("0002", "0004"):
            file.copy("steps/0001", f"steps/{key}")
        for key, grouted in (("0001", 1), ("0002", 1), ("0004", 2)):
            for group in file[f"steps/{key}/increments"].values():
                for joint in group["joints"].values():
                    joint["grouted"][:] = grouted
    cards = [log.format(joint=name.lower()) for name in names]
    steps = ["", "\n".join(cards), "", ""]
    echo = "".join(f"*STEP, NAME=S{k}\n{text}\n*END STEP\n" for k, text in enumerate(steps, 1))
    (folder / "job.log").write_text(f"*HEADING\n{echo}step 1  increment 1  time 1\n")
    return SiResults(folder, "job")


PRESSED = ["*GROUT, JOINT={joint}, PRESSURE=3e5", "*GROUT, JOINT={joint},\n  PRESSURE=3e5"]


@pytest.mark.parametrize("card", PRESSED)
def test_grout_with_pressure_hardens_at_the_end_of_its_step(staged, card):
    """job.h5 shows it in the step after it: the step of the grout has a panel, not the next."""
    assert changing_steps(write_grouting(staged, card)) == [1, 2]


def test_grout_without_pressure_is_not_shown_before_its_step(staged):
    """job.h5 shows it in its own step: the step before has no panel."""
    assert changing_steps(write_grouting(staged, "*GROUT, JOINT={joint}, PRESSURE=0")) == [1, 4]
    (staged / "job.log").unlink()
    assert changing_steps(SiResults(staged, "job")) == [1, 4]


def test_joints_that_open_before_their_grout_do_not_hide_the_motion(staged):
    """All points wait for their grout, and are open, in the step before the earthquake."""
    with h5py.File(staged / "job.h5", "a") as file:
        file.move("steps/0001", "steps/0003")
        file.copy("steps/0003", "steps/0001")
        file["steps/0001"].attrs["procedure"] = "STATIC"
        for step, grouted in (("0001", 1), ("0003", 2)):
            for number, group in file[f"steps/{step}/increments"].items():
                group.attrs["time"] = float(step) + 0.1 * int(number)
                for joint in group["joints"].values():
                    joint["grouted"][:] = grouted
                    if grouted == 1:
                        joint["state"][:] = 0
    assert "State of joints at t = 3.1 s, with most area open\n" in words_of_states(staged)
    with h5py.File(staged / "job.h5", "a") as file:  # open by the weight, after the grout
        for group in file["steps/0001/increments"].values():
            for joint in group["joints"].values():
                joint["grouted"][:] = 2
    assert "at t = 3.1 s, with most area open in a motion\n" in words_of_states(staged)


def test_joints_that_wait_for_their_grout_are_shown_as_such(staged):
    with h5py.File(staged / "job.h5", "a") as file:
        file["steps/0001"].attrs["procedure"] = "STATIC"
        for group in file["steps/0001/increments"].values():
            for joint in group["joints"].values():
                joint["grouted"][:] = 1
    text = words_of_states(staged)
    assert "no joint is open at a saved time" in text
    assert "not grouted yet" in text


def words_of_states(folder):
    """Title and legend of the state of joints."""
    sheet = SimpleNamespace(save=lambda figure: figure)
    figure = plot_joint_states(SiResults(folder, "job"), sheet)
    (legend,) = figure.legends
    return "\n".join([figure.get_suptitle(), *(text.get_text() for text in legend.texts)])


def test_joints_without_grout_are_not_called_grouted(staged):
    """Points that are not there yet do not wait for grout: without *GROUT they come bonded."""
    assert figure_of(staged).legends == []
    wait_for_grout(staged)
    (legend,) = figure_of(staged).legends
    assert [text.get_text() for text in legend.texts] == ["joint, not grouted", "joint, grouted"]


@pytest.mark.parametrize("scale", [0.15, 1.0, 4.0])
def test_words_of_the_colour_bar_have_room(tmp_path, scale):
    """Dams that are low and wide, or tall: the words lie in the picture, and apart."""
    figure = figure_of(write_stages(tmp_path, scale))
    bar = figure.axes[-1]
    label = bar.xaxis.label.get_window_extent()
    ticks = [text.get_window_extent() for text in bar.get_xticklabels()]
    assert bar.xaxis.label.get_text() == "step in which an element was added"
    for box in (label, *ticks):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1
    assert len(ticks) == 2
    assert not ticks[0].overlaps(ticks[1]) and not any(label.overlaps(box) for box in ticks)


def test_steps_have_their_names_as_written(staged):
    titles = [axis.get_title(loc="left") for axis in figure_of(staged).axes[:2]]
    assert titles == ["step 1: EARTHQUAKE", f"step 2: {SiResults(staged, 'job').step_name(2)}"]


def test_a_run_without_stages_has_no_such_picture(tmp_path):
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=1, num_bottom=2, rock=None)
    )
    write_results(tmp_path, mesh)
    results = SiResults(tmp_path, "job")
    assert results.stage(1) is None
    assert plot_stages(Faces(results), Sheet(tmp_path / "stages")) == []
