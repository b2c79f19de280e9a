"""Temperature fields of dams by tools/make_temperature.py."""

from __future__ import annotations

import make_temperature
import matplotlib.image
import numpy as np
import pytest
from keyway_tools.box_mesh import box_mesh, stretched
from keyway_tools.deck_text import mesh_deck
from keyway_tools.temperature.climate import Air, Climate, Level, Water

LENGTH, THICKNESS, HEIGHT = 6.0, 9.0, 30.0  # of the wall, upstream face at y = 0 [m]
WAVE = ["--air", "14", "10"]
WATER = ["--water", "16", "9", "6", "--level", "20"]
DIGITS = 5e-5  # of the file, six figures


@pytest.fixture
def deck(tmp_path):
    """A wall on a block of rock, its mesh in an included file."""
    mesh, number = box_mesh((2, 6, 10), stretched((LENGTH, THICKNESS, HEIGHT)))
    low = np.arange(len(mesh.bricks)).reshape(2, 6, 10)
    mesh.brick_sets = {"DAM": low[:, :, 2:].ravel(), "ROCK": low[:, :, :2].ravel()}
    mesh.surfaces = {
        "UPSTREAM": [(int(b), 3) for b in low[:, 0, 2:].ravel()],
        "DOWNSTREAM": [(int(b), 5) for b in low[:, -1, 2:].ravel()],
    }
    mesh.node_sets = {"WET": number[:, 0, 2:].ravel(), "DRY": number[:, -1, 2:].ravel()}
    mesh.node_sets["CREST"] = number[:, 3, -1]
    mesh.node_sets |= {"SIDE": number[0, :, 2:].ravel(), "FOOT": number[:, :, 2].ravel()}
    types = {"DAM": "C3D8", "ROCK": "C3D8"}
    # sets of bricks must lie in the order of the mesh
    order = np.concatenate(list(mesh.brick_sets.values()))
    rank = np.argsort(order)
    mesh.bricks = mesh.bricks[order]
    mesh.brick_sets = {name: rank[m] for name, m in mesh.brick_sets.items()}
    mesh.surfaces = {n: [(int(rank[b]), f) for b, f in faces] for n, faces in mesh.surfaces.items()}
    (tmp_path / "wall_mesh.inp").write_text(mesh_deck(mesh, types, "A wall"))
    (tmp_path / "wall.inp").write_text(
        "*INCLUDE, INPUT=wall_mesh.inp\n*SURFACE, NAME=ODD\nDAM, S7\n*SURFACE, NAME=BARE\nDAM\n"
    )
    return tmp_path / "wall.inp", mesh


def make(path, *options):
    """Node numbers and values of the file, by time."""
    assert make_temperature.main([str(path), "--no-picture", *options]) == 0
    head, *rows = path.with_name("wall_temperature.csv").read_text().splitlines()
    first, *times = head.split(",")
    assert first == "node"
    table = np.array([[float(word) for word in row.split(",")] for row in rows])
    return {
        float(time): {"node": table[:, 0].astype(int), "value": table[:, k]}
        for k, time in enumerate(times, start=1)
    }


def at(rows, mesh, x):
    """Value at a node of the mesh."""
    node = np.linalg.norm(mesh.x - x, axis=1).argmin() + 1
    return float(rows["value"][rows["node"] == node][0])


def test_faces_have_the_temperature_of_air_and_water(deck):
    """Above and below the level at 20 m; the foot is at 6 m."""
    path, mesh = deck
    field = make(path, *WAVE, *WATER, "--year", "12", "--times", "0", "3", "6.5")
    assert list(field) == [0.0, 3.0, 6.5]
    month = np.array([0.0, 3.0, 6.5])
    water, air = Water(16.0, 9.0, 6.0, 14.0), Air(14.0, 10.0)
    for k, rows in enumerate(field.values()):
        assert at(rows, mesh, (0, THICKNESS, 12)) == pytest.approx(
            air.on_face(month)[k], abs=DIGITS
        )
        assert at(rows, mesh, (0, 0, 27)) == pytest.approx(air.on_face(month)[k], abs=DIGITS)
        for z in (6.0, 12.0):
            wet = water.at(np.array([20.0 - z]), month)[k]
            assert at(rows, mesh, (3, 0, z)) == pytest.approx(wet, abs=DIGITS)
        assert len(rows["node"]) == 3 * 7 * 9  # no rock


