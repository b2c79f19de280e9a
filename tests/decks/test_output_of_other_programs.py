"""Cards by which decks of Abaqus and CalculiX ask for output never stop a run.

Fields that Keyway has are written. The rest stands in `ignored_input`.
"""

import h5py
import pytest
from harness import ROOT

BLOCK = (ROOT / "tests" / "errors" / "base" / "block.inp").read_text()
AT_STEP = "*DLOAD"

CARDS = """\
*Restart, write, frequency=0
*Output, field, frequency=1, time marks=NO
*Node Output, nset=TOP
CF, RF, U, U1
*Element Output, directions=YES
LE, PEEQ, PEMAG, CTSHR, S
*Contact Output
CDISP, CSTRESS
*Output, history, variable=PRESELECT
*Output, history, frequency=2
*Node Output, nset=TOP
U3, RF3
*Element Output, elset=DAM
S11
*Energy output
ALLIE, ALLKE
*Node print, totals=only
U
*Section print, surface=UPSTREAM
SOF
"""


def deck_with(tmp_path, cards, procedure="*STATIC"):
    path = tmp_path / "asked.inp"
    path.write_text(BLOCK.replace("*STATIC", procedure).replace(AT_STEP, cards + AT_STEP))
    return path


def fields_of_last_step(run):
    with h5py.File(run.folder / "asked.h5") as file:
        step = file["steps"][sorted(file["steps"])[-1]]
        names = set()
        step.visit(lambda name: names.add(name.split("/")[-1]))
        return names


def test_known_fields_are_written_and_the_rest_is_named(tmp_path, keyway):
    run = keyway(deck_with(tmp_path, CARDS))
    noted = [(item["keyword"], item["why"]) for item in run.json["ignored_input"]]
    assert ("OUTPUT", "TIME MARKS has no effect here") in noted
    assert ("CONTACT OUTPUT", "has no effect here") in noted
    assert ("SECTION PRINT", "has no effect here") in noted
    unwritten = {keyword: why for keyword, why in noted if why.startswith("not written")}
    assert unwritten["NODE OUTPUT"].startswith("not written: CF; expected U, V, A, RF")
    assert unwritten["ELEMENT OUTPUT"].startswith("not written: CTSHR; expected S, E")
    assert {"U", "RF", "S", "E"} <= fields_of_last_step(run)


def test_histories_are_prints_of_sets(tmp_path, keyway):
    run = keyway(deck_with(tmp_path, CARDS))
    heads = (run.folder / "asked_node_TOP.csv").read_text().splitlines()[0].split(",")
    assert heads[4:] == ["U1", "U2", "U3", "RF1", "RF2", "RF3"]
    assert "S11" in (run.folder / "asked_el_DAM.csv").read_text().splitlines()[0]


@pytest.mark.parametrize(
    ("card", "frames"),
    [
        ("*Output, field, variable=PRESELECT", 20),
        ("*Output, field, variable=PRESELECT, number interval=5", 5),
        ("*Output, field, variable=PRESELECT, time interval=0.1", 2),
        ("*Output, field, variable=ALL, frequency=20", 1),
    ],
)
def test_times_of_output(tmp_path, keyway, card, frames):
    """20 increments of 0.01 s; the state at the start of the step is not counted."""
    run = keyway(deck_with(tmp_path, card + "\n", "*DYNAMIC, DIRECT\n0.01, 0.2"))
    pictures = (run.folder / "asked.pvd").read_text().count("<DataSet")
    assert pictures in (frames, frames + 1)
    assert {"U", "RF", "S"} <= fields_of_last_step(run)
