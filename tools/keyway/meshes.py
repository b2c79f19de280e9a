"""Fields of job.h5 on PyVista meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import h5py
import numpy as np
from keyway_tools.result_files import as_array
from keyway_tools.results import Results

if TYPE_CHECKING:
    import pyvista as pv


@dataclass(frozen=True)
class SavedFields:
    """An increment of which fields are saved."""

    step: int  # from 1
    increment: int
    time: float  # total time [s]
    fields: tuple[str, ...]
    path: str  # of the group in job.h5


def saved_fields(results: Results) -> list[SavedFields]:
    """All increments with saved fields, in their order."""
    found = []
    for number in sorted(results.file["steps"]):
        increments = results.file[f"steps/{number}"].get("increments", {})
        for key in sorted(increments):
            group = increments[key]
            names = tuple(name for name, item in group.items() if isinstance(item, h5py.Dataset))
            time = float(np.ravel(group.attrs["time"])[0])
            found.append(SavedFields(int(number), int(key), time, names, group.name))
    return found


def nearest(saved: list[SavedFields], time: float | None, step: int | None) -> SavedFields:
    """The increment nearest to a time, of a step if one is named; without a time the last one.

    Raises LookupError where no fields are saved.
    """
    chosen = [one for one in saved if step is None or one.step == step]
    if not chosen:
        where = "" if step is None else f" in step {step}"
        raise LookupError(f"no fields are saved{where}; request them with *NODE FILE or *EL FILE")
    if time is None:
        return chosen[-1]
    return min(chosen, key=lambda one: abs(one.time - time))


def bare_mesh(results: Results) -> pv.UnstructuredGrid:
    """The solids: all nodes of the deck as points; numbers of nodes, elements and materials."""
    from keyway_tools.render_dam import solid_grid

    solids = results.solids
    grid = solid_grid(results.x, results.connectivity[solids])
    grid.point_data["NODE_ID"] = results.node_id
    grid.cell_data["ELEMENT_ID"] = results.element_id[solids]
    grid.cell_data["MATERIAL"] = results.file["mesh/material"][:][solids] + 1
    return grid


def mesh_with_fields(results: Results, saved: SavedFields) -> pv.UnstructuredGrid:
    """The solids with the fields of an increment."""
    grid = bare_mesh(results)
    group = results.file[saved.path]
    for name in saved.fields:
        grid.point_data[name] = group[name][:]
    for name, data in group.get("elements", {}).items():
        grid.cell_data[name] = data[:][results.solids]
    _add_stage(grid, results, saved.step)
    grid.field_data["TIME"] = [saved.time]
    return grid


def _add_stage(grid: pv.UnstructuredGrid, results: Results, step: int) -> None:
    """The step in which each solid was added, 0 where it is absent; in decks with stages."""
    stage = results.stage(step)
    if stage is not None:
        grid.cell_data["STAGE"] = stage[results.solids]


def mesh_with_envelopes(results: Results, step: int | None) -> pv.UnstructuredGrid:
    """The solids with the envelopes of a step. Raises LookupError where there are none."""
    groups = {int(key): group["envelopes"] for key, group in results.file["steps"].items()
              if len(group.get("envelopes", ()))}  # fmt: skip
    if not groups or (step is not None and step not in groups):
        where = "" if step is None else f" of step {step}"
        raise LookupError(f"no envelopes{where}; request them with *ENVELOPE")
    grid = bare_mesh(results)
    step = max(groups) if step is None else step
    _add_stage(grid, results, step)
    for name, data in groups[step].items():
        if len(data) == len(results.x):
            grid.point_data[name] = data[:]
        else:
            grid.cell_data[name] = data[:][results.solids]
    return grid


def mesh_with_modes(results: Results) -> pv.UnstructuredGrid:
    """The solids with mode shapes MODE_01, ... Raises LookupError where there are none."""
    modes = results.modes()
    if modes is None:
        raise LookupError("no modes; request them with a *FREQUENCY step")
    grid = bare_mesh(results)
    for number, shape in enumerate(modes[1], 1):
        grid.point_data[f"MODE_{number:02d}"] = shape
    grid.field_data["HZ"] = modes[0]
    return grid


def joint_mesh(results: Results, saved: SavedFields, joint: str) -> pv.PolyData:
    """The points of a joint with opening, slip, traction and state in an increment.

    Raises LookupError for a joint that is not there, or without saved openings.
    """
    import pyvista as pv

    if joint not in results.joint_names():
        known = ", ".join(results.joint_names()) or "none"
        raise LookupError(f"no joint '{joint}'; the model has: {known}")
    group = results.file[saved.path].get(f"joints/{joint}")
    if group is None:
        raise LookupError(f"no openings of '{joint}' are saved; request OPENING with *NODE FILE")
    place = results.file[f"joints/{joint}"]
    cloud = pv.PolyData(np.array(place["x"][:], dtype=float))
    cloud.point_data["area"] = place["area"][:]
    for name, data in group.items():
        cloud.point_data[name] = as_array(data[:])
    cloud.field_data["TIME"] = [saved.time]
    return cloud
