"""Pictures of made-up results: every kind appears, is named and is not blank."""

import contextlib
import io
import shutil

import h5py
import imageio_ffmpeg
import matplotlib.image
import numpy as np
import PIL.Image
import pytest
from keyway.commands import plot
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_shape import ArchShape
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.colour_scale import FIELDS, Scales, parse_ranges
from keyway_tools.dam_views import Faces
from keyway_tools.picture_style import COLOURS, GREY, Sheet, new_figure, plt
from keyway_tools.pictures_damage import worst_element
from keyway_tools.pictures_faces import _marks, plot_envelope, plot_face_openings
from keyway_tools.pictures_joints import (
    JointView,
    last_slips,
    plot_joint_areas,
    plot_joint_slips,
    ranges_of,
)
from keyway_tools.pictures_material import Curve, _damage_panel
from keyway_tools.pictures_shapes import masses_in_words
from keyway_tools.results import Results, find_jobs
from keyway_tools.shared_scales import shared_scales
from keyway_tools.si_results import SiResults, Units
from synthetic_results import write_results

KINDS = {
    "envelope_s1",
    "envelope_s3",
    "envelope_u",
    "envelope_damaget",
    "envelope_damagec",
    "envelope_opening",
    "envelope_opening_joints",
    "section_s1",
    "section_s3",
    "slip_joints",
    "state_joints",
    "damage",
    "damage_growth",
    "deformed",
    "modes",
    "openings",
    "displacements",
    "energy",
}


@pytest.fixture(scope="module")
def dam_results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dam")
    mesh = build_arch_dam(
        ArchShape(), DamOptions(num_arc=14, num_height=6, num_thick=2, num_bottom=2)
    )
    write_results(folder, mesh)
    return folder


