"""The report of a run, opened in a real browser without a network.

The runs are short; the long deck whose page must stay below 15 MB is a long test.
"""

import contextlib
import hashlib
import io
import json
import re
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
from harness import ROOT
from keyway_tools.report import __main__ as report
from keyway_tools.report.browser import find_browser, opened, print_pdf
from keyway_tools.report.errors import error_beside, estimates
from keyway_tools.report.values import (
    accuracy,
    deck_of,
    echo_of,
    header,
    key_numbers,
    title_of,
    verdict,
)
from keyway_tools.results import folder_and_job
from keyway_tools.si_results import SiResults, Units
from stage_decks import build
from stage_decks import lifts as column

NEEDS = "no Chromium, Chrome or Edge; tools/test installs chromium on Debian"
needs_browser = pytest.mark.skipif(find_browser() is None, reason=NEEDS)
# Without a graphics card a page takes 10 s to draw, on a busy machine much longer.
pytestmark = pytest.mark.timeout(900)
LARGEST = 15e6  # [bytes] of a page: it must still pass as an attachment of a mail


def page_of(*arguments):
    """The page that tools/report writes."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert report.main([str(argument) for argument in arguments]) == 0
    return report.Path(text.getvalue().split()[0])


@pytest.fixture(scope="module")
def block(tmp_path_factory, program_path):
    """Results of a block on a joint under water: two static steps, 10 saved states, a joint."""
    folder = tmp_path_factory.mktemp("block")
    run(program_path, "block_on_joint.inp", folder)
    return folder


@pytest.fixture(scope="module")
def modes(tmp_path_factory, program_path):
    """Results of a step of natural modes alone."""
    folder = tmp_path_factory.mktemp("modes")
    run(program_path, "monolith_frequencies.inp", folder)
    return folder


def run(program, deck, folder):
    command = [str(program), "-q", "-j", "1", "-o", str(folder), str(ROOT / "input" / deck)]
    assert subprocess.run(command, timeout=300).returncode == 0


def summary_of(folder):
    return json.loads(next(folder.glob("*.json")).read_text())


def value_at(summary, path):
    """A value by its path in job.json."""
    for key in path.split("."):
        summary = summary[int(key)] if isinstance(summary, list) else summary[key]
    return summary


@needs_browser
def test_page_shows_the_numbers_of_job_json(block):
    """Every number with a path, to the four digits shown; no error in the console."""
    page_file, summary, errors = page_of(block), summary_of(block), []
    assert page_file.stat().st_size < LARGEST
    with opened(page_file, errors) as page:
        shown = page.eval_on_selector_all(
            "[data-path]", "all => all.map(e => [e.dataset.path, e.textContent])"
        )
        verdict_text = page.inner_text("#verdict")
        assert page.get_attribute("body", "data-failed") is None
    assert errors == []
    assert "finished" in verdict_text
    assert {"displacement.anywhere.value", "joints.BED.opening.anywhere.value"} <= {
        path for path, _ in shown
    }
    for path, text in shown:
        in_page_units = 1e-6 if ".S1" in path or ".S3" in path or ".pressure" in path else 1e3
        expected = in_page_units * value_at(summary, path)
        assert float(text) == pytest.approx(expected, rel=1e-3, abs=1e-12), path


@needs_browser
def test_slider_moves_the_dam_through_the_saved_states(block):
    """Positions in the drawing: of the mesh plus the displacement of the chosen time."""
    results, errors = SiResults(block), []
    saved = sorted(results.displacements(), key=lambda one: one[1])
    with opened(page_of(block), errors) as page:
        page.select_option("#field", "displacement")
        largest = []
        for k in (0, len(saved) - 1):
            page.eval_on_selector("#time", MOVE, k)
            page.wait_for_function(
                f"document.getElementById('time-shown').textContent === '{saved[k][1]:.6g} s'"
            )
            page.wait_for_timeout(300)
            largest.append(float(page.get_attribute("#caption-0", "data-largest")))
            u = results.displacement(saved[k][0])
            expected = 1e3 * np.linalg.norm(u, axis=1).max()
            assert largest[-1] == pytest.approx(expected, rel=1e-4)
        drawn = np.array(page.evaluate(DRAWN))
        page.eval_on_selector("#factor", MOVE, 0)
        page.wait_for_timeout(500)
        at_rest = np.array(page.evaluate(DRAWN))
    assert errors == []
    assert largest[1] > largest[0]
    assert np.ptp(at_rest[0]) == pytest.approx(np.ptp(results.x[:, 0]), rel=1e-6)
    assert np.abs(drawn - at_rest).max() > 0.02 * np.ptp(results.x[:, 2])


MOVE = "(slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')); }"
CUT_TABLES = (
    "[...document.querySelectorAll('.run table')].filter("
    "t => t.offsetWidth > t.closest('.run').clientWidth + 1).map(t => t.innerText)"
)
DRAWN = "['x', 'y', 'z'].map(k => Array.from(document.getElementById('space-0').data[0][k]))"


@needs_browser
def test_modes_move_and_fields_change(modes):
    errors = []
    with opened(page_of(modes), errors) as page:
        page.select_option("#field", "mode:1")
        page.wait_for_timeout(500)
        before = np.array(page.evaluate(DRAWN))
        page.click("#play")
        page.wait_for_timeout(1500)
        assert np.abs(np.array(page.evaluate(DRAWN)) - before).max() > 0.0
        hz = page.inner_text("[data-path='steps.0.frequencies.1.hz']")
        assert "mode 2" in page.inner_text("#caption-0")
    assert errors == []
    assert float(hz) == pytest.approx(summary_of(modes)["steps"][0]["frequencies"][1]["hz"], 1e-3)


@pytest.fixture(scope="module")
def lifts(tmp_path_factory, program_path):
    """Results of a column that is built in three lifts of 1 m."""
    folder = tmp_path_factory.mktemp("lifts")
    steps = build(3).replace("*NODE PRINT", "*NODE FILE\nU\n*NODE PRINT")
    (folder / "job.inp").write_text(column(3) + steps)
    command = [str(program_path), "-q", "-j", "1", "-o", str(folder), str(folder / "job.inp")]
    assert subprocess.run(command, timeout=300).returncode == 0
    return folder


@needs_browser
def test_absent_elements_are_not_drawn(lifts):
    """Triangles reach up to the lift of the step; envelopes and modes show the whole dam."""
    errors = []
    with opened(page_of(lifts), errors) as page:
        page.select_option("#field", "displacement")
        page.eval_on_selector("#factor", MOVE, 0)
        heights = []
        for k in range(3):
            page.eval_on_selector("#time", MOVE, k)
            page.wait_for_timeout(500)
            heights.append(page.evaluate(TOP))
    assert errors == []
    assert heights == pytest.approx([1.0, 2.0, 3.0], rel=1e-6)


TOP = """(() => {
  const body = document.getElementById('space-0').data[0];
  return Math.max(...[body.i, body.j, body.k].flatMap(all => Array.from(all, n => body.z[n])));
})()"""


@needs_browser
def test_two_runs_side_by_side_and_on_paper(block, modes, tmp_path):
    errors = []
    path = page_of(block, modes, "-o", tmp_path / "both.html")
    with opened(path, errors) as page:
        boxes = [page.locator(f"#space-{k}").bounding_box() for k in (0, 1)]
        assert boxes[0]["y"] == boxes[1]["y"]
        assert boxes[0]["x"] + boxes[0]["width"] <= boxes[1]["x"]
        page.set_viewport_size({"width": 1300, "height": 1000})
        assert page.evaluate(CUT_TABLES) == []  # nothing hidden at the right of a column
    assert errors == []
    assert print_pdf(path).read_bytes().startswith(b"%PDF")


def test_page_needs_no_network(block):
    """No address of another file in what the page itself says (plotly.js names some in texts)."""
    text = page_of(block).read_text()
    own = re.sub(r"<script>.*?</script>", "", text, flags=re.S)
    assert re.findall(r"(?:src|href|url)\s*[=(]\s*[\"']?(?!data:)[\w/.:]", own) == []


def test_verdict_of_a_stopped_run(block, tmp_path):
    for file in block.iterdir():
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    path = tmp_path / "block_on_joint.json"
    summary = json.loads(path.read_text())
    summary |= {"status": "stopped", "message": "no equilibrium at t = 1.2 s", "warnings": ["odd"]}
    path.write_text(json.dumps(summary))
    found = verdict(SiResults(tmp_path))
    assert found[0] == ("bad", "The run is incomplete (stopped): no equilibrium at t = 1.2 s.")
    assert ("fair", "odd") in found
    assert "no equilibrium at t = 1.2 s" in page_of(tmp_path).read_text()


def test_assumptions_come_from_the_deck(block):
    deck = deck_of(SiResults(block))
    assert deck.caution == ""
    assert "Shows: *JOINT without strength" in deck.remarks
    assert title_of("** a\n*Heading\n** b\n Dam, 30 m \n*NODE\n") == "Dam, 30 m"
    assert title_of("*NODE\n1, 0\n") == ""


def test_echo_of_the_deck_ends_above_its_warnings(tmp_path):
    log = tmp_path / "job.log"
    results = SimpleNamespace(path=lambda ending: log)
    for heading in ("warnings of the deck", "ignored input", "step 1  increment 1"):
        log.write_text(f"*STEP\n*STATIC\n{heading}\njob.inp:1: *STEP\n")
        assert echo_of(results) == "*STEP\n*STATIC"


def test_estimates_of_errors_are_shown_where_there_are_some(block, tmp_path):
    for file in block.iterdir():
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    path = tmp_path / "block_on_joint.json"
    summary = json.loads(path.read_text())
    summary["accuracy"]["estimates"] = {"displacement": {"value": 9.0, "error": 1.2, "mesh": 1.1}}
    path.write_text(json.dumps(summary))
    text = page_of(tmp_path).read_text()
    assert text.count("± 1200 mm (mesh 1100)") == 1  # beside the envelope, in its unit
    assert "Other estimated errors" not in text
    assert "no estimate of those" not in text


def test_other_estimates_are_told_in_words_and_in_the_units_of_the_page(block):
    """In a deck in mm and MPa; what stands beside an envelope is not told again."""
    results = SiResults(block, units=Units.parse("mm,MPa"))
    results.summary["accuracy"]["estimates"] = {
        "stress": {"value": 8.0, "error": 2.0, "relative": 0.25, "at": 1.5, "elastic_volume": 0.5},
        "law": {"value": 9.0, "relative": 0.04, "stress": 0.3, "points": 7},
        "displacement": {"value": 5.0, "error": 1.0, "mesh": 1.0, "iteration": 1e-9},
        "opening": {"value": 4.0, "error": 0.5, "springs": 0.1, "joints": 0.5},
        "new": {"value": 2.0},
    }
    assert estimates(results, ["Largest displacement"]) == [
        ("Largest joint opening",
         "± 0.5 mm (joints 0.5; mesh not estimated); springs of joints contribute about 0.1 mm"),
        ("Mesh, in the stresses of the whole model",
         "25 % in the energy norm, at 1.5 s, in the solids that are elastic then, "
         "50 % of the volume"),
        ("Increments, in the law of the solids",
         "4 % of the dissipated energy, at most 0.3 MPa in a stress (7 points sampled)"),
        ("new", "value 2"),
    ]  # fmt: skip
    assert error_beside(results, "U", 1e3, "mm") == "± 1 mm (mesh 1)"
    known = results.summary["accuracy"]["estimates"]
    known |= {"displacement": {"error": 2.0, "iteration": 2.0}, "S1": {"error": 3.0, "mesh": 3.0}}
    assert error_beside(results, "U", 1e3, "mm") == "± 2 mm (iteration 2; mesh not estimated)"
    assert error_beside(results, "S1", 1e-6, "MPa") == "± 3 MPa (mesh 3)"
    results.summary["steps"] = [{"procedure": "dynamic"}]
    assert error_beside(results, "S1", 1e-6, "MPa") == "± 3 MPa (mesh 3; time not estimated)"


def test_a_run_killed_early_has_the_rows_of_its_energies(block, tmp_path):
    """job.json is that of the start; the table of energies knows how far the run has come."""
    for file in block.glob("block_on_joint*"):
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    results = SiResults(tmp_path)
    results.summary.update(status="running", steps=[], displacement={}, envelopes={}, joints={})
    text = " ".join(words for _, words in verdict(results))
    assert "step 2, increment 4, time 2 s, by block_on_joint_energy.csv" in text
    assert key_numbers(results) == []
    assert accuracy(results) == []


def test_a_run_killed_later_says_that_its_tables_go_on(block, tmp_path):
    """job.json is that of the end of the first step, and the page has the largest values of it."""
    for file in block.glob("block_on_joint*"):
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    results = SiResults(tmp_path)
    results.summary.update(status="running", steps=results.summary["steps"][:1])
    name = results.summary["steps"][0]["name"]
    text = " ".join(words for _, words in verdict(results))
    assert "What follows holds up to there" not in text
    assert f"Key numbers, joints and balances below hold up to step {name}, " in text
    assert "go on: the last row of block_on_joint_energy.csv is that of step 2, increment 4" in text
    whole = SiResults(tmp_path)
    whole.summary.update(status="stopped", message="no equilibrium")
    assert "What follows holds up to there: step " in verdict(whole)[1][1]


def test_cracks_without_damage_have_their_energy_and_no_place(block):
    """A law without a damage variable: damage 0 everywhere occurs at no place."""
    results = SiResults(block)
    zero = {"value": 0.0, "time": 1.0, "x": [1.0, 2.0, 3.0]}
    results.summary["envelopes"]["DAMAGET"] = {"anywhere": zero}
    results.summary["damage"] = {
        "inelastic": {"volume": 30.0}, "dissipated": {"cracking": 2e6, "crushing": 0.0}
    }  # fmt: skip
    rows = {row["label"]: row for row in key_numbers(results)}
    assert rows["Largest damage in tension"]["x"] is None
    assert rows["Largest damage in tension"]["time"] is None
    energy = rows["Dissipated by cracking"]
    assert (energy["value"], energy["unit"]) == (2.0, "MJ")
    assert value_at(results.summary, energy["path"]) == 2e6
    assert "Dissipated by crushing" not in rows
    assert rows["Volume beyond elasticity"]["value"] == 30.0


def test_deck_is_looked_for_above_the_results(block, tmp_path, monkeypatch):
    """The run knows its deck by a name relative to where it started; the digest decides."""
    text = b"*HEADING\nA dam\n** Shows: a remark\n*NODE\n"
    folder = tmp_path / "study" / "results"
    folder.mkdir(parents=True)
    (tmp_path / "study" / "dam.inp").write_bytes(b"*HEADING\nAnother dam\n")
    (tmp_path / "dam.inp").write_bytes(text)
    for file in block.glob("block_on_joint.*"):
        (folder / file.name).write_bytes(file.read_bytes())
    monkeypatch.chdir("/")
    results = SiResults(folder)
    results.summary["deck"] = {"file": "dam.inp", "sha256": hashlib.sha256(text).hexdigest()}
    assert deck_of(results).title == "A dam"
    assert deck_of(results).caution == ""
    results.summary["deck"]["sha256"] = "0" * 64
    assert "has changed" in deck_of(results).caution
    results.summary["deck"]["file"] = "no such deck.inp"
    assert "neither here nor" in deck_of(results).caution


def test_folder_without_results_is_refused(tmp_path, capsys):
    assert report.main([str(tmp_path)]) == 2
    assert "no results of Keyway" in capsys.readouterr().err
    assert report.main([str(tmp_path / "dam.inp")]) == 2
    assert "nor results of a job of this name" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.2443, "0.244 s"), (59.96, "60 s"), (1132.42, "18 min 52 s"), (3599.6, "1 h 0 min")],
)
def test_cost_is_in_minutes_where_it_is_long(seconds, words):
    summary = {"ledger": {"wall_s": seconds, "peak_memory_mb": 1388.47}}
    rows = header(SimpleNamespace(summary=summary, job="dam", date="2026-01-01"))
    assert dict(rows)["Cost"] == f"{words}, 1,388 MB"


@pytest.mark.parametrize("name", ["dam.v2", "dam.v2.inp", "dam.v2.json", "dam.v2.h5"])
def test_job_may_be_named_by_its_deck_or_a_file_of_it(tmp_path, name):
    (tmp_path / "dam.v2.json").touch()
    (tmp_path / "other.json").touch()
    assert folder_and_job(tmp_path / name) == (tmp_path, "dam.v2")


@pytest.mark.full
@needs_browser
def test_page_of_the_arch_dam_is_small(tmp_path, program_path):
    """15 MB, and the opening of a joint as in job.json. Long: 1000 increments."""
    run(program_path, "xingbiling_matching/xingbiling_matching.inp", tmp_path)
    path, errors = page_of(tmp_path), []
    assert path.stat().st_size < LARGEST
    with opened(path, errors) as page:
        shown = float(page.inner_text("[data-path='joints.JOINT1.opening.anywhere.value']"))
    opening = summary_of(tmp_path)["joints"]["JOINT1"]["opening"]["anywhere"]["value"]
    assert errors == []
    assert shown == pytest.approx(1e3 * opening, rel=1e-3)
