"""The arch dam's mesh: valid bricks, fit of neighbours, symmetry, joints, volume."""

from math import radians

import numpy as np
import pytest
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_rock import RockOptions
from keyway_tools.arch_shape import ArchShape
from keyway_tools.mesh_quality import (
    corner_jacobians,
    find_faults,
    gauss_points,
    jacobians,
    volumes,
)

COARSE = DamOptions(num_arc=14, num_height=6, num_thick=2, num_bottom=2)
CASES = {
    "default": (ArchShape(), DamOptions()),
    "coarse": (ArchShape(), COARSE),
    "sharp valley": (
        ArchShape(bottom_width=0.0),
        DamOptions(num_arc=12, num_height=6, num_bottom=0, num_joints=3),
    ),
    "306.5 m": (
        ArchShape(
            height=306.5,
            crest_arc=563.77,
            crest_thickness=18.5,
            base_thickness=66.0,
            crest_angle=95.0,
            base_radius_ratio=0.55,
        ),
        DamOptions(num_arc=32, num_height=14, num_bottom=4, num_joints=6),
    ),
    "columns within a level": (ArchShape(), DamOptions(num_arc=30, num_height=6, num_bottom=4)),
    "no rock, no joints": (ArchShape(), DamOptions(num_joints=0, rock=None)),
    "shallow rock": (ArchShape(), DamOptions(rock=RockOptions(extent=0.5, num_deep=2))),
}


@pytest.fixture(params=CASES, scope="module")
def mesh(request):
    return build_arch_dam(*CASES[request.param])


def test_every_jacobian_is_positive(mesh):
    assert np.nanmin(corner_jacobians(mesh)) > 0.0
    assert jacobians(mesh, gauss_points()).min() > 0.0
    assert find_faults(mesh) == []


def test_neighbours_share_whole_faces(mesh):
    """Every edge of the exterior belongs to two exterior faces: the surface is closed."""
    # one body again: the slave nodes of the joints become their masters
    whole = np.arange(len(mesh.x))
    whole[mesh.joints[:, 4:]] = mesh.joints[:, :4]
    glued = type(mesh)(mesh.x, whole[mesh.bricks], mesh.joints[:0])
    edges: dict[frozenset[int], int] = {}
    for pairs in glued.exterior_faces().values():
        nodes = glued.face_nodes(*pairs[0])
        for a, b in zip(nodes, np.roll(nodes, -1), strict=True):
            if a != b:
                edges[frozenset((a, b))] = edges.get(frozenset((a, b)), 0) + 1
    assert {count % 2 for count in edges.values()} == {0}


def test_exterior_volume_is_the_sum_of_bricks(mesh):
    """Divergence theorem over the exterior faces: no overlap counted, no hole left inside."""
    total = 0.0
    for pairs in mesh.exterior_faces().values():
        a, b, c, d = mesh.x[mesh.face_nodes(*pairs[0])]
        # flux of x/3 through the bilinear face (inward by the faces' order for S1, as numbered)
        for u in (-1.0, 1.0):
            for v in (-1.0, 1.0):
                r, s = u / np.sqrt(3.0), v / np.sqrt(3.0)
                weights = (
                    np.array(
                        [(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)]
                    )
                    / 4
                )
                d_r = np.array([-(1 - s), 1 - s, 1 + s, -(1 + s)]) / 4
                d_s = np.array([-(1 - r), -(1 + r), 1 + r, 1 - r]) / 4
                corners = np.array([a, b, c, d])
                total -= weights @ corners @ np.cross(d_r @ corners, d_s @ corners) / 3.0
    assert total == pytest.approx(volumes(mesh).sum(), rel=1e-10)


def test_left_mirrors_right_to_the_last_bit(mesh):
    points = {tuple(point) for point in mesh.x.tolist()}
    assert {(-x if x else 0.0, y, z) for x, y, z in points} == points


def test_bricks_mirror_too(mesh):
    def corner_sets(sign):
        turned = mesh.x * np.array([sign, 1.0, 1.0]) + 0.0
        return {frozenset(map(tuple, turned[nodes].tolist())) for nodes in mesh.bricks}

    assert corner_sets(1.0) == corner_sets(-1.0)


