"""tools/accuracy: decks read and written again, refined meshes, errors, the ladder and effects."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from keyway_tools.results import Results
from keyway_tools.study.couplings import chains, coupling_rungs, joints_on_surfaces
from keyway_tools.study.deck_cards import Deck, number_of, read_deck
from keyway_tools.study.effects import bonded, change_in_words, list_effects
from keyway_tools.study.errors import observed_order, time_errors
from keyway_tools.study.ladder import Outcome
from keyway_tools.study.measured import measure
from keyway_tools.study.mesh_sets import back_of_slice, read_sets
from keyway_tools.study.refined_mesh import RefinementError, refine
from keyway_tools.study.rungs import Rung, as_it_is, base_deck, list_rungs, scaled, shortened

ROOT = Path(__file__).resolve().parents[2]
INPUT = ROOT / "input"


def run_deck(program: Path, deck: Deck, folder: Path, name: str) -> Results:
    path = folder / f"{name}.inp"
    deck.write(path)
    command = [program, "-q", "-j", "1", "-o", folder / name, path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return Results(folder / name, name)


@pytest.mark.parametrize("name", ["block_on_joint", "sliding_block", "xingbiling_different"])
def test_decks_that_are_written_again_are_the_same(program_path, tmp_path, name):
    """--check prints the same model for a deck and for its flat copy, but for places of files."""
    found = next(INPUT.glob(f"**/{name}.inp"))
    (tmp_path / f"{name}.inp").write_text(read_deck(found).text(), encoding="utf-8")
    texts = [
        subprocess.run([program_path, "--check", path], capture_output=True, text=True).stdout
        for path in (found, tmp_path / f"{name}.inp")
    ]
    texts = [text.partition("Cost on this machine")[0] for text in texts]
    plain = [re.sub(r"INPUT=\S*/", "INPUT=", " ".join(text.split())) for text in texts]
    assert plain[0]
    assert plain[0] == plain[1]


def test_refined_cantilever_tends_to_the_beam(program_path, tmp_path):
    """Timoshenko's deflection is 0.134293 m (header of the deck); forces keep their sum."""
    deck = base_deck(read_deck(INPUT / "cantilever.inp"))
    errors = []
    for name in ("coarse", "fine"):
        found = measure(run_deck(program_path, deck, tmp_path, name))
        errors.append(abs(found.values["displacement"] - 0.134293))
        deck = refine(deck)
    # The end of the clamped beam leaves 0.1 % at any mesh: half of the error of the coarse mesh.
    assert errors[1] < 0.6 * errors[0]


def test_refined_column_keeps_its_closed_form(program_path, tmp_path):
    """Weight, supports and sets follow: the top sinks by rho g h^2 / (2 E) on both meshes. The
    column is a slice: it has four bricks for one."""
    deck = base_deck(read_deck(INPUT / "gravity_column.inp"))
    coarse = measure(run_deck(program_path, deck, tmp_path, "coarse"))
    fine = measure(run_deck(program_path, refine(deck), tmp_path, "fine"))
    assert fine.unknowns == 3 * coarse.unknowns
    # Linear and quadratic sink alike at the nodes of the coarse mesh; the tolerance is round-off.
    exact = coarse.values["displacement"]
    assert fine.values["displacement"] == pytest.approx(exact, rel=1e-9)


def test_refined_joints_and_surfaces_are_accepted(program_path, tmp_path):
    """Joints of elements and on surfaces; stages with temperatures of data lines and a file."""
    for name in ("xingbiling_matching", "xingbiling_different", "built_in_lifts"):
        coarse, fine = next(INPUT.glob(f"**/{name}.inp")), tmp_path / f"{name}.inp"
        refine(read_deck(coarse)).write(fine)
        done = [subprocess.run([program_path, "--check", deck], capture_output=True, text=True)
                for deck in (coarse, fine)]  # fmt: skip
        assert done[1].returncode == 0, done[1].stderr
        assert done[1].stderr.count("warning") == done[0].stderr.count("warning")


