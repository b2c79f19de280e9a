"""Laws of inelastic solids on several processes, each of which has the points of its own blocks."""

from __future__ import annotations

import re
from pathlib import Path

import make_jinping
import pytest
from harness import ROOT
from joint_decks import static
from rank_decks import BlockOnRock
from test_ranks import worst_difference


def without_modes(deck: str) -> str:
    """A deck of the Jinping dam without its step of natural modes."""
    before, modes = deck.split("*STEP, NAME=MODES\n")
    return before + modes.split("*END STEP\n", maxsplit=1)[1]


def cracking_dam(folder: Path) -> str:
    """Jinping with 15 000 unknowns, the law of table 1 and 30 increments of motion; it cracks under
    its weight already.
    """
    path = folder / "jinping.inp"
    sizes = ["--unknowns", "15000", "--duration", "0.3", "--increment", "0.01"]
    assert make_jinping.main([str(path), *sizes]) == 0
    mesh = (folder / "jinping_mesh.inp").read_text()
    deck = path.read_text().replace("*INCLUDE, INPUT=jinping_mesh.inp\n", mesh)
    deck = without_modes(deck)
    deck = re.sub(r"INPUT=\S*/xingbiling/", f"INPUT={ROOT}/input/xingbiling/", deck)
    return deck.replace("PRECISION=MIXED", "PRECISION=DOUBLE")


def check_cracks(plain, divided) -> None:
    """1e-4 of the largest value: RESIDUAL=1.2e-5 ends the iterations, which may be another number
    on another processor (1e-7 measured, with the same iterations).
    """
    for name, key in (("node_CROWN_CREST", "U2"), ("joint_JOINT3", "slip2")):
        expected, found = plain.csv(name)[key], divided.csv(name)[key]
        assert found == pytest.approx(expected, abs=1e-4 * abs(expected).max())
    expected, found = plain.csv("damage"), divided.csv("damage")
    assert expected["cracking"][-1] > 1e7
    for key in ("DAMAGET", "volume_50", "cracking", "created"):
        scale = max(1e-12, abs(expected[key]).max())
        assert found[key] == pytest.approx(expected[key], abs=1e-4 * scale), key
    assert divided.csv("energy")["error"].max() < 1e-6


@pytest.mark.parametrize("ranks", [2, 3])
def test_cracks(keyway, on_ranks, tmp_path, ranks):
    """A rank has the points of its blocks alone; the first one has all for the results."""
    deck = cracking_dam(tmp_path)
    plain, divided = keyway(deck, "-j", "1"), on_ranks(ranks)(deck, "--solver", "DIRECT")
    check_cracks(plain, divided)
    expected, found = (run.json["accuracy"]["estimates"]["law"] for run in (plain, divided))
    assert found["points"] == expected["points"]
    assert found["value"] == pytest.approx(expected["value"], rel=1e-3)


@pytest.mark.parametrize(("first", "second"), [(2, 3), (3, 0), (0, 2)])
def test_cracks_go_on_with_other_ranks(keyway, on_ranks, tmp_path, first, second):
    """The checkpoint has the points of all ranks, and each takes its own."""
    whole = cracking_dam(tmp_path)
    end = whole.index("*STEP, NAME=EARTHQUAKE")
    part = whole[:end].replace("*END STEP\n", "*RESTART, WRITE\n*END STEP\n")
    full = part + whole[end:]
    plain = keyway(full, "-j", "1")
    on_ranks(first)(part)
    (on_ranks(first).folder / "results_job").rename(on_ranks(second).folder / "results_job")
    check_cracks(plain, on_ranks(second)(full, "--continue"))


@pytest.mark.full
def test_cracks_and_sliding_by_conjugate_gradients(keyway, on_ranks, tmp_path):
    """Jinping with the law of table 1: joints slide by 14 mm and concrete cracks. The memory of
    joints takes all of its 64 changes, some of them tiny. 1e-3 of the largest displacement and
    slip: 30 increments on cracks within RESIDUAL=1.2e-5, which the tool writes.
    """
    path = tmp_path / "jinping.inp"
    assert make_jinping.main([str(path), "--duration", "0.3", "--increment", "0.01"]) == 0
    path.write_text(without_modes(path.read_text()))
    plain, divided = keyway(path, "-j", "2"), on_ranks(2)(path, "--solver", "ITERATIVE")
    assert divided.json["steps"][-1]["cutbacks"] == plain.json["steps"][-1]["cutbacks"] == 0
    old, new = (run.json["joints"]["JOINT3"]["slip"]["anywhere"] for run in (plain, divided))
    assert new["value"] == pytest.approx(old["value"], rel=1e-3)
    assert old["value"] > 0.014
    assert plain.json["damage"]["DAMAGET"]["value"] > 0.9
    for key in ("U2", "U3"):
        expected, found = (run.csv("node_CROWN_CREST")[key] for run in (plain, divided))
        assert found == pytest.approx(expected, abs=1e-3 * abs(expected).max())


def test_failing_user_material(on_ranks):
    """A law that fails on any rank ends all ranks with the words of one process."""
    pull = "*BOUNDARY\nTOP, 3, 3, 0.05\nTOP, 1, 2, 0.\n"
    deck = BlockOnRock().deck(static(pull, "0.5, 1., 0.1"))
    user = "*USER MATERIAL, CONSTANTS=3\n3e10, 0.2, 1."
    deck = deck.replace("*ELASTIC\n30000000000.0, 0.2", user, 1)
    umat = str(ROOT / "tests/umat/gives_up.for")
    run = on_ranks(4)(deck, "--umat", umat, code=1)
    words = re.findall(r"material M, element \d+, point [1-8]: UMAT: .*XIT was called", run.stderr)
    assert len(words) == 1
    assert run.json["status"] == "stopped"
    assert words[0] in run.json["message"]


@pytest.mark.parametrize("ranks", [2, 4])
def test_user_material(keyway, on_ranks, ranks):
    """A UMAT is built and called by every rank."""
    umat = str(ROOT / "input/umat/plastic_j2.f90")
    deck = (ROOT / "input/umat/plastic_j2.inp").read_text(encoding="utf-8")
    plain = keyway(deck, "--umat", umat, "-j", "1")
    size, place = worst_difference(plain, on_ranks(ranks)(deck, "--umat", umat))
    assert size <= 1e-8, place
