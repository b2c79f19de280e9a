"""The ledger: the parts add up in every run, job.h5 has the ledger, and the log ends with it."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

INPUT = Path(__file__).parents[2] / "input"
# Of the table at the end of the log, with single blanks.
HEADING = "time [s] share memory [MB] calls part"
# Numbers of job.json have 13 digits or more; the times of the runs stay below 1000 s.
PRINTED = 1e-9
# job.json is made between the reading of the parts and that of the peak memory [MB].
MEMORY = 1.0


def check_sums(ledger: dict) -> None:
    parts = ledger["parts"]
    assert all(part["wall_s"] >= 0 and part["memory_mb"] >= 0 for part in parts)
    assert sum(part["wall_s"] for part in parts) == pytest.approx(ledger["wall_s"], abs=PRINTED)
    memory = sum(part["memory_mb"] for part in parts)
    assert memory == pytest.approx(ledger["peak_memory_mb"], abs=MEMORY)
    assert all(part["name"] == f"{part['work']} {part['effect']}" for part in parts)
    keys = [(part["work"], part["effect"], part["kind"]) for part in parts]
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize(
    ("deck", "expected"),
    [
        ("sliding_block", {("iterate", "BED", "joint"), ("write", "CSV", "output")}),
        ("petersson_beam", {("update", "CONCRETE", "inelastic")}),
        ("monolith_frequencies", {("solve", "modes", "solver"), ("read", "deck", "deck")}),
    ],
)
def test_parts_add_up(deck: str, expected: set, keyway) -> None:
    run = keyway(INPUT / f"{deck}.inp")
    check_sums(run.json["ledger"])
    parts = run.json["ledger"]["parts"]
    found = {(part["work"], part["effect"], part["kind"]) for part in parts}
    assert found >= expected
    assert not {effect for _, effect, _ in found} & {"joints", "inelastic solids"}


def test_job_h5_holds_the_ledger(keyway) -> None:
    run = keyway(INPUT / "block_on_joint.inp")
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        ledger = file["ledger"]
        names = [name.decode() for name in ledger["name"][:]]
        seconds = ledger["wall_s"][:]
        # the same double-precision numbers, not printed
        assert seconds.sum() == pytest.approx(ledger.attrs["wall_s"], abs=1e-9)
        words = zip(ledger["work"][:], ledger["effect"][:], strict=True)
        assert names == [f"{work.decode()} {effect.decode()}" for work, effect in words]
        calls = dict(zip(names, ledger["calls"][:], strict=True))
        kinds = dict(zip(names, ledger["kind"][:], strict=True))
    parts = {part["name"]: part for part in run.json["ledger"]["parts"]}
    # job.json comes last: calls that end in between are those of the files
    assert {name: part["calls"] for name, part in parts.items() if part["kind"] != "output"} == {
        name: count for name, count in calls.items() if kinds[name] != b"output"
    }
    assert run.json["ledger"]["wall_s"] >= seconds.sum()


def test_log_ends_with_the_ledger(keyway) -> None:
    run = keyway(INPUT / "sliding_block.inp")
    log = (run.folder / f"{run.job}.log").read_text().splitlines()
    (start,) = (i for i, line in enumerate(log) if line.startswith("finished in "))
    table = log[start + 2 :]
    assert log[start + 1].split() == HEADING.split()
    assert len(table) <= 14
    assert run.stderr.splitlines()[-len(table) - 2 :] == log[start:]
    seconds = [float(line.split()[0]) for line in table]
    shares = [float(line.split()[1].rstrip("%")) for line in table]
    assert table[-1].endswith("  other")
    assert seconds[:-1] == sorted(seconds[:-1], reverse=True)
    # each row is rounded to 0.1 %
    assert sum(shares) == pytest.approx(100, abs=0.05 * len(table))


def test_quiet_run_prints_no_ledger(keyway) -> None:
    run = keyway(INPUT / "block_on_joint.inp", "-q")
    assert run.stderr == ""
    assert HEADING in " ".join((run.folder / f"{run.job}.log").read_text().split())


def test_failed_run_leaves_the_ledger(keyway) -> None:
    """The block is lifted off its bed and has no equilibrium."""
    text = (INPUT / "sliding_block.inp").read_text()
    lifted = text.replace("GRAV, 10., 0., 0., -1.", "GRAV, 10., 0., 0., 1.")
    assert lifted != text
    motion = "sliding_block_base.txt"
    run = keyway(lifted, code=1, files={motion: (INPUT / motion).read_text()})
    assert run.json["status"] == "stopped"
    assert "what it has computed" not in run.stderr  # no increment has been
    check_sums(run.json["ledger"])
    assert "iterate BED" in {part["name"] for part in run.json["ledger"]["parts"]}
    assert HEADING in " ".join((run.folder / "job.log").read_text().split())
