"""A picture of a dam's mesh in its valley."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista as pv

from .mesh_data import BrickMesh
from .render_dam import PIXELS, solid_grid

BLOCKS = ("#8FB3CC", "#C9DAE6")  # neighbours between joints
ROCK = "#CDBFA8"


def block_of_brick(mesh: BrickMesh) -> np.ndarray:
    """Number of the block, from the left, that each of the dam's bricks belongs to."""
    dam = mesh.bricks[mesh.brick_sets["DAM"]]
    block = np.zeros(len(dam), dtype=int)
    centre = mesh.x[dam].mean(axis=1)
    faces = [mesh.joints[members[0], :4] for members in mesh.joint_sets.values()]
    faces += [mesh.face_nodes(*mesh.surfaces[one][0]) for one, _ in mesh.surface_joints.values()]
    for nodes in faces:
        face = mesh.x[nodes]
        normal = np.cross(face[1] - face[0], face[3] - face[0])
        block += (centre - face[0]) @ normal * np.sign(normal[0]) > 0.0
    return block


def picture_mesh(mesh: BrickMesh, path: Path) -> Path:
    """Dam and rock from upstream and above; blocks between joints in alternating colours."""
    plotter = pv.Plotter(off_screen=True, window_size=PIXELS)
    plotter.set_background("white")
    look = {
        "show_edges": True,
        "edge_color": "#404040",
        "edge_opacity": 0.5,
        "ambient": 0.2,
        "diffuse": 0.75,
    }
    dam = mesh.bricks[mesh.brick_sets["DAM"]]
    block = block_of_brick(mesh)
    for number in range(block.max() + 1):
        body = solid_grid(mesh.x, dam[block == number])
        plotter.add_mesh(body, color=BLOCKS[number % 2], **look)
    if "ROCK" in mesh.brick_sets:
        plotter.add_mesh(
            solid_grid(mesh.x, mesh.bricks[mesh.brick_sets["ROCK"]]), color=ROCK, **look
        )
    x = mesh.x if "ROCK" in mesh.brick_sets else mesh.x[np.unique(dam)]
    middle = 0.5 * (x.min(axis=0) + x.max(axis=0))
    extent = float(np.ptp(x, axis=0).max())
    plotter.camera_position = [middle + extent * np.array([-0.75, -1.55, 1.15]), middle, (0, 0, 1)]
    plotter.camera.zoom(1.0)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(path)
    plotter.close()
    return path
