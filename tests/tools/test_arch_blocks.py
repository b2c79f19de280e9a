"""Dams whose blocks have meshes of their own: one body, faces that lie on each other, symmetry."""

import numpy as np
import pytest
from keyway_tools.arch_blocks import BlockOptions, build_block_dam
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_lattice import PartMesh
from keyway_tools.arch_shape import ArchShape
from keyway_tools.mesh_quality import corner_jacobians, find_faults, volumes
from keyway_tools.surface_fit import Fit, check_fit, facets_of, fit, fit_report, pairs_of

CELLS = DamOptions(num_arc=16, num_height=7, num_thick=2, num_bottom=2)
THREE, FOUR = PartMesh(3, 3), PartMesh(4, 4)
CASES = {
    "2:1": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR),
    "3:2": BlockOptions(refine=2, fine=(2,), fine_mesh=THREE),
    "sides 3:2": BlockOptions(refine=2, fine=(1, 3), fine_mesh=THREE),
    "upper third": BlockOptions(refine=2, fine=(2,), fine_mesh=FOUR, fine_above=0.66),
    # its lower part ends where the block meets the rock: in wedges
    "upper part from the rock on": BlockOptions(
        refine=2, fine=(2,), fine_mesh=FOUR, fine_above=0.3
    ),
    "shifted": BlockOptions(refine=2, fine=(2,), fine_mesh=PartMesh(2, 2, 0.5)),
    "all shifted": BlockOptions(refine=2, fine=(1, 2, 3), fine_mesh=PartMesh(2, 2, 0.5)),
    "chain 3:2": BlockOptions(refine=2, fine=(2,), fine_mesh=THREE, join="chain"),
    "equal, on surfaces": BlockOptions(refine=2, join="surfaces"),
    "all fine, tied": BlockOptions(refine=2, fine=(1, 2, 3), fine_mesh=THREE),
}


@pytest.fixture(params=CASES, scope="module")
def case(request):
    options = CASES[request.param]
    return options, build_block_dam(ArchShape(), CELLS, options)


def volume_of(mesh, name):
    return volumes(mesh)[mesh.brick_sets[name]].sum()


def test_mesh_is_valid(case):
    _, mesh = case
    assert find_faults(mesh) == []
    assert np.nanmin(corner_jacobians(mesh)) > 0.0


def test_all_meshes_fill_the_same_body(case):
    """The cells are trilinear; shifted levels cut the kinks between cells by centimetres."""
    options, mesh = case
    cells = build_block_dam(ArchShape(), CELLS, BlockOptions(refine=1))
    is_shifted = options.fine_mesh.shift != 0.0
    apart = volume_of(mesh, "DAM") / volume_of(cells, "DAM") - 1.0
    assert abs(apart) < (1e-4 if is_shifted else 1e-12)
    same = volume_of(build_block_dam(ArchShape(), CELLS, BlockOptions(refine=2)), "ROCK")
    assert volume_of(mesh, "ROCK") == pytest.approx(same, rel=1e-12)


def test_faces_lie_on_each_other(case):
    """To round-off of coordinates of 200 m; bases of shifted end blocks cut kinks of the rock."""
    options, mesh = case
    cuts_kinks = 1 in options.fine and options.fine_mesh.shift != 0.0
    for slave, master in pairs_of(mesh).values():
        found = fit(mesh, slave, master)
        assert found.slave_area == pytest.approx(
            found.master_area, rel=1e-3 if cuts_kinks else 1e-4
        )
        assert found.largest_distance < (0.2 if cuts_kinks else 1e-9)


def test_faces_have_opposite_normals(case):
    """Outward normals of slave and master are opposite."""
    _, mesh = case

    def normal(surface):
        facets = facets_of(mesh, surface)
        return np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1]).sum(axis=0)

    for slave, master in pairs_of(mesh).values():
        one, other = normal(slave), normal(master)
        assert one @ other < -0.999 * np.linalg.norm(one) * np.linalg.norm(other)


