"""Signals, limits, locks, and files that a run must not write over (docs/reliability.md)."""

from __future__ import annotations

import json
import resource
import signal
import subprocess
from pathlib import Path

import pytest
from keyway.commands import plot
from keyway_tools.results import why_incomplete
from restart_case import differences, kill_at, rows_of, start
from test_stopped_run import DECK

LONG = {"increments": 100_000, "duration": 1000, "frequency": 50}
SHORT = DECK.format(increments=100, duration=0.1, frequency=5)


@pytest.fixture
def long_deck(tmp_path: Path) -> Path:
    """Tens of thousands of increments."""
    path = tmp_path / "job.inp"
    path.write_text(DECK.format(**LONG))
    return path


def status_of(out: Path) -> tuple[str, str]:
    summary = json.loads((out / "job.json").read_text())
    return summary["status"], summary["message"]


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_stops_the_run(program_path, long_deck, tmp_path, name):
    out = tmp_path / "out"
    process = start(program_path, "-q", "-o", out, long_deck)
    kill_at(process, out / "job_energy.csv", 60, getattr(signal, name), 0.0)
    _, text = process.communicate()
    assert process.returncode == 1
    status, message = status_of(out)
    assert status == "stopped"
    assert f"stopped by {name}" in message
    assert message in text
    rows = rows_of(out / "job_energy.csv")
    assert f"after increment {rows - 1} " in message  # row 0 is the start of the step
    assert not (out / "job.lock").exists()
    assert why_incomplete(out, "job") == message
    assert "envelope_step1" in "".join(p.name for p in (out / "job_vtk").iterdir())


def test_a_second_signal_ends_the_program_at_once(program_path, tmp_path):
    """The mesh is so fine that an increment takes longer than the test waits."""
    path = tmp_path / "job.inp"
    path.write_text(block_deck(26))
    out = tmp_path / "out"
    process = start(program_path, "-q", "-o", out, path)
    while not (out / "job.json").exists():
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(5) == -signal.SIGINT
    assert status_of(out)[0] == "stopped"
    assert not (out / "job.lock").exists()


def block_deck(n: int) -> str:
    """A block of n x n x n bricks under its weight."""
    m = n + 1
    lines = ["*NODE"]
    lines += [f"{1 + i + m * j + m * m * k}, {i}, {j}, {k}"
              for k in range(m) for j in range(m) for i in range(m)]  # fmt: skip
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=E"]
    for k in range(n):
        for j in range(n):
            for i in range(n):
                a = 1 + i + m * j + m * m * k
                low = (a, a + 1, a + 1 + m, a + m)
                ids = [1 + i + n * j + n * n * k, *low, *(x + m * m for x in low)]
                lines.append(", ".join(map(str, ids)))
    lines += ["*MATERIAL, NAME=M", "*DENSITY", "2400", "*ELASTIC", "20e9, 0.2"]
    lines += ["*SOLID SECTION, ELSET=E, MATERIAL=M", "*NSET, NSET=B, GENERATE", f"1, {m * m}"]
    lines += [
        "*BOUNDARY",
        "B, 1, 3",
        "*STEP",
        "*STATIC",
        "1., 1.",
        "*DLOAD",
        "E, GRAV, 9.81, 0, 0, -1",
    ]
    return "\n".join([*lines, "*NODE FILE", "U", "*END STEP", ""])


def test_the_limit_of_file_sizes_stops_the_run(program_path, long_deck, tmp_path):
    text = long_deck.read_text().replace("*DYNAMIC", "*RESTART, WRITE, FREQUENCY=25\n*DYNAMIC")
    long_deck.write_text(text.replace("0.01, 1000", "0.01, 8"))
    out, whole = tmp_path / "out", tmp_path / "whole"

    def limit() -> None:  # above a checkpoint (134 kB), below the fields of the whole run (221 kB)
        resource.setrlimit(resource.RLIMIT_FSIZE, (160_000, resource.RLIM_INFINITY))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)

    done = subprocess.run(
        [program_path, "-q", "-o", out, long_deck],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=limit,
    )
    assert done.returncode == 1
    assert "stopped by the limit of file sizes (ulimit -f)" in done.stderr
    assert status_of(out)[0] == "stopped"
    subprocess.run([program_path, "-q", "-o", out, "--continue", long_deck], check=True)
    subprocess.run([program_path, "-q", "-o", whole, long_deck], check=True)
    assert differences(whole, out) == []


