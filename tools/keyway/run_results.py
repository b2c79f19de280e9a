"""The results of a run."""

from __future__ import annotations

import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from keyway_tools.job_files import job_of_file, table_of
from keyway_tools.results import Results, why_incomplete

from . import frames, meshes

if TYPE_CHECKING:
    import h5py
    import pandas as pd
    import pyvista as pv


def open_run(path: str | os.PathLike[str], job: str | None = None) -> RunResults:
    """Open the results of a run.

    `path` is the folder of the results, one of its files (dam.json, dam.h5, a table, a picture), or
    folder and name of the job (results/dam for results/dam.json). `job` names the job where a
    folder holds several. Raises FileNotFoundError where there are no results, ValueError where a
    folder holds several.
    """
    place = Path(path)
    if place.is_dir():
        return RunResults(Results(place, job))
    found = job_of_file(place) if place.is_file() and place.suffix != ".json" else None
    if found is not None:
        return RunResults(Results(*found))
    name = place.stem if place.is_file() else place.name
    if (place.parent / f"{name}.json").is_file():
        return RunResults(Results(place.parent, name))
    raise FileNotFoundError(f"no results of Keyway in '{place}', and there is no '{place}.json'")


class RunResults:
    """The results of one job; tables and fields are read when they are first asked for.

    Units are those of the deck, tension and opening are positive, `time` is total time. Tables have
    the columns that docs/results.md describes, with a column `time`; meshes hold the solids with
    all nodes of the deck as points, in its order.
    """

    def __init__(self, results: Results):
        self._results = results

    def __repr__(self) -> str:
        return f"<run {self.job} in {self.folder}: {self.status}>"

    @property
    def folder(self) -> Path:
        """The folder of the results."""
        return self._results.folder

    @property
    def job(self) -> str:
        """The name of the job."""
        return self._results.job

    @property
    def summary(self) -> dict[str, Any]:
        """The summary job.json."""
        return self._results.summary

    @property
    def status(self) -> str:
        """'finished', 'stopped', or 'running' (also where the program was killed)."""
        return str(self.summary.get("status", ""))

    @property
    def why_incomplete(self) -> str:
        """Why the run has not finished; '' where it has."""
        return why_incomplete(self.folder, self.job)

    @property
    def file(self) -> h5py.File:
        """The open file job.h5. Raises OSError where there is none or the run still writes it."""
        return self._results.file

    # histories

    @property
    def prints(self) -> list[str]:
        """Names of the tables, as ['energy', 'joint_J1', 'node_CREST']."""
        return self._results.tables()

    def table(self, name: str) -> pd.DataFrame:
        """A table by its name in `prints`: job_NAME.csv. Raises LookupError."""
        known = self.prints
        if name not in known:
            raise LookupError(f"no table '{name}' in {self.folder}; there are: {', '.join(known)}")
        return frames.frame_of(self._results.table(name))

    def node(self, name: str) -> pd.DataFrame:
        """*NODE PRINT of a node set: step, increment, time, node and the fields."""
        return self.table(table_of(self._results, "node", name))

    def element(self, name: str) -> pd.DataFrame:
        """*EL PRINT of an element set: step, increment, time, element, point and the fields."""
        return self.table(table_of(self._results, "el", name))

    def joint(self, name: str) -> pd.DataFrame:
        """*JOINT PRINT of a joint: step, increment, time, point, x, y, z and the fields."""
        return self.table(table_of(self._results, "joint", name))

    @property
    def energies(self) -> pd.DataFrame:
        """The energy balance, one row an increment."""
        return self.table("energy")

    @cached_property
    def openings(self) -> pd.DataFrame:
        """Largest opening of each joint: step, increment, time, one column a joint.

        Every increment has a row, also without *JOINT PRINT. A model without joints has none.
        """
        return frames.opening_frame(self._results)

    def joint_extremes(self, name: str) -> pd.DataFrame:
        """Largest opening, slip and pressure of a joint, one row an increment. Raises LookupError.

        Columns: step, increment, time, opening, slip, pressure.
        """
        history = self._results.history(f"joints/{name}")
        if not history:
            known = ", ".join(self._results.joint_names()) or "none"
            raise LookupError(f"no joint '{name}'; the model has: {known}")
        return frames.frame_of(history)

    @property
    def increments(self) -> pd.DataFrame:
        """All increments: step, increment, time, size, iterations, residual."""
        return frames.frame_of(self._results.history("increments"))

    # extremes and modes of the summary

    @property
    def envelopes(self) -> pd.DataFrame:
        """Extremes over the run: field, place (anywhere, upstream, downstream), value, time, x."""
        return frames.extremes_frame(self.summary, "envelopes")

    @property
    def joints(self) -> pd.DataFrame:
        """Extremes of the joints: joint, field (opening, slip, pressure), place, value, time, x."""
        return frames.extremes_frame(self.summary, "joints")

    @property
    def displacement(self) -> pd.DataFrame:
        """Largest displacement relative to the base: field, place, value, time, x, y, z."""
        return frames.extremes_frame(self.summary, "displacement")

    @property
    def frequencies(self) -> pd.DataFrame:
        """Modes: step, mode, hz and the effective masses in x, y and z."""
        return frames.frequency_frame(self.summary)

    # fields

    @cached_property
    def _saved(self) -> list[meshes.SavedFields]:
        return meshes.saved_fields(self._results)

    @property
    def saved(self) -> pd.DataFrame:
        """Increments with saved fields: step, increment, time, fields (a tuple of names)."""
        names = ("step", "increment", "time", "fields")
        return frames.frame_of({name: [getattr(s, name) for s in self._saved] for name in names})

    def mesh(self) -> pv.UnstructuredGrid:
        """The solids without fields; NODE_ID on points, ELEMENT_ID and MATERIAL on cells."""
        return meshes.bare_mesh(self._results)

    def fields(self, time: float | None = None, step: int | None = None) -> pv.UnstructuredGrid:
        """The solids with the fields that are saved nearest to a time, by default the last ones.

        Vectors have the shape (nodes, 3), tensors (nodes, 6) in the order 11, 22, 33, 12, 13, 23;
        the time itself is in field_data["TIME"]. `step` (from 1) chooses a step. Decks with stages
        have STAGE on cells: the step in which the element was added, 0 where it is absent. Raises
        LookupError where no fields are saved.
        """
        return meshes.mesh_with_fields(self._results, meshes.nearest(self._saved, time, step))

    def envelope_mesh(self, step: int | None = None) -> pv.UnstructuredGrid:
        """The solids with the envelopes (S1_MAX, S1_MAX_TIME, ...) of a step, by default the last.

        Raises LookupError where there are none.
        """
        return meshes.mesh_with_envelopes(self._results, step)

    def modes(self) -> pv.UnstructuredGrid:
        """The solids with mode shapes MODE_01, ... (nodes, 3), and field_data["HZ"].

        Raises LookupError where there are none.
        """
        return meshes.mesh_with_modes(self._results)

    def joint_points(self, name: str, time: float | None = None,
                     step: int | None = None) -> pv.PolyData:  # fmt: skip
        """The points of a joint with opening, slip, traction and state nearest to a time.

        Raises LookupError for a joint that is not there, or without saved openings.
        """
        saved = [one for one in self._saved if f"{one.path}/joints" in self.file] or self._saved
        return meshes.joint_mesh(self._results, meshes.nearest(saved, time, step), name)

    def close(self) -> None:
        """Close job.h5; it is opened again when it is needed."""
        if "file" in self._results.__dict__:
            self._results.__dict__.pop("file").close()

    def __enter__(self) -> RunResults:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
