"""Every component that changes in time is saved, loaded, and compared in a test.

A component added to one of the types below and forgotten in one of the procedures fails here.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STATE = "src/analysis/state/analysis_state.f90"
MODAL_ERRORS = "src/analysis/state/modal_errors.f90"
STATE_ARCHIVE = "src/analysis/state/state_archive.f90"
ENERGY_ARCHIVE = "src/analysis/state/energy_archive.f90"
MOTION_ARCHIVE = "src/analysis/state/motion_archive.f90"
RECORD_ARCHIVE = "src/results/record/record_archive.f90"
SUMMARY = "src/results/summary/run_summaries.f90"
SUMMARY_ARCHIVE = "src/results/summary/summary_archive.f90"
SAME_STATES = "tests/unit/same_states.f90"
FULL_STATE = "tests/unit/full_state.f90"
RECORD_TEST = "tests/unit/results/record/test_record_archive.f90"


@dataclass(frozen=True)
class Saved:
    """A type, the procedures that name all its components, and components that stay as they are."""

    name: str
    source: str
    procedures: tuple[tuple[str, str], ...]
    constant: dict[str, str] = field(default_factory=dict)


def of_state(name: str, source: str, what: str, archive: str = STATE_ARCHIVE) -> Saved:
    """A part of the state."""
    pairs = (
        (archive, f"save_{what}"),
        (archive, f"load_{what}"),
        (SAME_STATES, f"compare_{what}"),
        (FULL_STATE, f"fill_{what}"),
    )
    return Saved(name, source, pairs)


def of_record(name: str, source: str, what: str, comparison: str, **constant: str) -> Saved:
    """A part of the record of a run."""
    pairs = (
        (RECORD_ARCHIVE, f"save_{what}"),
        (RECORD_ARCHIVE, f"load_{what}"),
        (RECORD_TEST, comparison),
    )
    return Saved(name, source, pairs, constant)


TYPES = (
    Saved(
        "state",
        STATE,
        (
            (STATE_ARCHIVE, "save_state"),
            (STATE_ARCHIVE, "load_state"),
            (SAME_STATES, "compare_states"),
            (FULL_STATE, "make_full_state"),
        ),
    ),
    of_state("increment_status", STATE, "status"),
    of_state("energy_balance", STATE, "energy", ENERGY_ARCHIVE),
    of_state("motion", STATE, "motion", MOTION_ARCHIVE),
    Saved("motion", STATE, (("src/analysis/state/motion_parts.f90", "gather_motion"),)),
    of_state("modal_motion", STATE, "modal", MOTION_ARCHIVE),
    of_state("reduction_status", STATE, "reduction"),
    of_state("time_accuracy", STATE, "accuracy"),
    of_state("modal_error", MODAL_ERRORS, "timing", MODAL_ERRORS),
    of_state(
        "path_error",
        "src/analysis/state/path_errors.f90",
        "path",
        "src/analysis/state/path_errors.f90",
    ),
    Saved(
        "twin_points",
        "src/analysis/state/path_twins.f90",
        (
            ("src/analysis/state/path_twins.f90", "save_list"),
            ("src/analysis/state/path_twins.f90", "load_list"),
            (SAME_STATES, "compare_twins"),
            (FULL_STATE, "fill_twins"),
        ),
    ),
    of_state("last_matrix", STATE, "matrix"),
    of_state("increment_control", "src/model/steps/step_control.f90", "control"),
    of_state(
        "joint_state",
        "src/joints/law/joint_history.f90",
        "joint",
        "src/joints/law/joint_history.f90",
    ),
    of_state(
        "point_state",
        "src/materials/law/material_points.f90",
        "points",
        "src/materials/law/material_points.f90",
    ),
    of_record(
        "run_record",
        "src/results/record/run_records.f90",
        "record",
        "compare_records",
        stresses="made anew from the state",
        singular="of the mesh, found again",
        skin="of the model",
        fields="the same for all runs",
        path="of the state",
        extent="of the mesh, found when the record opens",
    ),
    of_record(
        "joint_record",
        "src/results/quantities/joint_readings.f90",
        "joint_record",
        "compare_records",
        is_upstream="of the model",
        is_downstream="of the model",
    ),
    of_record("goal_error", "src/results/errors/goal_errors.f90", "goal_error", "compare_records"),
    of_record(
        "space_error", "src/results/errors/space_errors.f90", "space_error", "compare_records"
    ),
    of_record(
        "damage_record",
        "src/results/quantities/damage_readings.f90",
        "damage_record",
        "compare_records",
        is_present="of the model",
        faces="of the model",
    ),
    of_record(
        "damage_extreme",
        "src/results/quantities/damage_readings.f90",
        "damage_extreme",
        "compare_damage",
    ),
    of_record("envelope", "src/results/quantities/envelopes.f90", "envelope", "compare_lists"),
    of_record("extreme", "src/results/quantities/extremes.f90", "extremes", "compare_extremes"),
    # tests/results/test_restart.py compares job.json of runs that go on with that of a whole run.
    Saved(
        "run_summary",
        SUMMARY,
        ((SUMMARY_ARCHIVE, "save_summary"), (SUMMARY_ARCHIVE, "load_summary")),
        {
            "status": "of the end of the run",
            "message": "of the end of the run",
            "balance": "of the end of the run",
            "deck_digest": "of the deck",
            "remarks": "of the deck",
        },
    ),
    Saved(
        "step_summary",
        SUMMARY,
        ((SUMMARY_ARCHIVE, "save_step"), (SUMMARY_ARCHIVE, "load_step")),
    ),
)


def without_comments(path: str) -> str:
    """A source in lower case; '!' stands in none of its texts."""
    return re.sub(r"!.*", "", (ROOT / path).read_text(encoding="utf-8")).lower()


def components(source: str, name: str) -> list[str]:
    """The components of a type."""
    block = re.search(
        rf"^ *type\b[^\n]*:: {name}\n(.*?)^ *(?:contains|end type)\b",
        source,
        re.DOTALL | re.MULTILINE,
    )
    assert block, f"there is no type {name}"
    found = []
    for line in block[1].splitlines():
        if "::" in line:
            names = line.split("::", 1)[1]
            while "(" in names:
                names = re.sub(r"\([^()]*\)", "", names)
            found += [part.split("=")[0].strip() for part in names.split(",")]
    return found


def body(source: str, name: str) -> str:
    """The lines of a subroutine."""
    parts = re.search(rf"^ *subroutine {name}\b.*?^ *end subroutine {name}\b", source, re.S | re.M)
    assert parts, f"there is no procedure {name}"
    return parts[0]


def body_with_parts(source: str, name: str) -> str:
    """A procedure with those of its file that it calls for the same object."""
    own = body(source, name)
    parts = [
        called
        for called in ("load_fields", "save_histories", "load_histories", "compare_lists")
        if f"call {called}(" in own
    ]
    return "\n".join([own, *(body(source, called) for called in parts)])


@pytest.mark.parametrize("saved", TYPES, ids=lambda saved: saved.name)
def test_no_component_is_forgotten(saved):
    names = components(without_comments(saved.source), saved.name)
    assert names
    assert set(saved.constant) <= set(names)
    missing = [
        f"{name} in {procedure} ({path})"
        for path, procedure in saved.procedures
        for name in names
        if name not in saved.constant
        and not re.search(rf"%{name}\b", body_with_parts(without_comments(path), procedure))
    ]
    assert missing == []


def test_a_forgotten_component_is_found():
    source = without_comments(STATE).replace(
        "end type motion", "real(rk) :: news(3)\nend type motion"
    )
    assert "news" in components(source, "motion")
    assert not re.search(r"%news\b", body(without_comments(MOTION_ARCHIVE), "save_motion"))


def test_values_keep_their_names():
    """The name in the file is that of the component."""
    for path in (
        STATE_ARCHIVE,
        MOTION_ARCHIVE,
        "src/joints/law/joint_history.f90",
        "src/materials/law/material_points.f90",
    ):
        for name, value in re.findall(r"%(?:put|get)\('(\w+)', (\w+%\w+)", without_comments(path)):
            assert value.split("%")[1] == name, (path, name, value)