def test_refined_block_slides_as_the_coarse_one(program_path, tmp_path):
    """The block is rigid: its slip does not depend on the mesh of block and joint."""
    deck = base_deck(read_deck(INPUT / "sliding_block.inp"))
    slips = []
    for name, variant in (("coarse", deck), ("fine", refine(deck))):
        joints = run_deck(program_path, variant, tmp_path, name).summary["joints"]
        slips.append(joints["BED"]["slip"]["anywhere"]["value"])
    # E = 1e7 Pa leaves an elastic part of 1e-4 of the slip.
    assert slips[1] == pytest.approx(slips[0], rel=2e-3)


def test_supports_inside_are_not_invented():
    """A new node is held only on the surface between held nodes, or on a joint."""
    deck = read_deck(INPUT / "block_on_joint.inp")
    old, new = read_sets(deck), read_sets(refine(deck))
    base = {new.nodes[n] for n in new.node_sets["BASE_AND_NEW"]}
    assert {old.nodes[n] for n in old.node_sets["BASE"]} < base
    assert {x[2] for x in base} == {0.0}


def test_elements_that_cannot_be_split_are_named(tmp_path):
    (tmp_path / "a.inp").write_text("*NODE\n1,0.,0.,0.\n*ELEMENT, TYPE=SPRING1\n1, 1\n")
    with pytest.raises(RefinementError, match="elements of type SPRING1"):
        refine(read_deck(tmp_path / "a.inp"))


def test_order_in_time_is_recognised():
    values = np.array([1.0 + 0.3 * h**2 for h in (1.0, 0.5, 0.25)])
    assert observed_order(values) == pytest.approx(2.0)
    assert observed_order(np.array([1.0, 1.1, 1.05])) is None
    sizes = (2.0, 1.0, 0.5, 0.25)
    found = [
        (Outcome(Rung("increment", str(h), 1.0, h, as_it_is), None), 1.0 + 0.3 * h**2)
        for h in sizes
    ]
    limit, errors = time_errors(found)
    assert limit == pytest.approx(1.0)
    assert [errors[str(h)] for h in sizes] == pytest.approx([0.3 * h**2 for h in sizes])


@pytest.fixture(scope="module")
def slide(tmp_path_factory) -> Path:
    """A short deck with a joint in motion."""
    folder = tmp_path_factory.mktemp("slide")
    text = (INPUT / "sliding_block.inp").read_text().replace("0.005, 6.", "0.01, 1.5")
    (folder / "slide.inp").write_text(text)
    motion = "sliding_block_base.txt"
    (folder / motion).write_text((INPUT / motion).read_text())
    return folder / "slide.inp"


