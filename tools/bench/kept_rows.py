"""Measured rows that are kept in a file, so that a long measurement can be stopped and go on."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from hashlib import sha256
from pathlib import Path

from measured_run import Program


@dataclass
class Row:
    """Measured values of one size."""

    size: int
    values: list[float]


@dataclass
class KeptRows:
    """Rows by name; those of another program or number of threads do not count."""

    path: Path | None = None  # None: nothing is kept
    owner: str = ""
    rows: dict[str, Row] = field(default_factory=dict)

    @staticmethod
    def of(path: Path | None, program: Program) -> KeptRows:
        """The rows in the file that are of this program."""
        digest = sha256(program.path.read_bytes()).hexdigest()[:16]
        kept = KeptRows(path, f"{digest}, {program.threads} threads")
        if path is not None and path.exists():
            found = json.loads(path.read_text())
            if found["owner"] == kept.owner:
                kept.rows = {name: Row(**row) for name, row in found["rows"].items()}
            else:
                print(f"bench: {path} holds rows of another program; they are measured anew")
        return kept

    def put(self, name: str, row: Row) -> None:
        """Keeps a row; the file is whole at any time."""
        self.rows[name] = row
        if self.path is None:
            return
        content = {
            "owner": self.owner,
            "rows": {key: asdict(value) for key, value in self.rows.items()},
        }
        part = self.path.with_name(self.path.name + ".part")
        part.write_text(json.dumps(content, indent=2) + "\n")
        part.replace(self.path)