def test_joint_faces_coincide_and_end_in_the_rock(mesh):
    for members in mesh.joint_sets.values():
        master, slave = mesh.joints[members, :4], mesh.joints[members, 4:]
        assert np.array_equal(mesh.x[master], mesh.x[slave])
        shared = np.unique(master[master == slave])
        assert set(shared) == set(np.unique(master)) & set(mesh.node_sets["ABUTMENT"])
        assert len(shared) > 1


def test_joint_normals_point_from_master_to_slave(mesh):
    centre = mesh.x[mesh.bricks].mean(axis=1)
    for members in mesh.joint_sets.values():
        for element in mesh.joints[members]:
            a, b, _, d = mesh.x[element[:4]]
            normal = np.cross(b - a, d - a)
            sides = []
            for face in (element[:4], element[4:]):
                owners = [e for e in range(len(mesh.bricks)) if set(face) <= set(mesh.bricks[e])]
                sides.append(min((centre[e] - a) @ normal for e in owners))
            assert sides[0] < 0.0 < sides[1]


def test_upstream_and_downstream_normals_point_outwards(mesh):
    for name, sign in (("UPSTREAM", -1.0), ("DOWNSTREAM", 1.0)):
        for brick, face in mesh.surfaces[name]:
            nodes = mesh.x[mesh.face_nodes(brick, face)]
            outward = nodes.mean(axis=0) - mesh.x[mesh.bricks[brick]].mean(axis=0)
            assert outward[1] * sign > 0.0


def test_dam_has_the_specified_heights_and_thicknesses():
    shape, options = CASES["default"]
    mesh = build_arch_dam(shape, options)
    crown = mesh.x[mesh.node_sets["CROWN"]]
    assert crown[:, 2].max() == shape.height
    for z, thickness in ((shape.height, shape.crest_thickness), (0.0, shape.base_thickness)):
        y = crown[crown[:, 2] == z, 1]
        assert np.ptp(y) == pytest.approx(thickness, rel=1e-12)
    edge = mesh.x[mesh.node_sets["CREST"]]
    edge = edge[
        np.isclose(np.hypot(edge[:, 0], edge[:, 1] - shape.crest_radius), shape.crest_radius)
    ]
    angle = np.arctan2(edge[:, 0], shape.crest_radius - edge[:, 1])
    assert np.ptp(angle) * shape.crest_radius == pytest.approx(shape.crest_arc, rel=1e-12)


def test_volume_converges_to_the_closed_form():
    """A cylinder of constant radius and thickness over a developed V: t (R - t/2) times the area.

    The abutment follows x = R sin(angle) = half width(z), so that the developed area is the
    integral of 2 asin(w(z) / R) dz: with w = w_c z / h it is 2 h (angle + (cos(angle) - 1) /
    sin(angle)), angle the crest's half angle. Chords shorten arcs: the error falls as h^2.
    """
    shape = ArchShape(
        crest_thickness=20.0,
        base_thickness=20.0,
        base_radius_ratio=1.0,
        crest_overhang=0.0,
        bottom_width=0.0,
    )
    angle = radians(shape.crest_angle / 2.0)
    area = 2.0 * shape.height * (angle + (np.cos(angle) - 1.0) / np.sin(angle))
    exact = 20.0 * (shape.crest_radius - 10.0) * area
    errors = []
    for n in (6, 12, 24):
        options = DamOptions(num_arc=2 * n, num_height=n, num_bottom=0, num_joints=0, rock=None)
        errors.append(1.0 - volumes(build_arch_dam(shape, options)).sum() / exact)
    assert abs(errors[-1]) < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize(
    ("shape", "options", "words"),
    [
        ({"height": -1.0}, {}, "--height -1: expected a length above 0"),
        ({"bottom_width": 1000.0}, {}, "--bottom-width 1000: expected 0 or more and below"),
        ({"crest_angle": 0.0}, {}, "--crest-angle 0: expected an angle above 0 and below 160"),
        ({"base_radius_ratio": 0.02}, {}, "does not span the valley"),
        ({}, {"num_arc": 12}, "at least 28 are needed"),
        ({}, {"num_arc": 29}, "must be even"),
        ({}, {"num_joints": 40}, "do not fit"),
        ({"bottom_width": 0.0}, {}, "need a bottom width"),
    ],
)
def test_impossible_dams_are_refused(shape, options, words):
    with pytest.raises(ValueError, match=words):
        build_arch_dam(ArchShape(**shape), DamOptions(**options))
