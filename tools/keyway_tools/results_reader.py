"""Reading what a run leaves in its folder: job.json, job.h5, the CSV histories."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from .joint_faces import JointFaces, read_joint_faces

# Fields of *ENVELOPE and the names of their extremes in job.h5.
ENVELOPE_NAMES = {
    "S1": "S1_MAX",
    "S3": "S3_MIN",
    "U": "U_MAX",
    "OPENING": "OPENING_MAX",
    "DAMAGET": "DAMAGET_MAX",
    "DAMAGEC": "DAMAGEC_MAX",
}
_SOLIDS = ("C3D8", "C3D8B", "C3D8I", "C3D8R")


def find_jobs(folder: Path) -> list[str]:
    """Names of the jobs whose results lie in a folder."""
    return sorted(path.stem for path in folder.glob("*.h5") if not path.stem.endswith(".ckpt"))


def read_csv(path: Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file by their names; words stay words."""
    with path.open() as file:
        names, *rows = csv.reader(file)
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(names)
    return {name: _as_numbers(column) for name, column in zip(names, columns, strict=True)}


def _as_numbers(words: tuple[str, ...]) -> np.ndarray:
    try:
        return np.array(words, dtype=float)
    except ValueError:
        return np.array(words)


@dataclass
class Step:
    """What a step left on the nodes and elements."""

    number: int
    name: str
    procedure: str
    envelopes: dict[str, np.ndarray]  # by field, NaN where there is none
    means: dict[str, np.ndarray]  # of damage: the largest mean over each element


class Results:
    """One job's results. Arrays are read when they are asked for."""

    def __init__(self, folder: Path, job: str):
        self.folder, self.job = Path(folder), job
        self.file = h5py.File(self.folder / f"{job}.h5", "r")
        summary = self.folder / f"{job}.json"
        self.summary = json.loads(summary.read_text()) if summary.exists() else {}

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
        words = self.file["mesh/element_type"][:]
        return np.array(
            [w.decode().strip() if isinstance(w, bytes) else str(w).strip() for w in words]
        )

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
    def dam(self) -> np.ndarray:
        """Positions of the dam's elements: the materials that touch the upstream face, else all."""
        solids = self.solids
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

    def table(self, path: str) -> dict[str, np.ndarray]:
        """A history by the names of its columns; empty when it is not there."""
        if path not in self.file:
            return {}
        data = self.file[path]
        names = _text(data.attrs["columns"]).split(",")
        return {name: data[:, k] for k, name in enumerate(names)}

    def joint_names(self) -> list[str]:
        """Names of the joints."""
        return list(self.file.get("joints", {}))

    def joint_faces(self, name: str) -> JointFaces | None:
        """The polygons of a joint."""
        return read_joint_faces(self.file[f"joints/{name}"], self.node_position, self)


def _text(word) -> str:
    word = np.ravel(word)[0] if isinstance(word, np.ndarray) else word
    return word.decode().strip() if isinstance(word, bytes) else str(word).strip()
