"""Dams with parabolic arches of variable thickness, joints at places, and outlets."""

import re

import make_dam
import numpy as np
import pytest
from keyway_tools.arch_blocks import BlockOptions, build_block_dam
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_lattice import PartMesh
from keyway_tools.arch_shape import ArchShape
from keyway_tools.arch_size import scaled, unknowns_of
from keyway_tools.joint_points import name_joint_points
from keyway_tools.mesh_quality import corner_jacobians, find_faults, volumes
from keyway_tools.outlets.options import OutletOptions, spans_of
from keyway_tools.surface_fit import facets_of, fit, pairs_of
from scipy.integrate import dblquad, quad

SHAPE = ArchShape(
    height=306.5, crest_arc=563.77, crest_thickness=16.0, base_thickness=57.0,
    abutment_thickening=1.15625, arches="parabolic", crest_angle=93.0, base_radius_ratio=0.55,
    bottom_width=60.0,
)  # fmt: skip
CELLS = DamOptions(num_arc=34, num_height=14, num_thick=2, num_bottom=4, num_joints=6)
OUTLETS = OutletOptions(
    count=3, block=4, width=6.0, sill=220.0, roof=240.0, pier_length=18.0, pier_top=258.0,
    corbel_depth=18.0,
)  # fmt: skip
FINE = BlockOptions(fine=(4,), fine_mesh=PartMesh(2, 4), fine_above=0.55, join="auto-chain")
PIERCED = BlockOptions(**{**FINE.__dict__, "outlets": OUTLETS})


@pytest.fixture(scope="module")
def solid():
    return build_block_dam(SHAPE, CELLS, FINE)


@pytest.fixture(scope="module")
def pierced():
    return build_block_dam(SHAPE, CELLS, PIERCED)


def volume_of(mesh):
    return volumes(mesh)[mesh.brick_sets["DAM"]].sum()


def exact_volume(shape):
    """Integral in polar coordinates about the axis: far t - t^2 / 2 is that of r dr over t."""

    def area(angle, z):
        t = shape.thickness(z, angle)
        return float(shape.upstream_distance(angle, z) * t - 0.5 * t**2)

    found, _ = dblquad(area, 0.0, shape.height, 0.0, shape.abutment_angle, epsrel=1e-9)
    return 2.0 * found


@pytest.mark.parametrize("arches", ["circular", "parabolic"])
def test_volume_tends_to_the_integral(arches):
    """Flat facets cut chords: second order, so that halving the elements leaves a quarter."""
    shape = ArchShape(**{**SHAPE.__dict__, "arches": arches})
    exact, apart = exact_volume(shape), []
    for n in (1, 2):
        dam = DamOptions(num_arc=36 * n, num_height=16 * n, num_bottom=4 * n, rock=None)
        apart.append(volume_of(build_arch_dam(shape, dam)) / exact - 1.0)
    assert abs(apart[1]) < 2e-3
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.15)


def test_parabolic_crest_has_its_length_and_its_planes():
    half = SHAPE.crest_half_width
    length, _ = quad(lambda x: np.hypot(1.0, x / SHAPE.crest_radius), -half, half)
    assert length == pytest.approx(SHAPE.crest_arc, rel=1e-12)
    end = SHAPE.abutment_angle(SHAPE.height)
    assert 2.0 * SHAPE.crest_position(end) == pytest.approx(SHAPE.crest_arc, rel=1e-12)
    # the plane of the end is normal to the parabola there, whose slope is x / R
    assert np.tan(end) == pytest.approx(half / SHAPE.crest_radius, rel=1e-12)
    point = SHAPE.point(0.3, 100.0, 1.0)
    rise = point[1] - SHAPE.upstream_crown(100.0)
    assert rise == pytest.approx(point[0] ** 2 / (2.0 * SHAPE.upstream_radius(100.0)), rel=1e-12)


def test_the_thickness_grows_to_the_abutment():
    end = SHAPE.abutment_angle(SHAPE.height)
    assert SHAPE.thickness(SHAPE.height) == 16.0
    assert SHAPE.thickness(SHAPE.height, end) == pytest.approx(18.5, rel=1e-12)
    edges = [SHAPE.point(end, SHAPE.height, share) for share in (0.0, 1.0)]
    assert np.linalg.norm(edges[0] - edges[1]) == pytest.approx(18.5, rel=1e-12)


def test_joints_stand_nearest_to_their_places():
    places = (60.0, 200.0, 563.77 - 200.0, 563.77 - 60.0)
    options = DamOptions(num_arc=60, num_height=20, num_bottom=6, num_joints=4, joint_places=places)
    mesh = build_arch_dam(SHAPE, options)
    assert mesh.joint_names == ["JOINT1", "JOINT2", "JOINT3", "JOINT4"]
    for name, place in zip(mesh.joint_names, places, strict=True):
        x = mesh.x[mesh.node_sets[f"{name}_CREST"][1], 0]
        along = np.sign(x) * SHAPE.curve.arc(abs(x), SHAPE.crest_radius) + 0.5 * SHAPE.crest_arc
        assert abs(along - place) < 0.6 * SHAPE.crest_arc / 60