def call_tool(program: Path, deck: Path, *options: str) -> str:
    command = [ROOT / "tools/accuracy", deck, "--program", program, "--threads", "1", *options]
    done = subprocess.run(command, capture_output=True, text=True, cwd=deck.parent, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_promised_accuracy_holds_against_a_finer_run(program_path, slide):
    """The error of the ladder is not below that of a run that the tool does not use, and not ten
    times above."""
    program = program_path.resolve()
    text = call_tool(program, slide, "--budget", "4m")
    assert "largest displacement: your deck has an error of about" in text
    page = (slide.parent / "slide_accuracy/accuracy.html").read_text()
    assert "data:image/png" in page
    assert "http" not in page
    rows = (slide.parent / "slide_accuracy/accuracy.csv").read_text().splitlines()
    head, base = rows[0].split(","), rows[1].split(",")
    promised = float(base[head.index("error_displacement")])
    finest = scaled(1.0 / 16.0)(refine(base_deck(read_deck(slide))))
    found = measure(run_deck(program, finest, slide.parent, "finest")).values["displacement"]
    true = abs(float(base[head.index("displacement")]) / found - 1.0)
    assert true <= promised <= 10.0 * true
    again = call_tool(program, slide, "--budget", "4m")
    assert again.count("kept from an earlier call") == sum(row.endswith(",") for row in rows[1:])


def test_a_small_budget_leaves_rungs_out_by_name(program_path, slide):
    """Finished runs are kept; what is not there does not fit."""
    program = program_path.resolve()
    call_tool(program, slide, "--budget", "4m", "-o", "little")
    for name in ("mesh_refined", "increment_x_0_25"):
        shutil.rmtree(slide.parent / "little/runs" / name)
    text = call_tool(program, slide, "--budget", "0s", "-o", "little")
    assert "increment x 0.25: would take about" in text
    assert "the error of the mesh is not known" in text
    assert text.index("predicted time of the variants") < text.index("increment x 2, about")


def test_a_deck_beyond_the_budget_is_not_run(program_path, slide):
    command = [ROOT / "tools/accuracy", slide, "--program", program_path.resolve()]
    done = subprocess.run([*command, "--budget", "0s", "-o", slide.parent / "nothing"],
                          capture_output=True, text=True, timeout=60)  # fmt: skip
    assert done.returncode == 1
    assert "the deck as it is would take about" in done.stderr


def test_a_study_that_is_ended_ends_its_run_and_goes_on(program_path, slide, tmp_path):
    """SIGTERM ends the run of the study; the next call keeps what has finished."""
    text = slide.read_text().replace("0.01, 1.5", "0.0002, 1.5")
    (tmp_path / "long.inp").write_text(text)
    motion = "sliding_block_base.txt"
    (tmp_path / motion).write_text((slide.parent / motion).read_text())
    command = [ROOT / "tools/accuracy", "long.inp", "--program", program_path.resolve(),
               "--threads", "1"]  # fmt: skip
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    for line in process.stdout:
        if line.startswith("increment x 2, about"):
            break
    process.terminate()
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert not list((tmp_path / "long_accuracy").rglob("*.lock"))
    again = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert "kept from an earlier call" in "".join(again.stdout.readline() for _ in range(2))
    again.terminate()
    again.communicate(timeout=60)


def test_a_deck_with_errors_names_their_place(program_path, tmp_path):
    (tmp_path / "bad.inp").write_text("*NODE\n1, 0., x\n")
    command = [ROOT / "tools/accuracy", "bad.inp", "--program", program_path.resolve()]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("bad.inp:2: *NODE: found 'x'")


def test_options_of_the_program_are_passed_on(program_path, tmp_path):
    """A deck with a UMAT needs --umat."""
    for name in ("elastic.inp", "elastic.for"):
        (tmp_path / name).write_bytes((INPUT / "umat" / name).read_bytes())
    deck = tmp_path / "elastic.inp"
    call = ("--budget", "1m", "--", "--umat", "elastic.for")
    text = call_tool(program_path.resolve(), deck, *call)
    assert "largest displacement: your deck has an error" in text


def test_effects_are_switched_off_in_turn(program_path, slide):
    text = call_tool(program_path.resolve(), slide, "--effects")
    names = [rung.name for rung in list_effects(base_deck(read_deck(slide)))]
    assert names == [
        "all effects", "without the motion along x", "without opening and sliding of the joints",
        "without friction in the joints", "without weight",
    ]  # fmt: skip
    for name in names[1:]:
        assert f"{name[0].upper()}{name[1:]} the displacement is" in text
    assert "smaller" in text
    assert json.loads(
        (slide.parent / "slide_accuracy/runs/all_effects/results/study.json").read_text()
    )


def test_effects_of_an_earthquake_have_names():
    """All effects of a dam under water, weight and motion, each once."""
    dam = read_deck(INPUT / "xingbiling_matching/xingbiling_matching.inp")
    for law in dam.of("JOINT LAW"):
        law.parameters |= {"UPLIFT": "LAKE", "COHESION": "1e5"}
    names = [rung.name.removeprefix("without ") for rung in list_effects(base_deck(dam))]
    assert names == [
        "all effects", "the motion along x", "the motion along y", "the motion along z",
        "the water", "the added mass of the water", "uplift in the joints",
        "opening and sliding of the joints", "friction in the joints", "cohesion of the joints",
        "damping", "weight",
    ]  # fmt: skip
    crack = base_deck(read_deck(INPUT / "cracking_monolith.inp"))
    assert "without cracking of the concrete" in [rung.name for rung in list_effects(crack)]


def test_bonded_joints_do_not_open_before_their_grouting_either(program_path, tmp_path):
    """A dam in three lifts: before *GROUT its joints are contact, whatever their law says."""
    text = "--arc 14 --levels 6 --bottom 2 --thick 1 --joints 3 --lifts 3 --grouting 3 --no-rock"
    command = [sys.executable, ROOT / "tools/make_dam.py", "-o", tmp_path / "dam.inp"]
    subprocess.run([*command, *text.split()], check=True, capture_output=True)
    deck = base_deck(read_deck(tmp_path / "dam.inp"))
    free = run_deck(program_path, deck, tmp_path, "free")
    closed = run_deck(program_path, bonded(deck), tmp_path, "closed")
    opening = "joints.JOINT1.opening.anywhere.value"
    assert free.find(opening) > 1e-6
    assert closed.find(opening) < 1e-3 * free.find(opening)


def test_a_file_in_place_of_the_folder_is_told(program_path, tmp_path):
    (tmp_path / "study").write_text("")
    deck = INPUT / "cantilever.inp"
    call = [ROOT / "tools/accuracy", deck, "-o", "study", "--program", program_path.resolve()]
    done = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "accuracy: 'study': File exists\n")


