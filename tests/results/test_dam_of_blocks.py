"""Faces and joints of an arch dam whose middle block has a mesh of its own, tied to the rock.

The same dam by joints on surfaces and by the paper's chain. The checks do not depend on the
accuracy: nodes and points of faces, and polygons of joints.
"""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import pyvista
from dam_trials import Trial, mesh_of, run_trial
from harness import Program, Run
from keyway.commands import plot
from keyway_tools.arch_blocks import BlockOptions
from keyway_tools.mesh_data import BrickMesh
from keyway_tools.results import Results

JOINS = {"surfaces": "surfaces", "chain": "elements"}  # the chain's joints are of JOINT8


def trial(join: str) -> Trial:
    """Twice as many elements along each side of the middle block; 0.2 s of motion."""
    return Trial(
        duration=0.2,
        is_coarse=True,
        blocks=BlockOptions(fine=(2,), join=join),
    )


@pytest.fixture(scope="module", params=JOINS)
def join(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def mesh(join: str) -> BrickMesh:
    return mesh_of(trial(join).mesh_key)


@pytest.fixture(scope="module")
def run(join: str, program_path, tmp_path_factory) -> Run:
    return run_trial(Program(program_path, tmp_path_factory.mktemp(join), 2), trial(join))


def free_nodes(mesh: BrickMesh) -> np.ndarray:
    """Nodes of faces that no joint, tie or interface covers and no element shares."""
    joined = set()
    for pair in [*mesh.surface_joints.values(), *mesh.ties.values()]:
        joined |= {face for name in pair for face in mesh.surfaces[name]}
    joined |= {face for _, name in mesh.interfaces.values() for face in mesh.surfaces[name]}
    glued = {frozenset(quad) for side in (slice(4), slice(4, 8)) for quad in mesh.joints[:, side]}
    free = [
        nodes
        for nodes, (pair,) in mesh.exterior_faces().items()
        if pair not in joined and nodes not in glued
    ]
    return np.unique([node for nodes in free for node in nodes])


def test_faces_of_the_dam_are_free(run: Run, mesh: BrickMesh):
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        upstream, downstream = (
            np.flatnonzero(file[f"faces/{name}"][:]) for name in ("upstream", "downstream")
        )
    assert set(upstream) == set(mesh.surface_nodes("UPSTREAM"))
    assert not set(upstream) & set(downstream)
    assert set(downstream) <= set(free_nodes(mesh))
    # The dam has as many nodes on either face: it is meshed through from one to the other.
    assert len(downstream) == len(upstream)


def test_points_on_the_faces_lie_along_the_edges(run: Run, join: str):
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        nodes = file["mesh/x"][:]
        for joint in file["joints"].values():
            x = joint["x"][:]
            levels = len(np.unique(x[:, 2].round(6)))
            for name in ("upstream", "downstream"):
                flagged = x[joint[name][:] == 1]
                assert len(flagged) == levels  # one a level
                on_face = nodes[file[f"faces/{name}"][:] == 1]
                apart = np.linalg.norm(flagged[:, None] - on_face[None], axis=2).min(axis=1)
                assert apart.max() < 1e-6  # printed coordinates
            both = (joint["upstream"][:] == 1) & (joint["downstream"][:] == 1)
            assert not both.any()
    for joint in run.json["joints"].values():
        assert joint["kind"] == JOINS[join]
        for extremes in (joint["opening"], joint["pressure"]):
            assert set(extremes) == {"anywhere", "upstream", "downstream"}
            assert extremes["anywhere"]["value"] >= extremes["upstream"]["value"]


def test_joints_are_drawn_whole(run: Run, mesh: BrickMesh):
    reader = pyvista.PVDReader(run.folder / f"{run.job}_joints.pvd")
    reader.set_active_time_value(reader.time_values[-1])
    surface = reader.read()[0]
    area = surface.compute_cell_sizes()["Area"]
    for number, name in enumerate(sorted(run.json["joints"]), start=1):
        assert area[surface["JOINT"] == number].sum() == pytest.approx(
            run.json["joints"][name]["area"], rel=1e-3  # facets of an arch dam are not quite flat
        )  # fmt: skip
    solid = pyvista.read(sorted((run.folder / f"{run.job}_vtk").glob("dam_[0-9]*.vtu"))[-1])
    opening = {int(n): v for n, v in zip(solid["NODE_ID"], solid["OPENING"], strict=True)}
    on_node = np.flatnonzero(surface["NODE_ID"])
    assert len(on_node) > 0.4 * surface.n_points
    for point in on_node:
        assert surface["OPENING"][point] == pytest.approx(opening[surface["NODE_ID"][point]])
        node = surface["NODE_ID"][point] - 1
        assert surface.points[point] == pytest.approx(mesh.x[node], abs=1e-9)


def test_pictures(run: Run, capsys):
    assert plot.main([str(run.folder)]) == 0
    names = capsys.readouterr().out.split()
    assert any(name.endswith("envelope_opening_joints.png") for name in names)
    results = Results(run.folder, run.job)
    for name in results.joint_names():
        joint = results.joint_faces(name)
        assert joint.triangles.max() < len(joint.first)
        assert len(joint.facets) >= 8
