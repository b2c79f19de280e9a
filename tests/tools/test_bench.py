"""The bench measures correctly; its limits, for large models, are not checked here."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.path.insert(0, str(ROOT / "tools/bench"))

from cost_of_estimates import write_twin  # noqa: E402
from cost_of_scale import LINEAR, Growth, ScaleBench, ScaleOptions  # noqa: E402
from kept_rows import Row  # noqa: E402
from measured_run import Program  # noqa: E402


def test_bench_measures_a_small_dam(program_path: Path, tmp_path: Path):
    figures = tmp_path / "figures.json"
    words = ["run", "--sizes", "1500", "--increments", "5", "--threads", "1", "--json", figures]
    command = [sys.executable, ROOT / "tools/bench", *words, "--program", program_path]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stderr == ""
    found = {figure["what"]: figure["value"] for figure in json.loads(figures.read_text())}
    for settings in ("", ", PRECISION=MIXED"):
        bare = found.pop(f"linear increment{settings} / solve of CHOLMOD alone", None)
        # A program of its own, which may not be built.
        assert (bare is None) == ("--target bench_bare_solve" in done.stdout)
    assert found.keys() == {
        "deck read and verified [s]",
        "static run / bare solver",
        "memory of the static run [MB]",
        "linear increment / solve",
        "linear increment with envelopes / solve",
        "increment with two joints / solve",
        "increment of undamaged concrete / without its laws",
    }
    assert all(value > 0.0 for value in found.values())
    assert found["linear increment / solve"] > 1.0


def test_scale_keeps_its_rows(tmp_path: Path):
    program, keep = tmp_path / "program", tmp_path / "rows.json"
    program.write_text("one")
    calls = []

    def measure(name: int, _growth: Growth) -> Row:
        calls.append(name)
        return Row(3 * name, [2.0 * name, 8.0 * name**2])

    def grow(names: list[int]) -> Growth:
        bench = ScaleBench(Program(program, 1), tmp_path, ScaleOptions([], [], keep=keep))
        return bench.grow(Growth("size", ("a", "b")), names, measure)

    assert grow([1, 2]).size == [3, 6]
    assert grow([1, 2, 4]).exponents() == pytest.approx([1.0, 2.0])
    assert calls == [1, 2, 4]
    program.write_text("two")  # times of another program do not count
    grow([1])
    assert calls == [1, 2, 4, 1]


def test_scale_leaves_out_what_finds_no_memory(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    program = tmp_path / "program"
    program.write_text("one")
    bench = ScaleBench(Program(program), tmp_path, ScaleOptions([], [], memory=500.0))
    growth = Growth("unknowns", LINEAR, [50_000], [[0.3, 1.9, 0.04, 0.05, 8.0, 400.0]])
    assert bench.linear_row(100_000, growth) is None
    assert capsys.readouterr().out.startswith("100000 unknowns: left out, needs about 1056 MB, 500")


def test_twin_without_estimates_finds_the_files_of_its_deck(program_path: Path, tmp_path: Path):
    """Its mesh beside it, and the records in a folder beside its own."""
    for name in ("built_in_lifts", "cantilever"):
        deck = next((ROOT / "input").rglob(f"{name}.inp"))
        twin = write_twin(deck, tmp_path / name)
        assert "*CONTROLS, ERROR ESTIMATE=OFF" in twin.read_text()
        subprocess.run([program_path.resolve(), "--check", twin], check=True, capture_output=True)


def test_bench_refuses_a_run_without_increments():
    command = [sys.executable, ROOT / "tools/bench", "joints", "--increments", "0"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2
    assert "--increments: 0: expected a whole number, 1 or more" in done.stderr
