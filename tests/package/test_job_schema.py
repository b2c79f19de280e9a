"""job.json of runs of all kinds fits its JSON Schema, and deck.md describes the same names."""

from __future__ import annotations

import json
import re
import shutil

import jsonschema
import keyway as package
import pytest
from harness import ROOT

SCHEMA = package.job_schema()
INPUT = ROOT / "input"
DECKS = (
    "block_on_joint.inp",  # joint, reservoir, envelopes
    "monolith_frequencies.inp",
    "cantilever.inp",
    "sliding_block.inp",  # dynamic
    "petersson_beam.inp",  # concrete that cracks
)


def faults_of(summary: dict) -> list[str]:
    validator = jsonschema.Draft202012Validator(SCHEMA)
    return [f"{error.json_path}: {error.message}" for error in validator.iter_errors(summary)]


def test_the_schema_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", DECKS)
def test_finished_runs_fit(keyway, name):
    summary = keyway(INPUT / name).json
    assert faults_of(summary) == []
    assert summary["schema"] == {"name": "keyway-job", "version": 1}


def test_a_run_with_a_umat_fits(keyway):
    summary = keyway(INPUT / "umat/elastic.inp", "--umat", str(INPUT / "umat/elastic.for"),
                     "--umat-check").json  # fmt: skip
    assert faults_of(summary) == []
    assert summary["umat"]["check"]["compared"] > 0


def test_a_stopped_run_fits(keyway):
    """A block that slides without end has no equilibrium."""
    deck = (INPUT / "block_on_joint.inp").read_text().replace("FRICTION=0.6", "FRICTION=0.1")
    summary = keyway(deck, code=1).json
    assert summary["status"] == "stopped"
    assert faults_of(summary) == []


def test_a_wrong_deck_beside_earlier_results_leaves_a_summary_that_fits(keyway, tmp_path):
    shutil.copy(INPUT / "cantilever.inp", tmp_path / "dam.inp")
    keyway(tmp_path / "dam.inp")
    (tmp_path / "dam.inp").write_text("*NODES\n")
    summary = keyway(tmp_path / "dam.inp", code=2).json
    assert summary["status"] == "stopped"
    assert faults_of(summary) == []


def test_the_schema_finds_faults(keyway):
    summary = keyway(INPUT / "cantilever.inp").json
    wrong = {**summary, "status": "done", "model": {**summary["model"], "nodes": "8"}}
    del wrong["ledger"]
    text = "\n".join(faults_of(wrong))
    for part in (r"\$\.status: 'done'", r"\$\.model\.nodes: '8'", "'ledger' is a required"):
        assert re.search(part, text), text


def test_the_contract_has_the_names_of_the_schema():
    page = (ROOT / "docs/deck.md").read_text(encoding="utf-8")
    block = page[page.index('    {"schema"') : page.index("`error` of the energy")]
    top = set(re.findall(r'^(?:    \{| {5})"(\w+)":', block, re.M))
    assert top - {"instances"} <= set(SCHEMA["required"])  # those only where a deck has parts
    assert top <= set(SCHEMA["properties"])
    energies = re.search(r'"energy": \{(.*?)\}', block, re.S)
    assert energies is not None
    required = SCHEMA["$defs"]["step"]["properties"]["energy"]["required"]
    assert sorted(re.findall(r'"(\w+)"', energies[1])) == sorted(required)
    json.dumps(SCHEMA)
