"""tools/accuracy refines a mesh twice where the budget allows."""

import json

import pytest
from harness import ROOT
from keyway_tools.study.__main__ import main
from keyway_tools.study.errors import choices_of, error_of
from keyway_tools.study.ladder import Outcome, predicted_twice
from keyway_tools.study.measured import Measured
from keyway_tools.study.rungs import BASE, ONCE, TWICE, Rung, as_it_is


def outcome(axis, name, size, seconds, value):
    """A rung that has run, with one displacement."""
    measured = Measured(seconds, 1.0, 9, 5, 0)
    measured.values["displacement"] = value
    return Outcome(Rung(axis, name, 1.0, size, as_it_is), seconds, measured)


def meshes(order):
    """Three meshes with errors of size**order, limit 1; each takes ten times as long."""
    sizes = (("base", BASE, 1.0), ("mesh", ONCE, 0.5), ("mesh", TWICE, 0.25))
    return [outcome(axis, name, size, 10.0**i, 1.0 + size**order)
            for i, (axis, name, size) in enumerate(sizes)]  # fmt: skip


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_limit_is_among_the_extrapolations_of_three_meshes(order):
    """The exact error of each mesh is not more than the error that is said."""
    found = error_of("displacement", meshes(order))
    for name, size in ((BASE, 1.0), (ONCE, 0.5), (TWICE, 0.25)):
        assert found.mesh[name] * found.limit >= size**order * (1.0 - 1e-12)
    once = error_of("displacement", meshes(order)[:2])
    assert found.uncertainty < once.uncertainty
    # First order from the finest pair: 2 v2 - v1; second order: v2 + (v2 - v1)/3.
    values = [1.0 + size**order for size in (0.5, 0.25)]
    first, second = 2.0 * values[1] - values[0], values[1] + (values[1] - values[0]) / 3.0
    assert found.uncertainty * found.limit == pytest.approx(second - first)


def test_a_mesh_refined_twice_alone_gives_no_limit():
    base, _, twice = meshes(1.0)
    assert error_of("displacement", [base, twice]).mesh == {}


def test_extrapolation_begins_at_the_finest_mesh():
    outcomes = meshes(1.0)
    error = error_of("displacement", outcomes)
    choice = choices_of(error, outcomes)[0]  # 10 %; the mesh refined twice has 1.25 * 0.25 / 1
    assert (choice.mesh, choice.num_refined) == ("mesh refined 4 times", 2)
    assert choice.seconds == pytest.approx(1e4)
    assert choice.error == pytest.approx(1.25 * error.mesh[TWICE] / 4.0)


def test_second_refinement_multiplies_the_time_as_the_first_did():
    assert predicted_twice(meshes(1.0)[:2]) == pytest.approx(100.0)
    assert predicted_twice(meshes(1.0)[:1]) is None


@pytest.mark.parametrize(("options", "is_refined_twice"), [([], True), (["--verify"], False)])
def test_ladder_refines_twice_unless_it_verifies(tmp_path, program_path, options, is_refined_twice):
    deck = str(ROOT / "input/cantilever.inp")
    assert main([deck, "-o", str(tmp_path), "--program", str(program_path), *options]) == 0
    facts = json.loads((tmp_path / "accuracy.json").read_text())
    axes = {rung["name"]: rung["axis"] for rung in facts["rungs"]}
    assert axes.get(TWICE) == ("mesh" if is_refined_twice else "finer")
    assert bool(facts["verified"]) != is_refined_twice