@pytest.mark.parametrize(
    "found", [Fit(100.0, 97.0, 0.0), Fit(100.0, 100.0, np.nan), Fit(100.0, 100.0, 1.0)]
)
def test_sides_that_do_not_fit_are_refused(found):
    check_fit("LIFT2", Fit(100.0, 99.0, 0.4))
    with pytest.raises(ValueError, match="LIFT2: its two sides do not fit: areas 100 and"):
        check_fit("LIFT2", found)


def test_a_face_without_area_is_refused():
    mesh = build_block_dam(ArchShape(), CELLS, CASES["upper part from the rock on"])
    surface = mesh.ties["LIFT2"][1]
    mesh.surfaces[surface] = [(brick, 5) for brick, _ in mesh.surfaces[surface]]
    with pytest.raises(ValueError, match="LIFT2: its two sides do not fit"):
        fit_report(mesh)


def test_chain_stands_on_the_coarse_face():
    mesh = build_block_dam(ArchShape(), CELLS, CASES["chain 3:2"])
    assert len(mesh.quads) == len(mesh.joints) > 0
    assert not set(mesh.quads.ravel()) & set(mesh.bricks.ravel())
    for name, (quads, surface) in mesh.interfaces.items():
        own = set(mesh.quads[mesh.quad_sets[quads]].ravel())
        pair = mesh.joints[mesh.joint_sets[name.replace("IFACE", "JOINT")]]
        assert own == set(pair[:, 4:].ravel())
        assert np.array_equal(mesh.x[pair[:, :4]], mesh.x[pair[:, 4:]])
        assert surface in mesh.surfaces


@pytest.mark.parametrize("name", [name for name in CASES if name != "equal, on surfaces"])
def test_left_mirrors_right_to_the_last_bit(name):
    mesh = build_block_dam(ArchShape(), CELLS, CASES[name])

    def corner_sets(sign):
        turned = mesh.x * np.array([sign, 1.0, 1.0]) + 0.0
        return {frozenset(map(tuple, turned[nodes].tolist())) for nodes in mesh.bricks}

    assert corner_sets(1.0) == corner_sets(-1.0)
    names = list(mesh.surface_joints)
    if names:
        left, right = (mesh.surface_joints[name] for name in names)
        for one, other in zip(left, right, strict=True):
            turned = facets_of(mesh, one) * np.array([-1.0, 1.0, 1.0])
            places = [{tuple(p) for p in f.reshape(-1, 3).tolist()} for f in (turned,)]
            assert places[0] == {tuple(p) for p in facets_of(mesh, other).reshape(-1, 3).tolist()}


def test_one_element_a_cell_is_the_classical_dam():
    classical = build_arch_dam(ArchShape(), DamOptions())
    mesh = build_block_dam(ArchShape(), DamOptions(), BlockOptions())

    def bricks_of(mesh):
        return {tuple(map(tuple, mesh.x[nodes].tolist())) for nodes in mesh.bricks}

    assert bricks_of(mesh) == bricks_of(classical)
    assert len(mesh.joints) == len(classical.joints)
    assert mesh.ties == mesh.surface_joints == {}


def test_blocks_that_differ_from_the_rock_are_tied():
    mesh = build_block_dam(ArchShape(), CELLS, CASES["2:1"])
    assert list(mesh.ties) == ["BASE2"]
    tied = set(mesh.surface_nodes("BASE2_DAM"))
    assert not tied & set(mesh.surface_nodes("BASE2_ROCK"))
    whole = build_block_dam(ArchShape(), CELLS, CASES["all fine, tied"])
    assert list(whole.ties) == ["BASE1", "BASE2", "BASE3"]
    bases = [whole.surface_nodes(f"BASE{block}_DAM") for block in (1, 2, 3)]
    assert len(np.unique(np.concatenate(bases))) == sum(map(len, bases))  # none tied twice


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"fine": (4,)}, "fine blocks must lie in 1..3"),
        ({"fine": (2,), "join": "matching"}, "need equal meshes"),
        ({"fine": (1,), "fine_above": 0.3}, "meets the rock at level"),
        ({"join": "glue"}, "join must be one of"),
        ({"slave": "left"}, "slave must be fine or coarse"),
    ],
)
def test_impossible_blocks_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        build_block_dam(ArchShape(), CELLS, BlockOptions(**options))
