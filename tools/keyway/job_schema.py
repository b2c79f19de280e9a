"""The JSON Schema of job.json."""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

VERSION = 1  # of the schema: `schema.version` in job.json


def job_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) that every job.json of this version fits."""
    text = resources.files(__package__).joinpath(f"job-{VERSION}.schema.json")
    return json.loads(text.read_text(encoding="utf-8"))
