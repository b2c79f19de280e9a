"""Points of joints whose histories are printed."""

from __future__ import annotations

import numpy as np

from .mesh_data import BrickMesh

PLACES = ("CREST", "MIDDLE", "BASE")


def joint_nodes(mesh: BrickMesh, name: str) -> np.ndarray:
    """Nodes of the master side of joint elements, or of the slave surface; no shared node."""
    if name in mesh.joint_sets:
        elements = mesh.joints[mesh.joint_sets[name]]
        is_free = elements[:, :4] != elements[:, 4:]
        return np.unique(elements[:, :4][is_free])
    return mesh.surface_nodes(mesh.surface_joints[name][0])


def name_joint_points(mesh: BrickMesh) -> None:
    """Sets JOINTn_HISTORY: upstream and downstream edge at crest, mid-height and base.

    The base is the lowest row of nodes that has an opening of its own, for the row below is
    that of the rock.
    """
    for name in mesh.joint_names:
        nodes = joint_nodes(mesh, name)
        z = mesh.x[nodes, 2]
        rows = np.unique(z.round(6))
        base = rows[min(1, len(rows) - 1)] if name in mesh.surface_joints else rows[0]
        wanted = (rows[-1], rows[np.argmin(np.abs(rows - 0.5 * (rows[-1] + rows[0])))], base)
        found = []
        for row in wanted:
            at = nodes[np.abs(z - row) < 1e-5]
            found += [at[np.argmin(mesh.x[at, 1])], at[np.argmax(mesh.x[at, 1])]]
        mesh.node_sets[f"{name}_HISTORY"] = np.unique(found)
