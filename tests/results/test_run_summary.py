"""What a run says while it goes on and at its end: progress, and the closing lines."""

import json
import os
import pty
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

INPUT = Path(__file__).resolve().parents[2] / "input"
BASES = Path(__file__).resolve().parents[1] / "errors/base"


@pytest.fixture(scope="module")
def sliding(tmp_path_factory, program_path):
    """A block that slides on its joint for some thousand increments; stderr of its run."""
    folder = tmp_path_factory.mktemp("sliding")
    deck = INPUT / "sliding_block.inp"
    command = [program_path, "-j", "1", "-o", folder, deck]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    return folder, done.stderr.splitlines()


def results_of(folder):
    return json.loads((folder / "sliding_block.json").read_text(encoding="utf-8"))


def test_through_a_pipe_a_line_comes_every_few_per_cent(sliding):
    folder, lines = sliding
    steps = results_of(folder)["steps"]
    log = (folder / "sliding_block.log").read_text(encoding="utf-8").splitlines()
    assert sum(" increment " in line and "residual" in line for line in log) >= sum(
        step["increments"] for step in steps
    )
    progress = [line for line in lines if "elapsed" in line]
    assert len(progress) <= 21 + len(steps)
    shares = [int(re.search(r"  (\d+) %", line)[1]) for line in progress]
    assert shares[-1] == 100
    assert max(np.diff([share for share in shares if share < 100])) <= 6
    assert re.search(r", 0:\d\d remaining, largest opening ", progress[-1])


def test_closing_lines_repeat_job_json(sliding):
    folder, lines = sliding
    results = results_of(folder)
    found = results["displacement"]["anywhere"]
    (line,) = (x for x in lines if x.startswith("largest displacement"))
    value, place, time = re.match(
        r"largest displacement (\S+) at \((.*)\), time (\S+)", line
    ).groups()
    # Four significant digits are printed.
    assert float(value) == pytest.approx(found["value"], rel=6e-4)
    assert [float(x) for x in place.split(",")] == pytest.approx(found["x"], rel=6e-4)
    assert float(time) == pytest.approx(found["time"], rel=6e-4)
    for name, joint in results["joints"].items():
        (line,) = (x for x in lines if x.startswith(f"{name}: "))
        slip = float(line.split("largest slip ")[1])
        assert slip == pytest.approx(joint["slip"]["anywhere"]["value"], rel=6e-4)
    (line,) = (x for x in lines if x.startswith("error of the energy balance"))
    assert f"at most {results['accuracy']['most_iterations']} iterations" in line


def test_times_of_later_steps_are_given_from_their_start_too(sliding):
    folder, lines = sliding
    first, second = results_of(folder)["steps"][:2]
    time = results_of(folder)["displacement"]["anywhere"]["time"]
    (line,) = (x for x in lines if x.startswith("largest displacement"))
    name, own = re.search(r"\((\w+) ([^\s)]+)\)(?:,|$)", line).groups()
    assert name == second["name"]
    assert float(own) == pytest.approx(time - first["time"], rel=6e-4)


def test_largest_displacement_is_that_of_the_envelope(sliding):
    results = results_of(sliding[0])
    assert results["displacement"] == results["envelopes"]["U"]


def test_cracks_without_damage_are_not_called_undamaged(keyway):
    """A law without *CONCRETE TENSION DAMAGE: no place is named where damage is 0."""
    deck = (INPUT / "petersson_beam.inp").read_text(encoding="utf-8")
    deck = deck.replace("*END STEP", "*ENVELOPE\nDAMAGET\n*END STEP")
    run = keyway(deck, name="cracked")
    lines = (run.folder / "cracked.log").read_text(encoding="utf-8").splitlines()
    assert "damage in tension 0, though solids have cracked: see *CONCRETE TENSION DAMAGE" in lines
    assert any(line.startswith("largest S1 ") for line in lines)
    assert not any("DAMAGET 0" in line for line in lines)


def test_a_run_that_stops_has_the_closing_lines_in_its_log(keyway):
    deck = (INPUT / "sliding_block.inp").read_text(encoding="utf-8")
    motion = (INPUT / "sliding_block_base.txt").read_text(encoding="utf-8")
    deck = deck.replace("INC=10000", "INC=50")
    run = keyway(deck, files={"sliding_block_base.txt": motion}, name="short", code=1)
    log = (run.folder / "short.log").read_text(encoding="utf-8")
    line = next(line for line in log.splitlines() if "has not ended after 50 increments" in line)
    assert line.endswith(" s: raise INC of *STEP")
    assert f"{line} [increments-used-up]" in run.stderr
    assert log.index("has not ended") < log.index("largest displacement")


