"""The table of fields: docs/fields.md, messages, keywords and files come from it."""

import subprocess
from pathlib import Path

import h5py
import pytest
import pyvista
from harness import ROOT
from make_fields import read_pages, table


@pytest.fixture(scope="module")
def pages(program_path: Path) -> list[dict[str, str]]:
    return read_pages(program_path)


def test_the_documentation_is_up_to_date(pages: list[dict[str, str]]) -> None:
    written = (ROOT / "docs/fields.md").read_text(encoding="utf-8")
    assert table(pages) == written, "run tools/make_fields.py"


def test_every_field_has_unit_and_meaning(pages: list[dict[str, str]]) -> None:
    assert len(pages) >= 19
    for page in pages:
        assert page["unit"] and page["meaning"] and page["components"] and page["computed by"]
        assert page["requested by"] and page["written to"], page["field"]


def test_keywords_take_the_fields_of_the_table(program_path: Path, pages) -> None:
    """Each keyword offers all fields that name the keyword, and no other."""
    for keyword in ("NODE PRINT", "EL PRINT", "NODE FILE", "EL FILE", "ENVELOPE", "NODE OUTPUT"):
        done = subprocess.run(
            [program_path, "--keywords", keyword], capture_output=True, text=True, check=True
        )
        data = " ".join(done.stdout.split("Data lines")[1].split("Example")[0].split())
        offered = data.split("one of ")[1].split(", ")
        expected = [p["field"] for p in pages if f"*{keyword}" in p["requested by"].split(", ")]
        assert offered == expected


def test_envelope_of_openings_needs_joints(keyway):
    """Without joints no file has the field, as the warning says; S1 and S3 are the usual fields."""
    text = (ROOT / "input/cantilever.inp").read_text(encoding="utf-8")
    at = text.index("*ENVELOPE")
    run = keyway(text[:at] + "*ENVELOPE\nS1, OPENING\n*END STEP\n")
    warnings = " ".join(run.json["warnings"])
    assert "the model has no joints; OPENING is not written" in warnings + run.stderr
    assert set(run.json["envelopes"]) == {"S1"}
    names = set(pyvista.read(run.folder / "job_vtk/job_envelope_step1.vtu").point_data)
    assert names == {"NODE_ID", "S1_MAX", "S1_MAX_TIME"}
    with h5py.File(run.folder / "job.h5") as file:
        assert set(file["steps/0001/envelopes"]) == {"S1_MAX", "S1_MAX_TIME"}


@pytest.mark.parametrize(("name", "nearest"), [("DAMAGE", "DAMAGET"), ("OPENIN", "OPENING")])
def test_an_unknown_field_names_the_nearest(program_path: Path, name: str, nearest: str) -> None:
    done = subprocess.run([program_path, "--fields", name], capture_output=True, text=True)
    assert done.returncode == 2
    assert f"there is no field '{name}'" in done.stderr
    assert f"did you mean '{nearest}'?" in done.stderr


NODAL, ELEMENTAL = "*NODE FILE\nU\n", "*EL FILE\nS\n"
OF_OUTPUT = "*OUTPUT, FIELD\n*NODE OUTPUT\nRF\n"


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (NODAL + ELEMENTAL, "", {"U", "S"}),
        (NODAL + ELEMENTAL, "*NODE FILE\nRF\n", {"RF", "S"}),
        (NODAL + ELEMENTAL, "*EL FILE\nE\n", {"U", "E"}),
        (NODAL + ELEMENTAL, "*NODE FILE, FREQUENCY=0\n", {"S"}),
        (NODAL + ELEMENTAL, OF_OUTPUT, {"RF"}),
        (NODAL + ELEMENTAL, "*OUTPUT, FIELD, FREQUENCY=0\n", set()),
        ("*OUTPUT, FIELD, VARIABLE=PRESELECT\n", "*NODE FILE\nU\n", {"U", "S"}),
    ],
)
def test_requests_of_a_later_step(keyway, first, second, expected) -> None:
    """Those for nodes, or for elements, replace their own kind; *OUTPUT, FIELD replaces both."""
    deck = (ROOT / "input/cantilever.inp").read_text(encoding="utf-8")
    cards = deck.split("*END STEP")[0].splitlines(keepends=True)
    start = max(i for i, line in enumerate(cards) if line.startswith("*STEP"))
    load = [line for line in cards[start:] if not line.startswith(("*NODE", "*EL", "U", "S"))]
    text = "".join([*cards[:start], *load, first, "*END STEP\n*STEP\n*STATIC\n"])
    run = keyway(f"{text}{second}*END STEP\n", name="two_steps")
    with h5py.File(run.folder / "two_steps.h5") as file:
        found = {name for state in file["steps/0002/increments"].values() for name in state}
        assert found & {"U", "RF", "S", "E"} == expected


def test_an_envelope_in_two_cards_is_written_once(keyway) -> None:
    """A field twice in the file stopped the run at its end, with 'disk full?'."""
    deck = (ROOT / "input/cantilever.inp").read_text(encoding="utf-8")
    deck = deck.replace("*END STEP", "*ENVELOPE\nS1\n*ENVELOPE\nU, S1\n*END STEP")
    run = keyway(deck, name="twice")
    with h5py.File(run.folder / "twice.h5") as file:
        assert "S1_MAX" in file["steps/0001/envelopes"]
        assert "U_MAX" in file["steps/0001/envelopes"]
