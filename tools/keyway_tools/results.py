"""The results of a run: the summary, the tables and the fields of a job."""

from __future__ import annotations

import fcntl
import json
import socket
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .job_files import job_of_file, name_of_table, tables_of
from .joint_faces import JointFaces, read_joint_faces
from .program import DamagedFileError
from .result_files import Table, as_array, as_file_word, load_json, natural, read_table
from .upright import Z

# Fields of *ENVELOPE and the names of their extremes in job.h5.
ENVELOPE_NAMES = {
    "S1": "S1_MAX",
    "S3": "S3_MIN",
    "S1_POINT": "S1_POINT_MAX",
    "S3_POINT": "S3_POINT_MIN",
    "U": "U_MAX",
    "OPENING": "OPENING_MAX",
    "DAMAGET": "DAMAGET_MAX",
    "DAMAGEC": "DAMAGEC_MAX",
}
_SOLIDS = ("C3D8", "C3D8B", "C3D8I", "C3D8R")


KINDS = (".json", ".h5")  # of files that each job leaves
GROUPS = {"mesh", "steps", "joints", "history"}  # in job.h5


def find_jobs(folder: Path) -> list[str]:
    """Names of the jobs whose fields (job.h5) lie in a folder."""
    checkpoints = (".ckpt", ".ckpt_old", ".ckpt_new")
    return sorted(path.stem for path in folder.glob("*.h5") if not path.stem.endswith(checkpoints))


def folder_and_job(given: Path) -> tuple[Path, str | None]:
    """The folder of results, and the job where a deck or a file of the results is given.

    >>> folder_and_job(Path("."))
    (PosixPath('.'), None)
    """
    if given.is_dir():
        return given, None
    for ending in (".inp", ".json", ".h5", ".log", ""):
        job = given.name.removesuffix(ending)
        has_ending = given.name.endswith(ending)
        if has_ending and any((given.parent / f"{job}{kind}").is_file() for kind in KINDS):
            return given.parent, job
    found = job_of_file(given) if given.is_file() else None
    return found or (given, None)