def test_progress_on_a_terminal_is_one_line_that_fits(program_path, tmp_path):
    """The line is written over; it has whole parts and no more letters than the terminal."""
    ours, theirs = pty.openpty()
    command = [program_path, "-j", "1", "-o", tmp_path, INPUT / "sliding_block.inp"]
    with subprocess.Popen(command, stdout=theirs, stderr=theirs, close_fds=True) as process:
        os.close(theirs)
        text = read_all(ours)
        assert process.wait(timeout=300) == 0
    lines = [line for line in text.replace("\n", "\r").split("\r") if "elapsed" in line]
    assert len(lines) > 100
    assert max(map(len, lines)) < 80
    assert text.count("\n") < 60


@pytest.mark.parametrize("deck", ["cantilever", "block_on_joint", "petersson_beam"])
def test_check_forecasts_the_memory_of_the_run(keyway, deck):
    """Within a factor of 1.5. The time depends on what else the machine does: it is only there."""
    path = INPUT / f"{deck}.inp"
    text = keyway(path, "--check").stdout
    cost = text.partition("Cost on this machine")[2]
    assert re.search(r"time +about \S+ s\n", cost)
    memory = float(re.search(r"memory +about (\S+) MB", cost)[1])
    found = keyway(path).json["ledger"]["peak_memory_mb"]
    assert 1.0 / 1.5 < found / memory < 1.5


def test_check_forecasts_the_files_and_keeps_the_speed_of_the_machine(program_path, tmp_path):
    """Files within a factor of 1.5; the speeds are those of the best call so far."""
    deck = INPUT / "petersson_beam.inp"
    here = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    command = [program_path.resolve(), "--check", deck]
    text = subprocess.run(command, env=here, capture_output=True, text=True, check=True).stdout
    files = float(re.search(r"files +about (\S+) MB", text)[1])
    subprocess.run([program_path.resolve(), "-q", "-o", tmp_path / "run", deck], check=True)
    found = sum(path.stat().st_size for path in (tmp_path / "run").rglob("*") if path.is_file())
    assert 1.0 / 1.5 < found / 1e6 / files < 1.5
    kept = tmp_path / "cache/keyway/machine_speed.txt"
    name, *speeds = kept.read_text().splitlines()
    assert len(speeds) == 2
    kept.write_text(f"other\n1.0\n2.0\n{name}\n1e15\n1e15\n")
    text = subprocess.run(command, env=here, capture_output=True, text=True, check=True).stdout
    assert "the machine is busy now: about" in text
    assert kept.read_text() == f"other\n1.0\n2.0\n{name}\n1e15\n1e15\n"


def test_the_machine_is_in_the_summary(keyway):
    """What /proc/cpuinfo says, and the threads that the run was given."""
    machine = keyway(INPUT / "gravity_column.inp", "-j", "1").json["machine"]
    assert list(machine) == ["processor", "processors", "threads", "blas_kernels", "memory_mb"]
    assert machine["threads"] == 1
    assert machine["processors"] == len(os.sched_getaffinity(0))
    assert machine["memory_mb"] > 100


def read_all(descriptor: int) -> str:
    parts = []
    try:
        while part := os.read(descriptor, 65536):
            parts.append(part)
    except OSError:  # the other end is closed
        pass
    return b"".join(parts).decode()