def test_zhus_formula():
    """Means at surface and bottom, lags and the fall of the amplitude as in the formula."""
    water = Water(16.0, 9.0, 6.0, 100.0)
    assert water.mean_at(np.array([0.0, 100.0])).tolist() == pytest.approx([16.0, 6.0])
    assert water.lag_at(np.array([0.0, 1e3])).tolist() == pytest.approx([0.85, 2.15])
    assert water.amplitude_at(np.array([50.0]))[0] == pytest.approx(9.0 * np.exp(-0.9))
    warmest = water.at(np.array([0.0]), np.array([6.5 + 0.85, 0.5 + 0.85]))
    assert warmest.ravel().tolist() == pytest.approx([25.0, 7.0])


def test_units_of_time_and_the_month_of_the_start(deck):
    """A year of 12 from January is a year of 365.25 days from April, three months later."""
    path, _ = deck
    months = make(path, *WAVE, "--year", "12", "--times", "3", "7")
    days = make(path, *WAVE, "--year", "365.25", "--start", "3", "--times", "0", "121.75")
    for one, other in zip(months.values(), days.values(), strict=True):
        assert one["value"] == pytest.approx(other["value"], abs=2 * DIGITS)
    seconds = make(path, *WAVE)
    assert len(seconds) == 13
    assert max(seconds) == pytest.approx(31557600.0)
    assert seconds[0.0]["value"] == pytest.approx(seconds[max(seconds)]["value"], abs=2 * DIGITS)


def test_surfaces_and_node_sets_are_the_same_faces(deck):
    path, _ = deck
    one = make(path, *WAVE, *WATER, "--times", "0", "1")
    other = make(
        path, *WAVE, *WATER, "--times", "0", "1", "--upstream", "WET", "--downstream", "dry"
    )
    assert np.array_equal(one[0.0]["value"], other[0.0]["value"])


def test_rock_has_one_temperature(deck):
    """Nodes outside of the dam; those on the contact belong to the dam."""
    path, mesh = deck
    rows = make(path, *WAVE, "--rock", "12.5", "--times", "0", "1")[1.0]
    assert len(rows["node"]) == len(mesh.x)
    assert rows["node"].tolist() == list(range(1, len(mesh.x) + 1))
    below = mesh.x[:, 2] < 5.9
    assert set(rows["value"][below]) == {12.5}
    assert not (rows["value"][~below] == 12.5).any()


def test_the_straight_line_is_one(deck):
    """--linear: equal differences along the thickness, the mean of the field."""
    path, mesh = deck
    rows = make(path, *WAVE, *WATER, "--times", "0", "1", "--linear")[0.0]
    y = np.linspace(0.0, THICKNESS, 7)
    values = np.array([at(rows, mesh, (3, one, 12)) for one in y])
    assert np.abs(np.diff(values, 2)).max() < 4 * DIGITS


def test_a_file_of_one_time_has_no_time(deck):
    path, _ = deck
    assert make_temperature.main([str(path), "--no-picture", *WAVE, "--times", "3"]) == 0
    head = path.with_name("wall_temperature.csv").read_text().splitlines()[0]
    assert head == "node,temperature"


