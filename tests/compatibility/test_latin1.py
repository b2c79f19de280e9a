"""Decks in Latin-1 and in UTF-8 with a byte order mark: their results are those of UTF-8."""

from __future__ import annotations

import json

import h5py
import pytest
from harness import ROOT, Run
from keyway.deck.deck_file import named_files

SURFACES = (ROOT / "tests/errors/base/surfaces.inp").read_text()
# Every kind of name; two names each that differ by an umlaut alone.
NAMES = {
    "*STEP\n": "*AMPLITUDE, NAME=RÜCK, INPUT=Füllung.txt\n*INCLUDE, INPUT=Grün.inc\n"
    "*STEP, NAME=FÜLLEN\n",
    "*END STEP": "*CLOAD, AMPLITUDE=RÜCK\nSÄULE, 3, -1e3\n*TEMPERATURE, INPUT=Kälte.csv\n"
    "*NODE PRINT, NSET=SÄULE\nU\n*NODE PRINT, NSET=SÖULE\nU\n*EL PRINT, ELSET=BLÖCKE\nS\n"
    "*JOINT PRINT, JOINT=FUGEÄ\nOPENING\n*END STEP",
    "*ELASTIC": "*EXPANSION\n1e-5\n*ELASTIC",
    "NSET=TOP\n5, 6, 7, 8\n": "NSET=SÄULE\n15, 16, 17, 18\n*NSET, NSET=SÖULE\n5, 6, 7, 8\n",
    "ELSET=BLOCK, MATERIAL": "ELSET=BLÖCKE, MATERIAL",
    "ELSET=BLOCK\n": "ELSET=BLÖCKE\n",
    "BLOCK, S1": "BLÖCKE, S1",
    "BLOCK, S2": "BLÖCKE, S2",
    "NAME=UPPER": "NAME=FLÄCHE",
    "UPPER, LOWER": "FLÄCHE, LOWER",
    "NAME=J1, LAW=CONTRACTION": "NAME=FUGEÄ, LAW=GESETZ Ö",
    "NAME=CONTRACTION": "NAME=GESETZ Ö",
}
FILES = {
    "Füllung.txt": "** Zeit, Größe\n0, 0, 1, 1\n",
    "Grün.inc": "** über\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n",
    "Kälte.csv": "SÄULE, 10.\nSÖULE, -10.\n",
}


def deck() -> str:
    text = SURFACES
    for old, new in NAMES.items():
        assert old in text, old
        text = text.replace(old, new)
    return text.replace("MATERIAL=CONCRETE", "MATERIAL=BETÖN").replace(
        "NAME=CONCRETE", "NAME=BETÖN"
    )


@pytest.fixture
def run_in(keyway):
    """Runs the deck as bytes of an encoding, all files beside it in the same."""

    def run(encoding: str, *options: str, text: str | None = None, **more) -> Run:
        folder = keyway.folder
        for name, content in FILES.items():
            (folder / name).write_bytes(content.encode(encoding))
        path = folder / "job.inp"
        path.write_bytes((text or deck()).encode(encoding))
        return keyway(path, *options, **more)

    return run


def kept(run: Run) -> dict[str, object]:
    """All that a run leaves, but for times, sizes and the digest of the deck."""
    summary = {
        key: value
        for key, value in json.loads((run.folder / "job.json").read_text(encoding="utf-8")).items()
        if key not in ("deck", "ledger", "machine", "program")
    }
    tables = {p.name: p.read_bytes() for p in run.folder.glob("*.csv")}
    log = (run.folder / "job.log").read_text(encoding="utf-8").partition("step ")[0]
    names: list[str] = []
    with h5py.File(run.folder / "job.h5") as file:
        file.visit(names.append)
        names += [str(value) for value in file["steps/0001"].attrs.values()]
    return {"json": summary, "tables": tables, "log": log, "h5": names, "said": run.stderr}


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig"])
def test_results_are_those_of_the_deck_in_utf8(run_in, encoding):
    plain = kept(run_in("utf-8"))
    other = kept(run_in(encoding))
    plain.pop("said"), other.pop("said")  # they have times
    assert other == plain
    assert list(plain["json"]["joints"]) == ["FUGEÄ"]
    assert "joints/FUGEÄ" in plain["h5"]


def test_texts_of_the_h5_file_say_that_they_are_utf8(run_in):
    """h5py reads them as text then; a text without umlauts is ASCII, as before."""
    run = run_in("utf-8")
    with h5py.File(run.folder / "job.h5") as file:
        assert file["/mesh/material_names"].asstr()[0] == "BETÖN"
        kinds = {
            name: h5py.check_string_dtype(file["/steps/0001"].attrs.get_id(name).dtype)
            for name in ("name", "procedure")
        }
    assert kinds["name"].encoding == "utf-8"
    assert kinds["procedure"].encoding == "ascii"


