"""The study of the paper's dams: what it asks of its runs, motions, and many records."""

from pathlib import Path

import numpy as np
import pytest
from keyway_tools.paper_study.checks import (
    asymmetry,
    check_verdicts,
    largest_change,
    run_verdicts,
)  # fmt: skip
from keyway_tools.paper_study.facts import Facts
from keyway_tools.paper_study.motions import KEPT, Motion
from keyway_tools.paper_study.records import openings_of, plot_fractiles, sentences
from keyway_tools.picture_style import Sheet


def shaken(name, openings, **changes):
    """Facts of a dam with openings [mm] on both faces."""
    facts = Facts(name, name, "finished", wall_s=2000.0, unknowns=100_500, increments=2010)
    facts.openings = {
        f"JOINT{k}": {"upstream": 1e-3 * value, "downstream": 0.5e-3 * value}
        for k, value in enumerate(openings, start=1)
    }
    facts.extremes = {"S1_POINT": {"anywhere": {"value": 2.48e6}}}
    for key, value in changes.items():
        setattr(facts, key, value)
    return facts


def test_a_run_that_keeps_everything_is_good():
    said = run_verdicts(shaken("a", [4.0, 2.0], energy_error=5e-9))
    assert [one.kind for one in said] == ["good"] * 4
    assert "in 33.3 minutes; asked are 100000 in 40" in said[0].text


def test_each_miss_is_said_with_its_number():
    extremes = {"S1_POINT": {"anywhere": {"value": 2.513e6}}}
    said = run_verdicts(
        shaken("a", [4.0], wall_s=3000.0, energy_error=3e-6, largest_fall=1e-4, extremes=extremes)
    )
    assert [one.kind for one in said] == ["fair"] * 4
    for words, one in zip(("in 50.0 min", "1.0133 f_t", "3.0e-06", "1.0e-04"), said, strict=True):
        assert words in one.text


def test_half_the_increment_and_symmetry_are_compared():
    facts = {
        "s_base": shaken("s_base", [4.0, 2.0]),
        "c_half_increment": shaken("c_half_increment", [4.0, 2.1]),
        "c_symmetric": shaken("c_symmetric", [4.0, 2.0]),
    }
    assert largest_change(facts["s_base"], facts["c_half_increment"]) == pytest.approx(0.025)
    assert asymmetry(facts["c_symmetric"]) == pytest.approx(0.5)
    assert asymmetry(shaken("b", [3.0, 1.0, 3.0])) == 0.0
    said = check_verdicts(facts)
    assert [one.kind for one in said] == ["fair", "fair"]
    assert "by up to 2.5 %" in said[0].text
    assert check_verdicts({"s_base": facts["s_base"]}) == []


def test_records_have_fractiles_and_a_picture(tmp_path):
    cases = [shaken(str(k), [float(k)], reduced_error=1e-3 * k) for k in range(1, 102)]
    wanted = np.arange(1.0, 102.0)
    assert openings_of(cases)["upstream"] == pytest.approx(wanted, rel=1e-15)  # from m to mm
    said = " ".join(sentences(cases))
    assert "Upstream face: half of the records open joints by less than 51 mm" in said
    assert "16 % and 84 % are 17 and 85 mm, the largest of 101 is 101 mm" in said
    assert "at most 10 % of the largest, 5.1 % in half" in said
    (picture,) = plot_fractiles(cases, Sheet(tmp_path / "records"))
    assert Path(picture).stat().st_size > 10_000


def test_motion_without_the_component_across_the_valley(tmp_path):
    motion = Motion(is_symmetric=True)
    motion.make(tmp_path)
    made = motion.folder(tmp_path)
    across, along = (np.loadtxt(made / f"motion_{axis}.txt") for axis in "xy")
    assert not across.any()
    assert len(across) == len(along) == len(np.loadtxt(KEPT / "motion_y.txt"))
    assert along.any()
    assert Motion().folder(tmp_path) == KEPT
