"""tools/accuracy recommends another element only where it holds on the refined mesh too."""

import shutil

from harness import ROOT
from keyway_tools.study.__main__ import main
from keyway_tools.study.errors import choices_of, element_to_check, error_of
from keyway_tools.study.ladder import Outcome
from keyway_tools.study.measured import Measured
from keyway_tools.study.rungs import BASE, ELEMENT_CHECK, ONCE, TWICE, Rung, as_it_is


def outcome(axis, name, size, seconds, value):
    """A rung with a displacement; None: it has not run."""
    rung = Rung(axis, name, 1.0, size, as_it_is)
    if value is None:
        return Outcome(rung, seconds, None, "would take too long")
    measured = Measured(seconds, 1.0, 9, 5, 0)
    measured.values["displacement"] = value
    return Outcome(rung, seconds, measured)


def ladder():
    """Three meshes whose limit is near 1, and an element that is there by chance, or not."""
    return [
        outcome("base", BASE, 1.0, 1.0, 1.08),
        outcome("mesh", ONCE, 0.5, 10.0, 1.02),
        outcome("mesh", TWICE, 0.25, 100.0, 1.005),
        outcome("element", "C3D8R", 1.0, 0.5, 1.0),
    ]


def chosen(outcomes):
    """The mesh for each accuracy of the displacement."""
    found = choices_of(error_of("displacement", outcomes), outcomes)
    return [choice and choice.mesh for choice in found]


def test_an_element_without_a_check_is_not_recommended():
    outcomes = ladder()
    assert element_to_check(outcomes) == "C3D8R"
    assert "C3D8R" not in chosen(outcomes)
    outcomes.append(outcome(ELEMENT_CHECK, "C3D8R, mesh refined", 0.5, 5.0, None))
    assert element_to_check(outcomes) is None  # the budget does not allow its run
    assert "C3D8R" not in chosen(outcomes)


def test_an_agreement_by_chance_is_lost_on_the_refined_mesh():
    """The element passes by the limit: 1.0 on the mesh of the deck, 0.97 on the refined one."""
    outcomes = ladder()
    outcomes.append(outcome(ELEMENT_CHECK, "C3D8R, mesh refined", 0.5, 5.0, 0.97))
    assert element_to_check(outcomes) is None
    assert error_of("displacement", outcomes).mesh["C3D8R"] > 0.03
    assert [mesh == "C3D8R" for mesh in chosen(outcomes)] == [True, True, False, False]


def test_an_element_that_holds_is_recommended():
    outcomes = ladder()
    outcomes.append(outcome(ELEMENT_CHECK, "C3D8R, mesh refined", 0.5, 5.0, 1.0))
    assert chosen(outcomes)[:3] == ["C3D8R"] * 3


def test_the_tool_runs_the_check(program_path, tmp_path, capsys):
    """A cantilever; its elements that would be recommended run on the refined mesh."""
    shutil.copy(ROOT / "input" / "cantilever.inp", tmp_path)
    call = [str(tmp_path / "cantilever.inp"), "--program", str(program_path.resolve())]
    assert main([*call, "--threads", "1", "-o", str(tmp_path / "study")]) == 0
    text = capsys.readouterr().out
    recommended = {kind for kind in ("C3D8", "C3D8B", "C3D8R") if f"%: {kind}, about" in text}
    assert "C3D8R, mesh refined" in text or "C3D8B, mesh refined" in text
    assert all(f"{kind}, mesh refined:" in text for kind in recommended)