def test_a_level_that_changes():
    """A point between low and high water is dry while the water is low."""
    level = Level.parse(["0:20", "6:10"])
    climate = Climate(Air(14.0, 10.0), Water(16.0, 9.0, 6.0, 14.0), level)
    month = np.array([0.0, 3.0, 6.0, 9.0, 12.0])
    assert level.at(month).tolist() == pytest.approx([20.0, 15.0, 10.0, 15.0, 20.0])
    face = climate.upstream(np.array([14.0]), month)[0]
    assert face[2] == pytest.approx(climate.air.on_face(month)[2])
    assert face[0] == pytest.approx(climate.water.at(np.array([6.0]), month)[0])
    assert not level.is_constant


def test_the_sun_warms_dry_faces_only(deck):
    path, mesh = deck
    plain = make(path, *WAVE, *WATER, "--times", "0", "1")[0.0]
    sunny = make(path, *WAVE, *WATER, "--times", "0", "1", "--sun", "3", "0")[0.0]
    dry, wet = (3, THICKNESS, 12), (3, 0, 12)
    assert at(sunny, mesh, dry) - at(plain, mesh, dry) == pytest.approx(3.0, abs=2 * DIGITS)
    assert at(sunny, mesh, wet) == pytest.approx(at(plain, mesh, wet), abs=2 * DIGITS)


def test_picture_of_four_dates(deck, capsys):
    path, _ = deck
    assert make_temperature.main([str(path), *WAVE, *WATER]) == 0
    picture = path.with_name("wall_temperature.png")
    assert str(picture) in capsys.readouterr().out
    image = matplotlib.image.imread(picture)[..., :3]
    assert (np.ptp(image, axis=2) > 0.3).mean() > 0.02


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--dam", "WALL"], "no set of elements 'WALL'; expected one of DAM, ROCK"),
        (
            ["--upstream", "FACE"],
            "no surface or node set 'FACE'; expected one of BARE, CREST, DOWN",
        ),
        (["--upstream", "CREST"], "'CREST' has no face of the dam's elements"),
        (["--downstream", "UPSTREAM"], "16 faces belong to 'UPSTREAM' (upstream) and 'UPSTREAM'"),
        (
            ["--downstream", "WET"],
            "16 faces belong to 'UPSTREAM' (upstream) and 'WET' (downstream)",
        ),
        (["--downstream", "SIDE"], "8 nodes lie on both faces, as node"),
        (["--downstream", "FOOT"], "3 nodes lie on both faces, as node"),
        (["--downstream", "ODD"], "surface 'ODD': found 'DAM, S7'; expected S1, S2, S3, S4, S5 or"),
        (
            ["--downstream", "BARE"],
            "surface 'BARE': found 'DAM'; expected S1, S2, S3, S4, S5 or S6",
        ),
        (["--level", "20"], "--water and --level belong together"),
        (["--water", "16", "9", "6"], "--water and --level belong together"),
        (["--water", "16", "9", "6", "--level", "5"], "depth of the water: -1 m; expected > 0"),
        (["--water", "16", "-9", "6", "--level", "20"], "amplitude of the water: -9; expected"),
        (["--water", "16", "9", "6", "--level", "low"], "expected one height, or MONTH:HEIGHT"),
        (["--water", "16", "9", "6", "--level", "1:9", "13:8"], "expected different ones, 0 to 12"),
        (["--times", "1", "0"], "expected growing times"),
        (["--harmonics", "500"], "harmonics: 500; expected 1 to 191"),
    ],
)
def test_input_that_cannot_be_used(deck, capsys, options, message):
    path, _ = deck
    assert make_temperature.main([str(path), *WAVE, *options]) == 2
    assert message in capsys.readouterr().err
    assert not path.with_name("wall_temperature.csv").exists()