def test_mesh_with_outlets_is_valid(pierced):
    assert find_faults(pierced) == []
    assert np.nanmin(corner_jacobians(pierced)) > 0.0
    for members in (*pierced.node_sets.values(), *pierced.surfaces.values()):
        assert len(members) > 0
    for slave, master in pairs_of(pierced).values():
        found = fit(pierced, slave, master)
        assert found.slave_area == pytest.approx(found.master_area, rel=1e-12)
        assert found.largest_distance < 1e-11  # [m], round-off of coordinates of 300 m


def test_meshes_differ_at_the_block_with_outlets_alone(pierced):
    assert sorted(pierced.interfaces) == ["IFACE3", "IFACE4"]
    assert len(pierced.joint_sets) == 6
    assert list(pierced.ties) == ["LIFT4"]
    for quads, surface in pierced.interfaces.values():
        own = pierced.x[pierced.quads[pierced.quad_sets[quads]]]
        fine = facets_of(pierced, surface)
        assert len(fine) > len(own)
        span = [np.ptp(corners.reshape(-1, 3), axis=0) for corners in (own, fine)]
        assert span[0] == pytest.approx(span[1], rel=1e-12)


def test_outlets_remove_and_add_what_they_should(solid, pierced):
    """By the levels of 10.95 m and the columns of the block, of which the outlets take spans_of."""
    crest = solid.node_sets["JOINT3_CREST"], solid.node_sets["JOINT4_CREST"]
    ends = [solid.x[nodes, 0].mean() for nodes in crest]
    centre = facets_of(solid, "UPSTREAM").mean(axis=1)
    is_top = (centre[:, 2] > 306.5 - 10.0) & (centre[:, 0] > ends[0]) & (centre[:, 0] < ends[1])
    columns = int(is_top.sum())
    spans = spans_of(3, 6.0, float(ends[1] - ends[0]), columns)
    open_columns = sum(b - a for a, b in spans)
    built = columns - (2 if spans[0][0] > 1 else 0)
    step = 306.5 / 28
    sill, roof, top, corbel = (round(z / step) for z in (220.0, 240.0, 258.0, 202.0))
    removed = open_columns * (roof - sill) * 4
    added = (built - open_columns) * (top - sill) * 3 + built * (sill - corbel) * 3
    assert len(solid.brick_sets["DAM"]) - len(pierced.brick_sets["DAM"]) == removed - added
    for face in ("UPSTREAM", "DOWNSTREAM"):
        fewer = len(solid.surfaces[face]) - len(pierced.surfaces[face])
        assert fewer == open_columns * (roof - sill)


def test_outlets_are_symmetric(pierced):
    points = {tuple(point) for point in pierced.x.tolist()}
    assert {(-x if x else 0.0, y, z) for x, y, z in points} == points


@pytest.mark.parametrize(("count", "columns"), [(1, 4), (2, 6), (3, 8), (4, 20), (5, 16), (5, 40)])
def test_outlets_fill_their_block_symmetrically(count, columns):
    spans = spans_of(count, 6.0, 80.0, columns)
    assert len(spans) == count
    edges = [0, *(edge for span in spans for edge in span), columns]
    assert np.diff(edges).min() >= 1
    assert [columns - edge for edge in reversed(edges)] == edges
    if columns == 40:  # two metres an element: three for each outlet but the middle one
        assert {b - a for a, b in spans} <= {2, 3, 4}


def test_histories_name_both_edges_at_three_heights(pierced):
    name_joint_points(pierced)
    nodes = pierced.node_sets["JOINT4_HISTORY"]
    z = np.unique(pierced.x[nodes, 2])
    assert len(nodes) == 6
    assert len(z) == 3
    assert z[-1] == 306.5
    joint = pierced.joints[pierced.joint_sets["JOINT4"]]
    assert set(nodes) <= set(joint[:, :4][joint[:, :4] != joint[:, 4:]])


SMALL = ["--height", "306.5", "--crest-arc", "563.77", "--arc", "34", "--levels", "14",
         "--bottom", "4", "--thick", "2", "--joints", "6", "--fine", "4", "--fine-above", "0.55",
         "--join", "auto-chain", "--base-radius-ratio", "0.7"]  # fmt: skip


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--outlets", "3", "--outlet-block", "2"], "expected --fine 2 with a --fine-above"),
        (["--outlets", "3", "--fine-above", "0"], "expected a larger --fine-above"),
        (["--outlets", "3", "--joints", "0"], "block 1 of 1 is not between two joints"),
        (
            ["--outlets", "3", "--outlet-roof", "400"],
            "--outlet-roof 400: expected at most the heig",
        ),
        (["--outlets", "9"], "9 outlets need an even number of elements"),
        (["--outlets", "3", "--outlet-width", "60"], "do not fit into a block"),
        (["--outlets", "3", "--outlet-sill", "100"], "sill"),
        (
            ["--outlets", "3", "--outlet-sill", "175", "--outlet-roof", "190"],
            "a smaller --fine-above",
        ),
        (["--fine", "4:a"], "--fine takes B"),
        (["--joint-places", "1", "2", "3"], "1 m is too near an end of the crest"),
        (["--abutment-thickening", "9"], "--abutment-thickening 9: expected a number of 0.5 to 3"),
        (["--concrete-cards", "nowhere.inp"], "there is no file of cards"),
    ],
)
def test_impossible_outlets_are_reported(tmp_path, capsys, options, message):
    if options[:3] == ["--outlets", "3", "--outlet-sill"] and len(options) == 4:
        options = [*options, "--outlet-roof", "90"]
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), *SMALL, *options]) == 2
    assert message in capsys.readouterr().err


