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


def test_number_of_outputs_in_a_later_step(tmp_path, keyway):
    """A request of the first step, of 2 increments, gives 5 outputs in the second one, of 20."""
    card = "*Output, field, variable=PRESELECT, number interval=5\n"
    path = deck_with(tmp_path, card, "*STATIC, DIRECT\n0.5, 1.")
    later = "*STEP\n*DYNAMIC, DIRECT\n0.01, 0.2\n*END STEP\n"
    path.write_text(path.read_text() + later)
    steps = keyway(path).results.file["steps"]
    assert [len(steps[f"{step:04d}/increments"]) for step in (1, 2)] == [2, 5]


# Cards as manuals, models of users and preprocessors have them; abbreviated and misspelt ones too.
ASKED = [
    "*Output, field, freq=5\n*Node output\nU,",
    "*Output, history, freq=2\n*Node Output, nset=TOP\nU1",
    "*Output, field, num=4, time marks=YES\n*Node Output, var=PRESELECT",
    "*Output, field, op=NEW, number interval=20, time marks=NO",
    "*Output, field, name=F, mode list\n*Element Output, elset=DAM, directions=NO, position=NODES",
    "*Output, frequencyf=3",
    "*Output, field, timepoints=T\n*Time Points, name=T\n0.1, 0.2",
    "*Output, field, frequncy=5",
    "*Output, fild, filter=ANTIALIASING, sensor",
    "*Node Output, nset=TOP, exterior\nU, UR, CF, RM, PHILSM",
    "*Element Output, elset=DAM, rebar, directions=YES, sectionpoints\n1, 3, 5\nS, LE, STATUSXFEM",
    "*Contact Output, nset=TOP, master=A, slave=B, variable=ALL\nCSTRESS, CDISP",
    "*Energy Output, elset=DAM, variable=PRESELECT\nALLAE",
    "*Modal Output\nGU",
    "*Incrementation Output, variable=PRESELECT",
    "*Integrated Output, section=SEC, variable=PRESELECT\nSOF",
    "*Surface Output\nCSTRESS",
    "*Node file, nset=TOP, global=YES, output=3D, last iterations, freq=2\nU, PU, KEQ",
    "*Node file, output all, contact elements=2, totals=YES, frequencyf=1\nRF",
    "*El file, elset=DAM, internal=NO, position=AVERAGED AT NODES, mode=3, last mode=5\nS, ME, ZZS",
    "*Elfile\nNOE, PEEQ, ENER, ERR",
    "*Contact file, freq=3, timepoints=T\nCDIS, CSTR, PCON",
    "*Contact print, totals=ONLY, slave=A, master=B\nCDIS, CF",
    "*Node print, nset=TOP, freq=2, totals=ONLY, global=NO, summary=NO, last mode=2\nU, RF, MF",
    "*Node print, nset=TOP, fequency=3\nU",
    "*Node print\nU",
    "*El print, elset=DAM, position=CENTROIDAL, summary=YES, freq=999\nS11, MISES, EVOL",
    "*Section print, surface=UPSTREAM, name=SP1, frequency=2, totals=YES, axes=LOCAL\nSOF, SOM",
    "*Section file, surface=UPSTREAM, name=SP2\nSOF",
    "*Energy print, elset=DAM, freq=0",
    "*Energy file",
    "*File format, ascii\n*File output, number interval=4",
    "*Monitor, dof=1, node=5, frequency=1",
    "*Print, contact=YES, frequency=1, plasticity=NO",
    "*Preprint, echo=YES, model=NO, history=NO, contact=NO",
    "*Diagnostics, contact=YES",
    "*Restart, write, frequency=0, overlay",
    "*Restart, write, freq=2, number interval=10, time marks=NO",
    "*Restart, frequency=10",
]


@pytest.mark.parametrize("cards", ASKED)
def test_no_request_stops_a_run(tmp_path, keyway, cards):
    keyway(deck_with(tmp_path, cards + "\n"))


@pytest.mark.parametrize(
    ("cards", "frames"),
    [
        ("*Output, field, freq=5\n*Node output\nU", 4),
        ("*Output, field, NUM=4\n*Node output\nU", 4),
        ("*Node file, FREQ=10\nU", 2),
    ],
)
def test_abbreviated_parameters(tmp_path, keyway, cards, frames):
    """The first letters of a parameter stand for it, as in Abaqus; 20 increments."""
    run = keyway(deck_with(tmp_path, cards + "\n", "*DYNAMIC, DIRECT\n0.01, 0.2"))
    assert (run.folder / "asked.pvd").read_text().count("<DataSet") in (frames, frames + 1)


def test_unknown_parameters_are_named(tmp_path, keyway):
    noted = keyway(deck_with(tmp_path, "*Node print, nset=TOP, fequency=3\nU\n")).json
    why = [item["why"] for item in noted["ignored_input"]]
    assert why == ["FEQUENCY has no effect here; did you mean 'FREQUENCY'?"]


def test_restart_of_another_run_is_refused(tmp_path, keyway):
    path = deck_with(tmp_path, "")
    path.write_text("*RESTART, READ, STEP=2\n" + path.read_text())
    run = keyway(path, code=2)
    assert "*RESTART: READ is not available; expected the same deck without this card" in run.stderr
    assert "--continue" in run.stderr