def test_faces_that_meet_at_the_crest(tmp_path, capsys):
    """A triangular section: the nodes of the edge have the mean of both faces."""
    nodes = "1,0,0,0\n2,1,0,0\n3,1,3,0\n4,0,3,0\n5,0,0,4\n6,1,0,4\n"
    mesh = f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=DAM\n1, 1,2,3,4, 5,6,6,5\n"
    faces = "*NSET, NSET=WET\n1,2,5,6\n*NSET, NSET=DRY\n3,4,5,6\n"
    (tmp_path / "wall.inp").write_text(mesh + faces)
    names = ["--upstream", "WET", "--downstream", "DRY", "--sun", "4", "0"]
    rows = make(
        tmp_path / "wall.inp", *WAVE, *WATER[:4], "--level", "3", *names, "--times", "0", "1"
    )
    assert np.isfinite(rows[0.0]["value"]).all()
    assert "the faces meet at 2 nodes of the crest" in capsys.readouterr().out


def test_water_below_freezing_is_warned_of(deck, capsys):
    """At the surface, where the amplitude is larger than the mean; not where it is smaller."""
    path, _ = deck
    make(path, *WAVE, "--water", "6", "9", "6", "--level", "20")
    assert "warning: the water falls to -3.0 deg C, 0 m below" in capsys.readouterr().err
    make(path, *WAVE, "--water", "16", "9", "10", "--level", "20")
    assert capsys.readouterr().err == ""


def test_a_deck_that_is_not_there(tmp_path, capsys):
    assert make_temperature.main([str(tmp_path / "none.inp"), *WAVE]) == 2
    assert "there is no deck" in capsys.readouterr().err


def test_an_amplitude_below_zero(deck, capsys):
    assert make_temperature.main([str(deck[0]), "--air", "14", "-10"]) == 2
    assert "amplitude of the air: -10; expected >= 0" in capsys.readouterr().err


@pytest.mark.parametrize("by_option", [True, False])
def test_the_axis_that_points_up(deck, by_option):
    """With y up, by --up or by *RESERVOIR, all temperatures are those of the dam with z up."""
    path, mesh = deck
    usual = make(path, *WAVE, *WATER, "--times", "0", "3")
    file = path.with_name("wall_mesh.inp")
    text = file.read_text()
    for number, (x, y, z) in enumerate(mesh.x.tolist(), start=1):
        old = f"\n{number}, {x!r}, {y!r}, {z!r}\n"
        assert old in text
        text = text.replace(old, f"\n{number}, {y!r}, {z!r}, {x!r}\n")
    file.write_text(text)
    if not by_option:
        lake = "*STEP\n*STATIC\n*RESERVOIR, NAME=L, SURFACE=UPSTREAM, LEVEL=20, BED=6, UP=2\n"
        path.write_text(path.read_text() + lake + "*END STEP\n")
    turned = make(path, *WAVE, *WATER, "--times", "0", "3", *(["--up", "2"] if by_option else []))
    for time, rows in usual.items():
        assert turned[time]["value"] == pytest.approx(rows["value"], abs=DIGITS)


def test_a_deck_in_mm_is_refused(deck, capsys):
    path, mesh = deck
    mesh.x *= 1000.0
    types = {"DAM": "C3D8", "ROCK": "C3D8"}
    path.with_name("wall_mesh.inp").write_text(mesh_deck(mesh, types, "mm"))
    assert make_temperature.main([str(path), *WAVE, "--no-picture"]) == 2
    assert "the dam is 24000 high along z; expected lengths in m" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["wall.inp", "wall_mesh.inp"])
def test_the_deck_is_not_overwritten(deck, capsys, name):
    """Neither the deck nor a file that it includes."""
    path, _ = deck
    file = path.with_name(name)
    before = file.read_text()
    assert make_temperature.main([str(path), *WAVE, "-o", str(file)]) == 2
    assert "the output would overwrite the deck" in capsys.readouterr().err
    assert file.read_text() == before


def test_the_picture_does_not_take_the_place_of_the_table(deck, capsys):
    path, _ = deck
    assert make_temperature.main([str(path), *WAVE, "-o", str(path.with_name("wall.png"))]) == 2
    assert "the picture has this name" in capsys.readouterr().err
    assert not path.with_name("wall.png").exists()