def test_a_gap_of_the_mesh_that_closes_is_told(tmp_path, program_path):
    """A block 1e-4 m above another one is pushed onto it in the first increment."""
    deck = Path(__file__).resolve().parents[1] / "errors" / "base" / "contact.inp"
    text = re.sub(r"^(1[1-4], .*), 1\.$", r"\1, 1.0001", deck.read_text(), flags=re.MULTILINE)
    push = "".join(f"{node}, 1, 2\n{node}, 3, 3, -2e-4\n" for node in range(15, 19))
    text = text.replace("*DLOAD\n", f"*BOUNDARY\n{push}*DLOAD\n")
    (tmp_path / "gap.inp").write_text(text)
    command = [program_path, "-j", "1", "-o", tmp_path, tmp_path / "gap.inp"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    assert "CONTACT1: open by up to 1e-4 in the mesh, closed at the end of all" in done.stderr
    assert "never open" not in done.stderr
    joint = json.loads((tmp_path / "gap.json").read_text())["joints"]["CONTACT1"]
    assert joint["open_in_mesh"] == pytest.approx(1e-4, rel=1e-9)  # digits of 1.0001
    assert joint["opening"]["anywhere"]["value"] == 0.0


def test_fields_that_static_steps_lack_are_told_once(tmp_path, program_path):
    deck = Path(__file__).resolve().parents[1] / "errors" / "base" / "block.inp"
    text = deck.read_text().replace("*END STEP", "*NODE FILE\nU, V\n*END STEP")
    step = "*STEP\n*STATIC\n*DLOAD, OP=NEW\nDAM, GRAV, 5., 0., 0., -1.\n*END STEP\n"
    dynamic = "*STEP\n*DYNAMIC\n0.01, 0.02\n*END STEP\n"
    (tmp_path / "steps.inp").write_text(text + step + dynamic)
    command = [program_path, "-j", "1", "-o", tmp_path, tmp_path / "steps.inp"]
    subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    warnings = json.loads((tmp_path / "steps.json").read_text(encoding="utf-8"))["warnings"]
    about_v = [text for text in warnings if "field V" in text]
    assert about_v == [
        "static steps have no field V: job.h5 and the VTK series are without it there"
    ]


def remarks_in(log: str) -> dict[str, list[str]]:
    """The lines below each heading between the echo of the deck and the first increment."""
    lines = log.splitlines()
    headings = [line for line in ("warnings of the deck", "ignored input") if line in lines]
    places = [lines.index(line) for line in headings]
    ends = [*places[1:], next(i for i, line in enumerate(lines) if line.startswith("step "))]
    return {
        heading: [line for line in lines[place + 1 : end] if "job.inp:" in line]
        for heading, place, end in zip(headings, places, ends, strict=True)
    }


@pytest.mark.parametrize("options", [(), ("-q",)])
def test_log_lists_warnings_and_ignored_cards_as_they_were_printed(keyway, options):
    deck = (BASES / "block.inp").read_text(encoding="utf-8")
    deck = deck.replace("*STATIC", "*STATIC, SOLVER=PARDISO").replace("*STEP", "*PREPRINT\n*STEP")
    deck = deck.replace("*BOUNDARY", "*AMPLITUDE, NAME=IDLE\n0., 0., 1., 1.\n*BOUNDARY")
    deck = deck.replace("*END STEP", "*MONITOR, DOF=1, NODE=1\n*EL FILE\nS, FOO\n*END STEP")
    run = keyway(deck, *options)
    found = remarks_in((run.folder / "job.log").read_text(encoding="utf-8"))
    ignored, warnings = run.json["ignored_input"], run.json["warnings"]
    assert len(ignored) > 3 and warnings
    assert len(found["ignored input"]) == len(ignored)
    for line, card in zip(found["ignored input"], ignored, strict=True):
        assert f":{card['line']}: *{card['keyword']}: warning: {card['why']}" in line
    for line, warning in zip(found["warnings of the deck"], warnings, strict=True):
        assert line.startswith(warning)
    if not options:
        printed = [line for line in run.stderr.splitlines() if "job.inp:" in line]
        assert sorted(printed) == sorted(line for lines in found.values() for line in lines)


def test_log_names_long_elements(keyway):
    """theory.md, 11.5: the log has the number of the elements whose strength is lowered."""
    deck = (BASES / "concrete.inp").read_text(encoding="utf-8")
    law = deck[deck.index("*CONCRETE TENSION STIFFENING") : deck.index("*SOLID SECTION")]
    long = "*CONCRETE TENSION STIFFENING, TYPE=GFI, LONG ELEMENTS=LOWER STRENGTH\n2.48e6, 100.\n"
    run = keyway(deck.replace(law, long))
    log = (run.folder / "job.log").read_text(encoding="utf-8")
    assert any("longer than" in line for line in remarks_in(log)["warnings of the deck"])


def test_log_of_material_tests_lists_what_is_ignored(keyway):
    deck = (BASES / "material_test.inp").read_text(encoding="utf-8")
    run = keyway("*PREPRINT\n" + deck, "--material")
    log = (run.folder / "job_material.log").read_text(encoding="utf-8")
    assert "\nignored input\n" in log