def test_results_that_cannot_be_opened(program_path, tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(SHORT)
    subprocess.run([program_path, "-q", path], check=True, cwd=tmp_path)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)

    done = subprocess.run(
        [program_path, "-q", path],
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        preexec_fn=limit,
    )
    assert done.returncode == 1
    assert "stopped by the limit of file sizes" in done.stderr
    assert not (tmp_path / "job.json").exists()  # the summary of the first run is too long
    assert not (tmp_path / "job.lock").exists()


def test_a_crash_is_marked(program_path, long_deck, tmp_path):
    out = tmp_path / "out"
    process = start(program_path, "-q", "-o", out, long_deck)
    kill_at(process, out / "job_energy.csv", 20, signal.SIGSEGV, 0.0)
    process.communicate()
    assert process.returncode == -signal.SIGSEGV
    assert status_of(out)[0] == "stopped"


def test_a_killed_run_is_recognised(program_path, long_deck, tmp_path, capsys):
    out = tmp_path / "out"
    process = start(program_path, "-q", "-o", out, long_deck)
    kill_at(process, out / "job_energy.csv", 20, 0, 0.0)
    assert why_incomplete(out, "job") == "the run is not at its end yet"
    process.kill()
    process.communicate()
    assert status_of(out)[0] == "running"
    assert (out / "job.lock").read_text().startswith(f"{process.pid} ")
    assert why_incomplete(out, "job") == "the run was killed"
    plot.main([str(out), "-o", str(tmp_path / "pictures")])
    assert "plot: job is incomplete: the run was killed" in capsys.readouterr().err
    long_deck.write_text(SHORT)
    done = subprocess.run(
        [program_path, "-o", out, long_deck], stderr=subprocess.PIPE, text=True, check=True
    )
    assert f"the earlier run of this job (process and host: {process.pid} " in done.stderr
    assert why_incomplete(out, "job") == ""
    assert not (out / "job.lock").exists()


def test_a_new_run_says_that_it_removes_a_checkpoint(program_path, long_deck, tmp_path):
    """One line in the log and on the screen; none where there is no checkpoint."""
    line = "the checkpoint of an earlier run of this job is removed"
    out = tmp_path / "out"
    process = start(program_path, "-q", "-o", out, long_deck)
    kill_at(process, out / "job_energy.csv", 20, signal.SIGTERM, 0.0)
    process.communicate()
    assert (out / "job.ckpt.h5").exists()
    assert line not in (out / "job.log").read_text()
    long_deck.write_text(SHORT)
    for expected in (True, False):
        done = subprocess.run(
            [program_path, "-o", out, long_deck], stderr=subprocess.PIPE, text=True, check=True
        )
        assert (line in done.stderr) == expected
        assert (line in (out / "job.log").read_text()) == expected
        assert not (out / "job.ckpt.h5").exists()


def test_a_second_run_in_the_folder_is_refused(program_path, long_deck, tmp_path):
    out = tmp_path / "out"
    first = start(program_path, "-q", "-o", out, long_deck)
    kill_at(first, out / "job_energy.csv", 20, 0, 0.0)
    second = subprocess.run([program_path, "-o", out, long_deck], stderr=subprocess.PIPE, text=True)
    assert second.returncode == 3
    assert f"process {first.pid} on host " in second.stderr
    bad = tmp_path / "bad"
    bad.mkdir()
    (bad / "job.inp").write_text("*NODES\n")
    subprocess.run([program_path, "-q", "-o", out, bad / "job.inp"], stderr=subprocess.DEVNULL)
    assert status_of(out)[0] == "running"  # the bad deck has not touched it
    other = tmp_path / "other.inp"
    other.write_text(SHORT)
    subprocess.run([program_path, "-q", "-o", out, other], check=True)  # another job
    first.send_signal(signal.SIGTERM)
    first.communicate()
    rows = [line.split(",")[1] for line in (out / "job_energy.csv").read_text().splitlines()[1:]]
    assert rows == [str(i) for i in range(len(rows))]


