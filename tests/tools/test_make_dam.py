"""The deck that make_dam writes."""

import make_dam
import numpy as np
import pytest


def write_deck(folder, *options):
    deck = folder / "dam.inp"
    small = ["--arc", "14", "--levels", "6", "--bottom", "2", "--thick", "2"]
    assert make_dam.main(["-o", str(deck), *small, *options]) == 0
    return deck.read_text(), (folder / "dam_mesh.inp").read_text()


def data_of(text, keyword):
    """Data lines below the first card that starts with `keyword`."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(keyword)) + 1
    stop = next(i for i in range(start, len(lines)) if lines[i].startswith("*"))
    return lines[start:stop]


def test_deck_and_mesh_have_the_specified_properties(tmp_path):
    deck, mesh = write_deck(tmp_path, "--joints", "2")
    assert "*INCLUDE, INPUT=dam_mesh.inp" in deck
    assert deck.count("*JOINT, NAME=JOINT") == 2
    for word in ("ELSET=DAM", "ELSET=ROCK", "ELSET=JOINT2", "NSET=FIXED", "NAME=UPSTREAM"):
        assert word in mesh


def test_ids_are_unique_and_nodes_known(tmp_path):
    _, mesh = write_deck(tmp_path)
    nodes = {int(line.split(",")[0]) for line in data_of(mesh, "*NODE")}
    elements = []
    for name in ("DAM", "ROCK", "JOINT1", "JOINT2"):
        kind = "JOINT8" if name.startswith("JOINT") else "C3D8"
        elements += data_of(mesh, f"*ELEMENT, TYPE={kind}, ELSET={name}")
    rows = np.array([[int(word) for word in line.split(",")] for line in elements])
    assert len(np.unique(rows[:, 0])) == len(rows)
    assert set(rows[:, 1:].ravel()) == nodes


def test_same_options_same_bytes(tmp_path):
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    assert write_deck(tmp_path / "a") == write_deck(tmp_path / "b")


def test_motion_makes_a_dynamic_step(tmp_path):
    motion = tmp_path / "x.txt"
    motion.write_text("0.\n0.\n")
    deck, _ = write_deck(tmp_path, "--motion", str(motion), "--duration", "3")
    assert "INPUT=x.txt, FORMAT=VALUES, DT=0.01" in deck
    assert "*BASE MOTION, DOF=1, AMPLITUDE=MOTION_X" in deck
    assert "0.01, 3\n" in deck


def test_reduced_model_and_water_in_joints(tmp_path, keyway):
    """The deck runs with both; fields and stresses are not asked for."""
    motion = tmp_path / "x.txt"
    motion.write_text("".join(f"{0.1 * (-1) ** (k // 10)}\n" for k in range(200)))
    options = [
        "--motion",
        str(motion),
        "--duration",
        "1",
        "--reduced",
        "0.05",
        "--uplift",
        "LINEAR",
    ]
    deck, _ = write_deck(tmp_path, *options)
    assert "*DYNAMIC, REDUCED, ACCURACY=0.05, DIRECT" in deck
    assert "   UPLIFT=LAKE, PROFILE=LINEAR" in deck
    assert " FILE" not in deck
    run = keyway(tmp_path / "dam.inp")
    reduced = run.json["accuracy"]["reduced"]
    assert all(0.0 < one["estimated_error"] <= 0.05 for one in reduced.values())


def test_bad_shape_is_refused_with_a_message(tmp_path, capsys):
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), "--levels", "40"]) == 2
    assert "elements along the arc" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--water", "200"], "--water 200: expected 0 to 135.5 m, the --height"),
        (
            ["--height", "200", "--crest-arc", "60"],
            "the crest of 60 m is too short for a height",
        ),
        (["--base-thickness", "300"], "m thick, 262.7 m from the axis of the dam; expected a long"),
        (["--extent", "20"], "elements of the rock are inside out: layers of rock cross"),
        (["--unknowns", "100000000000"], "--unknowns 100000000000: expected at most 20000000"),
        (["--fine", "2", "--fine-above", "0.99"], "--fine-above 0.99: block 2 has no level of 12"),
        (["--motion", "nowhere.txt"], "there is no motion file 'nowhere.txt'"),
        (["--uplift", "OPEN", "--water", "0"], "--uplift needs water"),
        (["--reduced", "0.6"], "--reduced: 0.6; expected an error above 0, up to 0.5"),
        (["--note", "bla"], "--note 'bla': expected the form 'Head: text'"),
        (["--note", "Head: "], "--note 'Head: ': expected the form 'Head: text'"),
        (["--title", "*END"], "--title '*END': expected one line"),
        (["--title", "a\n*END"], "expected one line"),
        (["--damping", "0.05", "0", "10"], "--damping 0.05 0 10: expected frequencies above 0"),
        (["--damping", "0.05", "5", "5"], "--damping 0.05 5 5: expected frequencies above 0, F1"),
        (["--damping", "1", "2", "10"], "--damping 1 2 10: expected a RATIO of 0 or more and bel"),
        (["--concrete", "2e10", "0.2", "0", "--modes", "2"], "expected RHO above 0 with --motion"),
        (["--motion", "x.txt", "--increment", "11"], "--increment 11: expected at most the dura"),
        (["--picture-every", "3000000000"], "expected up to 2147483647"),
        (["--reduced", "0.1", "--uplift", "OPEN"], "--reduced takes --uplift LINEAR"),
    ],
)
def test_options_out_of_range_are_reported(tmp_path, capsys, options, message):
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), *options]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert len(said.splitlines()) == 1


def test_a_deck_that_cannot_be_written_is_named(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    small = ["--arc", "14", "--levels", "6", "--bottom", "2", "--thick", "2"]
    deck = tmp_path / "file" / "dam.inp"
    assert make_dam.main(["-o", str(deck), *small]) == 2
    words = f"make_dam: '{deck.with_name('dam_mesh.inp')}' could not be written: "
    assert capsys.readouterr().err.startswith(words)


def test_limits_of_the_program_are_those_of_the_tool(tmp_path, keyway):
    """The largest values that the tool takes, by the program."""
    motion = tmp_path / "x.txt"
    motion.write_text("0.\n1.\n0.\n")
    extremes = ["--damping", "0.999", "1", "1.001", "--reduced", "0.5", "--increment", "0.1"]
    notes = ["--note", "Site: nowhere", "--title", "A dam: small"]
    write_deck(tmp_path, "--motion", str(motion), "--duration", "0.1", *extremes, *notes)
    assert keyway(tmp_path / "dam.inp", "--check").code == 0


def test_cards_that_are_no_text_are_refused(tmp_path, capsys):
    cards = tmp_path / "cards.txt"
    cards.write_bytes(b"\xff\xfe")
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), "--concrete-cards", str(cards)]) == 2
    assert f"{cards}: " in capsys.readouterr().err


@pytest.mark.parametrize(("text", "message"), [("nan\n1.\n", ":1: found 'nan'"), ("", "no record")])
def test_motion_that_is_no_motion_is_refused(tmp_path, capsys, text, message):
    motion = tmp_path / "x.txt"
    motion.write_text(text)
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), "--motion", str(motion)]) == 2
    assert message in capsys.readouterr().err


def test_motion_with_blank_lines_is_taken_as_it_is(tmp_path):
    motion = tmp_path / "x.txt"
    motion.write_text("0.\n1.\n\n0.\n\n")
    deck, _ = write_deck(tmp_path, "--motion", str(motion))
    assert "INPUT=x.txt, FORMAT=VALUES" in deck


def test_the_water_follows_the_height(tmp_path):
    deck, _ = write_deck(tmp_path, "--height", "271", "--crest-arc", "889.72")
    assert "LEVEL=210," in deck


BLOCKS = ["--refine", "2", "--fine", "2", "--fine-refine", "3", "--fine-thick", "3"]


def test_blocks_of_their_own_meet_on_surfaces(tmp_path):
    deck, mesh = write_deck(tmp_path, *BLOCKS)
    assert "*JOINT, NAME=JOINT1, LAW=CONTRACTION\nJOINT1_SLAVE, JOINT1_MASTER" in deck
    assert "*TIE, NAME=BASE2\nBASE2_DAM, BASE2_ROCK" in deck
    assert "** Blocks: " in deck
    assert "TYPE=JOINT8" not in mesh
    assert max(len(line) for line in deck.splitlines()) <= 100


def test_chain_of_the_paper(tmp_path):
    deck, mesh = write_deck(tmp_path, *BLOCKS, "--join", "chain")
    card = "*INTERFACE, NAME=IFACE2, ELSET=IFACE2, SURFACE=JOINT2_FINE, STIFFNESS=2.2e+10"
    assert card in deck
    assert "*JOINT, NAME=JOINT2, LAW=CONTRACTION, ELSET=JOINT2" in deck
    assert "*ELEMENT, TYPE=IFACE4, ELSET=IFACE1" in mesh
    ids = [
        int(line.split(",")[0])
        for name in ("C3D8, ELSET=DAM", "C3D8, ELSET=ROCK", "JOINT8, ELSET=JOINT1",
                     "JOINT8, ELSET=JOINT2", "IFACE4, ELSET=IFACE1", "IFACE4, ELSET=IFACE2")
        for line in data_of(mesh, f"*ELEMENT, TYPE={name}")
    ]  # fmt: skip
    assert ids == list(range(1, len(ids) + 1))


def test_impossible_blocks_are_reported(tmp_path, capsys):
    assert make_dam.main(["-o", str(tmp_path / "x.inp"), *BLOCKS[:2], "--fine", "7"]) == 2
    assert "fine blocks must lie in 1..3" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options",
    ["--reduced 0.02", "--duration 5", "--increment 0.02", "--damping 0.03 2 10",
     "--motion-dt 0.02", "--motion-unit g", "--damping-base CURRENT"],
)  # fmt: skip
def test_options_of_the_dynamic_step_need_a_motion(tmp_path, capsys, options):
    words = options.split()
    assert make_dam.main(["-o", str(tmp_path / "dam.inp"), *words]) == 2
    assert f"{words[0]} has no effect without --motion FILE" in capsys.readouterr().err
    assert not (tmp_path / "dam.inp").exists()


def test_a_record_with_its_own_times_takes_no_other(tmp_path, capsys):
    (tmp_path / "a.txt").write_text("# t [s] a [m/s2]\n0. 0.\n.005 1.\n.01 0.\n")
    words = ["-o", str(tmp_path / "dam.inp"), "--motion", str(tmp_path / "a.txt")]
    assert make_dam.main([*words, "--motion-dt", "0.02"]) == 2
    assert "--motion-dt beside a file of several columns" in capsys.readouterr().err
    assert make_dam.main(words) == 0
    assert "DT=0.005" in (tmp_path / "dam.inp").read_text()


def test_title_and_joints_in_words(tmp_path):
    deck, _ = write_deck(tmp_path, "--joints", "0", "--no-rock")
    assert "*HEADING\nArch dam\n" in deck
    deck, _ = write_deck(tmp_path, "--joints", "1", "--no-rock")
    assert "*HEADING\nArch dam with contraction joints\n" in deck
    assert "Joints: 1 vertical plane through" in deck
