"""The study of the paper's dams: cases, the page, going on after a kill, what it says."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from keyway_tools.colour_scale import parse_levels
from keyway_tools.paper_study.case_table import list_cases
from keyway_tools.paper_study.cases import Case, choose
from keyway_tools.paper_study.checks import coupling_verdicts
from keyway_tools.paper_study.facts import Facts
from keyway_tools.paper_study.openings import by_height
from keyway_tools.paper_study.page import write_page
from keyway_tools.paper_study.runner import Outcome, Study
from keyway_tools.paper_study.sizes import SIZES
from keyway_tools.paper_study.verdicts import dam_verdicts, differences, joint_verdicts, robust

TOOL = Path(__file__).resolve().parents[2] / "tools" / "paper_study.py"
CLOSED = {"upstream": 0.0, "downstream": 0.0}
PAIR = ["xingbiling_classical", "xingbiling_chain"]


def study(folder, program, *options):
    """The command line of a study with two tiny cases."""
    return [
        sys.executable, str(TOOL), "--size", "tiny", "--cases", *PAIR, "-o", str(folder),
        "--program", str(program), "--threads", "1", *options,
    ]  # fmt: skip


def test_stopped_study_goes_on_and_writes_its_page(tmp_path, program_path):
    """Stopped in its second case, it keeps the first, and the page holds both."""
    child = subprocess.Popen(
        study(tmp_path, program_path), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    for line in child.stdout:
        if line.startswith("xingbiling_chain: running"):
            os.kill(child.pid, signal.SIGTERM)
            break
    _, told = child.communicate(timeout=120)
    # 0 or -SIGTERM: the runs were at their end before the signal
    assert child.returncode in (130, 0, -signal.SIGTERM), told
    done = subprocess.run(
        study(tmp_path, program_path), capture_output=True, text=True, timeout=500, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "xingbiling_classical: finished (kept)" in done.stdout
    page = (tmp_path / "paper_study.html").read_text()
    for words in (
        "the paper's chain",
        "Fig. 10",
        "data:image/png;base64",
        "6.5 %",
        "No joint opens",
    ):
        assert words.replace("'", "&#39;") in page or words in page
    assert "src=" not in page.replace('src="data:', "")  # needs no other file
    assert "No case of Jinping has finished." in page
    assert "opening, downstream face differs" not in page  # of 1e-18 m
    data = json.loads((tmp_path / "paper_study.json").read_text())
    assert [case["openings"]["JOINT1"] for case in data["cases"]] == 2 * [CLOSED]
    assert [case["status"] for case in data["cases"]] == ["finished", "finished"]
    assert all(case["unknowns"] > 0 for case in data["cases"])
    other = study(tmp_path, program_path)
    other[other.index(PAIR[1])], other[other.index("--threads") + 1] = PAIR[0], "2"
    subprocess.run(other, capture_output=True, timeout=120, check=True)
    data = json.loads((tmp_path / "paper_study.json").read_text())
    # another number of threads keeps the runs; the page has also the case that was not chosen
    assert [case["name"] for case in data["cases"]] == PAIR


def test_no_case_starts_after_the_budget(tmp_path):
    class Idle:
        is_ending = False

        def is_kept(self, deck, folder):
            return False

    log = []
    spent = Study(tmp_path, Idle(), -1.0, log.append)
    spent.until = time.monotonic() - 1.0
    case = choose(list_cases(SIZES["tiny"]), PAIR[:1])
    outcomes = spent.run(case, 1)
    assert outcomes[0].record.status == "not run: the budget is spent"
    assert not log
    assert not (tmp_path / "decks").exists()  # a mesh of full size takes long


def test_cases_have_names_of_their_own_and_commands():
    cases = list_cases(SIZES["full"])
    names = [case.name for case in cases]
    assert len(set(names)) == len(names)
    assert len(choose(cases, ["s_*"])) == len(choose(cases, ["sensitivity"]))
    assert [case.name for case in choose(cases, ["jinping"])] == ["jinping"]
    (command,) = choose(cases, ["s_kn_1e11"])[0].commands(Path("a.inp"), Path("m"))
    assert command.startswith("tools/make_jinping.py a.inp --duration 20")
    assert "--kn 1.25e11" in command
    winter = choose(cases, ["s_winter"])[0].commands(Path("a.inp"), Path("m"))
    assert "--lifts 4 --grouting 2 4 --temperatures 1e-5 16 10" in winter[0]
    assert winter[1].startswith("tools/make_temperature.py a.inp")
    motion, deck = choose(cases, ["s_motion_5"])[0].commands(Path("a.inp"), Path("m"))
    assert "--seed 5" in motion
    assert "--motion-of m/seed_5" in deck
    with pytest.raises(ValueError, match="no case fits 'nothing'"):
        choose(cases, ["nothing"])


def test_a_deck_that_cannot_be_made_stops_only_its_case(tmp_path):
    bad = Case("bad", "xingbiling", "bad", "make_dam", "--arc 3")
    runner = SimpleNamespace(is_ending=False)
    outcome = Study(tmp_path, runner, 1.0, print).run([bad], 1)[0]
    assert outcome.record.status == "no deck"
    assert "could not be made" in outcome.record.message


def made_up(name, **changes):
    """Facts of a dam like the paper's."""

    def extreme(value):
        return {"anywhere": {"value": value, "time": 1.0, "x": [0.0, 0.0, 230.0]}}

    facts = Facts(name, name, "finished", unknowns=1, height=300.0)
    facts.extremes = {"S1_POINT": extreme(2.48e6), "S3_POINT": extreme(-28.73e6)}
    facts.openings = {
        f"JOINT{k}": {"upstream": 0.01 / k, "downstream": 0.005 / k} for k in range(1, 7)
    }
    facts.places = {name: [0.0, 0.0, 300.0] for name in facts.openings}
    facts.damaged = {"all": 10.0, "upper": 10.0, "upper downstream": 9.0, "lower": 0.0,
                     "lower, before the motion": 0.0, "volume of the dam": 100.0}  # fmt: skip
    for key, value in changes.items():
        setattr(facts, key, value)
    return facts


