"""A folder of results as a run leaves it, made up from a mesh and smooth fields."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
from keyway_tools.mesh_data import BrickMesh
from keyway_tools.results import ENVELOPE_NAMES

ENERGIES = (
    "step,increment,time,external,kinetic,strain,damping,friction,fracture,crushing,numerical,error"
)
DAMAGES = (
    "step,increment,time,DAMAGET,DAMAGEC,volume_10,volume_50,volume_90,inelastic_volume,"
    "cracking,crushing"
)


SUMMARY = {
    "program": {"name": "Keyway", "version": "0.1.0"},
    "status": "finished",
    "deck": {"file": "somewhere/made_up.inp", "sha256": "0" * 64},
}


def write_results(folder: Path, mesh: BrickMesh, job: str = "job", num_saved: int = 2) -> None:
    """job.json, job.h5 and CSV histories; fields grow with the height."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{job}.json").write_text(json.dumps(SUMMARY))
    with h5py.File(folder / f"{job}.h5", "w") as file:
        _write_mesh(file, mesh)
        _write_points(file, mesh)
        _write_steps(file, mesh, num_saved)
        time = np.linspace(0.0, 1.0, 50)
        table = np.zeros((50, 12))
        table[:, 2] = time
        table[:, 3:6] = 1.0e7 * time[:, None] * np.array([1.0, 0.3, 0.7])
        energy = file.create_dataset("history/energy", data=table)
        energy.attrs["columns"] = ENERGIES
        growth = np.outer(time, [0, 0, 1, 1, 0.2, 50, 30, 10, 90, 2000, 100])
        damage = file.create_dataset("history/damage", data=growth)
        damage.attrs["columns"] = DAMAGES
    _write_histories(folder, mesh, job)


def _write_mesh(file: h5py.File, mesh: BrickMesh) -> None:
    types = ["C3D8"] * len(mesh.bricks) + ["JOINT8"] * len(mesh.joints)
    material = np.full(len(types), -1)
    for number, members in enumerate(mesh.brick_sets.values()):
        material[members] = number
    file["mesh/x"] = mesh.x
    file["mesh/element_id"] = np.arange(1, len(types) + 1)
    file["mesh/node_id"] = np.arange(1, len(mesh.x) + 1)
    file["mesh/element_type"] = np.array(types, dtype="S8")
    file["mesh/connectivity"] = np.concatenate((mesh.bricks, mesh.joints))
    file["mesh/material"] = material
    for name in ("upstream", "downstream"):
        flags = np.zeros(len(mesh.x), dtype=int)
        if name.upper() in mesh.surfaces:
            flags[mesh.surface_nodes(name.upper())] = 1
        file[f"faces/{name}"] = flags
    for name, members in mesh.joint_sets.items():
        _write_cells(file.create_group(f"joints/{name}/cells"), mesh, members)
        points = np.unique(mesh.joints[members][:, 4:])
        file[f"joints/{name}/x"] = mesh.x[points]
        file[f"joints/{name}/area"] = np.ones(len(points))


def _write_cells(group: h5py.Group, mesh: BrickMesh, members: np.ndarray) -> None:
    """The slave face of each JOINT8 element, cut in two: corners on nodes and between them."""
    corners, nodes, weights = [], [], []
    for a, b, c, d in mesh.joints[members][:, 4:]:
        start = len(nodes)
        nodes += [(a, a), (a, b), (d, c), (d, d), (b, b), (c, c)]
        weights += [(0.5, 0.5)] * 6
        corners += [(start, start + 1, start + 2, start + 3)]
        corners += [(start + 1, start + 4, start + 5, start + 2)]
    group["element"] = np.repeat(len(mesh.bricks) + members + 1, 2)
    group["corner"] = np.ravel(corners) + 1
    group["first"] = 4 * np.arange(len(corners) + 1) + 1
    group["node"] = np.ravel(nodes) + 1
    group["weight"] = np.ravel(weights)
    group["first_node"] = 2 * np.arange(len(nodes) + 1) + 1


def _write_points(file: h5py.File, mesh: BrickMesh) -> None:
    """One point in each element."""
    file["points/element"] = np.arange(1, len(mesh.bricks) + 1)
    file["points/volume"] = np.ones(len(mesh.bricks))