def test_large_changes_are_told_as_factors():
    text = change_in_words("without the water", {"opening": 3.63, "stress": 0.5, "u": -0.2}, 0.1)
    assert text == (
        "Without the water the opening is 4.63 times as large, the stress is 50 % larger, "
        "the u is 20 % smaller; the run takes 10 % less time."
    )


@pytest.fixture(scope="module")
def chained(tmp_path_factory) -> Path:
    """A coarse dam whose joints are chains of interface elements between different meshes."""
    folder = tmp_path_factory.mktemp("chained")
    text = "--arc 12 --levels 4 --bottom 2 --thick 1 --joints 2 --fine 2 --fine-refine 2"
    command = [sys.executable, ROOT / "tools/make_dam.py", "-o", folder / "dam.inp", *text.split(),
               "--fine-thick", "2"]  # fmt: skip
    subprocess.run([*command, "--join", "chain"], check=True, capture_output=True)
    return folder / "dam.inp"


def test_couplings_of_a_dam_agree(program_path, chained):
    """A chain, joints on surfaces and ties in their kinds describe the same dam: it sinks alike
    under its weight. The mesh is coarse: the couplings differ by up to 5 %."""
    deck = base_deck(read_deck(chained))
    moved = []
    for number, rung in enumerate([Rung("base", "", 1.0, 1.0, as_it_is), *coupling_rungs(deck)]):
        variant = run_deck(program_path, rung.change(deck), chained.parent, f"v{number}")
        moved.append(measure(variant).values["displacement"])
    assert [rung.name for rung in coupling_rungs(deck)] == [
        "joints on surfaces", "joints with Gauss points", "ties by springs",
        "ties by joints that stay closed",
    ]  # fmt: skip
    assert moved == pytest.approx([moved[0]] * 5, rel=0.05)
    surfaces = joints_on_surfaces(deck)
    back = measure(run_deck(program_path, chains(surfaces), chained.parent, "back"))
    assert back.values["displacement"] == pytest.approx(moved[0], rel=0.05)


def test_joint_elements_and_joints_on_their_faces_are_the_same(program_path, tmp_path):
    deck = read_deck(INPUT / "xingbiling_matching/xingbiling_matching.inp")
    for step in deck.steps()[1:]:
        deck.without(step)
    ends = list(deck.of("END STEP"))
    deck.without(ends[1:])
    moved = [
        measure(run_deck(program_path, variant, tmp_path, name)).values["displacement"]
        for name, variant in (("elements", deck), ("surfaces", joints_on_surfaces(deck)))
    ]
    # The mortar projection of equal meshes is the identity, but for round-off and the iteration.
    assert moved[1] == pytest.approx(moved[0], rel=1e-6)


