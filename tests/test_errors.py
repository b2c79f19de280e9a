"""Bad decks: one for each message, the output compared to the letter.

tests/errors/README.md describes the tables; tests/update_errors.py writes changed messages into
them.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from error_cases import NAME, Case, base_decks, headlines, read_tables, without_names


@pytest.mark.parametrize("case", [pytest.param(c, id=c.name) for c in read_tables()])
def test_bad_deck(case: Case, program_path: Path, tmp_path: Path) -> None:
    done = case.run(program_path, tmp_path)
    assert without_names(done.stderr) == case.stderr
    assert done.returncode == case.code
    for line in headlines(done.stderr):
        assert NAME.search(line), f"no page of keyway --explain fits: {line}"


# Cases whose words could be those of another kind, and their kinds.
KINDS = {
    "material_in_an_instance": "outside-its-place",
    "keywords_below_the_last_step": "outside-its-place",
    "dynamic_explicit": "not-available",
    "static_stabilize": "not-available",
    "static_direct_with_a_value": "wrong-value",
    "set_generate": "wrong-value",
    "print_of_81_letters": "wrong-value",
    "warning_heading_without_text": "missing-value",
    "warning_nothing_acts": "incomplete-deck",
    "warning_plastic_falls": "plastic-table",
    "plastic_too_steep": "plastic-table",
    "plastic_rate": "not-available",
    "plastic_beside_concrete": "excludes",
    "concrete_long_gfi": "long-element",
    "concrete_hardening_rows": "concrete-table",
    "warning_concrete_lower_strength": "long-element",
    "warning_twisted_brick": "bad-element",
    "warning_two_nodes_at_one_place": "bad-element",
    "acceleration_of_supports_with_unit": "unit-of-record",
    "warning_unit_and_its_scale": "unit-of-record",
    "instance_rotation": "wrong-value",
    "damping_modal_without_modes": "missing-value",
    "warning_two_increments_for_one": "excludes",
    "model_change_springs": "excludes",
    "section_mass": "excludes",
    "mpc_nodes": "number-of-fields",
    "temperature_file_columns": "number-of-fields",
    "user_material_long_line": "needs-umat",
    "uplift_unknown_reservoir": "unknown-name",
    "warning_reservoir_twice": "acts-twice",
    "dynamic_reduced_full_solver": "reduced-model",
    "step_riks": "not-available",
    "warning_water_in_si": "units",
    "warning_modulus_in_mpa": "units",
    "warning_friction_in_degrees": "units",
    "warning_level_in_other_unit": "water",
    "warning_weight_upwards": "water",
    "warning_record_in_milliseconds": "motion-record",
    "warning_water_inside_the_solid": "inner-face",
    "decimal_commas": "number-of-fields",
    "inverted_solid_at_a_joint": "bad-element",
    "warning_increments_miss_the_peak": "motion-record",
    "joint_not_coincident": "faces-apart",
    "warning_supports_of_modes": "supports-of-modes",
    "warning_op_new_of_one_keyword": "other-loads-stay",
    "warning_tie_of_one_held_node": "support-on-tie",
    "warning_light_solid_in_motion": "light-solid",
    "warning_massless_dampings_of_a_reduced_model": "massless-damping",
    "warning_dampings_of_a_reduced_model": "coupled-damping",
}


@pytest.mark.parametrize("name", KINDS)
def test_kind_of_a_message(name: str, program_path: Path, tmp_path: Path) -> None:
    case = next(case for case in read_tables() if case.name == name)
    lines = headlines(case.run(program_path, tmp_path).stderr)
    assert any(line.endswith(f"[{KINDS[name]}]") for line in lines)


@pytest.mark.parametrize(
    "content, says",
    [
        (
            "*NODE\n1, 0., 0., 0.\n".encode("utf-16"),
            "it is in UTF-16, or no text; save it as UTF-8",
        ),
        (b"*NODE\r1, 0., 0., 0.\r", "its lines end with CR alone; save it with the line ends LF"),
    ],
    ids=["utf-16", "cr"],
)
def test_a_file_that_is_no_deck(content, says, program_path: Path, tmp_path: Path) -> None:
    (tmp_path / "a.inp").write_bytes(content)
    command = [str(program_path.resolve()), "--check", "a.inp"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith(f"a.inp: cannot read 'a.inp': {says}")
    assert done.stderr.count("\n") == 1


def test_files_include_each_other_too_deep(program_path: Path, tmp_path: Path) -> None:
    for k in range(103):
        (tmp_path / f"{k}.inp").write_text(f"*INCLUDE, INPUT={k + 1}.inp\n")
    command = [str(program_path.resolve()), "--check", "0.inp"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert "the file is below more than 100 levels of *INCLUDE; expected at most" in done.stderr
    assert "includes itself" not in done.stderr


def test_every_name_has_a_page(program_path: Path) -> None:
    listed = subprocess.run([program_path, "--explain"], capture_output=True, text=True).stdout
    names = re.findall(r"^([a-z][a-z0-9-]*) ", listed, re.MULTILINE)[:-1]  # `keyway --explain ..`
    assert len(names) == len(set(names)) > 40
    for name in names:
        done = subprocess.run(
            [program_path, "--explain", f"[{name}]"], capture_output=True, text=True
        )
        assert done.returncode == 0
        assert done.stdout.startswith(f"{name}\n  ")
        assert "\nWhat to do\n" in done.stdout
    done = subprocess.run([program_path, "--explain", "no-suport"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "did you mean 'no-support'?" in done.stderr


@pytest.mark.parametrize("deck", base_decks(), ids=lambda path: path.stem)
def test_base_deck_is_good(deck: Path, program_path: Path) -> None:
    options = ["--material"] if deck.stem == "material_test" else []
    command = [str(program_path), "--check", *options, str(deck)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stderr == ""
    assert done.returncode == 0