def test_check_of_a_deck_in_latin1(run_in):
    def without_cost(run: Run) -> str:
        return run.stdout.partition("Cost on this machine")[0] + run.stderr

    assert without_cost(run_in("latin-1", "--check")) == without_cost(run_in("utf-8", "--check"))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("SÄULE, 3, -1e3", "SÜULE, 3, -1e3"),
        ("FLÄCHE, LOWER", "äöü, FLÄCHE"),
        ("SÄULE, 10.", "SÜULE, 10."),
        ("0, 0, 1, 1", "0, 0, 1, é"),
    ],
)
def test_messages_are_those_of_the_deck_in_utf8(run_in, monkeypatch, old, new):
    """Also the carets below the word."""
    for name, content in FILES.items():
        monkeypatch.setitem(FILES, name, content.replace(old, new))
    text = deck().replace(old, new)
    latin1, plain = (
        run_in(encoding, "--check", text=text, code=2) for encoding in ("latin-1", "utf-8")
    )
    assert latin1.stderr == plain.stderr
    assert new.partition(",")[0] in plain.stderr or "é" in plain.stderr


def test_files_with_names_in_latin1_are_found(keyway):
    """A deck that was written beside such names on a disk."""
    path = keyway.folder / "job.inp"
    path.write_bytes(deck().encode("latin-1"))
    for name, content in FILES.items():
        (keyway.folder / name.encode("latin-1").decode("utf-8", "surrogateescape")).write_bytes(
            content.encode("latin-1")
        )
    keyway(path)
    # Tools that follow INPUT= find them too: a batch that did not would keep an old result.
    assert len(named_files(path)) == 1 + len(FILES)
    assert all(file.exists() for file in named_files(path))


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8"])
def test_a_run_goes_on_with_a_deck_in_latin1(keyway, run_in, encoding):
    """Also where the deck is saved in UTF-8 meanwhile: its cards are the same."""
    text = deck().replace("*STATIC\n", "*STATIC, DIRECT\n0.1, 1.\n*RESTART, WRITE, FREQUENCY=1\n")
    run_in("latin-1", text=text)
    path = keyway.folder / "job.inp"
    path.write_bytes(text.encode(encoding))
    run = keyway(path, "--continue")
    assert run.json["status"] == "finished"
    assert list(run.json["joints"]) == ["FUGEÄ"]


@pytest.mark.parametrize(
    ("letter", "most", "fault"),
    [
        ("Ä", 80, "a name of 81 letters, more than 80"),
        ("€", 53, "a name of 162 bytes in UTF-8, more than 160"),
        ("x", 80, "a name of 81 letters, more than 80"),
    ],
)
def test_names_have_80_letters_of_two_bytes(keyway, letter, most, fault):
    name = letter * most
    files = {file: content.replace("SÄULE", name) for file, content in FILES.items()}
    run = keyway(deck().replace("SÄULE", name), files=files)
    assert run.csv("node_" + (name.upper() if letter == "x" else "_" * len(name.encode())))
    done = keyway(deck().replace("SÄULE", name + letter), "--check", files=files, code=2)
    assert fault in done.stderr
    near = deck().replace("SÄULE", name).replace("SÖULE\nU", f"{name[:-1]}\nU")
    done = keyway(near, "--check", files=files, code=2)
    assert f"did you mean '{name.upper()}'" in done.stderr


@pytest.mark.parametrize("name", ["job.inp", *FILES])
def test_text_in_utf16_is_refused(keyway, name):
    """One message that says what to do, at the place where the file is named."""
    for file, text in {**FILES, "job.inp": deck()}.items():
        encoding = "utf-16" if file == name else "utf-8"
        (keyway.folder / file).write_bytes(text.encode(encoding))
    stderr = keyway(keyway.folder / "job.inp", "--check", code=2).stderr
    assert "job.inp:" in stderr and f"{name}': it is in UTF-16" in stderr
    assert stderr.count("[") == 1


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8"])
def test_mark_of_utf8_above_latin1(keyway, encoding):
    """An editor has put the mark there; the lines below are what they are."""
    for file, text in {**FILES, "job.inp": deck()}.items():
        (keyway.folder / file).write_bytes(b"\xef\xbb\xbf" + text.encode(encoding))
    assert list(keyway(keyway.folder / "job.inp").json["joints"]) == ["FUGEÄ"]