def test_a_number_of_unknowns_is_met_from_above(tmp_path, capsys):
    options = ["-o", str(tmp_path / "x.inp"), *SMALL, "--outlets", "3", "--unknowns", "12000"]
    assert make_dam.main(options) == 0
    unknowns = int(capsys.readouterr().out.split(" unknowns")[0].split()[-1])
    # two elements through the thickness become three: half as much again
    assert 12000 <= unknowns < 18000


@pytest.fixture
def builds(monkeypatch):
    """The dams that the tool builds."""
    seen = []

    def build(shape, dam, options):
        seen.append(dam)
        return build_block_dam(shape, dam, options)

    monkeypatch.setattr(make_dam, "build_block_dam", build)
    return seen


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--outlets", "3", "--outlet-width", "60"], "do not fit into a block"),
        (["--fine", "2", "--fine-above", "0.1"], "block 2 meets the rock"),
    ],
)
def test_faults_that_no_mesh_mends_end_at_once(tmp_path, capsys, builds, options, message):
    words = ["-o", str(tmp_path / "x.inp"), *SMALL, *options, "--unknowns", "12000"]
    assert make_dam.main(words) == 2
    assert message in capsys.readouterr().err
    assert len(builds) <= 1


def test_faults_that_a_finer_mesh_mends_go_on(tmp_path, capsys, builds):
    """Nine outlets need 20 elements across their block; the smallest mesh with them is noted."""
    words = ["-o", str(tmp_path / "x.inp"), *SMALL, "--outlets", "9", "--outlet-width", "4"]
    assert make_dam.main([*words, "--unknowns", "100"]) == 0
    said = capsys.readouterr().out
    assert (
        "note: --unknowns 100: this is the smallest mesh; in a coarser one 9 outlets need" in said
    )
    assert max(dam.num_arc for dam in builds) < 200


def test_the_smallest_mesh_is_noted(tmp_path, capsys):
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), "--unknowns", "10"]) == 0
    said = capsys.readouterr().out
    assert "330 unknowns" in said
    assert "note: --unknowns 10: this is the smallest mesh, with 0.25 of the elements" in said


COUNTED = {
    "lift, base and chains": [*SMALL, "--outlets", "3"],
    "bases alone": ["--arc", "16", "--levels", "7", "--bottom", "2", "--thick", "2", "--refine",
                    "2", "--fine", "1", "3", "--fine-refine", "3", "--fine-thick", "3"],
    "fixed abutment": ["--arc", "20", "--levels", "8", "--thick", "2", "--joints", "3", "--fine",
                       "2", "--fine-above", "0.5", "--no-rock", "--height", "80", "--crest-arc",
                       "300"],
}  # fmt: skip


@pytest.mark.parametrize("name", COUNTED)
def test_unknowns_are_those_of_the_program(tmp_path, capsys, keyway, name):
    deck = tmp_path / "x.inp"
    assert make_dam.main(["-o", str(deck), *COUNTED[name]]) == 0
    counted = int(capsys.readouterr().out.split(" unknowns")[0].split()[-1])
    run = keyway(deck, "--check")
    found = re.search(r"^ *unknowns +(\d+)$", run.stdout, re.MULTILINE)
    assert int(found[1]) == counted


def test_scaling_keeps_proportions():
    twice = scaled(CELLS, 2.0)
    assert (twice.num_arc, twice.num_height, twice.num_thick, twice.num_bottom) == (68, 28, 4, 8)
    assert unknowns_of(build_arch_dam(SHAPE, twice)) > 4 * unknowns_of(build_arch_dam(SHAPE, CELLS))


def test_law_of_concrete_stands_in_its_material(tmp_path):
    cards = tmp_path / "law.inp"
    cards.write_text("** a comment\n*CONCRETE DAMAGED PLASTICITY\n32.5\n")
    deck = tmp_path / "x.inp"
    assert make_dam.main(["-o", str(deck), *SMALL, "--concrete-cards", str(cards)]) == 0
    text = deck.read_text()
    assert "0.167\n*CONCRETE DAMAGED PLASTICITY\n32.5\n*SOLID SECTION, ELSET=DAM" in text
    assert "S1, S3, U, OPENING, S1_POINT, S3_POINT, DAMAGET" in text