def _write_damage(saved: h5py.Group, mesh: BrickMesh) -> None:
    """The elements near the top are cracked."""
    z = mesh.x[mesh.bricks, 2].mean(axis=1)
    cracked = np.flatnonzero(z > 0.7 * mesh.x[:, 2].max())
    saved["points/row"] = cracked
    saved["points/DAMAGET"] = np.clip(z[cracked] / mesh.x[:, 2].max(), 0.0, 1.0)


def _write_steps(file: h5py.File, mesh: BrickMesh, num_saved: int) -> None:
    z = mesh.x[:, 2]
    height = max(z.max(), 1e-9)
    envelopes = {
        "S1": 3.0e6 * z / height,
        "S3": -6.0e6 * (1.0 - z / height),
        "U": 0.05 * z / height,
        "DAMAGET": np.clip(z / height, 0.0, 1.0) ** 8,
        "DAMAGEC": 0.3 * np.clip(1.0 - z / height, 0.0, 1.0) ** 8,
    }
    if mesh.joint_sets:
        opening = np.zeros(len(z))
        opening[mesh.joints] = np.maximum(0.0, 0.01 * (z[mesh.joints] / height - 0.5))
        envelopes["OPENING"] = opening
    step = file.create_group("steps/0001")
    step.attrs["name"], step.attrs["procedure"] = "EARTHQUAKE", "DYNAMIC"
    for field, values in envelopes.items():
        name = ENVELOPE_NAMES[field]
        step[f"envelopes/{name}"] = values
        step[f"envelopes/{name}_TIME"] = np.full(len(z), 4.2)
    for name in ("DAMAGET", "DAMAGEC"):
        means = np.zeros(len(mesh.bricks) + len(mesh.joints))
        means[: len(mesh.bricks)] = envelopes[name][mesh.bricks].mean(axis=1)
        step[f"envelopes/{name}_MEAN_MAX"] = means
    for number in range(1, num_saved + 1):
        saved = step.create_group(f"increments/{number:06d}")
        saved.attrs["time"] = 0.1 * number
        shift = np.zeros_like(mesh.x)
        shift[:, 1] = 0.02 * number * np.clip(z / height, 0.0, None) ** 2
        saved["U"] = shift
        _write_damage(saved, mesh)
        for name, members in mesh.joint_sets.items():
            height_of = z[np.unique(mesh.joints[members][:, 4:])] / height
            saved[f"joints/{name}/slip"] = np.outer(0.01 * number * height_of, [1.0, 0.5])
            saved[f"joints/{name}/state"] = np.where(
                height_of > 0.8, 0, np.where(height_of > 0.5, 2, 1)
            )
    modes = file.create_group("steps/0002")
    modes.attrs["name"], modes.attrs["procedure"] = "MODES", "FREQUENCY"
    modes["modes/effective_mass"] = np.array([[0.0, 9.0e8, 1.0e6], [3.0e8, 0.0, 0.0]])
    modes["modes/hz"] = np.array([2.1, 3.4])
    modes["modes/shape"] = np.stack([shift, shift * np.sign(mesh.x[:, :1])])


def _write_histories(folder: Path, mesh: BrickMesh, job: str) -> None:
    time = np.linspace(0.0, 1.0, 50)
    for name in mesh.joint_sets:
        rows = ["step,increment,time,point,x,y,z,opening,slip1,slip2,tn,t1,t2,state"]
        for n, t in enumerate(time, start=1):
            for point in (1, 2):
                opening = 0.004 * point * np.sin(20.0 * t)
                rows.append(f"1,{n},{t},{point},70.0,{8.0 * point},100.0,{opening},0,0,0,0,0,1")
        (folder / f"{job}_joint_{name}.csv").write_text("\n".join(rows) + "\n")
    rows = ["step,increment,time,node,U1,U2,U3"]
    rows += [f"1,{n},{t},7,{0.01 * t},{0.02 * t},{-0.01 * t}" for n, t in enumerate(time, start=1)]
    (folder / f"{job}_node_CROWN_CREST.csv").write_text("\n".join(rows) + "\n")
