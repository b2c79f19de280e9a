"""Names of the components of a record in columns, and which axis each of them becomes."""

import make_motion
from keyway_tools.records.read_record import read_record

HEADING = "# Histories of a dam, of a book; columns: t[s], along, vertical(up-down), across [m/s2]"


def write(folder, heading):
    """A file of three components."""
    rows = [f"{0.01 * k:.2f},{k % 3},{k % 2},{k % 5}" for k in range(100)]
    path = folder / "a.csv"
    path.write_text("\n".join([heading, *rows]) + "\n")
    return path


def test_names_stand_behind_the_word_for_the_time(tmp_path):
    """Other words of the heading have commas too."""
    for heading in (HEADING, HEADING.replace("columns: t[s]", "Zeit")):
        names = [record.name for record in read_record(write(tmp_path, heading))]
        assert names == ["along", "vertical(up-down)", "across"]
    other = HEADING.replace("t[s]", "set")
    names = [record.name for record in read_record(write(tmp_path, other))]
    assert names == ["column 2", "column 3", "column 4"]


def test_command_says_which_component_each_axis_has(tmp_path, capsys):
    """The vertical component stands in the second column."""
    file = write(tmp_path, HEADING)
    call = ["--record", str(file), "--no-pictures", "-o", str(tmp_path / "q")]
    assert make_motion.main(call) == 0
    assert (
        "x is 'along', y is 'vertical(up-down)', z is 'across': the order of the files; --axes "
        "gives another one, as in --axes y z x; 'vertical(up-down)' has become y, not z\n"
        in capsys.readouterr().err
    )
    assert make_motion.main([*call, "--axes", "y", "z", "x"]) == 0
    found = capsys.readouterr()
    assert found.err == ""
    assert "q_z.txt: vertical(up-down)" in found.out


def test_a_vertical_component_that_is_z_is_no_reason_to_look(tmp_path, capsys):
    file = write(tmp_path, "t, NS, EW, UD [m/s2]")
    assert make_motion.main(["--record", str(file), "--no-pictures", "-o", str(file)]) == 0
    note = capsys.readouterr().err
    assert "z is 'UD [m/s2]'" in note
    assert "has become" not in note