def test_a_dam_like_the_papers_agrees_in_everything():
    assert {one.kind for one in dam_verdicts(made_up("a"))} == {"good"}


def test_findings_that_do_not_come_out_are_said():
    lower = {"all": 10.0, "upper": 2.0, "upper downstream": 1.0, "lower": 8.0,
             "lower, before the motion": 6.0, "volume of the dam": 100.0}  # fmt: skip
    places = {f"JOINT{k}": [0.0, 0.0, 100.0] for k in range(1, 7)}
    said = dam_verdicts(made_up("a", damaged=lower, places=places))
    text = " ".join(one.text for one in said if one.kind == "fair")
    assert "0 of 6 joints" in text
    assert "80 % of the damaged concrete is below 0.6" in text
    assert "75 % of that is damaged before the motion" in text
    kept = robust(made_up("base"), [made_up("other", damaged=lower)])
    assert [one.kind for one in kept].count("fair") == 1
    assert "not with other" in next(one.text for one in kept if one.kind == "fair")


def test_joints_that_stay_closed_are_said_to():
    closed = made_up("a", openings={f"JOINT{k}": CLOSED for k in range(1, 7)})
    said = [one.text for one in dam_verdicts(closed) if "oint" in one.text and "open" in one.text]
    assert said == ["No joint opens; in the paper joint 1 opens most."]
    (outer,) = [one for one in robust(closed, []) if one.text.startswith("An outer joint")]
    assert outer.text.endswith("not so in the base itself.")


def test_parts_without_their_cases_say_what_they_need(tmp_path):
    """What is true whichever of the cases have finished."""
    base = choose(list_cases(SIZES["tiny"]), ["s_base"])
    record = SimpleNamespace(status="stopped", wall_s=None, processor_s=None, message="")
    page = write_page(tmp_path, [], [Outcome(base[0], record)], []).read_text()
    assert " not run" not in page
    for words in (
        "the classical joint and at least one other joint model have finished",
        "at least two records have finished",
        "the base and at least one variant have finished",
    ):
        assert words in page


def test_differences_stand_beside_those_of_the_paper():
    def run(name, factor):
        places = ("anywhere", "upstream", "downstream")
        extremes = {
            field: {place: {"value": factor * value} for place in places}
            for field, value in (("S1", 5e6), ("S3", -8e6), ("OPENING", 0.02))
        }
        return Facts(name, name, "finished", extremes=extremes)

    rows = differences(run("a", 1.0), run("b", 1.03))
    assert [row.relative for row in rows] == pytest.approx([0.03] * 7)
    assert [row.paper for row in rows] == [0.065, None, None, None, None, 0.01, 0.065]
    kinds = [one.kind for one in joint_verdicts(run("a", 1.0), run("b", 1.03))]
    assert kinds == ["good", "fair", "good"]


def test_a_crest_that_the_motion_moves_is_named_with_its_reason():
    slips = {"JOINT1": 0.1, "JOINT3": 0.5}
    (one,) = [v for v in dam_verdicts(made_up("a", moved=0.5, slips=slips)) if "crest at" in v.text]
    assert one.kind == "fair"
    assert "by 0.5 m for good, and JOINT3 slips by up to 0.5 m" in one.text
    assert "Elastic concrete" in one.text


def test_coupling_is_judged_beside_both_equal_meshes():
    def run(s1, opening):
        fields = {"S1": s1, "S3": -2.0, "OPENING": opening}
        extremes = {
            name: {face: {"value": value} for face in ("upstream", "downstream")}
            for name, value in fields.items()
        }
        return Facts("a", "a", "finished", unknowns=1, extremes=extremes)

    facts = {
        "xingbiling_classical": run(1.0, 0.010),
        "xingbiling_classical_shifted": run(2.0, 0.020),
        "xingbiling_one_step_shifted": run(2.1, 0.015),
    }
    (one,) = coupling_verdicts(facts)
    assert one.kind == "fair"
    assert "by 5 % beyond" in one.text  # 2.1 beside 1 to 2
    assert "largest opening by 0 %" in one.text
    assert not coupling_verdicts({})


def test_lines_of_values_have_the_sign_of_their_field():
    assert parse_levels(["S1=2.48", "s3=20"]) == {"S1": 2.48, "S3": -20.0}
    for word, message in (("S9=1", "expected FIELD=VALUE"), ("S1=0", "other than zero")):
        with pytest.raises(ValueError, match=message):
            parse_levels([word])


def test_histories_are_sorted_by_height_and_face():
    points = [(1, 0.0, 300.0), (2, 9.0, 300.0), (3, 0.0, 200.0), (4, 30.0, 100.0), (5, 0.0, 100.0)]
    table = {
        "point": np.array([p for p, _, _ in points] * 2),
        "y": np.array([y for _, y, _ in points] * 2),
        "z": np.array([z for _, _, z in points] * 2),
    }
    crest, middle, base = by_height(table)
    assert table["point"][crest["upstream"]].tolist() == [1, 1]
    assert table["point"][crest["downstream"]].tolist() == [2, 2]
    assert table["point"][middle["upstream"]].tolist() == [3, 3]
    assert table["point"][base["upstream"]].tolist() == [5, 5]
    assert table["point"][base["downstream"]].tolist() == [4, 4]