@pytest.fixture(scope="module")
def names(dam_results):
    """Paths of the pictures of the dam, as the tool prints them."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert plot.main([str(dam_results)]) == 0
    return text.getvalue().split()


def kinds_of(names, job="job"):
    return {name.split("/")[-1].removeprefix(f"{job}_").removesuffix(".png") for name in names}


def test_every_picture_of_a_dam_is_made_and_named(names):
    assert kinds_of(names) == KINDS
    for name in names:
        image = matplotlib.image.imread(name)[..., :3]
        assert image.shape[0] > 200
        assert image.std() > 0.02


def test_faces_show_colours(names):
    path = next(name for name in names if name.endswith("job_envelope_s1.png"))
    image = matplotlib.image.imread(path)[..., :3]
    is_coloured = np.ptp(image, axis=2) > 0.2
    assert is_coloured.mean() > 0.02


def test_damage_is_the_mean_of_an_elements_points(dam_results):
    time, damage = Results(dam_results, "job").damage("DAMAGET")
    assert time == 0.2
    assert damage.max() <= 1.0
    assert (damage > 0.7).any()
    assert (damage == 0.0).any()
    assert Results(dam_results, "job").damage("DAMAGEC") is None


def test_dam_and_rock_are_distinguished(dam_results):
    results = Results(dam_results, "job")
    types = results.element_types[results.dam]
    assert set(types) == {"C3D8"}
    assert len(results.dam) < len(results.solids)


def test_body_without_water_or_joints(tmp_path, capsys):
    mesh, _ = box_mesh((2, 2, 10), stretched((1.0, 1.0, 10.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh, "column")
    assert plot.main([str(tmp_path), "-o", str(tmp_path / "pictures")]) == 0
    found = kinds_of(capsys.readouterr().out.split(), "column")
    assert found == {kind for kind in KINDS if "joints" not in kind and "section" not in kind} - {
        "envelope_opening",
        "openings",
    }


def test_folder_without_results_is_refused(tmp_path, capsys):
    assert plot.main([str(tmp_path)]) == 2
    assert "no job.h5" in capsys.readouterr().err
    assert find_jobs(tmp_path) == []


def test_one_singular_corner_does_not_set_the_scale():
    """A field of 1 MPa with one node of 50 MPa: bands to 1 MPa, and the picture says why."""
    stress = np.linspace(0.0, 1.0e6, 1000)
    stress[7] = 50.0e6
    usual = Scales().limits("S1", stress)
    assert usual.ends == (0.0, 1.0)
    assert "99 %" in usual.remark
    assert Scales(is_full=True).limits("S1", stress).ends == (0.0, 50.0)
    assert Scales({"S1": 3.0}).limits("S1", stress).ends == (0.0, 3.0)
    assert Scales().limits("S3", -stress).ends == (-1.0, 0.0)
    assert Scales().limits("S1", stress[8:]).remark == ""
    assert Scales().limits("DAMAGET", stress / 1e8).ends == (0.0, 1.0)


def test_words_of_ranges():
    scales, is_shared = parse_ranges(["shared", "S3=-4", "opening=20"])
    assert is_shared
    assert scales.given == {"S3": 4.0, "OPENING": 20.0}
    for wrong in ("S9=3", "S1=x", "S1=0", "half"):
        with pytest.raises(ValueError, match="expected"):
            parse_ranges([wrong])


def test_runs_share_a_range(dam_results, tmp_path):
    small = tmp_path / "small"
    mesh, _ = box_mesh((2, 2, 10), stretched((1.0, 1.0, 10.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(small, mesh)
    both = [SiResults(small), SiResults(dam_results)]
    scales = shared_scales(both, Scales())
    assert scales.shared["S1"] == pytest.approx(3.0)
    assert scales.shared["OPENING"] == pytest.approx(5.0)
    assert "DAMAGET" not in scales.shared
    slips = [last_slips(results)[0].values() for results in both]
    largest = max((slip.max() for one in slips for slip in one), default=0.0)
    assert largest > 0.0
    assert scales.shared["SLIP"] == pytest.approx(1e3 * largest)


def test_marks_and_notes_name_extreme_place_deck_and_date(dam_results, tmp_path):
    """What is written on a picture: taken from an SVG whose letters are text."""
    results = SiResults(dam_results)
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        sheet = Sheet(tmp_path / "s1", ("svg", "pdf"), results.note)
        files = plot_envelope(Faces(results), results.steps()[0], "S1", Scales(), sheet)
    assert [file.name for file in files] == ["s1.svg", "s1.pdf"]
    text = files[0].read_text()
    assert "made_up.inp" in text
    assert results.date in text
    assert "3 MPa" in text
    assert f", {results.x[:, 2].max():.5g}) m" in text
    assert files[1].read_bytes().startswith(b"%PDF")
    assert masses_in_words(np.array([0.0, 9.0e8, 1.0e6])) == "y 900, z 1 kt"


def test_marks_are_the_extremes_of_faces_in_job_json(dam_results):
    """Nodes of the crest between the faces are seen from both sides and belong to neither."""
    faces = Faces(SiResults(dam_results))
    for title, name in (("Upstream face", "upstream"), ("Downstream face", "downstream")):
        shown = faces.shown_on(title)
        assert len(shown) > 10
        assert faces.results.face_flags(name)[shown].all()


def test_means_of_points_are_named(dam_results, tmp_path, monkeypatch):
    """job.json has the extremes of the points themselves: a picture of means must not deny them."""
    results = SiResults(dam_results)
    step = results.steps()[0]
    step.envelopes["S1_POINT"] = step.envelopes["S1"]
    monkeypatch.setattr(results, "envelope_time", lambda *_: np.zeros(len(results.x)))
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        sheet = Sheet(tmp_path / "points", ("svg",), results.note)
        (file,) = plot_envelope(Faces(results), step, "S1_POINT", Scales(), sheet)
    text = file.read_text()
    assert "extreme of the means 3" in text
    assert "mean of the points around a node [MPa]" in text


def test_cracks_without_damage_are_not_called_undamaged(dam_results):
    """A law without *CONCRETE TENSION DAMAGE cracks and keeps its damage variable at zero."""
    results = SiResults(dam_results)
    faces = Faces(results)
    damage = np.zeros(len(results.connectivity))
    assert worst_element(faces, damage, "DAMAGET") == "no damage"
    results.summary["damage"] = {"dissipated": {"cracking": 5.0, "crushing": 0.0}}
    assert worst_element(faces, damage, "DAMAGET").startswith("0, though solids have cracked")
    assert worst_element(faces, damage, "DAMAGEC") == "no damage"
    damage[faces.elements[-1]] = 0.131
    faces.elements = faces.elements[:-1]  # a part of the dam
    text = "no damage in the part that is drawn, elsewhere up to 0.131"
    assert worst_element(faces, damage, "DAMAGET") == text


@pytest.mark.parametrize("kind", ["mp4", "gif"])
def test_film_shows_every_saved_state(tmp_path, kind, capsys):
    mesh, _ = box_mesh((1, 1, 4), stretched((1.0, 1.0, 4.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh, "column", num_saved=4)
    assert plot.main([str(tmp_path), "--animate", kind]) == 0
    film = tmp_path / f"column_motion.{kind}"
    assert capsys.readouterr().out.split() == [str(film)]
    if kind == "gif":
        with PIL.Image.open(film) as images:
            assert images.n_frames == 4
    else:
        assert imageio_ffmpeg.count_frames_and_secs(str(film))[0] == 4


def test_units_of_a_deck(tmp_path):
    """Results in mm and MPa become m and Pa; the effective mass is in tonnes there."""
    mesh, _ = box_mesh((1, 1, 4), stretched((1.0, 1.0, 4.0)))
    mesh.brick_sets["COLUMN"] = np.arange(len(mesh.bricks))
    write_results(tmp_path, mesh)
    raw, si = SiResults(tmp_path), SiResults(tmp_path, units=Units.parse("mm,MPa"))
    assert np.allclose(1e3 * si.x, raw.x)
    assert np.allclose(si.steps()[0].envelopes["S1"], 1e6 * raw.steps()[0].envelopes["S1"])
    energy = [one.history("energy")["external"][-1] for one in (raw, si)]
    assert energy[1] == pytest.approx(1e-3 * energy[0])  # N mm
    assert si.effective_mass()[0, 1] == pytest.approx(1e3 * raw.effective_mass()[0, 1])
    assert plot.main([str(tmp_path), "--units", "mm,MPa", "-o", str(tmp_path / "p")]) == 0
    with pytest.raises(SystemExit):
        plot.main([str(tmp_path), "--units", "mm"])


def test_perimetral_joint_is_drawn_in_plan():
    """A V whose sides hide each other in elevation; an upright plane is drawn in elevation."""
    v = np.array(
        [[-50, 0, 50], [0, 0, 0], [50, 0, 50], [-50, 9, 50], [0, 9, 0], [50, 9, 50]], float
    )
    triangles = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]])
    assert not JointView(v, triangles).is_upright
    assert JointView(v[:, [1, 0, 2]] * [0.01, 1.0, 1.0], np.array([[0, 1, 2]])).is_upright


CURVE = "leg,increment,time,E11,S11,E12,S12,DAMAGET,work,stored,fracture,crushing,iterations\n"


def write_curve(path, peak):
    rows = [(i, 1e-5 * i, peak * min(1.0, i / 5), 0.0, 0.0, 0.04 * i) for i in range(20)]
    lines = [
        f"1,{i},{i},{e},{s},{e12},{s12},{d},{e * s},{0.5 * e * s},{d},0,1\n"
        for i, e, s, e12, s12, d in rows
    ]
    path.write_text(CURVE + "".join(lines))


def test_material_curves_beside_measured_points(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("keyway_tools.pictures_material.COMPONENTS", ("11", "12"))
    write_curve(tmp_path / "dam_material_A.csv", 2e6)
    write_curve(tmp_path / "dam_material_B.csv", 3e6)
    (tmp_path / "points.csv").write_text("# measured, 1985\nstrain,stress\n1e-4,2.5e6\n2e-4,1e6\n")
    curves = [str(tmp_path / f"dam_material_{name}.csv") for name in "AB"]
    picture = tmp_path / "pictures" / "both.png"
    points = ["-e", str(tmp_path / "points.csv")]
    assert plot.main(["material", *curves, *points, "-o", str(picture)]) == 0
    assert capsys.readouterr().out.split() == [str(picture)]
    image = matplotlib.image.imread(picture)[..., :3]
    assert image.std() > 0.02
    assert plot.main(["material", curves[0]]) == 0
    assert (tmp_path / "dam_material_A.png").exists()


def test_words_of_the_damage_panel_lie_over_no_curve():
    figure, axis = new_figure(1, 4.0, 3.0)
    share = np.linspace(0.0, 1.0, 6)
    table = {"E11": share - 0.5, "DAMAGET": share, "DAMAGEC": 1.0 - share}
    _damage_panel(axis, [Curve("A", table, "11")])
    figure.canvas.draw()
    top = axis.transData.transform((0.0, 1.0))[1]
    assert axis.get_legend().get_window_extent().y0 > top
    plt.close(figure)


def test_words_of_the_damage_panel_have_the_colour_of_their_curve():
    """Grey stands for the colours of several curves."""
    share = np.linspace(0.0, 1.0, 6)
    one = Curve("A", {"E11": share, "DAMAGET": share}, "11")
    both = Curve("B", {"E11": share, "DAMAGET": share, "DAMAGEC": share}, "11")
    for curves, wanted in (
        ([one], [COLOURS[0]]),
        ([one, both], [GREY, COLOURS[1]]),
    ):
        figure, axis = new_figure(1, 4.0, 3.0)
        _damage_panel(axis, curves)
        assert [line.get_color() for line in axis.get_legend().get_lines()] == wanted
        plt.close(figure)


def test_material_file_that_is_no_curve_is_refused(tmp_path, capsys):
    (tmp_path / "job_node_TOP.csv").write_text("time,node,U1\n0,1,2\n1,1,2\n")
    assert plot.main(["material", str(tmp_path / "job_node_TOP.csv")]) == 2
    assert "no column work" in capsys.readouterr().err


def test_upright_joints_share_one_scale():
    """Each joint is drawn from its lowest to its highest corner, a short one beside a tall one; a
    wide one beside a narrow one has the same scale."""
    corners = np.array([[0.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 20.0, 1.0], [0.0, 0.0, 1.0]])
    tall, short = (JointView(corners * [1.0, s, z]) for s, z in ((1.0, 200.0), (3.0, 30.0)))
    flat = JointView(corners[:, [1, 1, 0]] * [1.0, 0.5, 1.0])
    for order in ([tall, short, flat], [flat, short, tall]):
        for view in (tall, short):
            along, up = ranges_of(view, order)
            assert up[0] < 0.0
            assert up[1] > 200.0
            assert along[1] > 60.0
        assert ranges_of(tall, order) == ranges_of(short, order)
        assert ranges_of(flat, order)[1][1] < 20.0


def test_round_off_is_no_slip(tmp_path, dam_results):
    """A slip of 2e-14 m in a dam of 100 m has no map, one of a hundredth of a millimetre has."""
    for size, count in ((2e-14, 0), (1e-5, 1)):
        folder = tmp_path / str(count)
        shutil.copytree(dam_results, folder, ignore=shutil.ignore_patterns("*.png"))
        with h5py.File(folder / "job.h5", "r+") as file:
            for saved in file["steps/0001/increments"].values():
                for joint in saved["joints"].values():
                    joint["slip"][:] *= size / 0.03
        sheet = Sheet(folder / "slip")
        assert len(plot_joint_slips(SiResults(folder), Scales(), sheet)) == count


@pytest.mark.parametrize("factor", [0.0, 1.0])
def test_round_off_is_no_opening(tmp_path, dam_results, factor):
    """Openings of 1e-18 m have no picture; beside larger ones on the other face, no mark."""
    shutil.copytree(dam_results, tmp_path / "run", ignore=shutil.ignore_patterns("*.png"))
    with h5py.File(tmp_path / "run" / "job.h5", "r+") as file:
        opening = file["steps/0001/envelopes/OPENING_MAX"]
        is_down = file["faces/downstream"][:] > 0
        opening[:] = np.where(is_down, factor * opening[:], 0.0) + 1e-18
    results = SiResults(tmp_path / "run")
    faces, step = Faces(results), results.steps()[0]
    marks = _marks(faces, 1e3 * step.envelopes["OPENING"], FIELDS["OPENING"])
    assert list(marks) == (["Downstream face"] if factor else [])
    sheet = Sheet(tmp_path / "opening")
    if not factor:
        assert plot_face_openings(faces, step, Scales(), sheet) == []
        assert plot_joint_areas(results, step, Scales(), sheet) == []
