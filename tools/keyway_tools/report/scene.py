"""The dam as the browser draws it: skin, joints, fields, displacements and modes in few bytes."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib import colormaps
from matplotlib.colors import to_hex

from ..colour_scale import FIELDS, Scales
from ..dam_views import Faces
from ..pictures_joints import joints_with_faces
from ..pictures_shapes import round_factor
from ..si_results import SiResults

MOST_BYTES = 4_000_000  # of displacements, and of modes
MOST_STATES = 200


def scene(results: SiResults, scales: Scales) -> dict[str, Any]:
    """All that the view in space needs."""
    faces = Faces(results)
    stages, stage_of_step = _stages(results, faces)
    skins = [one.surface() for one in stages]
    nodes = np.unique(np.concatenate([_nodes_of(skin) for skin in skins]))
    return {
        "x": packed(results.x[nodes]),
        "skins": [_skin(skin, nodes) for skin in skins],
        "eye": _eye(faces),
        "up": results.up_axis,
        "fields": _fields(results, faces, nodes, scales),
        "states": _states(results, nodes, faces.size, scales, stage_of_step),
        "modes": _modes(results, nodes, faces.size),
        "joints": _joints(results, scales),
    }


def _eye(faces: Faces) -> dict[str, float]:
    """From where the dam is seen first: upstream, aside and above; a slice from its side."""
    view = next(iter(faces.views.values()))
    eye = 1.2 * view.towards
    if len(faces.views) > 1:
        eye = eye + 0.5 * view.right + 0.45 * faces.results.upward
    return dict(zip("xyz", (float(v) for v in eye), strict=True))


def packed(values: np.ndarray, kind: str = "f4") -> dict[str, Any]:
    """An array as base64 of its bytes, the lowest byte first."""
    data = np.ascontiguousarray(values, dtype=f"<{kind}")
    text = base64.b64encode(data.tobytes()).decode("ascii")
    return {"kind": kind, "shape": list(data.shape), "data": text}


def packed_short(values: np.ndarray) -> dict[str, Any]:
    """An array as 16-bit integers times a scale: an error of 1.5e-5 of the largest value."""
    scale = float(np.abs(values).max()) / 32767.0 or 1.0
    return packed(np.rint(values / scale), "i2") | {"scale": scale}


def _stages(results: SiResults, faces: Faces) -> tuple[list[Faces], dict[int, int]]:
    """The complete dam, then the dams with absent elements; which of them each step has."""
    stages, of_mask, of_step = [faces], {}, {}
    for step in results.steps():
        added = results.stage(step.number)
        if added is None or (added[faces.elements] > 0).all():
            of_step[step.number] = 0
            continue
        mask = (added > 0).tobytes()
        if mask not in of_mask:
            of_mask[mask] = len(stages)
            stages.append(Faces(results, step.number))
        of_step[step.number] = of_mask[mask]
    return stages, of_step


def _nodes_of(skin: pv.PolyData) -> np.ndarray:
    """The nodes of the points of a skin."""
    return np.asarray(skin.point_data["vtkOriginalPointIds"])


def _skin(skin: pv.PolyData, nodes: np.ndarray) -> dict[str, Any]:
    """Triangles and sharp edges, both by places in the ascending list of nodes."""
    flat = skin.triangulate()
    triangles = _nodes_of(flat)[flat.faces.reshape(-1, 4)[:, 1:]]
    sharp = skin.extract_feature_edges(feature_angle=40.0)
    pairs = np.zeros((0, 2), dtype=int)
    if sharp.n_points > 0:
        pairs = _nodes_of(sharp)[sharp.lines.reshape(-1, 3)[:, 1:]]
    return {
        "triangles": packed(np.searchsorted(nodes, triangles), "i4"),
        "edges": packed(np.searchsorted(nodes, pairs), "i4"),
    }


def _fields(
    results: SiResults, faces: Faces, nodes: np.ndarray, scales: Scales
) -> list[dict[str, Any]]:
    """The envelopes of the last step that has some."""
    kept = [step for step in results.steps() if step.envelopes]
    if not kept:
        return []
    found = []
    for name in (name for name in FIELDS if name in kept[-1].envelopes and name != "OPENING"):
        values = kept[-1].envelopes[name]
        if not np.isfinite(values[faces.nodes]).any():
            continue
        shown = FIELDS[name]
        limits = scales.limits(name, values[faces.nodes])
        found.append({
            "name": name,
            "label": f"{shown.label} over step {kept[-1].name}",
            "unit": shown.unit,
            "values": packed(np.nan_to_num(shown.scale * values[nodes])),
            "ends": limits.ends,
            "remark": limits.remark,
            "colours": colours_of(shown.colours, limits.bands),
        })  # fmt: skip
    return found


def colours_of(name: str, bands: int) -> list[list[Any]]:
    """A scale of colours in bands."""
    chosen = colormaps[name].resampled(bands)
    found = []
    for k in range(bands):
        colour = to_hex(chosen(k))
        found += [[k / bands, colour], [(k + 1) / bands, colour]]
    return found


def _states(
    results: SiResults,
    nodes: np.ndarray,
    size: float,
    scales: Scales,
    stage_of_step: dict[int, int],
) -> dict[str, Any] | None:
    """Saved displacements, as many as there is room for."""
    saved = sorted(results.displacements(), key=lambda one: one[1])
    if not saved:
        return None
    count = min(len(saved), MOST_STATES, max(2, MOST_BYTES // (6 * len(nodes))))
    chosen = [saved[k] for k in np.unique(np.linspace(0, len(saved) - 1, count).astype(int))]
    u = np.stack([results.displacement(place)[nodes] for place, _ in chosen])
    sizes = np.linalg.norm(u, axis=2)
    largest = float(sizes.max())
    limits = scales.limits("U", sizes)
    return {
        "times": [float(f"{time:.9g}") for _, time in chosen],
        "skins": [stage_of_step[int(place.split("/")[2])] for place, _ in chosen],
        "u": packed_short(u),
        "factor": round_factor(size, largest),
        "ends": limits.ends,
        "colours": colours_of(FIELDS["U"].colours, limits.bands),
    }


def _modes(results: SiResults, nodes: np.ndarray, size: float) -> dict[str, Any] | None:
    """Mode shapes with a largest displacement of one."""
    modes = results.modes()
    if modes is None or len(modes[0]) == 0:
        return None
    hz, shapes = modes
    count = max(1, min(len(hz), MOST_BYTES // (6 * len(nodes))))
    shapes = shapes[:count][:, nodes]
    largest = np.linalg.norm(shapes, axis=2).max(axis=1)
    shapes = shapes / np.where(largest > 0.0, largest, 1.0)[:, None, None]
    mass = results.effective_mass()
    return {
        "hz": [float(value) for value in hz[:count]],
        "mass": [] if mass is None else mass[:count].tolist(),
        "shapes": packed_short(shapes),
        "amplitude": 0.08 * size,
        "colours": colours_of(FIELDS["U"].colours, 20),
    }


def _joints(results: SiResults, scales: Scales) -> dict[str, Any] | None:
    """The faces of all joints with their largest openings over the last step."""
    kept = [step for step in results.steps() if "OPENING" in step.envelopes]
    joints = joints_with_faces(results)
    if not kept or not joints:
        return None
    opening = np.nan_to_num(kept[-1].envelopes["OPENING"])
    x, values, triangles, start = [], [], [], 0
    for joint in joints.values():
        corners = joint.on_corners(results.x)
        x.append(corners)
        values.append(np.maximum(1e3 * joint.on_corners(opening), 0.0))
        triangles.append(joint.triangles + start)
        start += len(corners)
    limits = scales.limits("OPENING", opening)
    return {
        "x": packed(np.vstack(x)),
        "triangles": packed(np.vstack(triangles), "i4"),
        "values": packed(np.concatenate(values)),
        "label": f"{FIELDS['OPENING'].label} over step {kept[-1].name}",
        "ends": limits.ends,
        "colours": colours_of(FIELDS["OPENING"].colours, limits.bands),
    }