def test_a_slice_is_refined_in_its_plane(program_path, tmp_path):
    deck = base_deck(read_deck(INPUT / "monolith_water.inp"))
    fine = refine(deck)
    assert len(read_sets(deck).element_sets["MONOLITH"]) * 4 == len(
        read_sets(fine).element_sets["MONOLITH"]
    )
    values = [measure(run_deck(program_path, variant, tmp_path, name)).values["displacement"]
              for name, variant in (("coarse", deck), ("fine", fine))]  # fmt: skip
    assert values[1] == pytest.approx(values[0], rel=0.05)
    block = read_deck(INPUT / "block_on_joint.inp")
    assert back_of_slice(block, read_sets(block)) == set()


def test_smallest_and_largest_increments_follow(tmp_path):
    (tmp_path / "a.inp").write_text("*STEP\n*DYNAMIC\n0.01, 5., , 2.d-2\n*END STEP\n")
    (card,) = scaled(2.0)(read_deck(tmp_path / "a.inp")).of("DYNAMIC")
    assert card.lines == ["0.02, 5., , 0.04"]


def test_a_shorter_study_ends_dynamic_steps_alone(tmp_path):
    text = "*STEP\n*STATIC\n1., 5.\n*END STEP\n*STEP\n*DYNAMIC\n0.01, 9.\n"
    (tmp_path / "a.inp").write_text(text)
    deck = shortened(read_deck(tmp_path / "a.inp"), 0.5)
    for same in (deck, shortened(deck, 2.0)):
        (static,), (dynamic,) = same.of("STATIC"), same.of("DYNAMIC")
        assert static.lines == ["1., 5."]
        assert [number_of(item) for item in dynamic.lines[0].split(",")] == [0.01, 0.5]


def test_rungs_fit_the_deck():
    """A static elastic deck has no increments, no tolerances, no joints to vary."""
    axes = {rung.axis for rung in list_rungs(base_deck(read_deck(INPUT / "cantilever.inp")))}
    assert axes == {"base", "mesh", "element"}
    dam = base_deck(read_deck(INPUT / "xingbiling_matching/xingbiling_matching.inp"))
    assert len(list_rungs(dam)) == 18


@pytest.mark.parametrize("name", ["xingbiling_matching/xingbiling_matching", "cracking_monolith"])
def test_each_variant_is_another_deck(name):
    """No rung leaves the deck as it is: the page would show that its choice changes nothing."""
    deck = base_deck(read_deck(INPUT / f"{name}.inp"))
    texts = [rung.change(deck).text() for rung in list_rungs(deck)]
    assert len(set(texts)) == len(texts)
    for rung, text in zip(list_rungs(deck), texts, strict=True):
        if rung.axis in ("tolerance", "solver") and rung.name != "REDUCED":
            assert text.count("*CONTROLS") == 1, rung.name


def test_a_dynamic_deck_is_verified_to_its_end(program_path, tmp_path):
    """A joint that opens in motion: what was said is not less than what a finer run shows.

    The first half of the motion of input/opening_base.inp in increments twice as large.
    """
    text = (INPUT / "opening_base.inp").read_text()
    short = text.replace("\n0.01, 1\n", "\n0.02, 0.5\n")
    assert short != text
    (tmp_path / "short.inp").write_text(short)
    command = [ROOT / "tools/accuracy", tmp_path / "short.inp", "--verify", "--threads", "1"]
    command += ["--budget", "10m", "--program", program_path.resolve(), "-o", tmp_path / "study"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr
    check = json.loads((tmp_path / "study/accuracy.json").read_text())["verified"]
    quantities = {row["quantity"] for row in check["rows"]}
    assert quantities >= {"displacement", "opening"}
    assert check["kept"] == len(check["rows"]) >= 12
