"""What all commands do alike: faults of the system in one line, readers that stop early."""

import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import make_dam
import make_motion
import pytest
from keyway.commands import compare, plot
from keyway_tools.command import command
from keyway_tools.report.__main__ import main as report

TOOLS = Path(__file__).resolve().parents[2] / "tools"
SMALL = ["--arc", "10", "--levels", "3", "--no-rock"]


@command("talk")
def talk(count=1):
    """Prints at once and goes on."""
    for number in range(count):
        sys.stdout.write(f"line {number}\n")
        sys.stdout.flush()
    sys.stderr.write("at the end\n")
    return 0


def test_an_error_of_the_system_is_one_line_with_the_file(capsys):
    @command("write")
    def write():
        return len(Path("/no/such/file").read_text())

    assert write() == 2
    assert capsys.readouterr().err == "write: '/no/such/file': No such file or directory\n"


@pytest.mark.parametrize("is_folder", [True, False])
def test_outputs_that_cannot_be_written(tmp_path, capsys, is_folder):
    """An output that is a folder, or lies in a file."""
    place = tmp_path / "file.inp"
    place.mkdir() if is_folder else place.write_text("")
    output = place if is_folder else place / "out"
    for tool, options in ((make_dam, SMALL), (make_motion, ["--no-pictures", "--duration", "2"])):
        name = tool.__name__
        if is_folder and tool is make_motion:
            continue  # -o is the beginning of its names
        assert tool.main(["-o", str(output), *options]) == 2
        told = capsys.readouterr().err
        assert told.startswith(f"{name}: '{place}"), told
    (tmp_path / "a.csv").write_text("x\n1\n")
    files = [str(tmp_path / "a.csv")] * 2
    assert compare.main([*files, "--json", str(output)]) == 2
    assert capsys.readouterr().err.startswith(f"compare: '{place}")


def run_piped(text, tmp_path):
    """The error output of a piece of Python whose output is read for one line."""
    code = (
        f"import os, sys; sys.path[:0] = [{str(TOOLS)!r}, {str(Path(__file__).parent)!r}]; {text}"
    )
    reader, writer = os.pipe()
    child = subprocess.Popen(
        [sys.executable, "-c", code], stdout=writer, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    os.close(writer)
    os.read(reader, 4)
    os.close(reader)
    return child.communicate(timeout=60)[1], child.returncode


def test_a_command_goes_on_when_its_reader_has_gone(tmp_path):
    text, code = run_piped("import test_commands; sys.exit(test_commands.talk(20000))", tmp_path)
    assert (text, code) == ("at the end\n", 0)


def test_help_survives_a_reader_that_stops(tmp_path):
    call = "import make_dam; os.write(1, b'start\\n'); make_dam.main(['--help'])"
    assert run_piped(call, tmp_path) == ("", 0)


def test_findings_are_kept_when_nobody_reads_them(tmp_path):
    for name, value in (("a.csv", 1), ("b.csv", 2)):
        (tmp_path / name).write_text("x\n" + f"{value}\n")
    found = tmp_path / "found.json"
    call = "from keyway.commands import compare; os.write(1, b'start\\n'); "
    call += f"sys.exit(compare.main(['a.csv', 'b.csv', '--json', {str(found)!r}]))"
    assert run_piped(call, tmp_path) == ("", 1)
    assert not json.loads(found.read_text())["equal"]


def test_a_summary_cut_short_is_said_with_its_name(tmp_path, capsys):
    for name, text in (("job.json", '{"status": "fin'), ("job.h5", "")):
        (tmp_path / name).write_text(text)
    for name, main in (("plot", plot.main), ("report", report)):
        assert main([str(tmp_path / "job.json")]) == 2
        told = capsys.readouterr().err
        assert told.startswith(f"{name}: {tmp_path / 'job.json'} cannot be read, it is not whole: ")


def test_a_foreign_file_of_results_is_named(tmp_path, capsys):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["values"] = [1.0]
    (tmp_path / "other.json").write_text('{"program": {}, "status": "finished"}')
    for main in (plot.main, report):
        assert main([str(tmp_path / "other.h5")]) == 2
        told = capsys.readouterr().err
        assert "other.h5 holds no results of Keyway" in told, told


def test_a_report_replaces_no_other_file(tmp_path, capsys):
    deck = tmp_path / "dam.inp"
    deck.write_text("*HEADING\nDam\n")
    assert report([str(tmp_path), "-o", str(deck)]) == 2
    assert "dam.inp exists and is no HTML page" in capsys.readouterr().err
    assert deck.read_text() == "*HEADING\nDam\n"