def is_summary(path: Path) -> bool:
    """Whether a JSON file is the summary of an analysis (one of material tests holds 'tests')."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    has_keys = isinstance(content, dict) and {"program", "status"} <= content.keys()
    return has_keys and "tests" not in content


def why_incomplete(folder: Path, job: str) -> str:
    """Why a run has not finished: '' if it has, or if job.json does not say."""
    try:
        content = json.loads((folder / f"{job}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    if content.get("status") == "stopped":
        return content.get("message") or "the run has stopped"
    if content.get("status") == "running":
        return _why_running(folder / f"{job}.lock")
    return ""


def _why_running(lock: Path) -> str:
    """Whether a run whose summary says "running" does run: then it holds the lock of job.lock."""
    killed, runs = "the run was killed", "the run is not at its end yet"
    try:
        with lock.open(encoding="utf-8") as file:
            process, _, host = file.read().strip().partition(" ")
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return killed
    except OSError:
        return runs
    if host and host != socket.gethostname():
        return f"{runs}, or it was killed (process {process} on host {host})"
    return killed


@dataclass
class Step:
    """The envelopes of a step at nodes and elements."""

    number: int
    name: str
    procedure: str
    envelopes: dict[str, np.ndarray]  # by field, NaN where there is none
    means: dict[str, np.ndarray]  # of damage: the largest mean over each element


class Results:
    """The results of one job in a folder, each read at its first use."""

    def __init__(self, folder: Path | str, job: str | None = None):
        self.folder, named = folder_and_job(Path(folder))
        if not self.folder.is_dir():
            what = f"there is no folder '{self.folder}', nor results of a job of this name"
            raise FileNotFoundError(what)
        self.job = job or named or self._find_job()

    def _find_job(self) -> str:
        jobs = [p.stem for p in sorted(self.folder.glob("*.json")) if is_summary(p)]
        if len(jobs) == 1:
            return jobs[0]
        if not jobs:
            raise FileNotFoundError(f"no results of Keyway in '{self.folder}'")
        raise ValueError(f"several jobs in '{self.folder}': {', '.join(jobs)}; name one of them")

    def path(self, ending: str) -> Path:
        """File of the job, as in path('.json') or path('_node_TIP.csv')."""
        return self.folder / f"{self.job}{ending}"

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The summary JOB.json."""
        return load_json(self.path(".json"))

    def tables(self) -> list[str]:
        """Names of the tables, as in ['node_TIP', 'joint_J1']; numbers in them count up."""
        return sorted(tables_of(self.folder, self.job), key=natural)

    def table(self, name: str) -> Table:
        """Columns of the table JOB_NAME.csv."""
        return read_table(self.path(f"_{name}.csv"))

    def joint_of_table(self, word: str) -> str:
        """The joint of the table joint_WORD: other letters than a to z are '_' in its name."""
        known = self.summary.get("joints", {}) if self.path(".json").exists() else {}
        return _written_as(word, known)

    def set_of_table(self, word: str) -> str:
        """The set of the table node_WORD, as job.h5 names it."""
        names = self.file.get("sets/nodes", {})
        return name_of_table(self, "node", word, names) or _written_as(word, names)

    def step_name(self, step: int) -> str:
        """The name of a step."""
        return _text(self.file[f"steps/{step:04d}"].attrs["name"])

    def find(self, path: str) -> Any:
        """Value in the summary, as in find('steps.0.frequencies.2.hz')."""
        value: Any = self.summary
        for key in path.split("."):
            try:
                value = value[int(key)] if isinstance(value, list) else value[key]
            except (KeyError, IndexError, ValueError, TypeError):
                raise KeyError(f"{self.path('.json').name} has no '{path}' (at '{key}')") from None
        return value

    @cached_property
    def file(self) -> h5py.File:
        """The fields, job.h5. Raises OSError, also while the run writes the file."""
        path = self.path(".h5")
        try:
            file = h5py.File(path, "r")
            if not GROUPS & file.keys():
                raise DamagedFileError(f"{path} holds no results of Keyway")
            return file
        except FileNotFoundError:
            raise
        except BlockingIOError as error:
            text = f"{path}: the run is not at its end yet; its fields and histories can be read "
            raise OSError(f"{text}when it is, its tables (CSV) now") from error
        except OSError as error:
            raise OSError(f"{path} cannot be read: {error}") from error

    @cached_property
    def x(self) -> np.ndarray:
        """Coordinates of the nodes [m], shape (nodes, 3)."""
        return self.file["mesh/x"][:]

    @cached_property
    def node_id(self) -> np.ndarray:
        """The deck's number of each node."""
        return self.file["mesh/node_id"][:]

    @cached_property
    def node_position(self) -> dict[int, int]:
        """The position of each node by the deck's number."""
        return {int(number): place for place, number in enumerate(self.node_id)}

    @cached_property
    def element_id(self) -> np.ndarray:
        """The deck's number of each element."""
        return self.file["mesh/element_id"][:]

    @cached_property
    def element_types(self) -> np.ndarray:
        """Type of each element as text."""
        return as_array(self.file["mesh/element_type"][:]).astype(str)

    @cached_property
    def connectivity(self) -> np.ndarray:
        """Node positions from 0 of all elements, shape (elements, 8); -1 where there is no node."""
        return self.file["mesh/connectivity"][:]

    def face_flags(self, name: str) -> np.ndarray:
        """Whether each node lies on the 'upstream' or 'downstream' face."""
        path = f"faces/{name}"
        flags = self.file[path][:] if path in self.file else np.zeros(len(self.x))
        return flags.astype(bool)

    @cached_property
    def solids(self) -> np.ndarray:
        """Positions of the solid elements."""
        return np.flatnonzero(np.isin(self.element_types, _SOLIDS))

    @cached_property
    def up_axis(self) -> int:
        """The axis of the model that points up, from 0; z where job.h5 does not say."""
        return int(self.file["mesh"].attrs.get("up", Z + 1)) - 1

    @property
    def upward(self) -> np.ndarray:
        """The unit vector that points up."""
        return np.eye(3)[self.up_axis]

    @cached_property
    def dam(self) -> np.ndarray:
        """Positions of the dam's elements as the program takes them; all without a reservoir.

        Files of older programs do not say: then the materials that touch the upstream face.
        """
        solids = self.solids
        if "faces/dam" in self.file:
            found = solids[self.file["faces/dam"][:][solids] > 0]
            return found if found.size else solids
        material = self.file["mesh/material"][:]
        wet = self.face_flags("upstream")[self.connectivity[solids]].sum(axis=1) >= 3
        found = np.unique(material[solids[wet]])
        return solids[np.isin(material[solids], found)] if found.size else solids

    def steps(self) -> list[Step]:
        """The steps in their order."""
        found = []
        for key in sorted(self.file["steps"]):
            group = self.file["steps"][key]
            kept = group.get("envelopes", {})
            envelopes = {
                field: kept[name][:] for field, name in ENVELOPE_NAMES.items() if name in kept
            }
            means = {
                field: kept[f"{field}_MEAN_MAX"][:]
                for field in ENVELOPE_NAMES
                if f"{field}_MEAN_MAX" in kept
            }
            name, procedure = _text(group.attrs["name"]), _text(group.attrs["procedure"])
            found.append(Step(int(key), name, procedure, envelopes, means))
        return found

    def stage(self, step: int) -> np.ndarray | None:
        """The step in which each element was added, 0 where it is absent in a step.

        None in decks without *MODEL CHANGE.
        """
        path = f"steps/{step:04d}/stage"
        return self.file[path][:] if path in self.file else None

    def envelope_time(self, step: Step, field: str) -> np.ndarray:
        """Time of the extreme at each node [s]."""
        name = ENVELOPE_NAMES[field]
        return self.file[f"steps/{step.number:04d}/envelopes/{name}_TIME"][:]

    def displacements(self) -> list[tuple[str, float]]:
        """Paths and times of all saved displacement fields."""
        found = []
        for step in self.file["steps"].values():
            for group in step.get("increments", {}).values():
                if "U" in group:
                    found.append((f"{group.name}/U", float(np.ravel(group.attrs["time"])[0])))
        return found

    def damage(self, field: str) -> tuple[float, np.ndarray] | None:
        """Time of the last saved DAMAGET or DAMAGEC, and its mean over each element."""
        saved = [
            group
            for key in sorted(self.file["steps"])
            for _, group in sorted(self.file["steps"][key].get("increments", {}).items())
            if f"points/{field}" in group
        ]
        if not saved:
            return None
        points, now = self.file["points"], saved[-1]["points"]
        place = {int(number): e for e, number in enumerate(self.file["mesh/element_id"][:])}
        element = np.array([place[int(number)] for number in points["element"][:]])
        volume, damage = points["volume"][:], np.zeros(len(element))
        damage[now["row"][:]] = now[field][:]
        total = np.bincount(element, volume, len(place))
        mean = np.bincount(element, volume * damage, len(place)) / np.where(total > 0, total, 1.0)
        return float(np.ravel(saved[-1].attrs["time"])[0]), mean

    def modes(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Frequencies [Hz] and shapes (modes, nodes, 3) of the last *FREQUENCY step."""
        for step in reversed(list(self.file["steps"].values())):
            if "modes" in step:
                return step["modes/hz"][:], step["modes/shape"][:]
        return None

    def history(self, name: str) -> Table:
        """A history of job.h5 by the names of its columns; empty when it is not there."""
        path = f"history/{name}"
        if path not in self.file:
            return {}
        data = self.file[path]
        names = _text(data.attrs["columns"]).split(",")
        return {name: data[:, k] for k, name in enumerate(names)}

    def joint_names(self) -> list[str]:
        """Names of the joints; numbers in them count up."""
        return sorted(self.file.get("joints", {}), key=natural)

    def joint_faces(self, name: str) -> JointFaces | None:
        """The polygons of a joint."""
        return read_joint_faces(self.file[f"joints/{name}"], self.node_position, self)


def _written_as(word: str, names: Iterable[str]) -> str:
    """The one name that is `word` in the name of a file; else the word."""
    found = [name for name in names if as_file_word(name) == word]
    return found[0] if len(found) == 1 else word


def _text(word: Any) -> str:
    return str(as_array(word).ravel()[0])
