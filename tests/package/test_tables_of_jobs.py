"""Which tables are those of a job, and which of them is that of a set or a joint."""

from __future__ import annotations

import json
import shutil

import keyway as package
import numpy as np
import pytest
from harness import ROOT
from keyway.commands.compare import main as compare

BLOCK = ROOT / "input/block_on_joint.inp"
SETS = """*NSET, NSET=K R
1, 22
*NSET, NSET=K_R
2101
*NSET, NSET=Fuß Ö
2122
*NSET, NSET=K R_
2101
"""
PRINTS = """*NODE PRINT, NSET=K R
U
*NODE PRINT, NSET=K_R
U
*NODE PRINT, NSET=Fuß Ö
U
"""


@pytest.fixture(scope="module")
def block(program_path, tmp_path_factory):
    """The block with sets and a joint whose names are not those of the files."""
    deck = package.Deck(BLOCK)
    deck.add(SETS)
    deck.add(PRINTS, step=1)
    for card in (deck.card("JOINT"), deck.card("JOINT PRINT")):
        name = "NAME" if card.is_a("JOINT") else "JOINT"
        card.parameters[name] = "Fuge Ü 1"
    folder = tmp_path_factory.mktemp("names")
    return package.run(deck, threads=1, results=folder, program=program_path)


def nodes(table) -> set[int]:
    return set(table["node"])


def test_the_table_of_a_set_has_its_members(block):
    assert "node_K_R_5" in block.prints  # of the second set: its position among the requests
    assert nodes(block.node("K R")) == {1, 22}
    assert nodes(block.node("k r")) == {1, 22}
    assert nodes(block.node("K_R")) == {2101}
    with pytest.raises(LookupError, match="no table 'node_K_R_'"):
        block.node("K R_")
    names = {word: block._results.set_of_table(word) for word in ("K_R", "K_R_5", "HEEL")}
    assert names == {"K_R": "K R", "K_R_5": "K_R", "HEEL": "HEEL"}  # in titles of curves


def test_letters_beyond_ascii_are_a_mark_for_each_byte(block):
    assert nodes(block.node("Fuß Ö")) == nodes(block.node("fuß Ö")) == {2122}
    assert block.joint("Fuge Ü 1")["opening"].max() > 0.0
    with pytest.raises(LookupError):
        block.node("FUSS Ö")


def test_a_set_named_like_the_file_of_another_keeps_its_table(program_path, tmp_path):
    """The file of the last set is the eighth: its position alone gives it that of another."""
    members = {f"Q_R_{k}": {1} for k in (7, 8, 9)} | {"Q_R": {22}, "Q R": {2101}}
    deck = package.Deck(BLOCK)
    deck.add("".join(f"*NSET, NSET={name}\n{min(node)}\n" for name, node in members.items()))
    deck.add("".join(f"*NODE PRINT, NSET={name}\nU\n" for name in members), step=1)
    run = package.run(deck, threads=1, results=tmp_path, program=program_path)
    assert {name: nodes(run.node(name)) for name in members} == members


def test_a_set_without_a_table_has_not_that_of_another(block, tmp_path):
    folder = tmp_path / "results"
    shutil.copytree(block.folder, folder)
    (folder / f"{block.job}_node_K_R_5.csv").unlink()
    run = package.open(folder)
    assert nodes(run.node("K R")) == {1, 22}
    with pytest.raises(LookupError, match="no table has the members of 'K_R'"):
        run.node("K_R")
    run.close()
    shutil.copy(block.folder / f"{block.job}_node_K_R_5.csv", folder)
    (folder / f"{block.job}.h5").write_bytes(b"")  # as while the run writes it
    with pytest.raises(LookupError, match=r"may be node_K_R or node_K_R_5: job\.h5"):
        run.node("K_R")
    assert nodes(run.node("HEEL")) == {1, 22}


def test_a_folder_of_two_jobs_whose_names_begin_alike(block, tmp_path, capsys):
    for folder in ("one", "two"):
        shutil.copytree(block.folder, tmp_path / folder)
    job, other = block.job, f"{block.job}_node"
    for path in [*(tmp_path / "one").glob("*")]:
        if path.is_file():
            shutil.copy(path, path.with_name(path.name.replace(job, other, 1)))
    summary = tmp_path / "one" / f"{other}.json"
    content = json.loads(summary.read_text())
    content["files"] = [name.replace(job, other, 1) for name in content["files"]]
    summary.write_text(json.dumps(content))
    for name in (job, other):
        assert package.open(tmp_path / "one", name).prints == block.prints
    assert compare([str(tmp_path / "one"), str(tmp_path / "two"), "--job", job]) == 0
    capsys.readouterr()
    # Of a run that was killed before its first job.json the folder shows the tables.
    summary.unlink()
    (tmp_path / "one" / f"{job}.json").write_text('{"program": {}, "status": "running"}')
    assert set(package.open(tmp_path / "two").prints) <= set(package.open(tmp_path / "one").prints)
    summary.write_text(json.dumps(content))
    assert package.open(tmp_path / "one", job).prints == block.prints


def test_a_run_is_opened_by_each_of_its_files(block):
    picture = next((block.folder / f"{block.job}_vtk").glob("*.vtu"))
    table = block.folder / f"{block.job}_node_TOE.csv"
    for path in (table, picture, block.folder / f"{block.job}.pvd"):
        assert package.open(path).folder == block.folder
        assert package.open(path).job == block.job
    with pytest.raises(FileNotFoundError):
        package.open(BLOCK)


def test_elements_that_are_absent_are_marked(program_path, tmp_path):
    """VTK files leave them out; the meshes of Python keep the places of all elements."""
    deck = package.Deck(ROOT / "input/built_in_lifts/built_in_lifts.inp")
    run = package.run(deck, threads=1, results=tmp_path, program=program_path)
    first, last = run.fields(step=int(run.saved["step"].min())), run.fields()
    assert first.n_cells == last.n_cells == run.mesh().n_cells
    assert (first.cell_data["STAGE"] == 0).any()
    assert np.array_equal(last.cell_data["STAGE"] > 0, np.ones(last.n_cells, dtype=bool))
    stage = run.file["steps/0001/stage"][:][run._results.solids]
    assert np.array_equal(run.fields(step=1).cell_data["STAGE"], stage)