def test_a_lock_of_another_host_stays(program_path, long_deck, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "job.lock").write_text("123 another-host\n")
    done = subprocess.run([program_path, "-o", out, long_deck], stderr=subprocess.PIPE, text=True)
    assert done.returncode == 3
    assert "process 123 on host another-host" in done.stderr
    assert "remove the file when that process has ended" in done.stderr
    assert [p.name for p in out.iterdir()] == ["job.lock"]


PULSE = "*AMPLITUDE, NAME=PULSE\n0, 0, 0.1, 1, 0.2, 0\n"


@pytest.mark.parametrize(
    ("name", "other", "text"),
    [
        ("job.json", "", SHORT),
        ("job.h5", "", SHORT),
        ("job.lock", "", SHORT),
        ("job.inp", "job.log", SHORT.replace(PULSE, "*INCLUDE, INPUT=job.log\n")),
        (
            "job.inp",
            "job_energy.csv",
            SHORT.replace(PULSE, "*AMPLITUDE, NAME=PULSE, INPUT=job_energy.csv\n"),
        ),
        (
            "job.inp",
            "job_node_HEAD.csv",
            SHORT.replace(PULSE, "*AMPLITUDE, NAME=PULSE, INPUT=link.txt\n"),
        ),
    ],
)
def test_what_is_read_is_not_written_over(program_path, tmp_path, name, other, text):
    (tmp_path / name).write_text(text)
    if other:
        content = PULSE if other == "job.log" else "0, 0, 0.1, 1, 0.2, 0\n"
        (tmp_path / other).write_text(content)
        (tmp_path / "link.txt").symlink_to(tmp_path / other)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    done = subprocess.run(
        [program_path, "-q", name], stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    assert done.returncode == 2
    assert "the run would write over '" in done.stderr
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_a_table_of_an_earlier_run_stays_when_it_is_read(program_path, tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(SHORT)
    subprocess.run([program_path, "-q", path], check=True, cwd=tmp_path)
    table = tmp_path / "job_node_HEAD.csv"
    table.write_text("0, 0, 0.1, 1, 0.2, 0\n")
    text = SHORT.replace("*NODE PRINT, NSET=HEAD, FREQUENCY=5\nU\n", "")
    path.write_text(text.replace(PULSE, f"*AMPLITUDE, NAME=PULSE, INPUT={table.name}\n"))
    subprocess.run([program_path, "-q", path], check=True, cwd=tmp_path)
    assert table.read_text() == "0, 0, 0.1, 1, 0.2, 0\n"


def test_a_bad_deck_marks_the_earlier_summary(program_path, tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(SHORT)
    subprocess.run([program_path, "-q", path], check=True, cwd=tmp_path)
    before = json.loads((tmp_path / "job.json").read_text())
    path.write_text(SHORT.replace("*DENSITY", "*DENSITTY"))
    for option in ("--check", "--material"):  # neither says anything about a run
        subprocess.run([program_path, option, path], cwd=tmp_path, stderr=subprocess.DEVNULL)
        assert status_of(tmp_path) == ("finished", "")
    done = subprocess.run([program_path, path], cwd=tmp_path, stderr=subprocess.DEVNULL)
    assert done.returncode == 2
    status, message = status_of(tmp_path)
    assert status == "stopped"
    assert "the deck has errors; these results are of an earlier deck" in message
    after = json.loads((tmp_path / "job.json").read_text())
    assert {**after, "status": "", "message": ""} == {**before, "status": "", "message": ""}
    assert why_incomplete(tmp_path, "job") == message
